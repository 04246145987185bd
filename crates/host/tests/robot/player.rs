//! How actions end, and that the outcome told is what the robot did.

use std::sync::{Arc, mpsc};

use rsapien::link::virtual_robot::Pace;
use rsapien::protocol::{BumperMask, Direction, Mode, Parameter, Request, Status, Step, StopCause};
use rsapien::{
    CancelToken, Error, Interruption, Outcome, PlayOptions, Progress, Robot, RobotOptions,
};
use rsapien_sim::line::LineFaults;

use crate::common::{
    BreakableConnector, Shared, arms, at_step, interrupted, lock, motors_are_off, open,
    open_initialised, send_from_outside, virtual_robot,
};

#[test]
fn an_action_is_done_when_the_robot_has_ended_every_step() {
    let (_robot, shared, mut motion) = open_initialised();
    let seen: Shared<Progress> = Shared::default();
    let mut options = PlayOptions {
        on_progress: Some(Box::new(|progress| seen.lock().unwrap().push(*progress))),
        ..PlayOptions::default()
    };
    let report = motion.play(&arms(6, 400), &mut options).unwrap();
    assert_eq!(report.outcome, Outcome::Done);
    assert_eq!((report.steps_ended, report.steps_accepted, report.steps_total), (6, 6, 6));
    let evidence = report.evidence.unwrap();
    assert_eq!((evidence.mode, evidence.motors, evidence.steps_ended), (Mode::Idle, 0, 6));
    // 6 steps of 400 ms, then the arms' way of a second at most.
    assert!((2400..3600).contains(&report.elapsed_ms), "{report}");
    assert_eq!(lock(&shared).motion_report().steps_ended, 6);

    let seen = seen.lock().unwrap();
    let steps: Vec<usize> = seen.iter().map(|progress| progress.steps_ended).collect();
    assert!(steps.is_sorted() && steps.first() == Some(&0) && steps.last() == Some(&6));
    assert!(seen.iter().all(|progress| progress.steps_total == 6 && progress.total_ms == 2400));
}

#[test]
fn actions_longer_than_the_queue_lose_no_step_and_never_pause() {
    let (_robot, _shared, mut motion) = open_initialised();
    let report = motion.play(&arms(150, 20), &mut PlayOptions::default()).unwrap();
    assert_eq!((&report.outcome, report.steps_ended, report.pauses), (&Outcome::Done, 150, 0));
    assert!(report.elapsed_ms < 150 * 20 + 1500, "{report}");
}

#[test]
fn steps_shorter_than_a_package_make_pauses_but_all_are_done() {
    let (_robot, _shared, mut motion) = open_initialised();
    let report = motion.play(&arms(20, 1), &mut PlayOptions::default()).unwrap();
    assert_eq!((&report.outcome, report.steps_ended), (&Outcome::Done, 20));
    assert!(report.pauses > 10, "{report:?}");
}

#[test]
fn lost_and_damaged_packages_cost_no_step_and_double_none() {
    let (robot, shared, mut motion) = open_initialised();
    let faults = LineFaults { lost_ppm: 6_000, bit_error_ppm: 500, ..LineFaults::NONE };
    for direction in [Direction::ToRobot, Direction::ToPc] {
        lock(&shared).set_line_faults(direction, faults);
    }
    let report = motion.play(&arms(60, 100), &mut PlayOptions::default()).unwrap();
    assert_eq!((&report.outcome, report.steps_ended), (&Outcome::Done, 60));
    assert_eq!(lock(&shared).motion_report().steps_ended, 60);
    let counts = robot.sensors().unwrap().state().counts;
    assert!(counts.resent > 5, "the line was too good to show anything: {counts:?}");
}

#[test]
fn stop_from_another_thread_ends_the_action_with_the_motors_off() {
    let (robot, shared, mut motion) = open_initialised();
    let stop = robot.stop_handle();
    let (ask, asked) = mpsc::channel();
    let (tell, told) = mpsc::channel();
    let stopper = std::thread::spawn(move || {
        asked.recv().unwrap();
        tell.send(stop.stop()).unwrap();
    });
    let mut options = at_step(2, move || {
        ask.send(()).unwrap();
        told.recv().unwrap().unwrap();
    });
    let report = motion.play(&arms(40, 200), &mut options).unwrap();
    drop(options);
    stopper.join().unwrap();
    assert_eq!(report.outcome, interrupted(Interruption::Stop));
    assert_eq!(report.steps_ended, 2);
    assert!(motors_are_off(&shared));
    // Nothing of the action comes after it.
    robot.sleep_ms(1000).unwrap();
    assert!(motors_are_off(&shared) && lock(&shared).motion_report().mode == Mode::Stopped);
}

