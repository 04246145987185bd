//! `rsapien actions edit`.

use std::env;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use clap::Args;
use rsapien_registry::{ActionDraft, Registry, read_toml, write_toml};

use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::exit::Status;

/// Change an action in a text editor
///
/// Opens the action's TOML text in $VISUAL or $EDITOR (vi where neither is set) and saves it as a new version once the
/// editor has ended. A text with mistakes is not saved: it is kept in a file that the message names.
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  EDITOR=nano rsapien actions edit greet")]
pub(super) struct Cmd {
    /// Name of the action
    #[arg(value_name = "ACTION")]
    name: String,
}

impl Cmd {
    pub(super) fn run(
        self,
        context: &Context,
        mut registry: Registry,
        out: &mut impl Write,
    ) -> Result<Status> {
        let before = registry.get(&self.name)?;
        let path = scratch_file(&self.name, &write_toml(std::slice::from_ref(&before.draft)))?;
        run_editor(&path)?;
        let text =
            fs::read_to_string(&path).map_err(|error| Failure::file("read", &path, &error))?;
        let kept = |failure: Failure| {
            failure.hint(format!(
                "your text is kept in {0}: mend it there, then rsapien actions import --replace {0}",
                path.display()
            ))
        };
        let draft = the_action(&self.name, &text).map_err(kept)?;
        if draft == before.draft {
            discard(&path);
            let answer =
                serde_json::json!({"name": self.name, "version": before.version, "changed": false});
            context.style.answer(out, &answer, format_args!("{} is unchanged", self.name))?;
            return Ok(Status::Done);
        }
        let version = registry.save(&draft).map_err(|error| kept(error.into()))?;
        discard(&path);
        let answer = serde_json::json!({"name": self.name, "version": version, "changed": true});
        context.style.answer(
            out,
            &answer,
            format_args!("saved version {version} of {}", self.name),
        )?;
        Ok(Status::Done)
    }
}

/// The one action that the text has to hold, under its old name.
fn the_action(name: &str, text: &str) -> Result<ActionDraft> {
    let mut drafts =
        read_toml(text).map_err(|findings| Failure::new(findings.to_string()))?.into_iter();
    match (drafts.next(), drafts.next()) {
        (Some(draft), None) if draft.name == name => Ok(draft),
        (Some(draft), None) => Err(Failure::new(format!(
            "the action is called {:?} now, and {name:?} was edited",
            draft.name
        ))),
        (None, _) => Err(Failure::new("the text has no action")),
        (Some(_), Some(_)) => Err(Failure::new("the text has more than one action")),
    }
}

/// A new file with this text in the folder for temporary files.
fn scratch_file(name: &str, text: &str) -> Result<PathBuf> {
    let folder = env::temp_dir();
    let mut number = std::process::id();
    loop {
        let path = folder.join(format!("rsapien-{name}-{number}.toml"));
        let created = fs::OpenOptions::new().write(true).create_new(true).open(&path);
        match created.and_then(|mut file| file.write_all(text.as_bytes())) {
            Ok(()) => return Ok(path),
            Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {
                number = number.wrapping_add(1);
            }
            Err(error) => return Err(Failure::file("write", &path, &error)),
        }
    }
}

fn run_editor(path: &Path) -> Result<()> {
    let set = |name| env::var(name).ok().filter(|value| !value.trim().is_empty());
    let editor = set("VISUAL").or_else(|| set("EDITOR")).unwrap_or_else(|| "vi".to_owned());
    // As in `EDITOR="code --wait"`.
    let mut words = editor.split_whitespace();
    let program = words.next().unwrap_or("vi");
    let advice = "set EDITOR to the editor you like, as in EDITOR=nano";
    let status = Command::new(program).args(words).arg(path).status().map_err(|error| {
        Failure::new(format!("cannot start the editor {editor:?}: {error}")).hint(advice)
    })?;
    if status.success() {
        Ok(())
    } else {
        discard(path);
        Err(Failure::new(format!("the editor {editor:?} ended with {status}; nothing was saved")))
    }
}

/// A file left behind in the folder for temporary files does no harm.
fn discard(path: &Path) {
    let _ = fs::remove_file(path);
}
