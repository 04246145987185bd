//! `rsapien actions check`.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use rsapien_registry::check::{self, CheckedText};
use rsapien_registry::{Finding, Findings, Registry};

use super::text;
use crate::cli::context::Context;
use crate::cli::diagnostics::Result;
use crate::cli::exit::Status;
use crate::cli::output::{Screen, json_line};

/// Tell what is wrong with files of actions, without storing anything
///
/// Everything found is told with its place and what to do; docs/rules.md explains each rule. Errors refuse an action,
/// warnings do not. The exit status is 1 when there is an error.
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  rsapien actions check dances.rsa")]
pub(super) struct Cmd {
    /// Files in the action language; `-` is the standard input
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
            let CheckedText { actions, findings, silenced } =
                registry.check_text(&text::read(file)?)?;
            if findings.has_errors() {
                status = Status::Refused;
            }
            let name = file.display().to_string();
            if context.style.json {
                let list: Vec<_> =
                    findings.list.iter().map(|finding| json(&findings, finding)).collect();
                let silenced: Vec<_> =
                    silenced.iter().map(|finding| json(&findings, finding)).collect();
                let answer =
                    serde_json::json!({"file": file, "findings": list, "silenced": silenced});
                json_line(out, &answer)?;
            } else if findings.list.is_empty() {
                let what = match actions.len() {
                    1 => "1 action".to_owned(),
                    count => format!("{count} actions"),
                };
                let silenced = match silenced.len() {
                    0 => String::new(),
                    1 => " (1 warning is silenced with a reason)".to_owned(),
                    count => format!(" ({count} are silenced with a reason)"),
                };
                writeln!(out, "{name}: {what}, nothing wrong{silenced}")?;
            } else {
                let with_colour = context.style.output == Screen::Color;
                write!(out, "{}", check::render(&findings, &name, with_colour))?;
            }
        }
        Ok(status)
    }
}

/// A finding for programs.
fn json(findings: &Findings, finding: &Finding) -> serde_json::Value {
    let (line, column) = findings.place(finding.span);
    serde_json::json!({
        "severity": finding.severity().name(),
        "rule": finding.rule.name(),
        "message": finding.message,
        "line": line,
        "column": column,
        "action": finding.action,
        "help": finding.help,
    })
}