#[test]
fn stop_from_another_program_ends_the_action() {
    let (_robot, shared, mut motion) = open_initialised();
    let mut options = at_step(2, || send_from_outside(&shared, Request::Stop));
    let report = motion.play(&arms(8, 200), &mut options).unwrap();
    assert_eq!(report.outcome, interrupted(Interruption::Stop));
    assert!(motors_are_off(&shared));
}

#[test]
fn stop_from_another_program_between_two_steps_is_not_taken_for_done() {
    // The next step sets the robot going again, so that only the count tells.
    let (_robot, shared, mut motion) = open_initialised();
    let mut options = at_step(2, || send_from_outside(&shared, Request::Stop));
    let report = motion.play(&arms(60, 60), &mut options).unwrap();
    assert!(!report.outcome.is_done() && report.steps_ended < 60, "{report}");
    assert!(motors_are_off(&shared));
}

#[test]
fn another_programs_session_ends_the_action_and_is_left_alone() {
    let (_robot, shared, mut motion) = open_initialised();
    let hello = Request::Hello {
        lowest_version: 1,
        highest_version: 1,
        session: crate::common::SESSION_OF_ANOTHER,
    };
    let mut options = at_step(2, || send_from_outside(&shared, hello));
    let report = motion.play(&arms(60, 200), &mut options).unwrap();
    assert_eq!(report.outcome, Outcome::Refused { status: Status::NoSession });
    assert_eq!(lock(&shared).motion_report().mode, Mode::Executing);
}

#[test]
fn cancelling_stops_the_motors_first() {
    let (_robot, shared, mut motion) = open_initialised();
    let cancel = CancelToken::new();
    let mut options = at_step(1, || cancel.cancel());
    options.cancel = cancel.clone();
    let report = motion.play(&arms(40, 200), &mut options).unwrap();
    assert_eq!(report.outcome, interrupted(Interruption::Cancelled));
    assert!(motors_are_off(&shared) && report.steps_ended < 3, "{report}");

    // Cancelled before it begins: nothing is sent.
    let report = motion.play(&arms(1, 200), &mut options).unwrap();
    assert_eq!(report.outcome, interrupted(Interruption::Cancelled));
    assert_eq!(report.steps_accepted, 0);
    let Err(Error::Interrupted { by, .. }) = motion.init_unless(&cancel) else { panic!() };
    assert_eq!(by, Interruption::Cancelled);
    assert!(motors_are_off(&shared));
}

#[test]
fn a_bumper_ends_the_action_and_holds_the_robot_until_init() {
    let (_robot, shared, mut motion) = open_initialised();
    let toe = BumperMask::from_bits(1).unwrap();
    let steps: Vec<Step> =
        arms(10, 300).into_iter().map(|step| Step { ending_bumpers: toe, ..step }).collect();
    let mut options = at_step(1, || {
        // The hand ends nothing here.
        lock(&shared).press_bumper(5, true);
        lock(&shared).press_bumper(0, true);
    });
    let report = motion.play(&steps, &mut options).unwrap();
    assert_eq!(report.outcome, interrupted(Interruption::Bumper(toe)));
    assert_eq!(report.outcome.to_string(), "interrupted by bumper left-foot-front");
    assert!(motors_are_off(&shared));

    lock(&shared).press_bumper(0, false);
    let report = motion.play(&arms(1, 300), &mut PlayOptions::default()).unwrap();
    assert_eq!(report.outcome, Outcome::Refused { status: Status::Held });
    motion.init().unwrap();
    assert!(motion.play(&arms(1, 300), &mut PlayOptions::default()).unwrap().outcome.is_done());
}

