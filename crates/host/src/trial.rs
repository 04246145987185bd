//! An action tried on the virtual body before it is stored.

use std::fmt;
use std::sync::{Arc, PoisonError};

use rsapien_protocol::Joint;
use rsapien_registry::CompiledAction;
use rsapien_sim::robot::RobotReading;
use rsapien_sim::world::World;
use serde::{Deserialize, Serialize};

use crate::link::virtual_robot::{Pace, SharedVirtualRobot, VirtualOptions};
use crate::{CancelToken, Error, Outcome, PlayOptions, Robot, RobotOptions};

/// The most of an action that is tried, in ms of the robot's time.
pub const TRIED_MS_MAX: u64 = 600_000;

/// Less than this is a foot that slips, in metres.
const MOVED_M_MIN: f64 = 0.005;
/// Less than this is a foot that slips, in degrees.
const TURNED_DEG_MIN: f64 = 1.0;

/// How an action went on the virtual body, in an empty world, after the initialisation. A bumper that it
/// waits for is pressed at once.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// How it ended, in words.
    pub outcome: String,
    /// Whether every step ended.
    pub is_done: bool,
    /// How long it took, in ms of the robot's time.
    pub elapsed_ms: u64,
    /// How much of it was tried, in ms: all of it, or the beginning of a long one.
    pub tried_ms: u64,
    /// How far it went forward, in metres; backward negative.
    pub forward_m: f64,
    /// How far it went to its left, in metres; to the right negative.
    pub left_m: f64,
    /// How far it turned to the left, in degrees; to the right negative.
    pub turned_deg: f64,
    /// Where each joint ended, 0 at its first position and 1 at its last, in the order of the joints.
    pub joints_end_at: [f64; Joint::COUNT],
    /// The joints whose motors still ran when the last step had ended.
    pub still_travelling: Vec<String>,
    /// How far the voltage of the motors' batteries fell, in mV.
    pub motor_supply_drop_mv: u32,
}

/// Plays `action` on a fresh virtual robot, as fast as the computer goes.
///
/// # Errors
/// Those of the line; [`Error::Interrupted`] when `cancel` ends the initialisation.
pub fn try_on_virtual_body(action: &CompiledAction, cancel: &CancelToken) -> Result<Trial, Error> {
    let (shortened, tried_ms) = beginning(action);
    let action = shortened.as_ref().unwrap_or(action);
    let mut options = RobotOptions::new("trial");
    options.virtual_robot = VirtualOptions { pace: Pace::Fast, ..VirtualOptions::default() };
    options.virtual_robot.config.world = World::empty();
    let shared = options.virtual_robot.build()?;
    let robot = Robot::virtual_with(Arc::clone(&shared), Pace::Fast, options)?;
    let mut motion = robot.motion()?;
    motion.init_unless(cancel)?;
    let before = reading(&shared);
    let hand = Arc::clone(&shared);
    let mut options = PlayOptions {
        cancel: cancel.clone(),
        on_progress: Some(Box::new(move |progress| {
            let mut robot = hand.lock().unwrap_or_else(PoisonError::into_inner);
            for index in 0..rsapien_protocol::BumperMask::COUNT {
                robot.press_bumper(index, progress.waiting_for.contains(index));
            }
        })),
        wait_for_rest: false,
        ..PlayOptions::default()
    };
    let report = motion.perform(action, &mut options)?;
    let motors = report.evidence.map_or(0, |evidence| evidence.motors);
    let after = reading(&shared);
    let (east_m, north_m) = (after.pose.x_m - before.pose.x_m, after.pose.y_m - before.pose.y_m);
    let (sin, cos) = before.pose.heading_rad.sin_cos();
    let turned_deg = (after.pose.heading_rad - before.pose.heading_rad).to_degrees();
    Ok(Trial {
        outcome: report.outcome.to_string(),
        is_done: report.outcome == Outcome::Done,
        elapsed_ms: report.elapsed_ms,
        tried_ms,
        forward_m: rounded(east_m * cos + north_m * sin),
        left_m: rounded(north_m * cos - east_m * sin),
        turned_deg: rounded((turned_deg + 180.0).rem_euclid(360.0) - 180.0),
        joints_end_at: std::array::from_fn(|index| {
            rounded(after.joints.get(index).map_or(0.0, |joint| joint.position))
        }),
        still_travelling: Joint::ALL
            .into_iter()
            .filter(|joint| motors & (1 << joint.index()) != 0)
            .map(|joint| joint.name().to_owned())
            .collect(),
        motor_supply_drop_mv: before.motor_supply_mv.saturating_sub(after.motor_supply_mv),
    })
}

