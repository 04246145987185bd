//! The cable is pulled in the middle of every action of the library: the motors are off within the dead-man time,
//! and the outcome is told as it is.

use std::sync::{Arc, PoisonError};

use rsapien::link::virtual_robot::{Pace, SharedVirtualRobot, VirtualOptions};
use rsapien::protocol::Parameter;
use rsapien::registry::{CompileOptions, CompiledAction, Registry};
use rsapien::sim::world::World;
use rsapien::{Interruption, Outcome, PlayOptions, PlayReport, Robot, RobotOptions, Stage, Terms};

/// When the cable is pulled, in shares of the action's length.
const MOMENTS: [f64; 3] = [0.1, 0.5, 0.9];

/// A byte on its way and a tick of the controller, in ms.
const SLACK_MS: u64 = 5;

fn are_motors_off(robot: &SharedVirtualRobot) -> bool {
    let pins = robot.lock().unwrap_or_else(PoisonError::into_inner).motors();
    pins.towards_first == 0 && pins.towards_last == 0
}

/// Plays an action whose cable is pulled after `pulled_at_ms`, by the motion controller alone or on a stage that
/// others share; tells the report, and how long after that motors still ran.
fn play(action: &CompiledAction, pulled_at_ms: u64, is_on_stage: bool) -> (PlayReport, u64) {
    let mut options = RobotOptions::new("cable");
    options.virtual_robot = VirtualOptions { pace: Pace::Fast, ..VirtualOptions::default() };
    options.virtual_robot.config.world = World::empty();
    let shared = options.virtual_robot.build().unwrap();
    let robot = Robot::virtual_with(Arc::clone(&shared), Pace::Fast, options).unwrap();
    let mut motion = robot.motion().unwrap();
    motion.init().unwrap();
    let lock = || shared.lock().unwrap_or_else(PoisonError::into_inner);
    let begun_ms = lock().now_ms();
    let watched = Arc::clone(&shared);
    let mut ran_ms = None;
    let mut play = PlayOptions {
        on_progress: Some(Box::new(|progress| {
            // A wait for a bumper would last longer than the test wants to.
            let mut robot = watched.lock().unwrap_or_else(PoisonError::into_inner);
            for index in 0..6 {
                robot.press_bumper(index, progress.waiting_for.contains(index));
            }
            let now_ms = robot.now_ms();
            if ran_ms.is_none() && now_ms - begun_ms >= pulled_at_ms {
                robot.pull_cable(true);
                drop(robot);
                // With no clock but the player's, the robot's time is let pass here, tick by tick.
                let mut last_on_ms = now_ms;
                for ms in 1..=2 * u64::from(Parameter::DEAD_MAN_MS_DEFAULT) {
                    watched.lock().unwrap_or_else(PoisonError::into_inner).advance_to(now_ms + ms);
                    if !are_motors_off(&watched) {
                        last_on_ms = now_ms + ms;
                    }
                }
                ran_ms = Some(last_on_ms - now_ms);
            }
        })),
        wait_for_rest: false,
        ..PlayOptions::default()
    };
    let report = if is_on_stage {
        let stage = Stage::new(motion).unwrap();
        stage.share();
        stage.play(action, &Terms::default(), &mut play, &mut |_| {}).unwrap()
    } else {
        motion.perform(action, &mut play).unwrap()
    };
    drop(play);
    assert!(are_motors_off(&shared));
    (report, ran_ms.expect("the cable was pulled"))
}

#[test]
fn a_pulled_cable_ends_every_action_of_the_library_and_is_told() {
    let registry = Registry::open_in_memory().unwrap();
    let list = registry.list().unwrap();
    assert!(list.len() >= 25);
    let dead_man_ms = u64::from(Parameter::DEAD_MAN_MS_DEFAULT);
    let mut pulled = 0;
    for summary in list {
        let action = registry.compile(&summary.name, &CompileOptions::default()).unwrap();
        for (share, is_on_stage) in MOMENTS.into_iter().flat_map(|it| [(it, false), (it, true)]) {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "seconds")]
            #[expect(clippy::cast_precision_loss, reason = "seconds")]
            let wanted_ms = (action.duration_ms as f64 * share) as u64;
            // Progress is told at the ends of steps; one with a single step is pulled at its beginning.
            let last_begin_ms =
                action.duration_ms - u64::from(action.steps.last().unwrap().duration_ms);
            let (report, ran_ms) = play(&action, wanted_ms.min(last_begin_ms), is_on_stage);
            let where_played = if is_on_stage { "on a stage" } else { "alone" };
            let name = format!("{} {where_played} at {wanted_ms} ms", summary.name);
            assert!(ran_ms <= dead_man_ms + SLACK_MS, "{name}: motors ran for {ran_ms} ms");
            match &report.outcome {
                Outcome::Interrupted { by: Interruption::LinkLost } => {}
                // Its last step was in the robot's queue, or on its way there.
                Outcome::Unknown { .. } => {
                    assert!(report.steps_accepted + 1 >= report.steps_total, "{name}: {report}");
                }
                other => panic!("{name}: {other}"),
            }
            assert!(report.reached.is_some(), "{name}: {report}");
            pulled += 1;
        }
    }
    println!("{pulled} cables pulled");
}
