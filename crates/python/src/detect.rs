//! `detect`: a numpy array in, ellipses out.

use crate::errors::value_error;
use numpy::ndarray::Dimension;
use numpy::{
    PyArray2, PyReadonlyArray, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rsapien_vision::paper::{DetectedEllipse, Detection, Detector, Options};
use rsapien_vision::{ColorView, GrayImage, GrayView, PixelLayout};

/// An ellipse found in a picture. Pixel centres are at integers, y points down.
#[pyclass(name = "Ellipse", module = "rsapien", frozen)]
pub(crate) struct PyEllipse {
    found: DetectedEllipse,
}

#[pymethods]
impl PyEllipse {
    #[getter]
    fn center(&self) -> (f64, f64) {
        (self.found.ellipse.center_x_px, self.found.ellipse.center_y_px)
    }

    #[getter]
    fn semi_major(&self) -> f64 {
        self.found.ellipse.semi_major_px
    }

    #[getter]
    fn semi_minor(&self) -> f64 {
        self.found.ellipse.semi_minor_px
    }

    #[getter]
    fn theta(&self) -> f64 {
        self.found.ellipse.theta_rad
    }

    #[getter]
    fn quality(&self) -> u32 {
        self.found.quality
    }

    fn contains(&self, x: f64, y: f64) -> bool {
        self.found.ellipse.contains(x, y)
    }

    fn __iter__(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        let row = row(&self.found);
        Ok(row.into_pyobject(py)?.try_iter()?.into_any().unbind())
    }

    fn __repr__(&self) -> String {
        let [x, y, a, b, theta] = row(&self.found);
        format!(
            "Ellipse(center=({x:.1}, {y:.1}), semi_major={a:.1}, semi_minor={b:.1}, theta={theta:.3}, quality={})",
            self.found.quality
        )
    }
}

/// What a detection found, and the figures of the paper's Table 3.
#[pyclass(name = "Detection", module = "rsapien", frozen)]
pub(crate) struct PyDetection {
    detection: Detection,
}

#[pymethods]
impl PyDetection {
    #[getter]
    fn ellipses(&self) -> Vec<PyEllipse> {
        self.detection.ellipses.iter().map(|found| PyEllipse { found: *found }).collect()
    }

    #[getter]
    fn truncated(&self) -> bool {
        self.detection.truncated()
    }

    #[getter]
    fn statistics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let statistics = &self.detection.statistics;
        let found = PyDict::new(py);
        found.set_item("edge_points", statistics.edge_points)?;
        found.set_item("search_point_pairs", statistics.search_point_pairs)?;
        found.set_item("virtual_ellipses", statistics.virtual_ellipses)?;
        found.set_item("real_ellipses", statistics.real_ellipses)?;
        found.set_item("quality_min", statistics.quality_min)?;
        Ok(found)
    }

    #[getter]
    fn milliseconds(&self) -> f64 {
        self.detection.cost.total().as_secs_f64() * 1e3
    }

    /// The ellipses as an array of shape (n, 5): center x, center y, semi-major, semi-minor, theta.
    fn to_array<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows: Vec<Vec<f64>> =
            self.detection.ellipses.iter().map(|found| row(found).to_vec()).collect();
        if rows.is_empty() {
            return Ok(PyArray2::zeros(py, [0, 5], false));
        }
        PyArray2::from_vec2(py, &rows).map_err(value_error)
    }

    fn __len__(&self) -> usize {
        self.detection.ellipses.len()
    }

    fn __getitem__(&self, index: isize) -> PyResult<PyEllipse> {
        let count = self.detection.ellipses.len();
        let place = if index < 0 { index + count.cast_signed() } else { index };
        let found =
            usize::try_from(place).ok().and_then(|place| self.detection.ellipses.get(place));
        let message = || format!("ellipse {index} of {count}");
        let found = found.ok_or_else(|| pyo3::exceptions::PyIndexError::new_err(message()))?;
        Ok(PyEllipse { found: *found })
    }

    fn __repr__(&self) -> String {
        let statistics = &self.detection.statistics;
        let (ellipses, points) = (self.detection.ellipses.len(), statistics.edge_points);
        format!("Detection({ellipses} ellipses from {points} edge points)")
    }
}

fn row(found: &DetectedEllipse) -> [f64; 5] {
    let ellipse = &found.ellipse;
    let center = [ellipse.center_x_px, ellipse.center_y_px];
    [center[0], center[1], ellipse.semi_major_px, ellipse.semi_minor_px, ellipse.theta_rad]
}

