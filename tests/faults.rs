//! A line that damages, loses, doubles and invents bytes, and what is told of an action on it: never
//! more than the robot did, and never more than was asked.
//!
//! A failing seed is printed; it gives the same run again.

use rsapien::link::virtual_robot::{Pace, SharedVirtualRobot, VirtualOptions};
use rsapien::protocol::{Direction, Joint, Mode, Pose, Position, Step};
use rsapien::{Error, Outcome, PlayOptions, Robot, RobotOptions};
use rsapien_sim::line::LineFaults;
use std::sync::PoisonError;

/// Steps whose poses alternate, so that one executed twice or left out shows in the count.
fn steps() -> Vec<Step> {
    (0u16..40)
        .map(|index| {
            let position = if index % 2 == 0 { Position::First } else { Position::Last };
            Step::new(Pose::EMPTY.with(Joint::RightHand, Some(position)), 60 + index)
        })
        .collect()
}

/// Per million line bytes, from a few hurt packages to about one in three.
const LEVELS: [LineFaults; 4] = [
    LineFaults {
        bit_error_ppm: 1000,
        lost_ppm: 0,
        duplicated_ppm: 0,
        noise_ppm: 0,
        framing_ppm: 0,
    },
    LineFaults {
        bit_error_ppm: 0,
        lost_ppm: 4000,
        duplicated_ppm: 4000,
        noise_ppm: 0,
        framing_ppm: 0,
    },
    LineFaults {
        bit_error_ppm: 500,
        lost_ppm: 1000,
        duplicated_ppm: 1000,
        noise_ppm: 5000,
        framing_ppm: 1000,
    },
    LineFaults {
        bit_error_ppm: 2000,
        lost_ppm: 5000,
        duplicated_ppm: 5000,
        noise_ppm: 5000,
        framing_ppm: 2000,
    },
];

struct Run {
    outcome: Outcome,
    resends: u64,
    executed: usize,
}

fn run(seed: u64, faults: LineFaults) -> Run {
    let mut options = RobotOptions::new("faults");
    options.virtual_robot = VirtualOptions { pace: Pace::Fast, ..VirtualOptions::default() };
    options.virtual_robot.config.seed = seed;
    let shared: SharedVirtualRobot = options.virtual_robot.build().unwrap();
    let robot = Robot::virtual_with(shared.clone(), Pace::Fast, options).unwrap();
    let mut motion = robot.motion().unwrap();
    motion.init().unwrap();
    let lock = || shared.lock().unwrap_or_else(PoisonError::into_inner);
    for direction in [Direction::ToRobot, Direction::ToPc] {
        lock().set_line_faults(direction, faults);
    }
    let asked = steps();
    let told = motion.play(&asked, &mut PlayOptions::default());
    let resends = motion.state().counts.resent;
    let truth = lock().motion_report();
    let executed = usize::from(truth.steps_ended);
    let outcome = match told {
        Ok(report) => {
            assert!(report.steps_ended <= executed, "told {report}, executed {executed}");
            report.outcome
        }
        Err(
            error @ (Error::NoAnswer { .. } | Error::OutcomeUnknown { .. } | Error::Refused { .. }),
        ) => Outcome::Unknown { why: error.to_string() },
        Err(error) => panic!("{error}"),
    };
    assert!(executed <= asked.len(), "executed {executed} of {}", asked.len());
    if outcome.is_done() {
        assert_eq!((executed, truth.mode), (asked.len(), Mode::Idle));
    }
    Run { outcome, resends, executed }
}

#[test]
fn what_is_told_of_an_action_is_what_the_robot_did() {
    let mut table = Vec::new();
    for (level, faults) in LEVELS.into_iter().enumerate() {
        let (mut done, mut resends, mut executed) = (0, 0, 0);
        for seed in 1..=12 {
            let this_run = std::panic::catch_unwind(|| run(seed, faults));
            let this_run = this_run.unwrap_or_else(|_| panic!("level {level}, seed {seed}"));
            done += usize::from(this_run.outcome.is_done());
            resends += this_run.resends;
            executed += this_run.executed;
        }
        println!("level {level}: {done} of 12 done, {resends} resends, {executed} steps executed");
        table.push((done, resends));
    }
    assert!(table.iter().all(|(_, resends)| *resends > 0), "no fault was met: {table:?}");
    assert!(table[0].0 == 12, "a few damaged packages must not end an action: {table:?}");
}