/// The beginning of an action that is too long to be tried whole, and how much of it is tried.
fn beginning(action: &CompiledAction) -> (Option<CompiledAction>, u64) {
    if action.duration_ms <= TRIED_MS_MAX {
        return (None, action.duration_ms);
    }
    let mut tried_ms = 0;
    let mut count = 0;
    for step in &action.steps {
        let with_it = tried_ms + u64::from(step.duration_ms);
        if with_it > TRIED_MS_MAX {
            break;
        }
        (tried_ms, count) = (with_it, count + 1);
    }
    let mut shortened = action.clone();
    shortened.steps.truncate(count);
    shortened.sources.truncate(count);
    shortened.reactions.truncate(count);
    shortened.waits.retain(|wait| wait.before_step < count);
    shortened.labels.retain(|label| label.step < count);
    (Some(shortened), tried_ms)
}

fn reading(robot: &SharedVirtualRobot) -> RobotReading {
    robot.lock().unwrap_or_else(PoisonError::into_inner).reading()
}

/// To a tenth of a millimetre and so on: more is not worth keeping.
fn rounded(value: f64) -> f64 {
    (value * 10_000.0).round() / 10_000.0
}

/// `done in 6.3 s; it went 0.24 m forward`.
impl fmt::Display for Trial {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let tenths = (self.elapsed_ms + 50) / 100;
        write!(formatter, "{} in {}.{} s", self.outcome, tenths / 10, tenths % 10)?;
        let (forward_m, left_m, turned_deg) = (self.forward_m, self.left_m, self.turned_deg);
        if forward_m.abs() >= MOVED_M_MIN {
            let way = if forward_m < 0.0 { "backward" } else { "forward" };
            write!(formatter, "; it went {:.2} m {way}", forward_m.abs())?;
        }
        if left_m.abs() >= MOVED_M_MIN {
            let way = if left_m < 0.0 { "right" } else { "left" };
            write!(formatter, "; it went {:.2} m to the {way}", left_m.abs())?;
        }
        if turned_deg.abs() >= TURNED_DEG_MIN {
            let way = if turned_deg < 0.0 { "right" } else { "left" };
            write!(formatter, "; it turned {:.0} degrees {way}", turned_deg.abs())?;
        }
        if !self.still_travelling.is_empty() {
            write!(
                formatter,
                "; still travelling at its end: {}",
                self.still_travelling.join(", ")
            )?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rsapien_registry::NoActions;
    use rsapien_registry::check::check_text;

    fn trial(body: &str) -> Trial {
        let checked = check_text(&format!("action a {{ {body} }}"), &NoActions);
        let compiled = checked.actions[0].compiled.clone().expect("compiled");
        try_on_virtual_body(&compiled, &CancelToken::new()).expect("tried")
    }

    #[test]
    fn what_the_body_did_is_told() {
        let walk = trial(
            "do tilt-right do right-leg-back + left-leg-front do tilt-left do left-leg-back do tilt-mid",
        );
        assert!(walk.is_done && walk.forward_m > 0.02, "{walk}");
        assert!(walk.to_string().starts_with("done in 3.") && walk.to_string().contains("forward"));
        let arm = trial("do right-arm-up for 100ms");
        assert_eq!(arm.still_travelling, ["right-arm"]);
        let touched = trial("wait for left-hand at most 1min else end do tilt-left");
        assert!(touched.is_done && touched.elapsed_ms < 2000, "{touched}");
    }

    #[test]
    fn of_a_long_action_the_beginning_is_tried() {
        let long = trial("allow needs-the-pc \"a test\" repeat 1000 { wait 1s }");
        assert!(long.is_done, "{long}");
        assert_eq!(long.tried_ms, TRIED_MS_MAX);
    }

    #[test]
    fn what_is_kept_can_be_read_again() {
        let trial = trial("do tilt-left");
        let text = serde_json::to_string(&trial).unwrap();
        assert_eq!(serde_json::from_str::<Trial>(&text).unwrap(), trial);
    }
}
