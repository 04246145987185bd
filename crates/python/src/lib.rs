//! The Python module: conversion between Python and the crates, and nothing else.

mod bundle;
mod detect;
mod detection;
mod ellipse;
mod errors;
mod finding;
mod guest;
mod outcome;
mod picture;
mod pose;
mod recording;
mod registry;
mod robot;
mod state;
mod timeline;
mod tracker;
mod waiting;

use pyo3::prelude::*;
use std::ffi::OsString;

/// Runs the `rsapien` command with `arguments`, its name first, and returns its exit status.
#[pyfunction]
fn run_command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| rsapien::cli::main(arguments))
}

#[pymodule]
fn _rsapien(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<detect::PyDetector>()?;
    module.add_class::<detection::PyDetection>()?;
    module.add_class::<ellipse::PyEllipse>()?;
    module.add_class::<finding::PyFinding>()?;
    module.add_class::<timeline::PyTimeline>()?;
    module.add_class::<guest::PyGuest>()?;
    module.add_class::<robot::PyStates>()?;
    module.add_function(wrap_pyfunction!(registry::action_name, module)?)?;
    module.add_class::<tracker::PyTracker>()?;
    module.add_class::<tracker::PyTrack>()?;
    module.add_class::<registry::PyRegistry>()?;
    module.add_class::<recording::PyRecording>()?;
    module.add_class::<recording::PyFrames>()?;
    module.add_class::<recording::PyRecorder>()?;
    module.add_class::<outcome::PyOutcome>()?;
    module.add_class::<robot::PyRobot>()?;
    module.add_function(wrap_pyfunction!(detect::detect, module)?)?;
    module.add_function(wrap_pyfunction!(run_command, module)?)?;
    pose::register(module)?;
    errors::register(module)
}