/// A picture borrowed from numpy for the time of a detection.
enum Borrowed<'py> {
    Gray(PyReadonlyArray2<'py, u8>),
    Color(PyReadonlyArray3<'py, u8>, PixelLayout),
}

impl<'py> Borrowed<'py> {
    fn new(image: &Bound<'py, PyAny>) -> PyResult<Borrowed<'py>> {
        if let Ok(array) = image.extract::<PyReadonlyArray2<'py, u8>>() {
            return Ok(Borrowed::Gray(array));
        }
        if let Ok(array) = image.extract::<PyReadonlyArray3<'py, u8>>() {
            return match array.shape().get(2) {
                Some(3) => Ok(Borrowed::Color(array, PixelLayout::Rgb)),
                Some(4) => Ok(Borrowed::Color(array, PixelLayout::Rgba)),
                _ => Err(wrong_array(image)),
            };
        }
        Err(wrong_array(image))
    }
}

fn wrong_array(image: &Bound<'_, PyAny>) -> PyErr {
    let got = match image.cast::<PyUntypedArray>() {
        Ok(array) => format!("an array of shape {:?} and type {}", array.shape(), array.dtype()),
        Err(_) => format!("{}", image.get_type()),
    };
    PyTypeError::new_err(format!(
        "image must be a numpy array of type uint8 and shape (height, width), (height, width, 3) for RGB or (height, width, 4) for RGBA, not {got}"
    ))
}

/// The pixels where they stand, if row follows row without a gap. `as_slice` alone would also give those
/// of an array whose columns do.
fn c_order<'a, D: Dimension>(array: &'a PyReadonlyArray<'_, u8, D>) -> Option<&'a [u8]> {
    array.is_c_contiguous().then(|| array.as_slice().ok()).flatten()
}

/// What the caller may set beside the preset.
#[derive(FromPyObject)]
pub(crate) struct Range(f32, f32);

#[pyfunction]
#[pyo3(signature = (image, *, preset="paper", seed=0, semi_major=None, semi_minor=None, quality=None, distance=None))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub(crate) fn detect(
    py: Python<'_>,
    image: &Bound<'_, PyAny>,
    preset: &str,
    seed: u64,
    semi_major: Option<Range>,
    semi_minor: Option<Range>,
    quality: Option<u32>,
    distance: Option<f64>,
) -> PyResult<PyDetection> {
    let mut options = match preset {
        "paper" => Options::paper(),
        _ => return Err(value_error(format!("preset must be \"paper\", not {preset:?}"))),
    };
    if let Some(Range(least, greatest)) = semi_major {
        options.hough.semi_major_min_px = least;
        options.hough.semi_major_max_px = greatest;
    }
    if let Some(Range(least, greatest)) = semi_minor {
        options.hough.semi_minor_min_px = least;
        options.hough.semi_minor_max_px = greatest;
    }
    options.filter.quality_min = quality.unwrap_or(options.filter.quality_min);
    options.cluster.distance_max = distance.unwrap_or(options.cluster.distance_max);
    let detector = Detector::new(options).map_err(value_error)?;
    let borrowed = Borrowed::new(image)?;
    let detection = match &borrowed {
        Borrowed::Gray(array) => {
            let (height, width) = (array.shape()[0], array.shape()[1]);
            // A contiguous picture is read where it stands; another one is copied once.
            if let Some(pixels) = c_order(array) {
                let view = GrayView::new(pixels, width, height, width).map_err(value_error)?;
                py.detach(|| detector.detect(&view, seed))
            } else {
                let pixels = array.as_array().iter().copied().collect();
                let picture = GrayImage::new(pixels, width, height).map_err(value_error)?;
                py.detach(|| detector.detect(&picture.view(), seed))
            }
        }
        Borrowed::Color(array, layout) => {
            let (height, width, layout) = (array.shape()[0], array.shape()[1], *layout);
            let copied: Vec<u8>;
            let pixels = if let Some(pixels) = c_order(array) {
                pixels
            } else {
                copied = array.as_array().iter().copied().collect();
                &copied
            };
            let stride = width * layout.bytes_per_pixel();
            let view =
                ColorView::new(pixels, width, height, stride, layout).map_err(value_error)?;
            py.detach(|| detector.detect(&view.to_gray().view(), seed))
        }
    };
    Ok(PyDetection { detection })
}
