//! `Registry`: the registry from Python.

use crate::bundle;
use crate::errors::{registry_error, value_error};
use crate::finding::PyFinding;
use crate::timeline::PyTimeline;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use rsapien::CancelToken;
use rsapien::trial::try_on_virtual_body;
use rsapien_protocol::{Joint, Primitive};
use rsapien_registry::language::{Value, parse_value};
use rsapien_registry::{
    ActionDraft, ActionSummary, CompileOptions, CompiledAction, ImportPolicy, Query, Registry,
    RegistryError, Statement, Timeline, Trials, parse_text,
};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Values of parameters as Python gives them: texts as in the language, or numbers.
pub(crate) type Arguments = BTreeMap<String, Py<PyAny>>;

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

    /// The compiled form of an action that is stored, or of one in a text.
    pub(crate) fn compile(
        &self,
        action: &NameOrText,
        options: &CompileOptions,
    ) -> PyResult<CompiledAction> {
        let registry = self.lock();
        let compiled = match action {
            NameOrText::Name(name) => registry.compile(name, options),
            NameOrText::Text(text) => {
                only_action(text).and_then(|draft| registry.compile_draft(&draft, options))
            }
        };
        compiled.map_err(registry_error)
    }
}

/// An action by its name, or as an object with a text (`rsapien.Action`).
pub(crate) enum NameOrText {
    Name(String),
    Text(String),
}

impl<'a, 'py> FromPyObject<'a, 'py> for NameOrText {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<NameOrText> {
        if let Ok(name) = object.extract::<String>() {
            return Ok(NameOrText::Name(name));
        }
        object.getattr("text")?.extract().map(NameOrText::Text)
    }
}

/// The one action of a text.
fn only_action(text: &str) -> Result<ActionDraft, RegistryError> {
    let mut actions = parse_text(text).into_actions(text).map_err(RegistryError::Refused)?;
    match (actions.pop(), actions.pop()) {
        (Some(action), None) => Ok(action.draft),
        (found, _) => {
            let message = if found.is_none() {
                "the text has no action"
            } else {
                "the text has several actions"
            };
            let span = rsapien_registry::language::Span::default();
            let finding =
                rsapien_registry::Finding::new(rsapien_registry::Rule::Syntax, span, message);
            Err(RegistryError::Refused(rsapien_registry::Findings::new(text, vec![finding])))
        }
    }
}

/// The name of the one action of a text.
#[pyfunction]
pub(crate) fn action_name(text: &str) -> PyResult<String> {
    only_action(text).map(|draft| draft.name.text).map_err(registry_error)
}

