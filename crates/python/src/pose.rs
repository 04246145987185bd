//! `rsapien.pose`: from an ellipse to space and back.

use pyo3::prelude::*;
use rsapien_vision::pose::{self, BallPosition, CirclePose, Intrinsics};

use crate::ellipse::PyEllipse;
use crate::errors::value_error;

/// x, y and z.
type Vector = (f64, f64, f64);

/// A pinhole camera.
#[pyclass(name = "Intrinsics", module = "rsapien.pose", frozen)]
pub(crate) struct PyIntrinsics {
    intrinsics: Intrinsics,
}

#[pymethods]
impl PyIntrinsics {
    #[new]
    fn new(focal_x: f64, focal_y: f64, center_x: f64, center_y: f64) -> PyResult<Self> {
        let intrinsics = Intrinsics {
            focal_x_px: focal_x,
            focal_y_px: focal_y,
            center_x_px: center_x,
            center_y_px: center_y,
        };
        intrinsics.validate().map_err(value_error)?;
        Ok(Self { intrinsics })
    }

    #[staticmethod]
    fn from_field_of_view(width: u32, height: u32, horizontal: f64) -> PyResult<Self> {
        let intrinsics = Intrinsics::from_field_of_view(width, height, horizontal);
        Ok(Self { intrinsics: intrinsics.map_err(value_error)? })
    }

    #[getter]
    fn focal_x(&self) -> f64 {
        self.intrinsics.focal_x_px
    }

    #[getter]
    fn focal_y(&self) -> f64 {
        self.intrinsics.focal_y_px
    }

    #[getter]
    fn center_x(&self) -> f64 {
        self.intrinsics.center_x_px
    }

    #[getter]
    fn center_y(&self) -> f64 {
        self.intrinsics.center_y_px
    }

    fn __repr__(&self) -> String {
        let Intrinsics { focal_x_px, focal_y_px, center_x_px, center_y_px } = self.intrinsics;
        format!(
            "Intrinsics(focal_x={focal_x_px:.2}, focal_y={focal_y_px:.2}, center_x={center_x_px:.2}, center_y={center_y_px:.2})"
        )
    }
}

/// Where a circle stands and where it faces.
#[pyclass(name = "CirclePose", module = "rsapien.pose", frozen)]
pub(crate) struct PyCirclePose {
    pose: CirclePose,
}

#[pymethods]
impl PyCirclePose {
    #[new]
    fn new(center: [f64; 3], normal: [f64; 3]) -> Self {
        Self { pose: CirclePose { center_m: center, normal } }
    }

    #[getter]
    fn center(&self) -> Vector {
        self.pose.center_m.into()
    }

    #[getter]
    fn normal(&self) -> Vector {
        self.pose.normal.into()
    }

    fn __repr__(&self) -> String {
        let ([x, y, z], [nx, ny, nz]) = (self.pose.center_m, self.pose.normal);
        format!("CirclePose(center=({x:.4}, {y:.4}, {z:.4}), normal=({nx:.4}, {ny:.4}, {nz:.4}))")
    }
}

/// Where a ball is.
#[pyclass(name = "BallPosition", module = "rsapien.pose", frozen)]
pub(crate) struct PyBallPosition {
    position: BallPosition,
}

#[pymethods]
impl PyBallPosition {
    #[getter]
    fn center(&self) -> Vector {
        self.position.center_m.into()
    }

    #[getter]
    fn misfit(&self) -> f64 {
        self.position.misfit_rad
    }

    fn __repr__(&self) -> String {
        let BallPosition { center_m: [x, y, z], misfit_rad } = self.position;
        format!("BallPosition(center=({x:.4}, {y:.4}, {z:.4}), misfit={misfit_rad:.5})")
    }
}

#[pyfunction]
fn circle_poses(
    ellipse: &PyEllipse,
    intrinsics: &PyIntrinsics,
    radius: f64,
) -> PyResult<(PyCirclePose, PyCirclePose)> {
    let poses = pose::circle_poses(ellipse.ellipse(), &intrinsics.intrinsics, radius);
    Ok(poses.map_err(value_error)?.map(|pose| PyCirclePose { pose }).into())
}

#[pyfunction]
fn ball_position(
    ellipse: &PyEllipse,
    intrinsics: &PyIntrinsics,
    radius: f64,
) -> PyResult<PyBallPosition> {
    let position = pose::ball_position(ellipse.ellipse(), &intrinsics.intrinsics, radius);
    Ok(PyBallPosition { position: position.map_err(value_error)? })
}

#[pyfunction]
fn project_circle(
    pose: &PyCirclePose,
    radius: f64,
    intrinsics: &PyIntrinsics,
) -> Option<PyEllipse> {
    pose::project_circle(&pose.pose, radius, &intrinsics.intrinsics).map(PyEllipse::plain)
}

#[pyfunction]
fn project_ball(center: [f64; 3], radius: f64, intrinsics: &PyIntrinsics) -> Option<PyEllipse> {
    pose::project_ball(center, radius, &intrinsics.intrinsics).map(PyEllipse::plain)
}

/// Puts the classes and functions into the module.
pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PyIntrinsics>()?;
    module.add_class::<PyCirclePose>()?;
    module.add_class::<PyBallPosition>()?;
    module.add_function(wrap_pyfunction!(circle_poses, module)?)?;
    module.add_function(wrap_pyfunction!(ball_position, module)?)?;
    module.add_function(wrap_pyfunction!(project_circle, module)?)?;
    module.add_function(wrap_pyfunction!(project_ball, module)?)
}
