//! `Guest`: a robot whose line another program holds.

use crate::errors::robot_error;
use crate::outcome::{PyOutcome, admission_told, policy_of};
use crate::registry::{Arguments, NameOrText, PyRegistry, compiled, values};
use crate::waiting::{self, Listeners, ProgressTold};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rsapien::sharing::Guest;
use rsapien::{CancelToken, Claim, LinkAddress, PlayOptions, data};
use rsapien_registry::CompileOptions;
use std::sync::{Mutex, PoisonError};

/// Hands actions to the program that holds the line.
#[pyclass(name = "Guest", module = "rsapien", frozen)]
pub(crate) struct PyGuest {
    guest: Mutex<Guest>,
    link: String,
    holder: String,
}

#[pymethods]
impl PyGuest {
    #[staticmethod]
    #[pyo3(signature = (link="auto", *, baud=57_600))]
    fn find(py: Python<'_>, link: &str, baud: u32) -> PyResult<Option<PyGuest>> {
        let address: LinkAddress = link.parse().map_err(robot_error)?;
        let Some(folder) = data::lock_folder() else { return Ok(None) };
        let found = py.detach(|| Guest::find(&address, baud, &folder, "python"));
        Ok(found.map_err(robot_error)?.map(|guest| PyGuest {
            link: guest.link_name().to_owned(),
            holder: guest.holder().to_string(),
            guest: Mutex::new(guest),
        }))
    }

    #[getter]
    fn link(&self) -> &str {
        &self.link
    }

    #[getter]
    fn holder(&self) -> &str {
        &self.holder
    }

    /// What is played, and what waits.
    fn claims<'py>(&self, py: Python<'py>) -> PyResult<(Dicts<'py>, Dicts<'py>)> {
        let claims =
            py.detach(|| self.guest.lock().unwrap_or_else(PoisonError::into_inner).claims());
        let (playing, waiting) = claims.map_err(robot_error)?;
        Ok((dicts(py, &playing)?, dicts(py, &waiting)?))
    }

    #[pyo3(signature = (
        action, *, times=1, speed=1.0, mirrored=false, arguments=None, from_label=None, registry=None,
        policy="refuse", on_admission=None, on_progress=None
    ))]
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn play(
        &self,
        py: Python<'_>,
        action: NameOrText,
        times: u16,
        speed: f64,
        mirrored: bool,
        arguments: Option<Arguments>,
        from_label: Option<String>,
        registry: Option<&PyRegistry>,
        policy: &str,
        on_admission: Option<Py<PyAny>>,
        on_progress: Option<Py<PyAny>>,
    ) -> PyResult<PyOutcome> {
        let policy = policy_of(policy)?;
        let arguments = values(py, arguments)?;
        let options = CompileOptions { times, speed, mirrored, arguments };
        let compiled = compiled(registry, &action, &options)?;
        let listeners = Listeners { on_progress, on_admission };
        let token = CancelToken::new();
        let report = waiting::run(py, &token, &|| token.cancel(), &listeners, |told| {
            let told = Mutex::new(told);
            let tell = |what| told.lock().unwrap_or_else(PoisonError::into_inner)(what);
            let mut options = PlayOptions {
                cancel: token.clone(),
                from_label,
                on_progress: Some(Box::new(|progress| {
                    tell(ProgressTold::Steps(progress.steps_ended, progress.steps_total));
                })),
                ..PlayOptions::default()
            };
            let mut guest = self.guest.lock().unwrap_or_else(PoisonError::into_inner);
            guest.play(&compiled, policy, &mut options, &mut |it| tell(admission_told(it)))
        })?;
        Ok(PyOutcome { report })
    }

    fn __repr__(&self) -> String {
        format!("Guest({:?}, held by {})", self.link, self.holder)
    }
}

type Dicts<'py> = Vec<Bound<'py, PyDict>>;

fn dicts<'py>(py: Python<'py>, claims: &[Claim]) -> PyResult<Dicts<'py>> {
    let dict = |claim: &Claim| {
        let dict = PyDict::new(py);
        dict.set_item("action", &claim.action)?;
        dict.set_item("program", &claim.program)?;
        dict.set_item("pid", claim.pid)?;
        let joints = claim.common(claim).into_iter().map(rsapien_protocol::Joint::name);
        dict.set_item("joints", joints.collect::<Vec<_>>())?;
        Ok(dict)
    };
    claims.iter().map(dict).collect()
}
