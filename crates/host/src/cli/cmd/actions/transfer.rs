//! `rsapien actions import` and `export`.

use std::fs;
use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use rsapien_registry::{ImportPolicy, ImportReport, Registry};

use super::text;
use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::exit::Status;

/// Import the actions of TOML files
///
/// All of a file or none. An action that exists with other content is refused unless --replace is given.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien actions import dances.toml
  rsapien actions import --replace dances.toml")]
pub(super) struct Import {
    /// TOML files; `-` is the standard input
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,

    /// Save actions that exist with other content as new versions
    #[arg(long)]
    replace: bool,
}

/// Export actions as TOML
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien actions export > all.toml
  rsapien actions export dance --with-played --out dance.toml")]
pub(super) struct Export {
    /// Names of the actions; all when none is given
    #[arg(value_name = "ACTION")]
    names: Vec<String>,

    /// Also whatever they play, so that another registry can import the text
    #[arg(long, requires = "names")]
    with_played: bool,

    /// Write to this file instead of the standard output
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
}

impl Import {
    pub(super) fn run(
        self,
        context: &Context,
        mut registry: Registry,
        out: &mut impl Write,
    ) -> Result<Status> {
        let policy = if self.replace { ImportPolicy::Replace } else { ImportPolicy::Refuse };
        for file in &self.files {
            let report = registry.import_toml(&text::read(file)?, policy)?;
            tell_import(context, out, &report)?;
        }
        Ok(Status::Done)
    }
}

impl Export {
    pub(super) fn run(
        self,
        context: &Context,
        registry: &Registry,
        out: &mut impl Write,
    ) -> Result<Status> {
        let text = if self.names.is_empty() {
            registry.export_all_toml()?
        } else {
            let names: Vec<&str> = self.names.iter().map(String::as_str).collect();
            registry.export_toml(&names, self.with_played)?
        };
        match &self.out {
            Some(path) => {
                fs::write(path, text).map_err(|error| Failure::file("write", path, &error))?;
                let answer = serde_json::json!({"file": path});
                context.style.answer(out, &answer, format_args!("wrote {}", path.display()))?;
            }
            None if context.style.json => {
                context.style.answer(out, &serde_json::json!({"toml": text}), "")?;
            }
            None => out.write_all(text.as_bytes())?,
        }
        Ok(Status::Done)
    }
}

/// What an import did.
pub(super) fn tell_import(
    context: &Context,
    out: &mut impl Write,
    report: &ImportReport,
) -> Result<Status> {
    let parts = [
        ("added", &report.added),
        ("new version of", &report.replaced),
        ("unchanged", &report.unchanged),
    ];
    let lines: Vec<String> = parts
        .iter()
        .filter(|(_, names)| !names.is_empty())
        .map(|(what, names)| format!("{what} {}", names.join(", ")))
        .collect();
    let text =
        if lines.is_empty() { "the text has no action".to_owned() } else { lines.join("\n") };
    context.style.answer(out, report, text)?;
    Ok(if lines.is_empty() { Status::Refused } else { Status::Done })
}
