//! `rsapien actions import` and `export`.

use std::fs;
use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use rsapien_registry::{ImportPolicy, Registry};

use super::save;
use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::exit::Status;

/// Import the actions of files
///
/// All of a file or none. An action that exists with other content is refused unless --replace is given.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien actions import dances.rsa
  rsapien actions import --replace dances.rsa")]
pub(super) struct Import {
    /// Files in the action language; `-` is the standard input
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,

    /// Save actions that exist with other content as new versions
    #[arg(long)]
    replace: bool,
}

/// Export actions as text
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien actions export > all.rsa
  rsapien actions export dance --with-played --out dance.rsa")]
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
            save::save(context, &mut registry, out, file, policy)?;
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
            registry.export_all_text()?
        } else {
            let names: Vec<&str> = self.names.iter().map(String::as_str).collect();
            registry.export_text(&names, self.with_played)?
        };
        match &self.out {
            Some(path) => {
                fs::write(path, text).map_err(|error| Failure::file("write", path, &error))?;
                let answer = serde_json::json!({"file": path});
                context.style.answer(out, &answer, format_args!("wrote {}", path.display()))?;
            }
            None if context.style.json => {
                context.style.answer(out, &serde_json::json!({"text": text}), "")?;
            }
            None => out.write_all(text.as_bytes())?,
        }
        Ok(Status::Done)
    }
}
