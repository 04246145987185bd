//! `Timeline`: an action as a picture.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use rsapien_protocol::Joint;
use rsapien_registry::Timeline;
use rsapien_registry::motion::{Movement, Sense};
use rsapien_registry::timeline::SvgOptions;

/// The joints of an action over time.
#[pyclass(name = "Timeline", module = "rsapien", frozen)]
pub(crate) struct PyTimeline {
    pub(crate) timeline: Timeline,
}

#[pymethods]
impl PyTimeline {
    #[getter]
    fn name(&self) -> &str {
        &self.timeline.name
    }

    #[getter]
    fn duration_ms(&self) -> u64 {
        self.timeline.duration_ms()
    }

    #[getter]
    fn labels(&self) -> Vec<(u64, String)> {
        self.timeline.labels.clone()
    }

    /// Every movement, joint after joint.
    fn movements<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let rows = Joint::ALL.into_iter().zip(&self.timeline.motion.rows);
        rows.flat_map(|(joint, row)| row.iter().map(move |it| movement(py, joint, it))).collect()
    }

    #[pyo3(signature = (*, title="", description="", width=900))]
    fn svg(&self, title: &str, description: &str, width: u32) -> String {
        let (title, description) = (title.to_owned(), description.to_owned());
        self.timeline.to_svg(&SvgOptions { title, description, width })
    }

    #[pyo3(signature = (width=100))]
    fn text(&self, width: usize) -> String {
        self.timeline.to_text(width, false)
    }

    fn _repr_svg_(&self) -> String {
        self.timeline.to_svg(&SvgOptions::default())
    }

    fn __str__(&self) -> String {
        self.text(100)
    }

    fn __repr__(&self) -> String {
        format!("Timeline({:?}, {} ms)", self.timeline.name, self.timeline.duration_ms())
    }
}

fn movement<'py>(py: Python<'py>, joint: Joint, it: &Movement) -> PyResult<Bound<'py, PyDict>> {
    let row = PyDict::new(py);
    row.set_item("joint", joint.name())?;
    row.set_item("from_ms", it.from_ms)?;
    row.set_item("to_ms", it.to_ms)?;
    row.set_item("motor_until_ms", it.motor_until_ms)?;
    row.set_item("from_place", it.from)?;
    row.set_item("to_place", it.to)?;
    row.set_item("target", joint.position_names()[usize::from(it.target.number() - 1)])?;
    row.set_item("towards", if it.sense == Sense::First { "first" } else { "last" })?;
    row.set_item("is_certain", it.is_certain)?;
    row.set_item("is_complete", it.is_complete)?;
    Ok(row)
}
