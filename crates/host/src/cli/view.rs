//! The robot's state for people and for programs.

use std::fmt::Write as _;

use rsapien_protocol::{CameraReport, HelloReport, Joint, MotionReport, Pose, StopCause};
use serde_json::{Value, json};

use crate::doctor::cause_in_words;
use crate::{LinkState, RobotState};

/// `2.4 s` of milliseconds.
pub(crate) fn seconds(duration_ms: u64) -> String {
    format!("{}.{} s", (duration_ms + 50) / 1000, (duration_ms + 50) % 1000 / 100)
}

/// Degrees of hundredths of a degree.
fn degrees(centideg: i16) -> f64 {
    f64::from(centideg) / 100.0
}

/// The name of where a joint is.
fn place(pose: Pose, joint: Joint) -> Option<&'static str> {
    let position = pose.get(joint)?;
    joint.position_names().get(usize::from(position.number() - 1)).copied()
}

fn running(report: &MotionReport) -> Vec<&'static str> {
    Joint::ALL.into_iter().filter(|joint| report.is_running(*joint)).map(Joint::name).collect()
}

/// The motion controller's report for programs.
pub(crate) fn motion(report: &MotionReport) -> Value {
    let joints: serde_json::Map<String, Value> = Joint::ALL
        .into_iter()
        .map(|joint| (joint.name().to_owned(), json!(place(report.pose_reached, joint))))
        .collect();
    let [left, right] = report.middle_switches;
    let presses: serde_json::Map<String, Value> = rsapien_protocol::BumperMask::NAMES
        .into_iter()
        .zip(report.presses)
        .map(|(name, count)| (name.to_owned(), json!(count)))
        .collect();
    json!({
        "mode": report.mode.name(),
        "cause": report.cause.name(),
        "joints": joints,
        "motors": running(report),
        "bumpers": report.bumpers.names().collect::<Vec<_>>(),
        "presses": presses,
        "middle_switches": {"left": left, "right": right},
        "supply_low": report.supply_low,
        "queue_free": report.queue_free,
        "steps_ended": report.steps_ended,
        "boot": report.boot,
        "reception_errors": report.reception_errors,
    })
}

/// The camera controller's report for programs.
pub(crate) fn camera(report: &CameraReport) -> Value {
    json!({
        "mode": report.mode.name(),
        "cause": report.cause.name(),
        "pan_deg": degrees(report.pan_centideg),
        "tilt_deg": degrees(report.tilt_centideg),
        "pan_target_deg": degrees(report.pan_target_centideg),
        "tilt_target_deg": degrees(report.tilt_target_centideg),
        "moving": report.axes.pan_moving || report.axes.tilt_moving,
        "boot": report.boot,
        "reception_errors": report.reception_errors,
    })
}

/// What a controller told of itself, for programs. `boot` and `cause` are those of its last report: it may have been
/// reset since HELLO.
pub(crate) fn information(report: &HelloReport, boot: u8, cause: StopCause) -> Value {
    let is_reset = matches!(cause, StopCause::PowerOn | StopCause::BrownOut | StopCause::Watchdog);
    json!({
        "firmware": firmware(report),
        "clock_mhz": report.clock_mhz,
        "queue_length": report.queue_length,
        "dead_man_ms": report.dead_man_ms,
        "protocol": report.version,
        "boot": boot,
        "reset_cause": is_reset.then(|| cause.name()),
        "cause_in_words": cause_in_words(cause),
    })
}

fn firmware(report: &HelloReport) -> String {
    let [major, minor, patch] = report.firmware;
    format!("{major}.{minor}.{patch}")
}

/// The whole state for programs.
pub(crate) fn state(link: &str, state: &RobotState) -> Value {
    let link_state = match &state.link {
        LinkState::Up => json!("up"),
        LinkState::Silent { .. } => json!("silent"),
        LinkState::Lost { .. } => json!("lost"),
    };
    json!({
        "link": link,
        "link_state": link_state,
        "time_ms": state.time_ms,
        "motion": state.motion_report().map(|report| motion(&report)),
        "camera": state.camera_report().map(|report| camera(&report)),
        "motion_information": motion_starts(state)
            .map(|(report, boot, cause)| information(&report, boot, cause)),
        "camera_information": camera_starts(state)
            .map(|(report, boot, cause)| information(&report, boot, cause)),
    })
}

