//! `rsapien actions edit`.

use std::env;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use clap::Args;
use rsapien_registry::{ImportPolicy, Registry, parse_text};

use super::save;
use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::exit::Status;

/// Change an action in a text editor
///
/// Opens the action's text in $VISUAL or $EDITOR (vi where neither is set) and saves it as a new version once the
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
        let path = scratch_file(&self.name, &format!("{}\n", before.text))?;
        run_editor(&path)?;
        let text =
            fs::read_to_string(&path).map_err(|error| Failure::file("read", &path, &error))?;
        let kept = |failure: Failure| {
            failure.hint(format!(
                "your text is kept in {0}: mend it there, then rsapien actions import --replace {0}",
                path.display()
            ))
        };
        check_name(&before.name, &text, &path).map_err(kept)?;
        if text.trim() == before.text.trim() {
            discard(&path);
            let answer =
                serde_json::json!({"name": self.name, "version": before.version, "changed": false});
            context.style.answer(out, &answer, format_args!("{} is unchanged", self.name))?;
            return Ok(Status::Done);
        }
        let file_name = path.display().to_string();
        let policy = ImportPolicy::Replace;
        save::save_text(context, &mut registry, &text, &file_name, policy).map_err(kept)?;
        let version = registry.get(&before.name)?.version;
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

/// Refuses a text that does not hold one action under its old name.
fn check_name(name: &str, text: &str, path: &Path) -> Result<()> {
    let parsed = parse_text(text);
    let file_name = path.display().to_string();
    let actions =
        parsed.into_actions(text).map_err(|findings| Failure::findings(findings, &file_name))?;
    match actions.as_slice() {
        [action] if action.draft.name.text == name => Ok(()),
        [action] => Err(Failure::new(format!(
            "the action is called {:?} now, and {name:?} was edited",
            action.draft.name.text
        ))),
        [] => Err(Failure::new("the text has no action")),
        _ => Err(Failure::new("the text has more than one action")),
    }
}

/// A new file with this text in the folder for temporary files.
fn scratch_file(name: &str, text: &str) -> Result<PathBuf> {
    let folder = env::temp_dir();
    let mut number = std::process::id();
    loop {
        let path = folder.join(format!("rsapien-{name}-{number}.rsa"));
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
