//! What a scenario expects of the reference model.

use super::parse::{bumper, joint, named, number, position};
use crate::firmware::bench::{BenchError, World};
use crate::firmware::vectors;
use rsapien_firmware_model::{JointState, MotorOutput};
use rsapien_protocol::{Joint, Mode, Position, Status, StopCause};

const JOINT_STATES: [(&str, JointState); 5] = [
    ("resting", JointState::Resting),
    ("homing", JointState::Homing),
    ("travelling", JointState::Travelling),
    ("searching", JointState::Searching),
    ("searching-back", JointState::SearchingBack),
];
const MOTOR_OUTPUTS: [(&str, MotorOutput); 3] = [
    ("off", MotorOutput::Off),
    ("towards-first", MotorOutput::TowardsFirst),
    ("towards-last", MotorOutput::TowardsLast),
];

#[derive(Clone, Debug)]
pub(super) enum Expectation {
    Mode(Mode),
    Cause(StopCause),
    Status(Status),
    Answers(u32),
    AnswerBytes(Vec<u8>),
    Motor(Joint, MotorOutput),
    JointState(Joint, JointState),
    Position(Joint, u16),
    Reached(Joint, Option<Position>),
    Pressed(usize, bool),
    Presses(usize, u8),
    SupplyLow(bool),
    Driven(bool),
    /// A number by its name.
    Number(String, i64),
}

fn pick<T: Copy>(name: &str, table: &[(&'static str, T)]) -> Result<T, String> {
    let found = table.iter().find(|(other, _)| *other == name);
    found.map(|(_, value)| *value).ok_or_else(|| format!("{name} is not known here"))
}

impl Expectation {
    pub(super) fn parse(words: &[&str]) -> Result<Expectation, String> {
        Ok(match words {
            ["mode", name] => Expectation::Mode(named(name, Mode::ALL, Mode::name)?),
            ["cause", name] => Expectation::Cause(named(name, StopCause::ALL, StopCause::name)?),
            ["status", name] => {
                let found = Status::ALL.into_iter().find(|status| format!("{status:?}") == *name);
                Expectation::Status(found.ok_or_else(|| format!("no such status: {name}"))?)
            }
            ["answers", count] => Expectation::Answers(number(count)?),
            ["answer", name] => {
                let packages = vectors::packages("synchronization_packages");
                let found = packages.into_iter().find(|package| package.name == *name);
                let package = found.ok_or_else(|| format!("no synchronization package {name}"))?;
                Expectation::AnswerBytes(package.line)
            }
            ["motor", name, output] => {
                Expectation::Motor(joint(name)?, pick(output, &MOTOR_OUTPUTS)?)
            }
            ["joint", name, state] => {
                Expectation::JointState(joint(name)?, pick(state, &JOINT_STATES)?)
            }
            ["position", name, ms] => Expectation::Position(joint(name)?, number(ms)?),
            ["reached", name, "nothing"] => Expectation::Reached(joint(name)?, None),
            ["reached", name, place] => {
                let joint = joint(name)?;
                Expectation::Reached(joint, Some(position(joint, place)?))
            }
            ["bumper", name, state @ ("pressed" | "released")] => {
                Expectation::Pressed(bumper(name)?, *state == "pressed")
            }
            ["presses", name, count] => Expectation::Presses(bumper(name)?, number(count)?),
            ["supply", state @ ("low" | "good")] => Expectation::SupplyLow(*state == "low"),
            ["servos", state @ ("driven" | "limp")] => Expectation::Driven(*state == "driven"),
            [name, value] => Expectation::Number((*name).to_owned(), number(value)?),
            other => return Err(format!("what is {}?", other.join(" "))),
        })
    }

    pub(super) fn check(&self, world: &mut World) -> Result<(), BenchError> {
        let reference = &world.reference;
        let motion = reference.motion();
        let not = "the camera has none";
        let (met, found) = match self {
            Expectation::Mode(mode) => told(mode, &reference.mode()),
            Expectation::Cause(cause) => told(cause, &reference.cause()),
            Expectation::Status(status) => {
                told(&Some(*status), &world.answer.map(|answer| answer.status))
            }
            Expectation::Answers(count) => told(count, &std::mem::take(&mut world.answer_count)),
            Expectation::AnswerBytes(bytes) => told(bytes, &world.answer_bytes),
            Expectation::Motor(joint, output) => {
                let motors = motion.ok_or(BenchError(not.to_owned()))?.motors();
                told(output, &motors[usize::from(joint.index())])
            }
            Expectation::JointState(joint, state) => {
                told(&Some(*state), &motion.map(|motion| motion.joint_state(*joint)))
            }
            Expectation::Position(joint, ms) => {
                told(&Some(*ms), &motion.map(|motion| motion.joint_position_ms(*joint)))
            }
            Expectation::Reached(joint, place) => {
                told(&Some(*place), &motion.map(|motion| motion.report().position(*joint)))
            }
            Expectation::Pressed(bumper, pressed) => {
                let found = motion.map(|motion| motion.report().bumpers.contains(*bumper));
                told(&Some(*pressed), &found)
            }
            Expectation::Presses(bumper, count) => {
                told(&Some(*count), &motion.map(|motion| motion.report().presses[*bumper]))
            }
            Expectation::SupplyLow(low) => {
                told(&Some(*low), &motion.map(|motion| motion.report().supply_low))
            }
            Expectation::Driven(driven) => {
                let camera = reference.camera();
                let found = camera.map(|camera| camera.outputs().pan_centideg.is_some());
                told(&Some(*driven), &found)
            }
            Expectation::Number(name, value) => told(&Some(*value), &value_of(world, name)),
        };
        if met { Ok(()) } else { Err(BenchError(format!("{self:?} expected, not {found}"))) }
    }
}

fn told<T: PartialEq + std::fmt::Debug>(expected: &T, found: &T) -> (bool, String) {
    (expected == found, format!("{found:?}"))
}

fn value_of(world: &World, name: &str) -> Option<i64> {
    let reference = &world.reference;
    let counters = reference.counters();
    let common = match name {
        "session" => Some(i64::from(reference.session())),
        "boot" => Some(i64::from(reference.boot())),
        "last-sequence" => Some(i64::from(reference.last_sequence())),
        "accepted" => Some(i64::from(counters.accepted)),
        "resets" => Some(i64::from(counters.resets)),
        "crc-errors" => Some(i64::from(counters.crc_errors)),
        "framing-errors" => Some(i64::from(counters.framing_errors)),
        "overruns" => Some(i64::from(counters.overruns)),
        "duplicates" => Some(i64::from(counters.duplicates)),
        "dead-man-trips" => Some(i64::from(counters.dead_man_trips)),
        _ => None,
    };
    if common.is_some() {
        return common;
    }
    if let Some(motion) = reference.motion() {
        let report = motion.report();
        return match name {
            "queue-free" => Some(i64::from(report.queue_free)),
            "steps-ended" => Some(i64::from(report.steps_ended)),
            "motors" => Some(i64::from(report.motors)),
            "pose" => Some(i64::from(report.pose_reached.word())),
            "errors" => Some(i64::from(report.reception_errors)),
            _ => None,
        };
    }
    let report = reference.camera()?.report();
    match name {
        "pan" => Some(i64::from(report.pan_centideg)),
        "tilt" => Some(i64::from(report.tilt_centideg)),
        "pan-target" => Some(i64::from(report.pan_target_centideg)),
        "tilt-target" => Some(i64::from(report.tilt_target_centideg)),
        "axes" => Some(i64::from(report.axes.bits())),
        "errors" => Some(i64::from(report.reception_errors)),
        _ => None,
    }
}
