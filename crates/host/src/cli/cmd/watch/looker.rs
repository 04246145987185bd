//! What is found in each frame, and followed from frame to frame.

use std::time::{Duration, Instant};

use clap::Args;
use rsapien_vision::{
    Detector, Ellipse, GrayView, Options, Track, TrackState, Tracker, TrackerOptions,
};

use crate::cli::diagnostics::{Failure, Result};
use crate::cli::limits::LimitOptions;

/// What steers the detector.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Options of the detector")]
pub(super) struct LookerOptions {
    #[command(flatten)]
    limits: LimitOptions,

    /// Find the ellipses of each frame by itself, and follow none: for pictures that have nothing to do with each other
    #[arg(long)]
    no_tracks: bool,
}

impl LookerOptions {
    pub(super) fn looker(&self) -> Result<Looker> {
        let detector = self.limits.detector(Options::default())?;
        if self.no_tracks {
            return Ok(Looker::Finder(Box::new(detector)));
        }
        let tracker = Tracker::new(detector, TrackerOptions::default());
        Ok(Looker::Follower(Box::new(tracker.map_err(|error| Failure::from_error(&error))?)))
    }
}

/// Looks at one frame after the other.
pub(super) enum Looker {
    /// At each by itself.
    Finder(Box<Detector>),
    /// With the tracks of those before it.
    Follower(Box<Tracker>),
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
    pub(super) state: TrackState,
}

impl Looker {
    /// Looks at the frame taken at `time_s`, in seconds from the first one on.
    pub(super) fn look(&mut self, view: &GrayView<'_>, time_s: f64) -> Look {
        let start = Instant::now();
        match self {
            Self::Finder(detector) => {
                let found = detector.detect(view);
                let took = start.elapsed();
                let (ellipses, scores) =
                    found.ellipses.iter().map(|found| (found.ellipse, found.score)).unzip();
                Look { ellipses, scores, tracks: None, took }
            }
            Self::Follower(tracker) => {
                let tracks = tracker.update(view, time_s);
                let took = start.elapsed();
                let seen = tracks.iter().filter(|track| track.misses == 0);
                let (ellipses, scores) = seen.map(|track| (track.ellipse, track.score)).unzip();
                let tracks = Some(tracks.iter().map(Followed::from).collect());
                Look { ellipses, scores, tracks, took }
            }
        }
    }
}

impl From<&Track> for Followed {
    fn from(track: &Track) -> Self {
        Self { id: track.id, ellipse: track.ellipse, state: track.state }
    }
}
