//! `Detection`: what was found in a picture.

use numpy::{PyArray1, PyArray2, PyArray3};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rsapien_vision::{Detection, Ellipse, draw, paper};

use crate::ellipse::{PyEllipse, row};
use crate::errors::value_error;
use crate::picture::{Borrowed, to_numpy};

/// The fields of a structured array, in the order of [`row`], and the score.
pub(crate) const FIELDS: [&str; 6] =
    ["center_x", "center_y", "semi_major", "semi_minor", "theta", "score"];

/// What a detection found.
#[pyclass(name = "Detection", module = "rsapien", frozen)]
pub(crate) struct PyDetection {
    found: Found,
    /// The picture, to be drawn on.
    image: Py<PyAny>,
}

/// The detection of either preset.
pub(crate) enum Found {
    Default(Detection),
    Paper(paper::Detection),
}

impl PyDetection {
    pub(crate) fn new(found: Found, image: &Bound<'_, PyAny>) -> Self {
        Self { found, image: image.clone().unbind() }
    }

    fn plain_ellipses(&self) -> Vec<Ellipse> {
        match &self.found {
            Found::Default(detection) => detection.ellipses.iter().map(|e| e.ellipse).collect(),
            Found::Paper(detection) => detection.ellipses.iter().map(|e| e.ellipse).collect(),
        }
    }

    /// The scores; the paper's detector gives none.
    fn plain_scores(&self) -> Vec<f64> {
        match &self.found {
            Found::Default(detection) => detection.ellipses.iter().map(|e| e.score).collect(),
            Found::Paper(detection) => vec![f64::NAN; detection.ellipses.len()],
        }
    }

    fn ellipse(&self, index: usize) -> Option<PyEllipse> {
        match &self.found {
            Found::Default(detection) => {
                let found = detection.ellipses.get(index)?;
                Some(PyEllipse::found(found, detection.support_of(found)))
            }
            Found::Paper(detection) => detection.ellipses.get(index).map(PyEllipse::of_paper),
        }
    }
}

#[pymethods]
impl PyDetection {
    #[getter]
    fn ellipses(&self) -> Vec<PyEllipse> {
        (0..self.__len__()).filter_map(|index| self.ellipse(index)).collect()
    }

    #[getter]
    fn scores<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.plain_scores())
    }

    #[getter]
    fn truncated(&self) -> bool {
        match &self.found {
            Found::Default(detection) => detection.truncated,
            Found::Paper(detection) => detection.truncated(),
        }
    }

    #[getter]
    fn statistics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let counts = PyDict::new(py);
        match &self.found {
            Found::Default(detection) => {
                let statistics = &detection.statistics;
                counts.set_item("edge_points", statistics.edge_points)?;
                counts.set_item("chains", statistics.chains)?;
                counts.set_item("arcs", statistics.arcs)?;
                counts.set_item("pairs", statistics.pairs)?;
                counts.set_item("candidates", statistics.candidates)?;
                counts.set_item("accepted", statistics.accepted)?;
            }
            Found::Paper(detection) => {
                let statistics = &detection.statistics;
                counts.set_item("edge_points", statistics.edge_points)?;
                counts.set_item("search_point_pairs", statistics.search_point_pairs)?;
                counts.set_item("virtual_ellipses", statistics.virtual_ellipses)?;
                counts.set_item("real_ellipses", statistics.real_ellipses)?;
                counts.set_item("quality_min", statistics.quality_min)?;
            }
        }
        Ok(counts)
    }

    #[getter]
    fn milliseconds(&self) -> f64 {
        let cost = match &self.found {
            Found::Default(detection) => detection.cost.total(),
            Found::Paper(detection) => detection.cost.total(),
        };
        cost.as_secs_f64() * 1e3
    }

    fn to_array<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows: Vec<Vec<f64>> =
            self.plain_ellipses().iter().map(|ellipse| row(ellipse).to_vec()).collect();
        if rows.is_empty() {
            return Ok(PyArray2::zeros(py, [0, 5], false));
        }
        PyArray2::from_vec2(py, &rows).map_err(value_error)
    }

    fn to_structured<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let ellipses = self.plain_ellipses();
        let fields: Vec<(&str, &str)> = FIELDS.map(|name| (name, "f8")).to_vec();
        let array = py.import("numpy")?.call_method1("empty", (ellipses.len(), fields))?;
        let scores = self.plain_scores();
        for (index, name) in FIELDS.into_iter().enumerate() {
            let column = if name == "score" {
                scores.clone()
            } else {
                ellipses.iter().map(|ellipse| row(ellipse)[index]).collect()
            };
            array.set_item(name, PyArray1::from_vec(py, column))?;
        }
        Ok(array)
    }

    #[pyo3(signature = (image=None))]
    fn draw<'py>(
        &self,
        py: Python<'py>,
        image: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let borrowed = Borrowed::new(image.unwrap_or_else(|| self.image.bind(py)))?;
        let mut picture = borrowed.pixels().to_picture()?;
        draw::annotate(&mut picture, &self.plain_ellipses());
        to_numpy(py, &picture)
    }

    fn __len__(&self) -> usize {
        match &self.found {
            Found::Default(detection) => detection.ellipses.len(),
            Found::Paper(detection) => detection.ellipses.len(),
        }
    }

    fn __getitem__(&self, index: isize) -> PyResult<PyEllipse> {
        let count = self.__len__();
        let place = if index < 0 { index + count.cast_signed() } else { index };
        let found = usize::try_from(place).ok().and_then(|place| self.ellipse(place));
        found.ok_or_else(|| PyIndexError::new_err(format!("ellipse {index} of {count}")))
    }

    fn __repr__(&self) -> String {
        let points = match &self.found {
            Found::Default(detection) => detection.statistics.edge_points,
            Found::Paper(detection) => detection.statistics.edge_points,
        };
        let (count, ms) = (self.__len__(), self.milliseconds());
        let cut = if self.truncated() { ", truncated" } else { "" };
        format!("Detection({count} ellipses from {points} edge points in {ms:.1} ms{cut})")
    }
}
