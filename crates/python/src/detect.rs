//! `detect` and `Detector`: numpy arrays in, ellipses out.

use pyo3::prelude::*;
use rayon::prelude::*;
use rsapien_vision::{Detector, ImageError, Options, Region, Strokes, paper};
use std::sync::{Mutex, PoisonError};

use crate::detection::{Found, PyDetection};
use crate::errors::value_error;
use crate::picture::{Borrowed, Pixels};

/// Most threads that can be asked for.
const THREADS_MAX: usize = 256;

/// Left, top, width and height in pixels.
type RegionNumbers = (usize, usize, usize, usize);

/// The default detector's keyword arguments; what is not given is the default.
#[derive(Default)]
struct Keywords<'a> {
    semi_axis_min: Option<f64>,
    semi_axis_max: Option<f64>,
    axis_ratio_min: Option<f64>,
    score_min: Option<f64>,
    region: Option<RegionNumbers>,
    strokes: Option<&'a str>,
    support_points: Option<bool>,
    covariance: Option<bool>,
    seed: Option<u64>,
}

impl Keywords<'_> {
    /// The first given that the paper's detector does not have.
    fn unknown_to_paper(&self) -> Option<&'static str> {
        let given = [
            (self.semi_axis_min.is_some(), "semi_axis_min"),
            (self.semi_axis_max.is_some(), "semi_axis_max"),
            (self.axis_ratio_min.is_some(), "axis_ratio_min"),
            (self.score_min.is_some(), "score_min"),
            (self.region.is_some(), "region"),
            (self.strokes.is_some(), "strokes"),
            (self.support_points.is_some(), "support_points"),
            (self.covariance.is_some(), "covariance"),
        ];
        given.into_iter().find_map(|(is_given, name)| is_given.then_some(name))
    }

    fn detector(&self) -> PyResult<Detector> {
        let usual = Options::default();
        let strokes = match self.strokes {
            None => usual.strokes,
            Some("middle") => Strokes::MiddleLine,
            Some("edges") => Strokes::BothEdges,
            Some(other) => {
                let text = format!("strokes must be \"middle\" or \"edges\", not {other:?}");
                return Err(value_error(text));
            }
        };
        let region = |(left, top, width, height)| Region { left, top, width, height };
        let options = Options {
            semi_axis_min_px: self.semi_axis_min.unwrap_or(usual.semi_axis_min_px),
            semi_axis_max_px: self.semi_axis_max.unwrap_or(usual.semi_axis_max_px),
            axis_ratio_min: self.axis_ratio_min.unwrap_or(usual.axis_ratio_min),
            score_min: self.score_min.unwrap_or(usual.score_min),
            region: self.region.map(region),
            strokes,
            support_points: self.support_points.unwrap_or(usual.support_points),
            covariance: self.covariance.unwrap_or(usual.covariance),
            seed: self.seed.unwrap_or(usual.seed),
        };
        Detector::builder().options(options).build().map_err(value_error)
    }
}

/// The paper's keyword arguments.
#[derive(Default)]
struct PaperKeywords {
    semi_major: Option<Range>,
    semi_minor: Option<Range>,
    quality: Option<u32>,
    distance: Option<f64>,
}

/// Least and greatest semi-axis in pixels.
#[derive(FromPyObject)]
pub(crate) struct Range(f32, f32);

impl PaperKeywords {
    /// The first given.
    fn given(&self) -> Option<&'static str> {
        let given = [
            (self.semi_major.is_some(), "semi_major"),
            (self.semi_minor.is_some(), "semi_minor"),
            (self.quality.is_some(), "quality"),
            (self.distance.is_some(), "distance"),
        ];
        given.into_iter().find_map(|(is_given, name)| is_given.then_some(name))
    }

    fn detector(&self) -> PyResult<paper::Detector> {
        let mut options = paper::Options::paper();
        if let Some(Range(least, greatest)) = self.semi_major {
            options.hough.semi_major_min_px = least;
            options.hough.semi_major_max_px = greatest;
        }
        if let Some(Range(least, greatest)) = self.semi_minor {
            options.hough.semi_minor_min_px = least;
            options.hough.semi_minor_max_px = greatest;
        }
        options.filter.quality_min = self.quality.unwrap_or(options.filter.quality_min);
        options.cluster.distance_max = self.distance.unwrap_or(options.cluster.distance_max);
        paper::Detector::new(options).map_err(value_error)
    }
}

#[pyfunction]
#[pyo3(signature = (
    image, *, preset="default", semi_axis_min=None, semi_axis_max=None, axis_ratio_min=None, score_min=None, region=None,
    strokes=None, support_points=None, covariance=None, seed=None, semi_major=None, semi_minor=None, quality=None,
    distance=None
))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub(crate) fn detect(
    py: Python<'_>,
    image: &Bound<'_, PyAny>,
    preset: &str,
    semi_axis_min: Option<f64>,
    semi_axis_max: Option<f64>,
    axis_ratio_min: Option<f64>,
    score_min: Option<f64>,
    region: Option<RegionNumbers>,
    strokes: Option<&str>,
    support_points: Option<bool>,
    covariance: Option<bool>,
    seed: Option<u64>,
    semi_major: Option<Range>,
    semi_minor: Option<Range>,
    quality: Option<u32>,
    distance: Option<f64>,
) -> PyResult<PyDetection> {
    let keywords = Keywords {
        semi_axis_min,
        semi_axis_max,
        axis_ratio_min,
        score_min,
        region,
        strokes,
        support_points,
        covariance,
        seed,
    };
    let of_paper = PaperKeywords { semi_major, semi_minor, quality, distance };
    let refused = |name: &str, needed: &str| {
        value_error(format!("{name} needs preset={needed:?}, and preset is {preset:?}"))
    };
    let found = match preset {
        "default" => {
            if let Some(name) = of_paper.given() {
                return Err(refused(name, "paper"));
            }
            let mut detector = keywords.detector()?;
            let borrowed = Borrowed::new(image)?;
            let pixels = borrowed.pixels();
            py.detach(|| look(&mut detector, &pixels)).map_err(value_error)?
        }
        "paper" => {
            if let Some(name) = keywords.unknown_to_paper() {
                return Err(refused(name, "default"));
            }
            let detector = of_paper.detector()?;
            let borrowed = Borrowed::new(image)?;
            let pixels = borrowed.pixels();
            let look = || pixels.with_gray(|view| detector.detect(view, seed.unwrap_or(0)));
            Found::Paper(py.detach(look).map_err(value_error)?)
        }
        _ => {
            let text = format!("preset must be \"default\" or \"paper\", not {preset:?}");
            return Err(value_error(text));
        }
    };
    Ok(PyDetection::new(found, image))
}

