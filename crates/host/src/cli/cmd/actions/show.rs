//! `rsapien actions show`.

use std::io::Write;

use clap::Args;
use rsapien_registry::{CompileOptions, Registry};

use super::text::{date, seconds};
use crate::cli::context::Context;
use crate::cli::diagnostics::Result;
use crate::cli::exit::Status;
use crate::cli::output::{Table, json_line};

/// Show an action as it is written, or its versions
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien actions show wave
  rsapien actions show wave --history
  rsapien actions show wave --version 1")]
pub(super) struct Cmd {
    /// Name of the action
    #[arg(value_name = "ACTION")]
    name: String,

    /// An older version; also of an action that was removed
    #[arg(long, value_name = "N", conflicts_with = "history")]
    version: Option<u32>,

    /// The list of its versions; also of an action that was removed
    #[arg(long)]
    history: bool,
}

impl Cmd {
    pub(super) fn run(
        self,
        context: &Context,
        registry: &Registry,
        out: &mut impl Write,
    ) -> Result<Status> {
        if self.history {
            return self.show_history(context, registry, out);
        }
        let action = match self.version {
            Some(version) => registry.get_version(&self.name, version)?,
            None => registry.get(&self.name)?,
        };
        if context.style.json {
            json_line(out, &action)?;
            return Ok(Status::Done);
        }
        // An old version may play actions that are gone; then its length is not known.
        let draft = action.draft().unwrap_or_default();
        let compiled = registry.compile_draft(&draft, &CompileOptions::default()).ok();
        let lasts = compiled.map_or(String::new(), |compiled| {
            let steps = match compiled.steps.len() {
                1 => "1 step".to_owned(),
                count => format!("{count} steps"),
            };
            format!(", {steps} in {}", seconds(compiled.duration_ms))
        });
        writeln!(out, "# version {} of {}{lasts}", action.version, date(action.changed_ms))?;
        writeln!(out, "{}", action.text)?;
        Ok(Status::Done)
    }

    fn show_history(
        &self,
        context: &Context,
        registry: &Registry,
        out: &mut impl Write,
    ) -> Result<Status> {
        let versions = registry.history(&self.name)?;
        if context.style.json {
            json_line(out, &versions)?;
            return Ok(Status::Done);
        }
        let mut table = Table::new(&["version", "saved", "description"]);
        for version in &versions {
            table.row([
                version.version.to_string(),
                date(version.changed_ms),
                version.description.lines().next().unwrap_or_default().to_owned(),
            ]);
        }
        writeln!(out, "{table}")?;
        Ok(Status::Done)
    }
}
