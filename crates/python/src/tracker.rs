//! `Tracker` and `Track`: ellipses followed from picture to picture.

use pyo3::prelude::*;
use rsapien_vision::{Detector, Track, TrackState, Tracker, TrackerOptions};
use std::sync::{Mutex, PoisonError};

use crate::detect::PyDetector;
use crate::ellipse::PyEllipse;
use crate::errors::value_error;
use crate::picture::Borrowed;

/// Finds ellipses in a series of pictures and follows them.
#[pyclass(name = "Tracker", module = "rsapien", frozen)]
pub(crate) struct PyTracker {
    tracker: Mutex<Tracker>,
}

#[pymethods]
impl PyTracker {
    #[new]
    #[pyo3(signature = (
        detector=None, *, fresh_every=None, confirmations=None, misses_max=None, overlap_min=None, noise=None,
        acceleration=None, speed=None
    ))]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn new(
        py: Python<'_>,
        detector: Option<&Bound<'_, PyDetector>>,
        fresh_every: Option<u32>,
        confirmations: Option<u32>,
        misses_max: Option<u32>,
        overlap_min: Option<f64>,
        noise: Option<f64>,
        acceleration: Option<f64>,
        speed: Option<f64>,
    ) -> PyResult<Self> {
        let usual = TrackerOptions::default();
        let options = TrackerOptions {
            fresh_every: fresh_every.unwrap_or(usual.fresh_every),
            confirmations: confirmations.unwrap_or(usual.confirmations),
            misses_max: misses_max.unwrap_or(usual.misses_max),
            overlap_min: overlap_min.unwrap_or(usual.overlap_min),
            noise_px: noise.unwrap_or(usual.noise_px),
            acceleration_px_per_s2: acceleration.unwrap_or(usual.acceleration_px_per_s2),
            speed_px_per_s: speed.unwrap_or(usual.speed_px_per_s),
        };
        let detector = detector.map_or_else(Detector::default, |given| given.get().copy(py));
        let tracker = Tracker::new(detector, options).map_err(value_error)?;
        Ok(Self { tracker: Mutex::new(tracker) })
    }

    fn update(
        &self,
        py: Python<'_>,
        image: &Bound<'_, PyAny>,
        time: f64,
    ) -> PyResult<Vec<PyTrack>> {
        let borrowed = Borrowed::new(image)?;
        let pixels = borrowed.pixels();
        let tracks = py.detach(|| {
            let mut tracker = self.tracker.lock().unwrap_or_else(PoisonError::into_inner);
            pixels.with_gray(|view| tracker.update(view, time).to_vec())
        });
        Ok(tracks.map_err(value_error)?.into_iter().map(PyTrack::from).collect())
    }

    #[getter]
    fn tracks(&self, py: Python<'_>) -> Vec<PyTrack> {
        let tracks = self.with(py, |tracker| tracker.tracks().to_vec());
        tracks.into_iter().map(PyTrack::from).collect()
    }

    fn reset(&self, py: Python<'_>) {
        self.with(py, Tracker::reset);
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let (options, count) =
            self.with(py, |tracker| (*tracker.options(), tracker.tracks().len()));
        let plural = if count == 1 { "" } else { "s" };
        format!(
            "Tracker({count} track{plural}, fresh_every={}, confirmations={}, misses_max={})",
            options.fresh_every, options.confirmations, options.misses_max
        )
    }
}

impl PyTracker {
    /// Waits for another thread's picture only while other Python code can run.
    fn with<T: Send>(&self, py: Python<'_>, act: impl FnOnce(&mut Tracker) -> T + Send) -> T {
        py.detach(|| act(&mut self.tracker.lock().unwrap_or_else(PoisonError::into_inner)))
    }
}

/// An ellipse followed from picture to picture, as it stood after one of them.
#[pyclass(name = "Track", module = "rsapien", frozen)]
pub(crate) struct PyTrack {
    track: Track,
}

impl From<Track> for PyTrack {
    fn from(track: Track) -> Self {
        Self { track }
    }
}

#[pymethods]
impl PyTrack {
    #[getter]
    fn id(&self) -> u64 {
        self.track.id
    }

    #[getter]
    fn ellipse(&self) -> PyEllipse {
        PyEllipse::plain(self.track.ellipse)
    }

    #[getter]
    fn score(&self) -> f64 {
        self.track.score
    }

    #[getter]
    fn state(&self) -> &'static str {
        match self.track.state {
            TrackState::Tentative => "tentative",
            TrackState::Confirmed => "confirmed",
            TrackState::Predicted => "predicted",
        }
    }

    #[getter]
    fn velocity(&self) -> (f64, f64) {
        self.track.velocity_px_per_s.into()
    }

    #[getter]
    fn center_deviation(&self) -> (f64, f64) {
        self.track.center_deviation_px().into()
    }

    #[getter]
    fn age(&self) -> u32 {
        self.track.age
    }

    #[getter]
    fn sightings(&self) -> u32 {
        self.track.sightings
    }

    #[getter]
    fn misses(&self) -> u32 {
        self.track.misses
    }

    fn __repr__(&self) -> String {
        let Track { id, ellipse, score, .. } = &self.track;
        let (x, y) = (ellipse.center_x_px, ellipse.center_y_px);
        format!(
            "Track(id={id}, state={:?}, center=({x:.2}, {y:.2}), semi_major={:.2}, semi_minor={:.2}, score={score:.2})",
            self.state(),
            ellipse.semi_major_px,
            ellipse.semi_minor_px
        )
    }
}