/// What the motion controller told of itself, with boot number and cause as it reported them last.
fn motion_starts(state: &RobotState) -> Option<(HelloReport, u8, StopCause)> {
    let hello = state.motion_information?;
    let (boot, cause) = state
        .motion_report()
        .map_or((hello.boot, hello.cause), |report| (report.boot, report.cause));
    Some((hello, boot, cause))
}

/// The same of the camera controller.
fn camera_starts(state: &RobotState) -> Option<(HelloReport, u8, StopCause)> {
    let hello = state.camera_information?;
    let (boot, cause) = state
        .camera_report()
        .map_or((hello.boot, hello.cause), |report| (report.boot, report.cause));
    Some((hello, boot, cause))
}

/// `firmware 0.1.0 at 40 MHz, dead-man 500 ms, boot 1, started by power-on`.
fn information_text((report, boot, cause): (HelloReport, u8, StopCause)) -> String {
    let dead_man = match report.dead_man_ms {
        0 => "no dead-man".to_owned(),
        ms => format!("dead-man {ms} ms"),
    };
    format!(
        "firmware {} at {} MHz, {dead_man}, boot {boot}, {}",
        firmware(&report),
        report.clock_mhz,
        cause_in_words(cause)
    )
}

/// The whole state for people, without the last new line.
pub(crate) fn state_text(link: &str, state: &RobotState) -> String {
    let mut text = format!("link      {link}");
    // Writing to a string cannot fail.
    match &state.link {
        LinkState::Up => {}
        LinkState::Silent { since_ms } => {
            let silent_ms = state.time_ms.saturating_sub(*since_ms);
            let _ = write!(text, ", no answer for {}", seconds(silent_ms));
        }
        LinkState::Lost { why, .. } => {
            let _ = write!(text, ", lost: {why}");
        }
    }
    if let Some(starts) = motion_starts(state) {
        let _ = write!(text, "\nmotion    {}", information_text(starts));
    }
    if let Some(starts) = camera_starts(state) {
        let _ = write!(text, "\ncamera    {}", information_text(starts));
    }
    if let Some(report) = state.motion_report() {
        motion_text(&mut text, &report);
    }
    match state.camera_report() {
        Some(report) => {
            let _ = write!(
                text,
                "\nhead      {}, pan {:.1}, tilt {:.1} degrees",
                report.mode.name(),
                degrees(report.pan_centideg),
                degrees(report.tilt_centideg)
            );
        }
        None => text.push_str("\nhead      no camera controller answers"),
    }
    text
}

fn motion_text(text: &mut String, report: &MotionReport) {
    let list = |names: Vec<&'static str>| {
        if names.is_empty() { "none".to_owned() } else { names.join(", ") }
    };
    let _ = write!(text, "\nmode      {}", report.mode.name());
    if report.mode == rsapien_protocol::Mode::Held {
        let _ =
            write!(text, " ({}); rsapien init or rsapien stop releases it", report.cause.name());
    }
    let places: Vec<String> = Joint::ALL
        .into_iter()
        .map(|joint| {
            format!("{} {}", joint.name(), place(report.pose_reached, joint).unwrap_or("?"))
        })
        .collect();
    let _ = write!(text, "\njoints    {}", places.join(", "));
    let _ = write!(text, "\nmotors    {}", list(running(report)));
    let _ = write!(text, "\nbumpers   {}", list(report.bumpers.names().collect()));
    let _ = write!(
        text,
        "\nqueue     {} places free, {} steps ended",
        report.queue_free, report.steps_ended
    );
    let supply = if report.supply_low { "below 5 V: change the batteries" } else { "5 V" };
    let _ = write!(text, "\nsupply    {supply}");
}

#[cfg(test)]
mod tests;
