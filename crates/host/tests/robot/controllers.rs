//! Controllers: who may hold them, what they tell, and what happens when they are let go.

use std::sync::Arc;

use rsapien::link::virtual_robot::Pace;
use rsapien::protocol::{Address, BumperMask, Kind, Mode, Parameter, Primitive};
use rsapien::{Error, PlayOptions, Robot, RobotOptions};

use crate::common::{Shared, arms, lock, motors_are_off, open, open_initialised, virtual_robot};

#[test]
fn a_controller_has_one_holder_whom_the_second_is_told() {
    let (robot, _shared) = open();
    let same = robot.clone();
    let motion = robot.motion().unwrap();
    let sensors = robot.sensors().unwrap();
    let camera = robot.camera().unwrap();
    for refused in [same.motion().err(), same.sensors().err(), same.camera().err()] {
        let Some(Error::Held { what, by }) = refused else { panic!("{refused:?}") };
        assert!(what.contains("controller of virtual"), "{what}");
        assert_eq!((by.pid, by.program.as_str()), (std::process::id(), "test"));
    }
    drop((motion, sensors, camera));
    same.motion().unwrap();
    same.sensors().unwrap();
    same.camera().unwrap();
}

#[test]
fn letting_go_of_the_motion_controller_stops_the_robot() {
    let (robot, shared, mut motion) = open_initialised();
    motion.step(arms(1, 60_000)[0]).unwrap();
    robot.sleep_ms(100).unwrap();
    assert!(!motors_are_off(&shared));
    drop(motion);
    assert!(motors_are_off(&shared));
    assert_eq!(lock(&shared).motion_report().mode, Mode::Stopped);
}

#[test]
fn the_dead_man_does_not_trip_while_the_program_only_waits() {
    let (robot, shared, mut motion) = open_initialised();
    motion.configure(Parameter::DeadMan { timeout_ms: 100 }).unwrap();
    motion.step(arms(1, 10_000)[0]).unwrap();
    robot.sleep_ms(9_000).unwrap();
    assert_eq!(lock(&shared).motion_report().mode, Mode::Executing);
}

#[test]
fn a_request_comes_to_its_turn_on_a_silent_line() {
    let (robot, shared, mut motion) = open_initialised();
    // Heartbeats are due every 25 ms now, and take 290 ms each in vain.
    motion.configure(Parameter::DeadMan { timeout_ms: 100 }).unwrap();
    lock(&shared).pull_cable(true);
    for _ in 0..3 {
        assert!(matches!(motion.refresh(), Err(Error::NoAnswer { .. })));
        robot.sleep_ms(10).unwrap();
    }
    assert!(robot.stop().is_err());
}

#[test]
fn a_queue_that_is_full_refuses_and_loses_nothing() {
    let (_robot, shared, mut motion) = open_initialised();
    let mut accepted = 0;
    let refused = loop {
        match motion.step(arms(1, 700)[0]) {
            Ok(_) => accepted += 1,
            Err(error) => break error,
        }
        assert!(accepted < 100);
    };
    assert!(matches!(refused, Error::Refused { kind: Kind::Step, .. }) && refused.is_refusal());
    let done = motion.wait_for(60_000, |state| !state.is_moving()).unwrap();
    assert!(done.is_some());
    assert_eq!(usize::from(lock(&shared).motion_report().steps_ended), accepted);
}

#[test]
fn primitives_of_one_joint_do_not_go_together() {
    let (_robot, _shared, mut motion) = open_initialised();
    let both = [1, 3].map(|number| Primitive::from_number(number).unwrap());
    let refused = motion.do_primitives(&both, 500, &mut PlayOptions::default()).unwrap_err();
    assert!(refused.to_string().starts_with("right-arm-up and right-arm-down"), "{refused}");
    let bad = motion.configure(Parameter::DeadMan { timeout_ms: 99 }).unwrap_err();
    assert!(bad.to_string().contains("99 ms is out of range: 0 for off, or 100"), "{bad}");
}