/// Arguments as the language takes them.
pub(crate) fn values(
    py: Python<'_>,
    arguments: Option<Arguments>,
) -> PyResult<Vec<(String, Value)>> {
    let one = |(name, value): (String, Py<PyAny>)| {
        let text = value.bind(py).str()?.to_string();
        let value = parse_value(&text).map_err(|finding| value_error(finding.in_words()))?;
        Ok((name.replace('_', "-"), value))
    };
    arguments.unwrap_or_default().into_iter().map(one).collect()
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

    /// The actions that fit: by words, tags, joints and length.
    #[pyo3(signature = (text="", *, tags=vec![], joints=vec![], shortest_ms=None, longest_ms=None, limit=50, offset=0))]
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn search<'py>(
        &self,
        py: Python<'py>,
        text: &str,
        tags: Vec<String>,
        joints: Vec<String>,
        shortest_ms: Option<u64>,
        longest_ms: Option<u64>,
        limit: u32,
        offset: u32,
    ) -> PyResult<Bound<'py, PyList>> {
        let joint = |name: String| {
            let found = Joint::ALL.into_iter().find(|joint| joint.name() == name);
            found.ok_or_else(|| {
                let names = Joint::ALL.map(Joint::name).join(", ");
                value_error(format!("{name:?} is no joint: the joints are {names}"))
            })
        };
        let query = Query {
            text: text.to_owned(),
            tags,
            joints: joints.into_iter().map(joint).collect::<PyResult<_>>()?,
            duration_ms_min: shortest_ms,
            duration_ms_max: longest_ms,
            limit,
            offset,
        };
        let actions = py.detach(|| self.lock().search(&query)).map_err(registry_error)?;
        let rows: PyResult<Vec<_>> = actions.iter().map(|action| summary(py, action)).collect();
        PyList::new(py, rows?)
    }

    #[pyo3(signature = (action, *, times=1, speed=1.0, arguments=None))]
    fn steps(
        &self,
        py: Python<'_>,
        action: NameOrText,
        times: u16,
        speed: f64,
        arguments: Option<Arguments>,
    ) -> PyResult<Vec<(Vec<String>, u16)>> {
        let arguments = values(py, arguments)?;
        let options = CompileOptions { times, speed, arguments, ..CompileOptions::default() };
        let compiled = py.detach(|| self.compile(&action, &options))?;
        let names = |step: &rsapien_protocol::Step| {
            step.pose.primitives().map(|primitive| primitive.to_string()).collect()
        };
        Ok(compiled.steps.iter().map(|step| (names(step), step.duration_ms)).collect())
    }

    /// The joints of an action over time.
    #[pyo3(signature = (action, *, arguments=None))]
    fn timeline(
        &self,
        py: Python<'_>,
        action: NameOrText,
        arguments: Option<Arguments>,
    ) -> PyResult<PyTimeline> {
        let arguments = values(py, arguments)?;
        let options = CompileOptions { arguments, ..CompileOptions::default() };
        let compiled = py.detach(|| self.compile(&action, &options))?;
        Ok(PyTimeline { timeline: Timeline::of(&compiled) })
    }

    fn restore(&self, py: Python<'_>, name: &str, version: u32) -> PyResult<u32> {
        py.detach(|| self.lock().restore(name, version)).map_err(registry_error)
    }

    #[pyo3(signature = (action, *, replace=false))]
    fn save<'py>(
        &self,
        py: Python<'py>,
        action: NameOrText,
        replace: bool,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (NameOrText::Name(text) | NameOrText::Text(text)) = action;
        self.import_text(py, &text, replace)
    }

    fn backup(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| self.lock().backup(&path, |_, _| {})).map_err(registry_error)
    }

    fn verify(&self, py: Python<'_>) -> PyResult<Vec<(String, String)>> {
        let found = py.detach(|| self.lock().integrity()).map_err(registry_error)?;
        Ok(found.problems.into_iter().map(|it| (it.what, it.advice)).collect())
    }

    #[pyo3(signature = (text, *, replace=false))]
    fn import_text<'py>(
        &self,
        py: Python<'py>,
        text: &str,
        replace: bool,
    ) -> PyResult<Bound<'py, PyDict>> {
        let policy = if replace { ImportPolicy::Replace } else { ImportPolicy::Refuse };
        let report = py.detach(|| {
            let mut registry = self.lock();
            let trials = try_all(&registry, text)?;
            registry.import_text(text, policy, &trials).map_err(registry_error)
        })?;
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

    #[pyo3(signature = (path, *names))]
    fn export_bundle(
        &self,
        py: Python<'_>,
        path: PathBuf,
        names: Vec<String>,
    ) -> PyResult<Vec<String>> {
        py.detach(|| bundle::export(&self.lock(), &path, &names))
    }

    #[pyo3(signature = (path, *, on_conflict="refuse"))]
    fn import_bundle<'py>(
        &self,
        py: Python<'py>,
        path: PathBuf,
        on_conflict: &str,
    ) -> PyResult<Bound<'py, PyDict>> {
        let policy = bundle::policy(on_conflict)?;
        let plan = py.detach(|| bundle::import(&mut self.lock(), &path, policy))?;
        bundle::dict(py, &plan)
    }

    #[pyo3(signature = (path, *, on_conflict="keep-mine"))]
    fn plan_bundle<'py>(
        &self,
        py: Python<'py>,
        path: PathBuf,
        on_conflict: &str,
    ) -> PyResult<Bound<'py, PyDict>> {
        let policy = bundle::policy(on_conflict)?;
        let plan = py.detach(|| bundle::plan(&self.lock(), &path, policy))?;
        bundle::dict(py, &plan)
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

/// How the actions of a text went on the virtual body, where nothing is wrong with them.
/// An action of a registry; without one, of those that come with the robot.
pub(crate) fn compiled(
    registry: Option<&PyRegistry>,
    action: &NameOrText,
    options: &CompileOptions,
) -> PyResult<CompiledAction> {
    match registry {
        Some(registry) => registry.compile(action, options),
        None => PyRegistry::in_memory()?.compile(action, options),
    }
}

pub(crate) fn try_all(registry: &Registry, text: &str) -> PyResult<Trials> {
    let checked = registry.check_text(text).map_err(registry_error)?;
    let mut trials = Trials::new();
    if checked.findings.has_errors() {
        return Ok(trials);
    }
    for compiled in checked.actions.iter().filter_map(|action| action.compiled.as_ref()) {
        let trial = try_on_virtual_body(compiled, &CancelToken::new());
        let trial = trial.map_err(crate::errors::robot_error)?;
        let kept = serde_json::to_string(&trial).map_err(value_error)?;
        trials.insert(compiled.name.clone(), kept);
    }
    Ok(trials)
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
