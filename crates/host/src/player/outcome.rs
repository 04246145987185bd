//! How an action ended, and what the robot said that shows it.

use std::fmt;

use rsapien_protocol::{BumperMask, Mode, MotionReport, Status, Step, StopCause};
use rsapien_registry::StepSource;

use crate::Interruption;

/// How far an action is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Steps that the robot has ended.
    pub steps_ended: usize,
    /// Steps of the action.
    pub steps_total: usize,
    /// Since the action began, in ms of the line's clock.
    pub elapsed_ms: u64,
    /// What the steps' durations sum up to, in ms.
    pub total_ms: u64,
    /// The index of the label that was passed last, among those of the action, if one was.
    pub label: Option<usize>,
    /// The bumpers that are waited for; none while steps are played.
    pub waiting_for: BumperMask,
    /// Whether it stands still because it was paused.
    pub is_paused: bool,
    /// The index, among the action's handlers, of what is played instead of the rest; then everything
    /// here is told of that. None while the action itself is played.
    pub handler: Option<usize>,
}

/// How an action ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Every step ended, by the robot's own count, and the robot is idle.
    Done,
    /// The robot refused a step; what was queued of the action is stopped.
    Refused {
        /// Why.
        status: Status,
    },
    /// Something ended it before its time.
    Interrupted {
        /// What.
        by: Interruption,
    },
    /// How it ended cannot be known.
    Unknown {
        /// What made it unknown.
        why: String,
    },
}

impl Outcome {
    /// Whether the action was done.
    pub const fn is_done(&self) -> bool {
        matches!(self, Outcome::Done)
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Outcome::Done => formatter.write_str("done"),
            Outcome::Refused { status } => write!(formatter, "refused: {status}"),
            Outcome::Interrupted { by } => write!(formatter, "interrupted by {by}"),
            Outcome::Unknown { why } => write!(formatter, "outcome unknown: {why}"),
        }
    }
}

/// The step that was under way when an action ended early.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StepReached {
    /// Its number among the steps of the action, from 1.
    pub number: usize,
    /// Where it is written: the action, and the number of the step in it.
    pub source: StepSource,
}

/// How an action ended, with the robot's evidence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlayReport {
    /// How it ended.
    pub outcome: Outcome,
    /// The step that was under way when a compiled action ended early.
    pub reached: Option<StepReached>,
    /// What was played instead of the rest, because a bumper was met or waited for in vain, and how that
    /// ended. The outcome above stays that of the action itself.
    pub instead: Option<Box<PlayReport>>,
    /// The action's name; empty for plain steps.
    pub action: String,
    /// Steps that the robot has ended, by its own count.
    pub steps_ended: usize,
    /// Steps that the robot has accepted.
    pub steps_accepted: usize,
    /// Steps of the action.
    pub steps_total: usize,
    /// From the first step to the end, in ms of the line's clock.
    pub elapsed_ms: u64,
    /// How often the robot's queue ran dry before the action's end, because this program or the
    /// line was too slow. The robot stood still then, but did everything in order.
    pub pauses: usize,
    /// The robot's last report before the first step.
    pub before: Option<MotionReport>,
    /// The robot's last report.
    pub evidence: Option<MotionReport>,
}

impl PlayReport {
    /// What ended before anything was sent for it.
    pub(crate) fn unplayed(action: &str, steps_total: usize, by: Interruption) -> PlayReport {
        PlayReport {
            outcome: Outcome::Interrupted { by },
            reached: None,
            instead: None,
            action: action.to_owned(),
            steps_ended: 0,
            steps_accepted: 0,
            steps_total,
            elapsed_ms: 0,
            pauses: 0,
            before: None,
            evidence: None,
        }
    }
}

/// `done: 12 of 12 steps in 6012 ms`.
impl fmt::Display for PlayReport {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let PlayReport { outcome, steps_ended, steps_total, elapsed_ms, .. } = self;
        write!(formatter, "{outcome}: {steps_ended} of {steps_total} steps in {elapsed_ms} ms")?;
        if let Some(instead) = &self.instead {
            write!(formatter, "; instead {}: {instead}", instead.action)?;
        }
        Ok(())
    }
}

/// What `report` tells of an interruption since `before` was reported; none when all is well.
/// `ending_bumpers` are those that may end what is under way.
pub(crate) fn interruption(
    before: &MotionReport,
    report: &MotionReport,
    ending_bumpers: BumperMask,
) -> Option<Interruption> {
    if report.boot != before.boot {
        return Some(Interruption::Reset(report.cause));
    }
    match (report.mode, report.cause) {
        (Mode::Fresh, cause) => Some(Interruption::Reset(cause)),
        (Mode::Stopped, _) => Some(Interruption::Stop),
        (Mode::Held, StopCause::Bumper) => {
            Some(Interruption::Bumper(pressed_since(before, report, ending_bumpers)))
        }
        (Mode::Held, _) => Some(Interruption::DeadMan),
        (Mode::Initialising | Mode::Idle | Mode::Executing, _) => None,
    }
}

/// The bumpers among `ending` that are pressed, or were since `before`: one that ended an action
/// is often released again when it is asked for.
fn pressed_since(before: &MotionReport, report: &MotionReport, ending: BumperMask) -> BumperMask {
    let mut bits = report.bumpers.bits();
    let counts = before.presses.iter().zip(&report.presses);
    for (index, (earlier, now)) in counts.enumerate() {
        bits |= u8::from(earlier != now) << index;
    }
    let pressed = BumperMask::from_low_bits(bits);
    match pressed.intersection(ending) {
        BumperMask::NONE => pressed,
        both => both,
    }
}

/// The bumpers that end one of `steps`.
pub(crate) fn ending_bumpers(steps: &[Step]) -> BumperMask {
    let bits = steps.iter().fold(0, |bits, step| bits | step.ending_bumpers.bits());
    BumperMask::from_low_bits(bits)
}
