//! `rsapien actions check`.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use rsapien_registry::Registry;

use super::text;
use crate::cli::context::Context;
use crate::cli::diagnostics::Result;
use crate::cli::exit::Status;
use crate::cli::output::json_line;

/// Tell what is wrong with TOML files of actions, without storing anything
///
/// Everything found is told with its line, action and step. The exit status is 1 when something is wrong.
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  rsapien actions check dances.toml")]
pub(super) struct Cmd {
    /// TOML files; `-` is the standard input
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
}

impl Cmd {
    pub(super) fn run(
        self,
        context: &Context,
        registry: &Registry,
        out: &mut impl Write,
    ) -> Result<Status> {
        let mut status = Status::Done;
        for file in &self.files {
            let findings = registry.check_toml(&text::read(file)?)?;
            if !findings.is_empty() {
                status = Status::Refused;
            }
            let name = file.display();
            if context.style.json {
                let findings: Vec<_> = findings
                    .iter()
                    .map(|finding| {
                        serde_json::json!({
                            "line": finding.line,
                            "action": finding.action,
                            "step": finding.step,
                            "problem": finding.problem.to_string(),
                        })
                    })
                    .collect();
                json_line(out, &serde_json::json!({"file": file, "findings": findings}))?;
            } else if findings.is_empty() {
                writeln!(out, "{name}: nothing wrong")?;
            } else {
                for finding in findings {
                    writeln!(out, "{name}: {finding}")?;
                }
            }
        }
        Ok(status)
    }
}