#[test]
fn a_pulled_cable_ends_motion_and_nothing_resumes_when_it_is_back() {
    let (robot, shared, mut motion) = open_initialised();
    let mut options = at_step(2, || lock(&shared).pull_cable(true));
    let report = motion.play(&arms(60, 300), &mut options).unwrap();
    drop(options);
    assert_eq!(report.outcome, interrupted(Interruption::LinkLost));
    robot.sleep_ms(500).unwrap();
    assert!(motors_are_off(&shared));
    assert!(matches!(motion.refresh(), Err(Error::NoAnswer { .. })));

    lock(&shared).pull_cable(false);
    let up = |state: &rsapien::RobotState| state.link == rsapien::LinkState::Up;
    let state = motion.wait_for(2000, up).unwrap().expect("the robot answers again");
    let told = state.motion_report().unwrap();
    assert_eq!((told.mode, told.cause), (Mode::Held, StopCause::DeadMan));
    robot.sleep_ms(1000).unwrap();
    assert!(motors_are_off(&shared));
    let report = motion.play(&arms(1, 300), &mut PlayOptions::default()).unwrap();
    assert_eq!(report.outcome, Outcome::Refused { status: Status::Held });
    motion.init().unwrap();
    assert!(motion.play(&arms(2, 300), &mut PlayOptions::default()).unwrap().outcome.is_done());
}

#[test]
fn a_cable_pulled_when_all_steps_are_queued_leaves_the_outcome_unknown() {
    let (_robot, shared, mut motion) = open_initialised();
    let mut options = at_step(1, || lock(&shared).pull_cable(true));
    let report = motion.play(&arms(2, 400), &mut options).unwrap();
    assert!(matches!(report.outcome, Outcome::Unknown { .. }), "{report}");
}

#[test]
fn a_queue_that_outlasts_the_dead_man_cannot_have_been_done_in_silence() {
    for (dead_man_ms, expected) in [(500, true), (0, false)] {
        let (_robot, shared, mut motion) = open_initialised();
        motion.configure(Parameter::DeadMan { timeout_ms: dead_man_ms }).unwrap();
        let mut options = at_step(1, || lock(&shared).pull_cable(true));
        let report = motion.play(&arms(8, 400), &mut options).unwrap();
        assert_eq!(report.steps_accepted, 8);
        let is_told = report.outcome == interrupted(Interruption::LinkLost);
        assert_eq!(is_told, expected, "{report}");
        assert!(is_told || matches!(report.outcome, Outcome::Unknown { .. }), "{report}");
    }
}

#[test]
fn a_short_silence_costs_the_action_nothing() {
    // Longer than all tries of one package, shorter than the dead-man.
    const LOST_PACKAGES: u32 = 8;
    let shared = virtual_robot();
    let plug_in = Arc::clone(&shared);
    let mut lost = 0;
    let mut options = RobotOptions::new("test");
    options.on_package = Some(Box::new(move |_| {
        let mut robot = lock(&plug_in);
        lost += u32::from(robot.is_cable_pulled());
        if lost == LOST_PACKAGES {
            robot.pull_cable(false);
        }
    }));
    let robot = Robot::virtual_with(Arc::clone(&shared), Pace::Fast, options).unwrap();
    let mut motion = robot.motion().unwrap();
    motion.init().unwrap();
    let mut options = at_step(3, || lock(&shared).pull_cable(true));
    let report = motion.play(&arms(12, 300), &mut options).unwrap();
    assert_eq!((&report.outcome, report.steps_ended), (&Outcome::Done, 12));
    assert_eq!(motion.state().counts.unanswered, 1);
}

#[test]
fn a_broken_link_is_opened_again_and_the_robot_stays_still() {
    for broken_ms in [50, 3000] {
        let (robot, shared, broken) = BreakableConnector::open();
        let mut motion = robot.motion().unwrap();
        motion.init().unwrap();
        let break_it = || broken.store(true, std::sync::atomic::Ordering::SeqCst);
        let mut options = at_step(2, break_it);
        let report = motion.play(&arms(60, 300), &mut options).unwrap();
        drop(options);
        assert_eq!(report.outcome, interrupted(Interruption::LinkLost));
        assert!(matches!(motion.refresh(), Err(Error::LinkLost { .. })));
        robot.sleep_ms(broken_ms).unwrap();

        broken.store(false, std::sync::atomic::Ordering::SeqCst);
        let up = |state: &rsapien::RobotState| state.link == rsapien::LinkState::Up;
        let state = motion.wait_for(2000, up).unwrap().expect("the link comes back");
        assert_eq!(state.counts.reconnects, 1);
        robot.sleep_ms(100).unwrap();
        assert!(motors_are_off(&shared), "broken for {broken_ms} ms");
        motion.init().unwrap();
        let report = motion.play(&arms(2, 300), &mut PlayOptions::default()).unwrap();
        assert!(report.outcome.is_done(), "{report}");
    }
}

