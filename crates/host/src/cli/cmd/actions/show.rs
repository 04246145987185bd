//! `rsapien actions show`.

mod beside;

use std::fs;
use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use rsapien_registry::timeline::SvgOptions;
use rsapien_registry::{
    Action, CONTENT_HASH_SHORT, CompileOptions, CompiledAction, Registry, Timeline,
};

use super::text::{date, seconds};
use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::exit::Status;
use crate::cli::output::{Screen, Table, json_line};
use crate::cli::performance;
use crate::cli::robot::{self, PaceOptions};
use crate::trial::Trial;

/// Columns of the timeline where the output is no terminal.
const COLUMNS: usize = 100;

/// Show an action: its joints over time, and its text; or its versions
///
/// The timeline is reckoned with nominal travel times. A hollow arrow begins at an unknown place; it is drawn from the
/// middle, where the robot's initialisation leaves every joint.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien actions show wave
  rsapien actions show wave --svg wave.svg
  rsapien actions show wave --play
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

    /// Only the text of the action, word for word
    #[arg(long, conflicts_with = "history")]
    text: bool,

    /// Write the timeline as a picture to this file
    #[arg(long, value_name = "FILE", conflicts_with_all = ["history", "text"])]
    svg: Option<PathBuf>,

    /// Also play it on the virtual robot
    #[arg(long, conflicts_with_all = ["history", "text"])]
    play: bool,
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
        if self.text {
            writeln!(out, "{}", action.text)?;
            return Ok(Status::Done);
        }
        // An old version may play actions that are gone; then there is nothing to draw.
        let draft = action.draft().unwrap_or_default();
        let compiled = registry.compile_draft(&draft, &CompileOptions::default());
        if let Some(path) = &self.svg {
            let svg = picture(&action, &compiled?);
            fs::write(path, svg).map_err(|error| Failure::file("write", path, &error))?;
            let answer = serde_json::json!({"name": action.name, "file": path});
            context.style.answer(out, &answer, format_args!("wrote {}", path.display()))?;
            return Ok(Status::Done);
        }
        // Played on a terminal, the timeline is drawn with a bar that goes over it.
        let is_beside = self.play && context.style.error.is_terminal() && !context.style.json;
        if context.style.json {
            json_line(out, &action)?;
        } else {
            let hash = if self.version.is_none() { hash_of(registry, &action.name)? } else { None };
            tell(context, out, &action, compiled.as_ref().ok(), hash.as_deref(), is_beside)?;
        }
        if self.play {
            play(context, out, &action.name, &compiled?, is_beside)
        } else {
            Ok(Status::Done)
        }
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

/// The picture of an action as it is stored.
pub(super) fn picture(action: &Action, compiled: &CompiledAction) -> String {
    let description = action.description.clone();
    let options = SvgOptions { title: action.name.clone(), description, ..SvgOptions::default() };
    Timeline::of(compiled).to_svg(&options)
}

fn hash_of(registry: &Registry, name: &str) -> Result<Option<String>> {
    let summary = registry.summary(name)?;
    Ok(summary.content_hash.get(..CONTENT_HASH_SHORT).map(str::to_owned))
}

/// Everything about an action, for people.
fn tell(
    context: &Context,
    out: &mut impl Write,
    action: &Action,
    compiled: Option<&CompiledAction>,
    hash: Option<&str>,
    is_beside: bool,
) -> Result<()> {
    let lasts = compiled.map_or(String::new(), |compiled| {
        let steps = match compiled.steps.len() {
            1 => "1 step".to_owned(),
            count => format!("{count} steps"),
        };
        format!(", {steps} in {}", seconds(compiled.duration_ms))
    });
    let hash = hash.map_or(String::new(), |hash| format!(", #{hash}"));
    let (name, version) = (&action.name, action.version);
    writeln!(out, "{name}: version {version} of {}{lasts}{hash}", date(action.changed_ms))?;
    if let Some(trial) = action.trial.as_deref().and_then(|it| serde_json::from_str(it).ok()) {
        let trial: Trial = trial;
        writeln!(out, "tried on the virtual body: {trial}")?;
    }
    for warning in &action.warnings {
        writeln!(out, "warning: {warning}")?;
    }
    writeln!(out)?;
    if let (Some(compiled), false) = (compiled, is_beside) {
        let with_colour = context.style.output == Screen::Color;
        writeln!(out, "{}", Timeline::of(compiled).to_text(columns(context), with_colour))?;
    }
    writeln!(out, "{}", action.text)?;
    Ok(())
}

/// How wide the terminal is.
fn columns(context: &Context) -> usize {
    if !context.style.output.is_terminal() {
        return COLUMNS;
    }
    #[cfg(unix)]
    if let Ok(size) = rustix::termios::tcgetwinsize(std::io::stdout()) {
        return usize::from(size.ws_col).max(1);
    }
    COLUMNS
}

/// Plays it on a virtual robot of its own, on a terminal beside its timeline.
fn play(
    context: &Context,
    out: &mut impl Write,
    name: &str,
    compiled: &CompiledAction,
    is_beside: bool,
) -> Result<Status> {
    let command = format!("actions show {name}");
    let address = crate::LinkAddress::Virtual;
    let open = robot::open_at(context, &address, &command, PaceOptions::default())?;
    let mut motion = open.ready_motion(context, out)?;
    performance::tell_played(context, out, &open, name, compiled, || {
        if is_beside {
            let with_colour = context.style.error == Screen::Color;
            // A line as wide as the terminal would wrap.
            let width = columns(context).saturating_sub(1);
            beside::play(&open, &mut motion, compiled, width, with_colour)
        } else {
            performance::run(context, &open, &mut motion, compiled, None)
        }
    })
}
