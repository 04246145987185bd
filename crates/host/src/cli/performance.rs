//! Playing steps: progress on a terminal, and how it ended.

use std::io::Write;

use indicatif::{ProgressBar, ProgressStyle};
use rsapien_protocol::Step;

use super::context::Context;
use super::diagnostics::{Failure, Result};
use super::exit::Status;
use super::output::{Screen, Style};
use super::robot::OpenRobot;
use super::view;
use crate::{Interruption, MotionController, Outcome, PlayOptions, PlayReport};

/// Plays `steps` and tells how they ended; `name` is the action they are, if they are one.
pub(crate) fn play(
    context: &Context,
    out: &mut impl Write,
    open: &OpenRobot,
    motion: &mut MotionController,
    name: Option<&str>,
    steps: &[Step],
) -> Result<Status> {
    let report = run(context, open, motion, steps)?;
    if open.interrupt.is_raised() {
        return Err(Failure::interrupted());
    }
    let (word, detail, status) = outcome(&report.outcome);
    let answer = serde_json::json!({
        "action": name,
        "outcome": word,
        "detail": detail,
        "steps_ended": report.steps_ended,
        "steps_total": report.steps_total,
        "elapsed_ms": report.elapsed_ms,
        "motion": report.evidence.as_ref().map(view::motion),
    });
    let name = name.map_or(String::new(), |name| format!("{name}: "));
    let detail = detail.map_or(String::new(), |detail| format!(" {detail}"));
    let text = format!(
        "{name}{word}{detail} ({} of {} steps, {})",
        report.steps_ended,
        report.steps_total,
        view::seconds(report.elapsed_ms)
    );
    context.style.answer(out, &answer, text)?;
    Ok(status)
}

/// Plays `steps` with progress on a terminal.
pub(crate) fn run(
    context: &Context,
    open: &OpenRobot,
    motion: &mut MotionController,
    steps: &[Step],
) -> Result<PlayReport> {
    let bar = progress_bar(context.style);
    let mut options = PlayOptions {
        cancel: open.cancel.clone(),
        on_progress: Some(Box::new(|progress| {
            bar.set_length(progress.total_ms);
            bar.set_position(progress.elapsed_ms);
            bar.set_message(format!("step {} of {}", progress.steps_ended, progress.steps_total));
        })),
        ..PlayOptions::default()
    };
    let report = motion.play(steps, &mut options);
    drop(options);
    bar.finish_and_clear();
    open.done(report)
}

/// A bar on the standard error, where that is a terminal.
fn progress_bar(style: Style) -> ProgressBar {
    if !style.error.is_terminal() {
        return ProgressBar::hidden();
    }
    let template =
        if style.error == Screen::Color { "{bar:30.green} {msg}" } else { "{bar:30} {msg}" };
    let bar = ProgressBar::new(0);
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.progress_chars("━╸ "));
    }
    bar
}

/// The outcome in a word, with its detail, and the exit status.
fn outcome(outcome: &Outcome) -> (&'static str, Option<String>, Status) {
    match outcome {
        Outcome::Done => ("done", None, Status::Done),
        Outcome::Refused { status } => ("refused", Some(format!("({status})")), Status::Refused),
        Outcome::Interrupted { by: Interruption::Cancelled } => {
            ("interrupted", None, Status::Refused)
        }
        Outcome::Interrupted { by } => ("interrupted", Some(format!("by {by}")), Status::Refused),
        Outcome::Unknown { why } => ("unknown", Some(format!("({why})")), Status::Refused),
    }
}
