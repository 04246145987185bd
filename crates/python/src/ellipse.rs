//! `Ellipse`: what a detection finds, and conversions to the forms of other packages.

use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rsapien_vision::{DetectedEllipse, Ellipse, SupportPoint, paper};

use crate::errors::value_error;

/// An ellipse. Pixel centres are at integers, y points down.
#[pyclass(name = "Ellipse", module = "rsapien", frozen)]
pub(crate) struct PyEllipse {
    ellipse: Ellipse,
    evidence: Evidence,
}

/// What speaks for it.
enum Evidence {
    /// It was made by hand, followed or projected.
    None,
    /// The default detector found it.
    Default(Box<(DetectedEllipse, Vec<SupportPoint>)>),
    /// The paper's detector found it.
    Paper { quality: u32 },
}

/// What `cv2` calls a `RotatedRect`: centre, width and height, angle of the width in degrees.
type RotatedRect = ((f64, f64), (f64, f64), f64);

impl PyEllipse {
    pub(crate) fn found(found: &DetectedEllipse, support: &[SupportPoint]) -> Self {
        let evidence = Evidence::Default(Box::new((found.clone(), support.to_vec())));
        Self { ellipse: found.ellipse, evidence }
    }

    /// One that nothing more is told of.
    pub(crate) fn plain(ellipse: Ellipse) -> Self {
        Self { ellipse, evidence: Evidence::None }
    }

    pub(crate) fn ellipse(&self) -> &Ellipse {
        &self.ellipse
    }

    pub(crate) fn of_paper(found: &paper::DetectedEllipse) -> Self {
        Self { ellipse: found.ellipse, evidence: Evidence::Paper { quality: found.quality } }
    }

    fn detected(&self) -> Option<&DetectedEllipse> {
        match &self.evidence {
            Evidence::Default(evidence) => Some(&evidence.0),
            _ => None,
        }
    }
}

/// Centre x, centre y, semi-major axis, semi-minor axis, theta.
pub(crate) fn row(ellipse: &Ellipse) -> [f64; 5] {
    [
        ellipse.center_x_px,
        ellipse.center_y_px,
        ellipse.semi_major_px,
        ellipse.semi_minor_px,
        ellipse.theta_rad,
    ]
}

#[pymethods]
impl PyEllipse {
    #[new]
    #[pyo3(signature = (center_x, center_y, semi_major, semi_minor, theta=0.0))]
    fn new(
        center_x: f64,
        center_y: f64,
        semi_major: f64,
        semi_minor: f64,
        theta: f64,
    ) -> PyResult<Self> {
        for (name, value) in [("center_x", center_x), ("center_y", center_y), ("theta", theta)] {
            if !value.is_finite() {
                return Err(value_error(format!("{name} must be a finite number, not {value}")));
            }
        }
        for (name, value) in [("semi_major", semi_major), ("semi_minor", semi_minor)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(value_error(format!("{name} must be above 0 pixels, not {value}")));
            }
        }
        let ellipse = Ellipse {
            center_x_px: center_x,
            center_y_px: center_y,
            semi_major_px: semi_major,
            semi_minor_px: semi_minor,
            theta_rad: theta,
        };
        Ok(Self::plain(ellipse.canonical()))
    }

    #[staticmethod]
    fn from_rotated_rect(rect: RotatedRect) -> PyResult<Self> {
        let ((center_x, center_y), (width, height), angle_deg) = rect;
        Self::new(center_x, center_y, width / 2.0, height / 2.0, angle_deg.to_radians())
    }

    fn to_rotated_rect(&self) -> RotatedRect {
        let [x, y, major, minor, theta] = row(&self.ellipse);
        ((x, y), (2.0 * major, 2.0 * minor), theta.to_degrees())
    }

    /// A patch of matplotlib, which is imported here alone: it is no dependency of the module.
    #[pyo3(signature = (**kwargs))]
    fn patch<'py>(
        &self,
        py: Python<'py>,
        kwargs: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let [x, y, major, minor, theta] = row(&self.ellipse);
        let arguments = PyDict::new(py);
        arguments.set_item("fill", false)?;
        arguments.set_item("angle", theta.to_degrees())?;
        if let Some(kwargs) = kwargs {
            arguments.update(kwargs.as_mapping())?;
        }
        py.import("matplotlib.patches")?
            .getattr("Ellipse")?
            .call(((x, y), 2.0 * major, 2.0 * minor), Some(&arguments))
    }

    #[getter]
    fn center(&self) -> (f64, f64) {
        (self.ellipse.center_x_px, self.ellipse.center_y_px)
    }

    #[getter]
    fn semi_major(&self) -> f64 {
        self.ellipse.semi_major_px
    }

    #[getter]
    fn semi_minor(&self) -> f64 {
        self.ellipse.semi_minor_px
    }

    #[getter]
    fn theta(&self) -> f64 {
        self.ellipse.theta_rad
    }

    #[getter]
    fn score(&self) -> Option<f64> {
        self.detected().map(|found| found.score)
    }

    #[getter]
    fn support_share(&self) -> Option<f64> {
        self.detected().map(|found| found.support_share)
    }

    #[getter]
    fn gradient_agreement(&self) -> Option<f64> {
        self.detected().map(|found| found.gradient_agreement)
    }

    #[getter]
    fn log10_false_alarms(&self) -> Option<f64> {
        self.detected().map(|found| found.log10_false_alarms)
    }

    #[getter]
    fn residual(&self) -> Option<f64> {
        self.detected().map(|found| found.residual_px)
    }

    #[getter]
    fn stroke_width(&self) -> Option<f64> {
        self.detected().and_then(|found| found.stroke_width_px)
    }

    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let Some(rows) = self.detected().and_then(|found| found.covariance) else {
            return Ok(None);
        };
        PyArray2::from_vec2(py, &rows.map(Vec::from)).map(Some).map_err(value_error)
    }

    #[getter]
    fn support_points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let points = match &self.evidence {
            Evidence::Default(evidence) => evidence.1.as_slice(),
            _ => &[],
        };
        let rows: Vec<Vec<f32>> =
            points.iter().map(|point| vec![point.x_px, point.y_px, point.gradient_rad]).collect();
        if rows.is_empty() {
            return Ok(PyArray2::zeros(py, [0, 3], false));
        }
        PyArray2::from_vec2(py, &rows).map_err(value_error)
    }

    #[getter]
    fn quality(&self) -> Option<u32> {
        match self.evidence {
            Evidence::Paper { quality } => Some(quality),
            _ => None,
        }
    }

    fn contains(&self, x: f64, y: f64) -> bool {
        self.ellipse.contains(x, y)
    }

    fn overlap(&self, other: &Self) -> f64 {
        self.ellipse.overlap(&other.ellipse)
    }

    fn __iter__(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        Ok(row(&self.ellipse).into_pyobject(py)?.try_iter()?.into_any().unbind())
    }

    fn __repr__(&self) -> String {
        let [x, y, major, minor, theta] = row(&self.ellipse);
        let evidence = match &self.evidence {
            Evidence::None => String::new(),
            Evidence::Default(evidence) => format!(", score={:.2}", evidence.0.score),
            Evidence::Paper { quality } => format!(", quality={quality}"),
        };
        format!(
            "Ellipse(center=({x:.2}, {y:.2}), semi_major={major:.2}, semi_minor={minor:.2}, theta={theta:.3}{evidence})"
        )
    }
}
