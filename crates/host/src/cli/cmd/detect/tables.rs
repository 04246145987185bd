//! The paper's Table 2 and Table 3.

use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt;

use rsapien_vision::paper::Detection;

use crate::cli::output::Table;

/// Both tables, a detection at a time.
#[derive(Debug)]
pub(super) struct Tables {
    ellipses: Table,
    statistics: Table,
}

impl Default for Tables {
    fn default() -> Self {
        Self {
            ellipses: Table::new(&[
                "Image",
                "Center x (pixels)",
                "Center y (pixels)",
                "Major Axis (pixels)",
                "Minor Axis (pixels)",
                "Alfa (rad)",
                "Alfa by equation (6)",
            ]),
            statistics: Table::new(&[
                "Image",
                "Virtual Ellipses",
                "Real Ellipses",
                "Ellipse Quality",
                "Search Point Pairs",
                "Total Edge Points",
            ]),
        }
    }
}

impl Tables {
    /// Adds what was found in a picture.
    pub(super) fn add(&mut self, name: &str, detection: &Detection) {
        for found in &detection.ellipses {
            let ellipse = found.ellipse;
            // In (-π/2, π/2], so that an axis a little off the horizontal has a small angle, as in the paper.
            let angle = if ellipse.theta_rad > FRAC_PI_2 {
                ellipse.theta_rad - PI
            } else {
                ellipse.theta_rad
            };
            self.ellipses.row([
                name.to_owned(),
                format!("{:.1}", ellipse.center_x_px),
                format!("{:.1}", ellipse.center_y_px),
                format!("{:.0}", ellipse.semi_major_px),
                format!("{:.0}", ellipse.semi_minor_px),
                format!("{angle:.3}"),
                ellipse.paper_alpha().map_or("-".to_owned(), |alpha| format!("{alpha:.3}")),
            ]);
        }
        let statistics = &detection.statistics;
        self.statistics.row([
            name.to_owned(),
            statistics.virtual_ellipses.to_string(),
            statistics.real_ellipses.to_string(),
            statistics.quality_min.to_string(),
            statistics.search_point_pairs.to_string(),
            statistics.edge_points.to_string(),
        ]);
    }
}

impl fmt::Display for Tables {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.statistics.is_empty() {
            return Ok(());
        }
        writeln!(formatter, "Table 2: detected ellipses parameters (the axes are semi-axes)")?;
        writeln!(formatter, "{}\n", self.ellipses)?;
        writeln!(formatter, "Table 3: detected ellipses statistics")?;
        writeln!(formatter, "{}", self.statistics)
    }
}

/// Table 3 of one picture for programs, with the tangents of Table 2.
pub(super) fn counts(detection: &Detection) -> serde_json::Value {
    let statistics = &detection.statistics;
    let alphas: Vec<_> =
        detection.ellipses.iter().map(|found| found.ellipse.paper_alpha()).collect();
    serde_json::json!({
        "virtual_ellipses": statistics.virtual_ellipses,
        "real_ellipses": statistics.real_ellipses,
        "ellipse_quality": statistics.quality_min,
        "search_point_pairs": statistics.search_point_pairs,
        "total_edge_points": statistics.edge_points,
        "alfa_by_equation_6": alphas,
    })
}