#[test]
fn the_camera_is_homed_aimed_and_stopped() {
    let (robot, shared) = open();
    let camera = robot.camera().unwrap();
    let refused = camera.look(10.0, 0.0, 0).unwrap_err();
    assert!(matches!(refused, Error::Refused { kind: Kind::Aim, .. }), "{refused}");
    camera.home().unwrap();
    let report = camera.look(30.5, -20.25, 60).unwrap();
    assert_eq!((report.pan_centideg, report.tilt_centideg), (3050, -2025));
    assert_eq!(lock(&shared).camera_report().pan_centideg, 3050);

    camera.aim(-90.0, 0.0, 20).unwrap();
    robot.stop().unwrap();
    let stopped = camera.wait_until_reached(5_000).unwrap_err();
    assert!(matches!(stopped, Error::Interrupted { .. }), "{stopped}");
    assert!(matches!(camera.aim(90.1, 0.0, 0), Err(Error::OutOfRange { .. })));
}

#[test]
fn sensors_tell_bumpers_and_every_state() {
    let (robot, shared) = open();
    let sensors = robot.sensors().unwrap();
    assert_eq!(sensors.bumpers().unwrap(), BumperMask::NONE);
    let states = sensors.subscribe().unwrap();
    lock(&shared).press_bumper(5, true);
    robot.sleep_ms(350).unwrap();
    assert_eq!(sensors.bumpers().unwrap().names().collect::<Vec<_>>(), ["right-hand"]);
    assert_eq!(sensors.presses().unwrap(), [0, 0, 0, 0, 0, 1]);
    assert!(!sensors.supply_low().unwrap());
    let states: Vec<_> = states.try_iter().collect();
    // Two controllers, asked every 100 ms, and the questions above.
    assert!(states.len() >= 8, "{}", states.len());
    assert!(states.is_sorted_by_key(|state| (state.version, state.time_ms)));
}

#[test]
fn a_robot_tells_of_itself() {
    let (robot, _shared) = open();
    let information = robot.information(Address::Motion).unwrap();
    assert_eq!((information.version, information.clock_mhz), (1, 40));
    assert!(information.queue_length >= 32 && information.dead_man_ms == 500);
    assert_eq!(robot.link_name(), "virtual");
}

#[test]
fn a_robot_that_is_off_is_told_from_one_that_refuses() {
    let shared = virtual_robot();
    lock(&shared).power_off();
    let options = RobotOptions::new("test");
    let error = Robot::virtual_with(Arc::clone(&shared), Pace::Fast, options).unwrap_err();
    let Error::NoAnswer { tries, address, kind, .. } = &error else { panic!("{error}") };
    assert_eq!((*tries, *address, *kind), (6, Address::Motion, Kind::State));
    assert!(!error.is_refusal());
}

#[test]
fn opening_and_watching_a_robot_takes_no_session_from_anyone() {
    let (robot, _shared) = open();
    let sensors = robot.sensors().unwrap();
    sensors.refresh().unwrap();
    assert_eq!(sensors.state().sessions, [None, None]);
    assert!(robot.packages().iter().all(|package| !package.meaning().starts_with("HELLO")));
}

#[test]
fn the_same_run_is_the_same_package_for_package() {
    let run = || {
        let lines: Shared<String> = Shared::default();
        let times: Shared<String> = Shared::default();
        let sink = Arc::clone(&lines);
        let mut options = RobotOptions::new("test");
        options.on_package =
            Some(Box::new(move |package| sink.lock().unwrap().push(package.to_string())));
        let robot = Robot::virtual_with(virtual_robot(), Pace::Fast, options).unwrap();
        let mut motion = robot.motion().unwrap();
        motion.init().unwrap();
        let camera = robot.camera().unwrap();
        camera.home().unwrap();
        camera.aim(45.0, 10.0, 30).unwrap();
        motion.play(&arms(40, 70), &mut PlayOptions::default()).unwrap();
        // Some end in the middle of a heartbeat; the clock stands still all the same.
        for index in 0..300 {
            robot.sleep_ms(index % 23).unwrap();
            let line = format!("it is {}", robot.now_ms());
            times.lock().unwrap().push(line);
        }
        robot.stop().unwrap();
        let kept: Vec<String> = robot.packages().iter().map(ToString::to_string).collect();
        assert_eq!(kept, *lines.lock().unwrap());
        let times = times.lock().unwrap().clone();
        [kept, times].concat()
    };
    let first = run();
    assert!(first.len() > 200);
    for _ in 0..5 {
        assert_eq!(run(), first);
    }
}
