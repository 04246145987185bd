//! Ellipses through a video: the last pictures say where to look in the next one.
//!
//! Every picture goes three steps. Where each ellipse should be is predicted (constant velocity, a Kalman filter for each
//! parameter); the detector [looks near there](Detector::detect_near); what it finds is given to the tracks by overlap and
//! smooths them. A *fresh* look at the whole picture is taken of the first picture, of every
//! [`fresh_every`](TrackerOptions::fresh_every)-th, while no track is confirmed, and at once where more than half of the
//! confirmed tracks get lost together, as when the camera is moved. Then tracks that moved by the same shift keep their
//! identity.
//!
//! The same pictures and times give the same tracks.

mod association;
mod filter;
mod shift;
#[cfg(test)]
mod tests;
mod tracks;

use crate::detection::Detection;
use crate::detector::Detector;
use crate::ellipse::Ellipse;
use crate::image::GrayView;
use crate::options::{OptionsError, check};
use filter::Filter;
use tracks::Tracks;

/// How a track stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TrackState {
    /// Not seen often enough yet; goes with the first picture that does not show it.
    Tentative,
    /// Seen in this picture and often enough.
    Confirmed,
    /// Not seen in this picture: its ellipse is where it should be.
    Predicted,
}

/// An ellipse followed from picture to picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// Who it is: lasts as long as the track and is given to no other one.
    pub id: u64,
    /// The ellipse in this picture, smoothed, in canonical form.
    pub ellipse: Ellipse,
    /// Velocity `[x, y]` of its centre in pixels a second.
    pub velocity_px_per_s: [f64; 2],
    /// [Score](crate::DetectedEllipse::score) of the ellipse when it was last seen, `0..=1`.
    pub score: f64,
    /// Pictures since it was first seen, that one included.
    pub age: u32,
    /// Pictures that showed it.
    pub sightings: u32,
    /// Pictures since one showed it; 0 if this one did.
    pub misses: u32,
    /// How it stands.
    pub state: TrackState,
    filter: Filter,
}

impl Track {
    /// Standard deviation `[x, y]` of the centre in pixels, as the filter estimates it.
    pub fn center_deviation_px(&self) -> [f64; 2] {
        self.filter.center_deviation_px()
    }
}

/// How a picture was looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Look {
    /// All of it.
    #[default]
    Fresh,
    /// Near the predictions only.
    Near,
    /// Near the predictions, and then all of it because too few were found.
    NearThenFresh,
}

/// Everything that steers a [`Tracker`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackerOptions {
    /// Every how manieth picture is looked at as a whole, `1..=1000`. New ellipses are found in those only. 8 keeps the
    /// mean cost of a picture below half of a fresh one's where looking near costs up to 0.4 of it.
    pub fresh_every: u32,
    /// Pictures that must show an ellipse before its track is confirmed, `1..=100`.
    pub confirmations: u32,
    /// Pictures for which a confirmed track that is not seen is kept, `0..=1000`.
    pub misses_max: u32,
    /// Least overlap of a prediction with the ellipse that it is taken for, `0.05..=0.95`. One of the same shape that lies
    /// beside it is taken too where the uncertainty of the prediction allows.
    pub overlap_min: f64,
    /// Standard deviation in pixels that each centre and mean radius has at least, `0.001..=100`; that of the detector's
    /// fit comes to it.
    pub noise_px: f64,
    /// Standard deviation in pixels a second squared by which velocities change on their own, `0..=1e6`: the lower, the
    /// smoother. A sudden turn raises it for a moment.
    pub acceleration_px_per_s2: f64,
    /// Standard deviation in pixels a second of the velocity of what is seen for the first time, `0..=1e6`.
    pub speed_px_per_s: f64,
}

impl Default for TrackerOptions {
    fn default() -> Self {
        Self {
            fresh_every: 8,
            confirmations: 2,
            misses_max: 5,
            overlap_min: 0.5,
            noise_px: 0.25,
            acceleration_px_per_s2: 100.0,
            speed_px_per_s: 300.0,
        }
    }
}

impl TrackerOptions {
    /// Checks every field.
    ///
    /// # Errors
    /// The first field outside its range, by name, with its value and the range.
    pub fn validate(&self) -> Result<(), OptionsError> {
        check("tracker.fresh_every", f64::from(self.fresh_every), 1.0, 1000.0)?;
        check("tracker.confirmations", f64::from(self.confirmations), 1.0, 100.0)?;
        check("tracker.misses_max", f64::from(self.misses_max), 0.0, 1000.0)?;
        check("tracker.overlap_min", self.overlap_min, 0.05, 0.95)?;
        check("tracker.noise_px", self.noise_px, 0.001, 100.0)?;
        check("tracker.acceleration_px_per_s2", self.acceleration_px_per_s2, 0.0, 1e6)?;
        check("tracker.speed_px_per_s", self.speed_px_per_s, 0.0, 1e6)
    }
}

/// Finds ellipses in a series of pictures and follows them.
#[derive(Debug, Clone)]
pub struct Tracker {
    detector: Detector,
    tracks: Tracks,
}

impl Tracker {
    /// A tracker that looks with this detector. With [`covariance`](crate::Options::covariance) among the detector's
    /// options the filters weigh each parameter by it, and otherwise by the residual and the length of the contour.
    ///
    /// # Errors
    /// The first option outside its range, by name, with its value and the range.
    pub fn new(detector: Detector, options: TrackerOptions) -> Result<Self, OptionsError> {
        options.validate()?;
        Ok(Self { detector, tracks: Tracks::new(options) })
    }

    /// Looks at the next picture, taken at `time_s` in seconds from any start, and gives the tracks, oldest first. A time
    /// that is not a number or lies before the last one counts as the same interval again, one later than 10 s after it as
    /// 10 s. A picture of another size than
    /// the last one starts anew.
    pub fn update(&mut self, picture: &GrayView<'_>, time_s: f64) -> &[Track] {
        self.tracks.advance(&mut self.detector, picture, time_s)
    }

    /// The tracks of the last picture, oldest first.
    pub fn tracks(&self) -> &[Track] {
        self.tracks.all()
    }

    /// How the last picture was looked at.
    pub fn look(&self) -> Look {
        self.tracks.look()
    }

    /// The options in force.
    pub fn options(&self) -> &TrackerOptions {
        self.tracks.options()
    }

    /// The detector's options.
    pub fn detector_options(&self) -> &crate::options::Options {
        self.detector.options()
    }

    /// Forgets all tracks. Identities go on from where they are.
    pub fn reset(&mut self) {
        self.tracks.clear();
    }
}

/// What looks at pictures: the detector.
trait Finder {
    fn detect(&mut self, picture: &GrayView<'_>) -> &Detection;
    fn detect_near(&mut self, picture: &GrayView<'_>, predictions: &[Ellipse]) -> &Detection;
}

impl Finder for Detector {
    fn detect(&mut self, picture: &GrayView<'_>) -> &Detection {
        Detector::detect(self, picture)
    }

    fn detect_near(&mut self, picture: &GrayView<'_>, predictions: &[Ellipse]) -> &Detection {
        Detector::detect_near(self, picture, predictions)
    }
}
