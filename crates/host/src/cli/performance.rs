//! Playing steps: progress on a terminal, and how it ended.

use std::fmt::Write as _;
use std::io::Write;
use std::sync::PoisonError;

use rsapien_protocol::{Joint, Step};
use rsapien_registry::CompiledAction;
use rsapien_sim::geometry::RobotPose;

use super::context::Context;
use super::diagnostics::{Failure, Result};
use super::exit::Status;
use super::progress;
use super::robot::OpenRobot;
use super::view;
use crate::{Interruption, MotionController, Outcome, PlayOptions, PlayReport, Progress};

/// Plays `action` and tells how it ended; `name` is what it is called, if it has a name.
pub(crate) fn play(
    context: &Context,
    out: &mut impl Write,
    open: &OpenRobot,
    motion: &mut MotionController,
    name: Option<&str>,
    action: &CompiledAction,
    from_label: Option<&str>,
) -> Result<Status> {
    let before = pose(open);
    let report = run(context, open, motion, action, from_label)?;
    if open.interrupt.is_raised() {
        return Err(Failure::interrupted());
    }
    let (_, _, status) = outcome(&report.outcome);
    let mut answer = json(&report);
    answer["action"] = name.into();
    let name = name.map_or(String::new(), |name| format!("{name}: "));
    context.style.answer(out, &answer, format!("{name}{}", in_words(&report)))?;
    if let (Some(before), Some(after)) = (before, pose(open)) {
        let from = from_label.and_then(|name| action.labels.iter().find(|it| &*it.name == name));
        let from = from.map_or(0, |label| label.step);
        let played = action.steps.iter().skip(from).take(report.steps_accepted);
        let played: Vec<Step> = played.copied().collect();
        context.style.remark(out, what_moved(&played, &before, &after))?;
    }
    Ok(status)
}

/// A report for programs.
fn json(report: &PlayReport) -> serde_json::Value {
    let (word, detail, _) = outcome(&report.outcome);
    serde_json::json!({
        "action": report.action,
        "outcome": word,
        "detail": detail,
        "steps_ended": report.steps_ended,
        "steps_total": report.steps_total,
        "elapsed_ms": report.elapsed_ms,
        "reached": report.reached.as_ref().map(|reached| serde_json::json!({
            "step": reached.number,
            "action": &*reached.source.action,
            "step_of_action": reached.source.step,
        })),
        "instead": report.instead.as_ref().map(|instead| json(instead)),
        "motion_before": report.before.as_ref().map(view::motion),
        "motion": report.evidence.as_ref().map(view::motion),
    })
}

/// `interrupted by bumper left-hand (2 of 7 steps, 1.4 s, in step 3); instead back-off: done (...)`.
fn in_words(report: &PlayReport) -> String {
    let (word, detail, _) = outcome(&report.outcome);
    let detail = detail.map_or(String::new(), |detail| format!(" {detail}"));
    let reached = report.reached.as_ref().map_or(String::new(), |reached| {
        let source = &reached.source;
        let within = if *source.action == *report.action {
            String::new()
        } else {
            format!(" of {}", source.action)
        };
        format!(", in step {}{within}", source.step)
    });
    let (ended, total) = (report.steps_ended, report.steps_total);
    let elapsed = view::seconds(report.elapsed_ms);
    let mut text = format!("{word}{detail} ({ended} of {total} steps, {elapsed}{reached})");
    if let Some(instead) = &report.instead {
        let _ = write!(text, "; instead {}: {}", instead.action, in_words(instead));
    }
    text
}

/// Where the virtual robot stands; nobody knows it of another.
fn pose(open: &OpenRobot) -> Option<RobotPose> {
    let robot = open.robot.virtual_robot()?;
    Some(robot.lock().unwrap_or_else(PoisonError::into_inner).pose())
}

/// What someone who watched the virtual robot would have seen.
fn what_moved(steps: &[Step], before: &RobotPose, after: &RobotPose) -> String {
    let joints: Vec<&str> = Joint::ALL
        .into_iter()
        .filter(|joint| steps.iter().any(|step| step.pose.get(*joint).is_some()))
        .map(Joint::name)
        .collect();
    let mut text = match joints.as_slice() {
        [] => "the virtual robot waited".to_owned(),
        joints => format!("the virtual robot moved: {}", joints.join(", ")),
    };
    let (east_m, north_m) = (after.x_m - before.x_m, after.y_m - before.y_m);
    let (sin, cos) = before.heading_rad.sin_cos();
    let ahead_m = east_m * cos + north_m * sin;
    let turned_deg = (after.heading_rad - before.heading_rad).to_degrees();
    // Less than this is a foot that slips.
    if ahead_m.abs() >= 0.005 {
        let way = if ahead_m < 0.0 { "backward" } else { "forward" };
        let _ = write!(text, "; it went {:.2} m {way}", ahead_m.abs());
    }
    if turned_deg.abs() >= 1.0 {
        let way = if turned_deg < 0.0 { "right" } else { "left" };
        let _ = write!(text, "; it turned {:.0} degrees {way}", turned_deg.abs());
    }
    text
}

/// Plays `action` with progress on a terminal.
pub(crate) fn run(
    context: &Context,
    open: &OpenRobot,
    motion: &mut MotionController,
    action: &CompiledAction,
    from_label: Option<&str>,
) -> Result<PlayReport> {
    let bar = progress::bar(context.style);
    let now_ms = || open.robot.now_ms();
    let mut told = context.recording.as_ref().map(|it| it.begin(now_ms(), action));
    let mut options = PlayOptions {
        cancel: open.cancel.clone(),
        from_label: from_label.map(str::to_owned),
        on_progress: Some(Box::new(|progress| {
            if let Some(told) = &mut told {
                told.step(now_ms(), action, progress);
            }
            bar.set_length(progress.total_ms);
            bar.set_position(progress.elapsed_ms);
            bar.set_message(where_it_is(action, progress));
        })),
        ..PlayOptions::default()
    };
    let report = motion.perform(action, &mut options);
    drop(options);
    bar.finish_and_clear();
    if let (Some(told), Ok(report)) = (told, &report) {
        told.end(now_ms(), &json(report));
    }
    open.done(report)
}

/// How far an action is, in words.
fn where_it_is(action: &CompiledAction, progress: &Progress) -> String {
    let label = progress.label.and_then(|index| action.labels.get(index));
    let label = label.map_or(String::new(), |label| format!("{}, ", label.name));
    if progress.waiting_for.is_empty() {
        return format!("{label}step {} of {}", progress.steps_ended, progress.steps_total);
    }
    let names: Vec<&str> = progress.waiting_for.names().collect();
    format!("{label}waiting for {}", names.join(" or "))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_moved_is_told_as_one_who_watched_would() {
        let pose = |x_m, y_m, heading_deg: f64| RobotPose {
            x_m,
            y_m,
            heading_rad: heading_deg.to_radians(),
            roll_rad: 0.0,
        };
        let stood = pose(1.0, 2.0, 90.0);
        assert_eq!(what_moved(&[], &stood, &stood), "the virtual robot waited");
        // It faces along y, so 0.3 m less y is backward.
        let text = what_moved(&[], &stood, &pose(1.0, 1.7, 75.0));
        assert!(text.ends_with("; it went 0.30 m backward; it turned 15 degrees right"), "{text}");
    }
}
