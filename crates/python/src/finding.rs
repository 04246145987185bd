//! `Finding`: what the checker says.

use pyo3::prelude::*;
use rsapien_registry::{Findings, check};

/// One thing that the checker has found.
#[pyclass(name = "Finding", module = "rsapien", frozen, get_all)]
pub(crate) struct PyFinding {
    severity: &'static str,
    rule: &'static str,
    message: String,
    line: usize,
    column: usize,
    action: Option<String>,
    help: Option<String>,
    rendered: String,
}

impl PyFinding {
    /// Each finding, with its place.
    pub(crate) fn list(findings: &Findings) -> Vec<PyFinding> {
        let one = |finding: &rsapien_registry::Finding| {
            let (line, column) = findings.place(finding.span);
            let alone = Findings::new(findings.text.as_str(), vec![finding.clone()]);
            let rendered = check::render(&alone, "text", false);
            // Without the line that counts them.
            let rendered = rendered.rsplit_once("\n\n").map_or("", |(shown, _)| shown).to_owned();
            PyFinding {
                severity: finding.severity().name(),
                rule: finding.rule.name(),
                message: finding.message.clone(),
                line,
                column,
                action: finding.action.as_deref().map(str::to_owned),
                help: finding.help.as_deref().map(str::to_owned),
                rendered,
            }
        };
        findings.list.iter().map(one).collect()
    }
}

#[pymethods]
impl PyFinding {
    fn __str__(&self) -> &str {
        &self.rendered
    }

    fn __repr__(&self) -> String {
        format!("Finding({}: {:?}, line {})", self.rule, self.message, self.line)
    }
}