#[test]
fn a_robot_still_executing_when_the_link_is_back_is_stopped() {
    let (robot, shared, broken) = BreakableConnector::open();
    let mut motion = robot.motion().unwrap();
    motion.init().unwrap();
    // Nothing but the line itself can stop it then.
    motion.configure(Parameter::DeadMan { timeout_ms: 0 }).unwrap();
    for step in arms(20, 1000) {
        motion.step(step).unwrap();
    }
    broken.store(true, std::sync::atomic::Ordering::SeqCst);
    assert!(motion.refresh().is_err());
    robot.sleep_ms(200).unwrap();
    assert_eq!(lock(&shared).motion_report().mode, Mode::Executing);
    broken.store(false, std::sync::atomic::Ordering::SeqCst);
    robot.sleep_ms(1000).unwrap();
    assert_eq!(lock(&shared).motion_report().mode, Mode::Stopped);
}

#[test]
fn a_reset_ends_the_action_with_its_cause() {
    let (_robot, shared, mut motion) = open_initialised();
    let mut options = at_step(2, || lock(&shared).brown_out());
    let report = motion.play(&arms(60, 300), &mut options).unwrap();
    assert_eq!(report.outcome, interrupted(Interruption::Reset(StopCause::BrownOut)));
    let report = motion.play(&arms(1, 300), &mut PlayOptions::default()).unwrap();
    assert_eq!(report.outcome, Outcome::Refused { status: Status::NotInitialised });
    motion.init().unwrap();
    assert!(motion.play(&arms(1, 300), &mut PlayOptions::default()).unwrap().outcome.is_done());
}

#[test]
fn a_step_before_init_is_refused() {
    let (robot, shared) = open();
    let mut motion = robot.motion().unwrap();
    let report = motion.play(&arms(3, 300), &mut PlayOptions::default()).unwrap();
    assert_eq!(report.outcome, Outcome::Refused { status: Status::NotInitialised });
    assert_eq!((report.steps_accepted, report.steps_ended), (0, 0));
    assert!(motors_are_off(&shared));
}

#[test]
fn what_cannot_be_played_is_refused_before_anything_is_sent() {
    let (robot, _shared, mut motion) = open_initialised();
    let sent = robot.packages().len();
    let mut replacing = arms(2, 300);
    replacing[1].replace = true;
    for steps in [Vec::new(), arms(2, 0), replacing] {
        let refused = motion.play(&steps, &mut PlayOptions::default());
        assert!(matches!(refused, Err(Error::OutOfRange { .. })), "{refused:?}");
    }
    assert_eq!(robot.packages().len(), sent);
}

#[test]
fn a_first_step_that_replaces_the_queue_pre_empts_what_runs() {
    let (_robot, shared, mut motion) = open_initialised();
    for step in arms(5, 5000) {
        motion.step(step).unwrap();
    }
    let mut steps = arms(1, 300);
    steps[0].replace = true;
    let report = motion.play(&steps, &mut PlayOptions::default()).unwrap();
    assert!(report.outcome.is_done() && report.elapsed_ms < 3000, "{report}");
    assert_eq!(lock(&shared).motion_report().queue_free, 32);
}

#[test]
fn stop_is_sent_again_until_it_arrives_with_a_camera_to_stop_as_well() {
    let (robot, shared, mut motion) = open_initialised();
    assert!(robot.camera().is_ok(), "the line knows of the camera controller");
    let faults = LineFaults { lost_ppm: 6_000, ..LineFaults::NONE };
    for round in 0..20 {
        motion.step(arms(1, 5000).remove(0)).unwrap();
        for direction in [Direction::ToRobot, Direction::ToPc] {
            lock(&shared).set_line_faults(direction, faults);
        }
        let stopped = robot.stop();
        assert!(stopped.is_ok(), "round {round}: {stopped:?}");
        assert!(motors_are_off(&shared));
        for direction in [Direction::ToRobot, Direction::ToPc] {
            lock(&shared).set_line_faults(direction, LineFaults::NONE);
        }
    }
    let counts = robot.sensors().unwrap().state().counts;
    assert!(counts.resent > 5, "the line was too good to show anything: {counts:?}");
}
