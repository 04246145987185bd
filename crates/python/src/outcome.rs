//! What becomes of an action, and how it ended.

use crate::errors::value_error;
use crate::waiting::ProgressTold;
use pyo3::prelude::*;
use rsapien::{Admission, Outcome, PlayReport, Policy};

/// What becomes of an action, as a word and in words.
pub(crate) fn admission_told(admission: &Admission) -> ProgressTold {
    let word = match admission {
        Admission::Begins => "begins",
        Admission::Waits { .. } => "waits",
        Admission::Replaces { .. } => "replaces",
        Admission::Beside { .. } => "beside",
    };
    ProgressTold::Admission(word, admission.to_string())
}

/// The policy of a word.
pub(crate) fn policy_of(word: &str) -> PyResult<Policy> {
    Policy::from_name(word).ok_or_else(|| {
        let names = Policy::ALL.map(Policy::name).join(", ");
        value_error(format!("policy: {word:?} is none of {names}"))
    })
}

/// How an action ended.
#[pyclass(name = "Outcome", module = "rsapien", frozen)]
pub(crate) struct PyOutcome {
    pub(crate) report: PlayReport,
}

#[pymethods]
impl PyOutcome {
    #[getter]
    fn kind(&self) -> &'static str {
        match self.report.outcome {
            Outcome::Done => "done",
            Outcome::Refused { .. } => "refused",
            Outcome::Interrupted { .. } => "interrupted",
            Outcome::Unknown { .. } => "unknown",
        }
    }

    #[getter]
    fn text(&self) -> String {
        self.report.to_string()
    }

    #[getter]
    fn steps_ended(&self) -> usize {
        self.report.steps_ended
    }

    #[getter]
    fn steps_total(&self) -> usize {
        self.report.steps_total
    }

    #[getter]
    fn elapsed_ms(&self) -> u64 {
        self.report.elapsed_ms
    }

    /// Action and number of the step that was under way when it ended early.
    #[getter]
    fn reached(&self) -> Option<(String, usize)> {
        let reached = self.report.reached.as_ref()?;
        Some((reached.source.action.to_string(), reached.source.step))
    }

    /// How what was played instead of the rest ended.
    #[getter]
    fn instead(&self) -> Option<PyOutcome> {
        self.report.instead.as_ref().map(|report| PyOutcome { report: (**report).clone() })
    }

    fn __bool__(&self) -> bool {
        self.report.outcome.is_done()
    }

    fn __repr__(&self) -> String {
        format!("Outcome({})", self.report)
    }
}
