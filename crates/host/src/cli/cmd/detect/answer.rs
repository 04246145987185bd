//! How a detection is told: lines for people, JSON and CSV for programs.

use std::io::Write;

use rsapien_vision::{DetectedEllipse, Detection, Ellipse, Picture};
use serde::Serialize;
use serde_json::Value;

use super::search::{Either, Found};
use super::tables;
use crate::cli::diagnostics::Result;
use crate::cli::output::Table;

/// The columns of `--csv`. Those that a preset does not know stay empty.
const COLUMNS: [&str; 13] = [
    "image",
    "center_x_px",
    "center_y_px",
    "semi_major_px",
    "semi_minor_px",
    "theta_rad",
    "score",
    "support_share",
    "gradient_agreement",
    "log10_false_alarms",
    "residual_px",
    "stroke_width_px",
    "quality",
];

/// One line for people.
pub(super) fn summary(name: &str, picture: &Picture, found: &Found) -> String {
    let count = match found.ellipses().len() {
        0 => "no ellipse".to_owned(),
        1 => "1 ellipse".to_owned(),
        count => format!("{count} ellipses"),
    };
    let limits = match (&found.detection, found.is_truncated()) {
        (_, false) => "",
        (Either::Default(_), true) => {
            "; there may be more: the picture is so crowded that the search was cut short"
        }
        (Either::Paper(_), true) => {
            "; more of it is edge than a search can use: the picture is noise, or the options ask for too much"
        }
    };
    let (width, height, ms) = (picture.width(), picture.height(), found.duration_ms());
    format!("{name} ({width} x {height}): {count} in {ms:.1} ms{limits}")
}

/// The ellipses for people; `None` when there are none.
pub(super) fn listing(found: &Found) -> Option<Table> {
    // The paper's detector knows its ellipses to about a pixel, the default one to parts of one.
    let (last, digits) = match &found.detection {
        Either::Default(_) => (&["score", "stroke"][..], 2),
        Either::Paper(_) => (&["quality"][..], 1),
    };
    let head = ["  ", "center x", "center y", "semi-major", "semi-minor", "theta (rad)"];
    let mut table = Table::new(&[&head, last].concat());
    let mut row = |ellipse: &Ellipse, last: Vec<String>| {
        let numbers = numbers(ellipse);
        let cells = std::iter::once(String::new())
            .chain(numbers[..4].iter().map(|number| format!("{number:.digits$}")))
            .chain([format!("{:.3}", numbers[4])]);
        table.row(cells.chain(last));
    };
    match &found.detection {
        Either::Default(detection) => {
            for found in &detection.ellipses {
                let stroke = found.stroke_width_px.map(|width| format!("{width:.1}"));
                let last = vec![format!("{:.2}", found.score), stroke.unwrap_or("-".to_owned())];
                row(&found.ellipse, last);
            }
        }
        Either::Paper(detection) => {
            for found in &detection.ellipses {
                row(&found.ellipse, vec![found.quality.to_string()]);
            }
        }
    }
    (!table.is_empty()).then_some(table)
}

/// Centre x and y, semi-major and semi-minor axis in pixels, angle in radians.
pub(in crate::cli::cmd) fn numbers(ellipse: &Ellipse) -> [f64; 5] {
    [
        ellipse.center_x_px,
        ellipse.center_y_px,
        ellipse.semi_major_px,
        ellipse.semi_minor_px,
        // Adding 0 turns -0 into 0.
        ellipse.theta_rad + 0.0,
    ]
}

/// One line for programs; the keys stay in this order.
#[derive(Serialize)]
pub(super) struct Answer<'a> {
    image: &'a str,
    width: usize,
    height: usize,
    ms: f64,
    ellipses: Vec<[f64; 5]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    scores: Option<Vec<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    details: Option<Vec<Details>>,
    truncated: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    statistics: Option<Value>,
}

/// What speaks for an ellipse.
#[derive(Serialize)]
struct Details {
    support_share: f64,
    inside_share: f64,
    gap_share: f64,
    gradient_agreement: f64,
    log10_false_alarms: f64,
    residual_px: f64,
    stroke_width_px: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    covariance: Option<[[f64; 5]; 5]>,
    /// x and y in pixels, direction of the gradient in radians.
    #[serde(skip_serializing_if = "Option::is_none")]
    points: Option<Vec<[f32; 3]>>,
}

impl Details {
    fn new(detection: &Detection, found: &DetectedEllipse) -> Self {
        let points = detection.support_of(found);
        let point =
            |point: &rsapien_vision::SupportPoint| [point.x_px, point.y_px, point.gradient_rad];
        Self {
            support_share: found.support_share,
            inside_share: found.inside_share,
            gap_share: found.gap_share,
            gradient_agreement: found.gradient_agreement,
            log10_false_alarms: found.log10_false_alarms,
            residual_px: found.residual_px,
            stroke_width_px: found.stroke_width_px,
            covariance: found.covariance,
            points: (!points.is_empty()).then(|| points.iter().map(point).collect()),
        }
    }
}

/// The line of a picture; `with_counts` adds the counts of the paper's Table 3.
pub(super) fn line<'a>(
    name: &'a str,
    picture: &Picture,
    found: &Found,
    with_counts: bool,
) -> Answer<'a> {
    let (scores, details, statistics) = match &found.detection {
        Either::Default(detection) => (
            Some(detection.ellipses.iter().map(|found| found.score).collect()),
            Some(detection.ellipses.iter().map(|found| Details::new(detection, found)).collect()),
            None,
        ),
        Either::Paper(detection) => (None, None, with_counts.then(|| tables::counts(detection))),
    };
    Answer {
        image: name,
        width: picture.width(),
        height: picture.height(),
        ms: found.duration_ms(),
        ellipses: found.ellipses().iter().map(numbers).collect(),
        scores,
        details,
        truncated: found.is_truncated(),
        statistics,
    }
}

/// Writes the head of the CSV.
pub(super) fn csv_head(out: &mut impl Write) -> Result<()> {
    writeln!(out, "{}", COLUMNS.join(","))?;
    Ok(())
}

/// Writes a row of CSV for every ellipse.
pub(super) fn csv_rows(out: &mut impl Write, name: &str, found: &Found) -> Result<()> {
    let name = csv_text(name);
    let mut row = |ellipse: &Ellipse, last: [String; 7]| {
        let [x, y, major, minor, theta] = numbers(ellipse);
        let last = last.join(",");
        writeln!(out, "{name},{x:.4},{y:.4},{major:.4},{minor:.4},{theta:.6},{last}")
    };
    match &found.detection {
        Either::Default(detection) => {
            for found in &detection.ellipses {
                let numbers = [
                    found.score,
                    found.support_share,
                    found.gradient_agreement,
                    found.log10_false_alarms,
                    found.residual_px,
                ];
                let [score, share, agreement, alarms, residual] =
                    numbers.map(|number| format!("{number:.4}"));
                let stroke =
                    found.stroke_width_px.map_or(String::new(), |width| format!("{width:.4}"));
                row(
                    &found.ellipse,
                    [score, share, agreement, alarms, residual, stroke, String::new()],
                )?;
            }
        }
        Either::Paper(detection) => {
            for found in &detection.ellipses {
                let mut last = [const { String::new() }; 7];
                last[6] = found.quality.to_string();
                row(&found.ellipse, last)?;
            }
        }
    }
    Ok(out.flush()?)
}

/// A text as a field of CSV (RFC 4180).
pub(in crate::cli::cmd) fn csv_text(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}
