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
use super::floor::{self, Floor, PolicyOptions};
#[cfg(unix)]
use super::keys::Keys;
use super::output::json_line;
use super::progress;
use super::robot::OpenRobot;
use super::view;
use crate::{
    Interruption, MotionController, Outcome, PauseSwitch, PlayOptions, PlayReport, Progress, Robot,
};

/// Has `action` played by `play`, and tells how it ended and what moved.
pub(crate) fn tell_played(
    context: &Context,
    out: &mut impl Write,
    open: &OpenRobot,
    name: &str,
    action: &CompiledAction,
    play: impl FnOnce() -> Result<PlayReport>,
) -> Result<Status> {
    let before = pose(Some(open));
    let report = play()?;
    if open.interrupt.is_raised() {
        return Err(Failure::interrupted());
    }
    tell(context, out, Some(name), &report)?;
    tell_moved(context, out, action, None, &report, before.zip(pose(Some(open))))?;
    let (_, _, status) = outcome(&report.outcome);
    Ok(status)
}

/// Plays `action` where other programs may play, too, and tells what becomes of it and how it ended.
pub(crate) fn play_on(
    context: &Context,
    out: &mut impl Write,
    floor: &mut Floor,
    options: PolicyOptions,
    name: Option<&str>,
    action: &CompiledAction,
    from_label: Option<&str>,
) -> Result<Status> {
    let before = pose(floor.own());
    if let Floor::Guest { guest, .. } = floor {
        let (link, holder) = (guest.link_name(), guest.holder());
        context.style.remark(out, format!("{link} is held by {holder}; it plays for others"))?;
    }
    let report = run_on(context, out, floor, options, name, action, from_label)?;
    if floor.interrupt().is_raised() {
        return Err(Failure::interrupted());
    }
    tell(context, out, name, &report)?;
    tell_moved(context, out, action, from_label, &report, before.zip(pose(floor.own())))?;
    floor.wait_for_guests(context, out)?;
    let (_, _, status) = outcome(&report.outcome);
    Ok(status)
}

/// Plays `action` with progress, and keys that pause and stop it, on a terminal.
fn run_on(
    context: &Context,
    out: &mut impl Write,
    floor: &mut Floor,
    options: PolicyOptions,
    name: Option<&str>,
    action: &CompiledAction,
    from_label: Option<&str>,
) -> Result<PlayReport> {
    let bar = progress::bar(context.style);
    let pause = PauseSwitch::new();
    let keys = context.style.error.is_terminal().then(|| listen(floor, &pause)).flatten();
    let help = if keys.is_some() { " (p pauses, space stops)" } else { "" };
    // A recording is of a robot of one's own.
    let robot = floor.own().map(|open| open.robot.clone());
    let now_ms = || robot.as_ref().map_or(0, Robot::now_ms);
    let mut recorded = context.recording.as_ref().map(|it| it.begin(now_ms(), action));
    let streams = options.progress && context.style.json;
    let policy = options.into();
    let mut options = PlayOptions {
        cancel: floor.cancel().clone(),
        pause: Some(pause),
        from_label: from_label.map(str::to_owned),
        on_progress: Some(Box::new(|progress| {
            bar.set_length(progress.total_ms);
            bar.set_position(progress.elapsed_ms);
            bar.set_message(format!("{}{help}", where_it_is(action, progress)));
            if streams {
                // A reader that is gone is found out by the answer at the end.
                let line = json_of_progress(action, progress);
                let _ = json_line(&mut std::io::stdout(), &line);
            }
            if let Some(recorded) = &mut recorded {
                recorded.step(now_ms(), action, progress);
            }
        })),
        ..PlayOptions::default()
    };
    let mut told: Result<()> = Ok(());
    let mut has_waited = false;
    let report = floor.play(action, policy, &mut options, &mut |admission| {
        let name = name.unwrap_or("steps");
        let tell = || floor::tell(context, out, name, admission, has_waited);
        let now = bar.suspend(tell);
        has_waited = true;
        if now.is_err() {
            told = now;
        }
    });
    drop(options);
    drop(keys);
    bar.finish_and_clear();
    let report = report?;
    if let Some(recorded) = recorded {
        recorded.end(now_ms(), &json(&report));
    }
    told.map(|()| report)
}

/// Listens to the keys that pause and stop what is played.
#[cfg(unix)]
fn listen(floor: &Floor, pause: &PauseSwitch) -> Option<Keys> {
    let (stop, pause) = (floor.stopper(), pause.clone());
    Keys::listen(move |key| match key {
        b' ' => stop(),
        b'p' | b'P' if pause.is_paused() => pause.resume(),
        b'p' | b'P' => pause.pause(),
        b'r' | b'R' => pause.resume(),
        _ => {}
    })
}

/// Keys are listened to on Unix terminals only.
#[cfg(not(unix))]
fn listen(_floor: &Floor, _pause: &PauseSwitch) -> Option<()> {
    None
}

/// Tells how an action ended.
fn tell(
    context: &Context,
    out: &mut impl Write,
    name: Option<&str>,
    report: &PlayReport,
) -> Result<()> {
    let mut answer = json(report);
    answer["action"] = name.into();
    let name = name.map_or(String::new(), |name| format!("{name}: "));
    context.style.answer(out, &answer, format!("{name}{}", in_words(report)))
}

/// Tells what someone saw who watched the virtual robot.
fn tell_moved(
    context: &Context,
    out: &mut impl Write,
    action: &CompiledAction,
    from_label: Option<&str>,
    report: &PlayReport,
    poses: Option<(RobotPose, RobotPose)>,
) -> Result<()> {
    let Some((before, after)) = poses else { return Ok(()) };
    let from = from_label.and_then(|name| action.labels.iter().find(|it| &*it.name == name));
    let from = from.map_or(0, |label| label.step);
    let played = action.steps.iter().skip(from).take(report.steps_accepted);
    let played: Vec<Step> = played.copied().collect();
    context.style.remark(out, what_moved(&played, &before, &after))
}

/// How far an action is, for programs.
fn json_of_progress(action: &CompiledAction, progress: &Progress) -> serde_json::Value {
    let instead = progress.handler.and_then(|index| action.handlers.get(index));
    let label = progress.label.and_then(|index| instead.unwrap_or(action).labels.get(index));
    serde_json::json!({
        "progress": if progress.is_paused { "paused" } else { "playing" },
        "action": action.name,
        "instead": instead.map(|instead| &instead.name),
        "steps_ended": progress.steps_ended,
        "steps_total": progress.steps_total,
        "elapsed_ms": progress.elapsed_ms,
        "total_ms": progress.total_ms,
        "label": label.map(|label| &*label.name),
        "waiting_for": progress.waiting_for.names().collect::<Vec<_>>(),
    })
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
pub(crate) fn in_words(report: &PlayReport) -> String {
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
fn pose(open: Option<&OpenRobot>) -> Option<RobotPose> {
    let robot = open?.robot.virtual_robot()?;
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
    if let Some(handler) = progress.handler.and_then(|index| action.handlers.get(index)) {
        let own = Progress { handler: None, ..*progress };
        return format!("instead {}: {}", handler.name, where_it_is(handler, &own));
    }
    let label = progress.label.and_then(|index| action.labels.get(index));
    let label = label.map_or(String::new(), |label| format!("{}, ", label.name));
    if progress.waiting_for.is_empty() {
        let paused = if progress.is_paused { ", paused" } else { "" };
        let (ended, total) = (progress.steps_ended, progress.steps_total);
        return format!("{label}step {ended} of {total}{paused}");
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