/// What the default detector finds.
fn look(detector: &mut Detector, pixels: &Pixels<'_>) -> Result<Found, ImageError> {
    pixels.with_gray(|view| Found::Default(detector.detect(view).clone()))
}

/// The default detector with its buffers, which serve one picture after the other.
#[pyclass(name = "Detector", module = "rsapien", frozen)]
pub(crate) struct PyDetector {
    detector: Mutex<Detector>,
}

#[pymethods]
impl PyDetector {
    #[new]
    #[pyo3(signature = (
        *, semi_axis_min=None, semi_axis_max=None, axis_ratio_min=None, score_min=None, region=None, strokes=None,
        support_points=None, covariance=None, seed=None
    ))]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn new(
        semi_axis_min: Option<f64>,
        semi_axis_max: Option<f64>,
        axis_ratio_min: Option<f64>,
        score_min: Option<f64>,
        region: Option<RegionNumbers>,
        strokes: Option<&str>,
        support_points: Option<bool>,
        covariance: Option<bool>,
        seed: Option<u64>,
    ) -> PyResult<Self> {
        let keywords = Keywords {
            semi_axis_min,
            semi_axis_max,
            axis_ratio_min,
            score_min,
            region,
            strokes,
            support_points,
            covariance,
            seed,
        };
        Ok(Self { detector: Mutex::new(keywords.detector()?) })
    }

    fn detect(&self, py: Python<'_>, image: &Bound<'_, PyAny>) -> PyResult<PyDetection> {
        let borrowed = Borrowed::new(image)?;
        let pixels = borrowed.pixels();
        // Waits for another thread's detection only while other Python code can run.
        let found = py.detach(|| {
            let mut detector = self.detector.lock().unwrap_or_else(PoisonError::into_inner);
            look(&mut detector, &pixels)
        });
        Ok(PyDetection::new(found.map_err(value_error)?, image))
    }

    #[pyo3(signature = (images, *, threads=None))]
    fn detect_many(
        &self,
        py: Python<'_>,
        images: Vec<Bound<'_, PyAny>>,
        threads: Option<usize>,
    ) -> PyResult<Vec<PyDetection>> {
        let named = |index: usize, error: PyErr| -> PyErr {
            let text = format!("images[{index}]: {}", error.value(py));
            PyErr::from_type(error.get_type(py), text)
        };
        let borrowed: Vec<Borrowed<'_>> = (images.iter().enumerate())
            .map(|(index, image)| Borrowed::new(image).map_err(|error| named(index, error)))
            .collect::<PyResult<_>>()?;
        let pixels: Vec<Pixels<'_>> = borrowed.iter().map(Borrowed::pixels).collect();
        let pool = threads.map(pool).transpose()?;
        let found: Vec<Result<Found, ImageError>> = py.detach(|| {
            // A copy, so that a detection on another thread is waited for no longer than the copying takes.
            let detector = self.detector.lock().unwrap_or_else(PoisonError::into_inner).clone();
            let look_at_all = || {
                let pixels = pixels.par_iter();
                pixels.map_init(|| detector.clone(), look).collect()
            };
            match &pool {
                Some(pool) => pool.install(look_at_all),
                None => look_at_all(),
            }
        });
        (found.into_iter().zip(&images).enumerate())
            .map(|(index, (found, image))| {
                let found = found.map_err(|error| named(index, value_error(error)))?;
                Ok(PyDetection::new(found, image))
            })
            .collect()
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let options =
            py.detach(|| *self.detector.lock().unwrap_or_else(PoisonError::into_inner).options());
        let strokes = match options.strokes {
            Strokes::MiddleLine => "middle",
            Strokes::BothEdges => "edges",
        };
        format!(
            "Detector(semi_axis_min={}, semi_axis_max={}, axis_ratio_min={}, score_min={}, strokes={strokes:?}, seed={})",
            options.semi_axis_min_px,
            options.semi_axis_max_px,
            options.axis_ratio_min,
            options.score_min,
            options.seed
        )
    }
}

impl PyDetector {
    /// A detector of its own with the same options.
    pub(crate) fn copy(&self, py: Python<'_>) -> Detector {
        py.detach(|| self.detector.lock().unwrap_or_else(PoisonError::into_inner).clone())
    }
}

/// A pool of so many threads.
fn pool(threads: usize) -> PyResult<rayon::ThreadPool> {
    if !(1..=THREADS_MAX).contains(&threads) {
        return Err(value_error(format!("threads must be 1 to {THREADS_MAX}, not {threads}")));
    }
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(value_error)
}
