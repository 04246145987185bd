//! `Registry`: the registry from Python.

use crate::errors::registry_error;
use crate::finding::PyFinding;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use rsapien_protocol::Primitive;
use rsapien_registry::{
    ActionDraft, ActionSummary, CompileOptions, CompiledAction, ImportPolicy, Registry, Statement,
    Trials,
};
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The motion primitives and actions, in a file or in memory.
#[pyclass(name = "Registry", module = "rsapien", frozen)]
pub(crate) struct PyRegistry {
    registry: Mutex<Registry>,
}

impl PyRegistry {
    fn wrap(registry: Registry) -> PyRegistry {
        PyRegistry { registry: Mutex::new(registry) }
    }

    fn lock(&self) -> MutexGuard<'_, Registry> {
        // A call is one transaction: after a panic in one the registry is as it was before it.
        self.registry.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The compiled form of steps that are not stored.
    pub(crate) fn compile_steps(&self, steps: Vec<Statement>) -> PyResult<CompiledAction> {
        let draft = ActionDraft::new("steps", steps);
        self.lock().compile_draft(&draft, &CompileOptions::default()).map_err(registry_error)
    }

    /// The compiled form of an action.
    pub(crate) fn compile(&self, name: &str, times: u16, speed: f64) -> PyResult<CompiledAction> {
        let options = CompileOptions { times, speed, ..CompileOptions::default() };
        self.lock().compile(name, &options).map_err(registry_error)
    }
}

#[pymethods]
impl PyRegistry {
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> PyResult<PyRegistry> {
        py.detach(|| Registry::open(path)).map(PyRegistry::wrap).map_err(registry_error)
    }

    #[staticmethod]
    pub(crate) fn in_memory() -> PyResult<PyRegistry> {
        Registry::open_in_memory().map(PyRegistry::wrap).map_err(registry_error)
    }

    /// The names of the 21 motion primitives, in the order of the paper's Table 1.
    #[staticmethod]
    fn primitives() -> Vec<String> {
        Primitive::all().map(|primitive| primitive.to_string()).collect()
    }

    #[getter]
    fn path(&self) -> PathBuf {
        self.lock().path().to_path_buf()
    }

    fn actions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let actions = py.detach(|| self.lock().list()).map_err(registry_error)?;
        let rows: PyResult<Vec<_>> = actions.iter().map(|action| summary(py, action)).collect();
        PyList::new(py, rows?)
    }

    #[pyo3(signature = (name, *, times=1, speed=1.0))]
    fn steps(
        &self,
        py: Python<'_>,
        name: &str,
        times: u16,
        speed: f64,
    ) -> PyResult<Vec<(Vec<String>, u16)>> {
        let compiled = py.detach(|| self.compile(name, times, speed))?;
        let names = |step: &rsapien_protocol::Step| {
            step.pose.primitives().map(|primitive| primitive.to_string()).collect()
        };
        Ok(compiled.steps.iter().map(|step| (names(step), step.duration_ms)).collect())
    }

    #[pyo3(signature = (text, *, replace=false))]
    fn import_text<'py>(
        &self,
        py: Python<'py>,
        text: &str,
        replace: bool,
    ) -> PyResult<Bound<'py, PyDict>> {
        let policy = if replace { ImportPolicy::Replace } else { ImportPolicy::Refuse };
        let report = py
            .detach(|| self.lock().import_text(text, policy, &Trials::new()))
            .map_err(registry_error)?;
        let told = PyDict::new(py);
        told.set_item("added", report.added)?;
        told.set_item("replaced", report.replaced)?;
        told.set_item("unchanged", report.unchanged)?;
        Ok(told)
    }

    #[pyo3(signature = (*names))]
    fn export_text(&self, py: Python<'_>, names: Vec<String>) -> PyResult<String> {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        py.detach(|| {
            let registry = self.lock();
            if names.is_empty() {
                registry.export_all_text()
            } else {
                registry.export_text(&names, true)
            }
        })
        .map_err(registry_error)
    }

    fn check(&self, py: Python<'_>, text: &str) -> PyResult<Vec<PyFinding>> {
        let checked = py.detach(|| self.lock().check_text(text)).map_err(registry_error)?;
        Ok(PyFinding::list(&checked.findings))
    }

    fn text(&self, py: Python<'_>, name: &str) -> PyResult<String> {
        py.detach(|| self.lock().get(name)).map(|action| action.text).map_err(registry_error)
    }

    fn remove(&self, py: Python<'_>, name: &str) -> PyResult<()> {
        py.detach(|| self.lock().remove(name)).map_err(registry_error)
    }

    fn history<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let versions = py.detach(|| self.lock().history(name)).map_err(registry_error)?;
        let row = |version: &rsapien_registry::VersionSummary| {
            let row = PyDict::new(py);
            row.set_item("version", version.version)?;
            row.set_item("changed_ms", version.changed_ms)?;
            row.set_item("description", &version.description)?;
            Ok(row)
        };
        versions.iter().map(row).collect()
    }

    fn __repr__(&self) -> String {
        format!("Registry({:?})", self.lock().path().display().to_string())
    }
}

fn summary<'py>(py: Python<'py>, action: &ActionSummary) -> PyResult<Bound<'py, PyDict>> {
    let row = PyDict::new(py);
    row.set_item("name", &action.name)?;
    row.set_item("description", &action.description)?;
    row.set_item("tags", &action.tags)?;
    row.set_item("step_count", action.step_count)?;
    row.set_item("duration_ms", action.duration_ms)?;
    row.set_item("joints", &action.joints)?;
    row.set_item("content_hash", &action.content_hash)?;
    row.set_item("version", action.version)?;
    Ok(row)
}
