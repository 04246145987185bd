//! What happened, on one screen.

use std::fmt::{self, Write as _};
use std::path::PathBuf;
use std::time::Duration;

use rsapien_sim::geometry::Ellipse;
use serde_json::{Value, json};

use crate::behaviour::{BallFound, Sight};
use crate::cli::view::seconds;
use crate::{LineCounts, PlayReport};

/// How the walk went.
pub(super) struct Walk {
    pub(super) played: PlayReport,
    /// How far the robot came, where a simulator knows.
    pub(super) distance_m: Option<f64>,
}

/// Everything that the demo tells.
pub(super) struct Report {
    pub(super) link: String,
    pub(super) initialised_ms: u64,
    pub(super) walk: Option<Walk>,
    pub(super) looked_ms: u64,
    pub(super) sights: Vec<Sight>,
    pub(super) found: Option<BallFound>,
    /// The balls that can be seen in the end, where a simulator knows.
    pub(super) truth_balls: Option<Vec<Ellipse>>,
    pub(super) counts: LineCounts,
    pub(super) robot_ms: u64,
    pub(super) wall: Duration,
    pub(super) picture_file: Option<PathBuf>,
    pub(super) log_file: PathBuf,
}

/// The detection against the truth, in pixels.
struct Deviation {
    center_px: f64,
    radius_px: f64,
    truth: Ellipse,
}

impl fmt::Display for Walk {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let PlayReport { outcome, steps_ended, steps_total, elapsed_ms, .. } = &self.played;
        write!(
            formatter,
            "walked for {}: {outcome}, {steps_ended} of {steps_total} steps",
            seconds(*elapsed_ms)
        )?;
        match self.distance_m {
            Some(distance_m) => write!(formatter, ", {distance_m:.2} m"),
            None => Ok(()),
        }
    }
}

impl Report {
    /// Whether the ball is centred.
    pub(super) fn is_success(&self) -> bool {
        self.found.as_ref().is_some_and(|found| found.is_centered)
    }

    fn deviation(&self) -> Option<Deviation> {
        let found = self.found.as_ref()?.sight.ball?.ellipse;
        let distance = |truth: &Ellipse| {
            (truth.center_x - found.center_x_px).hypot(truth.center_y - found.center_y_px)
        };
        let truth = *self
            .truth_balls
            .as_ref()?
            .iter()
            .min_by(|one, other| distance(one).total_cmp(&distance(other)))?;
        let radius = f64::midpoint(found.semi_major_px, found.semi_minor_px);
        let true_radius = f64::midpoint(truth.semi_major, truth.semi_minor);
        // Rounded as it is shown; adding 0 turns -0 into 0.
        let radius_px = ((radius - true_radius) * 10.0).round() / 10.0 + 0.0;
        Some(Deviation { center_px: distance(&truth), radius_px, truth })
    }

    fn detection_ms(&self) -> f64 {
        let total: Duration = self.sights.iter().map(|sight| sight.detection.cost.total()).sum();
        // A handful of looks.
        #[allow(clippy::cast_precision_loss)]
        let count = self.sights.len().max(1) as f64;
        total.as_secs_f64() * 1e3 / count
    }

    /// The summary for people.
    pub(super) fn text(&self) -> String {
        let mut text = String::from("\n");
        text.push_str(match &self.found {
            Some(found) if found.is_centered => "The ball is found and centred.\n",
            Some(_) => "The ball was seen, and the head could not centre it.\n",
            None => "No ball was found.\n",
        });
        // Writing to a string cannot fail.
        let mut line = |name: &str, what: String| {
            let _ = write!(text, "\n  {name:<12}{what}");
        };
        line("initialised", format!("in {}", seconds(self.initialised_ms)));
        if let Some(walk) = &self.walk {
            line("walked", walk.to_string().trim_start_matches("walked ").to_owned());
        }
        let looks = match self.sights.len() {
            1 => "1 picture".to_owned(),
            count => format!("{count} pictures"),
        };
        line(
            "looked",
            format!(
                "for {}, {looks}, {:.0} ms a detection",
                seconds(self.looked_ms),
                self.detection_ms()
            ),
        );
        if let Some(found) = &self.found
            && let Some(ball) = &found.sight.ball
        {
            let (direction, ellipse) = (found.sight.direction, ball.ellipse);
            line(
                "ball",
                format!(
                    "first seen in picture {}; now at pan {:.1}, tilt {:.1} degrees, {:.1} px from the middle",
                    found.first_seen, direction.pan_deg, direction.tilt_deg, found.offset_px
                ),
            );
            line(
                "ellipse",
                format!(
                    "centre ({:.1}, {:.1}), semi-axes {:.1} x {:.1} px, {} points on its contour",
                    ellipse.center_x_px,
                    ellipse.center_y_px,
                    ellipse.semi_major_px,
                    ellipse.semi_minor_px,
                    ball.quality
                ),
            );
        }
        if let Some(deviation) = self.deviation() {
            line(
                "truth",
                format!(
                    "centre ({:.1}, {:.1}), semi-axes {:.1} x {:.1} px: off by {:.1} px, radius by {:+.1} px",
                    deviation.truth.center_x,
                    deviation.truth.center_y,
                    deviation.truth.semi_major,
                    deviation.truth.semi_minor,
                    deviation.center_px,
                    deviation.radius_px
                ),
            );
        }
        let LineCounts { sent, resent, answered, reception_errors, .. } = self.counts;
        line(
            "packages",
            format!(
                "{sent} sent, {answered} answered, {resent} sent again, {reception_errors} reception errors"
            ),
        );
        line(
            "time",
            format!(
                "{} of the robot's in {:.1} s",
                seconds(self.robot_ms),
                self.wall.as_secs_f64()
            ),
        );
        if let Some(path) = &self.picture_file {
            line("picture", path.display().to_string());
        }
        line("log", self.log_file.display().to_string());
        text
    }

    /// The summary for programs.
    pub(super) fn json(&self) -> Value {
        let ball = self.found.as_ref().and_then(|found| {
            let ellipse = found.sight.ball?.ellipse;
            Some(json!({
                "first_seen": found.first_seen,
                "centred": found.is_centered,
                "offset_px": found.offset_px,
                "pan_deg": found.sight.direction.pan_deg,
                "tilt_deg": found.sight.direction.tilt_deg,
                "ellipse": [
                    ellipse.center_x_px, ellipse.center_y_px,
                    ellipse.semi_major_px, ellipse.semi_minor_px, ellipse.theta_rad,
                ],
            }))
        });
        json!({
            "link": self.link,
            "success": self.is_success(),
            "initialised_ms": self.initialised_ms,
            "walk": self.walk.as_ref().map(|walk| json!({
                "outcome": walk.played.outcome.to_string(),
                "steps_ended": walk.played.steps_ended,
                "steps_total": walk.played.steps_total,
                "elapsed_ms": walk.played.elapsed_ms,
                "distance_m": walk.distance_m,
            })),
            "looks": self.sights.len(),
            "looked_ms": self.looked_ms,
            "detection_ms": self.detection_ms(),
            "ball": ball,
            "deviation": self.deviation().map(|deviation| json!({
                "center_px": deviation.center_px,
                "radius_px": deviation.radius_px,
            })),
            "packages": {
                "sent": self.counts.sent,
                "answered": self.counts.answered,
                "resent": self.counts.resent,
                "reception_errors": self.counts.reception_errors,
            },
            "robot_ms": self.robot_ms,
            "wall_ms": self.wall.as_secs_f64() * 1e3,
            "picture": self.picture_file,
            "log": self.log_file,
        })
    }
}
