//! Bundles: actions in one file, for another registry.

use crate::errors::{registry_error, value_error};
use crate::registry::try_all;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rsapien_registry::timeline::SvgOptions;
use rsapien_registry::{Bundle, BundlePlan, BundlePolicy, Registry, Timeline};
use std::fs::File;
use std::io::{BufReader, Cursor};
use std::path::Path;

/// The policy of a word.
pub(crate) fn policy(word: &str) -> PyResult<BundlePolicy> {
    match word {
        "refuse" => Ok(BundlePolicy::Refuse),
        "keep-mine" => Ok(BundlePolicy::KeepMine),
        "take-theirs" => Ok(BundlePolicy::TakeTheirs),
        "rename" => Ok(BundlePolicy::RenameTheirs),
        _ => Err(value_error(format!(
            "on_conflict: {word:?} is none of refuse, keep-mine, take-theirs, rename"
        ))),
    }
}

fn file_error(path: &Path, error: &std::io::Error) -> PyErr {
    PyOSError::new_err(format!("{}: {error}", path.display()))
}

/// Writes a bundle; the names of all that is in it.
pub(crate) fn export(registry: &Registry, path: &Path, names: &[String]) -> PyResult<Vec<String>> {
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    // Whole in memory first: a name that is unknown leaves no half file behind.
    let mut bytes = Cursor::new(Vec::new());
    let written = registry.export_bundle(&names, &mut bytes, |action, compiled| {
        let (title, description) = (action.name.clone(), action.description.clone());
        Timeline::of(compiled).to_svg(&SvgOptions { title, description, ..SvgOptions::default() })
    });
    let manifest = written.map_err(registry_error)?;
    std::fs::write(path, bytes.into_inner()).map_err(|error| file_error(path, &error))?;
    Ok(manifest.actions.into_iter().map(|action| action.name).collect())
}

fn read(path: &Path) -> PyResult<Bundle> {
    let file = File::open(path).map_err(|error| file_error(path, &error))?;
    Bundle::read(BufReader::new(file)).map_err(registry_error)
}

/// What an import would do.
pub(crate) fn plan(registry: &Registry, path: &Path, policy: BundlePolicy) -> PyResult<BundlePlan> {
    registry.plan_bundle(&read(path)?, policy).map_err(registry_error)
}

/// Imports a bundle, each of whose actions is tried here.
pub(crate) fn import(
    registry: &mut Registry,
    path: &Path,
    policy: BundlePolicy,
) -> PyResult<BundlePlan> {
    let bundle = read(path)?;
    let planned = registry.plan_bundle(&bundle, policy).map_err(registry_error)?;
    let trials = try_all(registry, &planned.text)?;
    registry.import_bundle(&bundle, policy, &trials).map_err(registry_error)
}

/// A plan for Python.
pub(crate) fn dict<'py>(py: Python<'py>, plan: &BundlePlan) -> PyResult<Bound<'py, PyDict>> {
    let told = PyDict::new(py);
    told.set_item("added", &plan.added)?;
    told.set_item("unchanged", &plan.unchanged)?;
    let conflicts: Vec<&str> = plan.conflicts.iter().map(|it| it.name.as_str()).collect();
    told.set_item("conflicts", conflicts)?;
    told.set_item("renamed", &plan.renamed)?;
    told.set_item("plays_mine", &plan.plays_mine)?;
    Ok(told)
}
