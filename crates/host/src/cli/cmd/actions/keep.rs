//! `rsapien actions restore`, `backup`, `verify`: keeping what is stored.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use rsapien_registry::Registry;

use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::exit::Status;
use crate::cli::progress;

/// Bring an older version of an action back, or a removed action
///
/// The old version is saved again, as the newest. With --from a whole registry is put in the place of this one; what
/// was there before is kept in a file beside it.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien actions restore wave 1
  rsapien actions restore --from backup.sqlite")]
pub(super) struct Restore {
    /// Name of the action
    #[arg(value_name = "ACTION", required_unless_present = "from")]
    name: Option<String>,

    /// Which of its versions; rsapien actions show ACTION --history lists them
    #[arg(value_name = "VERSION", required_unless_present = "from")]
    version: Option<u32>,

    /// A backup of a whole registry
    #[arg(long, value_name = "FILE", conflicts_with_all = ["name", "version"])]
    from: Option<PathBuf>,
}

/// Copy the registry to a new file, while it is in use
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  rsapien actions backup actions-today.sqlite")]
pub(super) struct Backup {
    /// The new file; nothing is written over one that is there
    #[arg(value_name = "FILE")]
    to: PathBuf,
}

/// Look whether everything in the registry is sound, and say what to do where it is not
///
/// The exit status is 1 when something is wrong.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien actions verify
  rsapien actions verify --repair")]
pub(super) struct Verify {
    /// Make anew what is derived of the texts: lengths, content hashes, the index of words
    #[arg(long)]
    repair: bool,
}

impl Restore {
    pub(super) fn run(
        self,
        context: &Context,
        mut registry: Registry,
        out: &mut impl Write,
    ) -> Result<Status> {
        if let Some(from) = &self.from {
            let kept = registry.restore_from(from)?;
            let answer = serde_json::json!({"from": from, "kept": kept});
            let text = format!(
                "restored from {}; what was there before is kept in {}",
                from.display(),
                kept.display()
            );
            context.style.answer(out, &answer, text)?;
            return Ok(Status::Done);
        }
        let (Some(name), Some(version)) = (self.name, self.version) else {
            return Err(Failure::new("name an action and one of its versions"));
        };
        let new = registry.restore(&name, version)?;
        let answer = serde_json::json!({"name": name, "restored": version, "version": new});
        let text = format!("version {version} of {name} is in force again, as version {new}");
        context.style.answer(out, &answer, text)?;
        Ok(Status::Done)
    }
}

impl Backup {
    pub(super) fn run(
        self,
        context: &Context,
        registry: &Registry,
        out: &mut impl Write,
    ) -> Result<Status> {
        let bar = progress::bar(context.style);
        registry.backup(&self.to, |copied, total| {
            bar.set_length(u64::from(total));
            bar.set_position(u64::from(copied));
        })?;
        bar.finish_and_clear();
        let answer = serde_json::json!({"file": self.to});
        context.style.answer(out, &answer, format_args!("wrote {}", self.to.display()))?;
        Ok(Status::Done)
    }
}

impl Verify {
    pub(super) fn run(
        self,
        context: &Context,
        mut registry: Registry,
        out: &mut impl Write,
    ) -> Result<Status> {
        let found = if self.repair { registry.repair()? } else { registry.integrity()? };
        let text = if found.problems.is_empty() {
            format!("{} actions, nothing wrong", found.actions)
        } else {
            let lines = found.problems.iter();
            lines
                .map(|problem| format!("{}\n  help: {}", problem.what, problem.advice))
                .collect::<Vec<_>>()
                .join("\n")
        };
        context.style.answer(out, &found, text)?;
        Ok(if found.problems.is_empty() { Status::Done } else { Status::Refused })
    }
}
