//! Playing steps: progress on a terminal, and how it ended.

use std::fmt::Write as _;
use std::io::Write;
use std::sync::PoisonError;

use rsapien_protocol::{Joint, Step};
use rsapien_sim::geometry::RobotPose;

use super::context::Context;
use super::diagnostics::{Failure, Result};
use super::exit::Status;
use super::progress;
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
    let before = pose(open);
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
    if let (Some(before), Some(after)) = (before, pose(open)) {
        context.style.remark(out, what_moved(steps, &before, &after))?;
    }
    Ok(status)
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

/// Plays `steps` with progress on a terminal.
pub(crate) fn run(
    context: &Context,
    open: &OpenRobot,
    motion: &mut MotionController,
    steps: &[Step],
) -> Result<PlayReport> {
    let bar = progress::bar(context.style);
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
