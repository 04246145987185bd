//! The host library against a simulator that it knows only by its line: a pseudo-terminal and TCP.

use rsapien::protocol::{Address, Mode, Step};
use rsapien::{Interruption, LinkAddress, Outcome, PlayOptions, Robot, RobotOptions};
use rsapien_registry::{CompileOptions, Registry};
use rsapien_sim::SharedRobot;
use rsapien_sim::server::{Simulator, SimulatorConfig};
use std::time::{Duration, Instant};

fn action(name: &str, times: u16) -> Vec<Step> {
    let registry = Registry::open_in_memory().unwrap();
    registry.compile(name, &CompileOptions { times, ..CompileOptions::default() }).unwrap().steps
}

/// A simulator on a terminal and on TCP, and the folder of its link.
fn simulator() -> (Simulator, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let config = SimulatorConfig {
        pty: Some(folder.path().join("robot")),
        tcp: Some("127.0.0.1:0".to_owned()),
        ..SimulatorConfig::default()
    };
    (Simulator::start(config).unwrap(), folder)
}

/// Whether a pin of a motor is driven, by the simulator's own word.
fn motors_run(robot: &SharedRobot) -> bool {
    robot.lock().motors().running() != 0
}

fn open(address: &LinkAddress) -> Robot {
    Robot::open(address, RobotOptions::new("end-to-end")).unwrap()
}

fn terminal(simulator: &Simulator) -> LinkAddress {
    simulator.link().unwrap().to_str().unwrap().parse().unwrap()
}

#[test]
fn the_robot_on_a_terminal_walks_looks_and_is_watched() {
    let (simulator, _folder) = simulator();
    let robot = open(&terminal(&simulator));
    let sensors = robot.sensors().unwrap();
    assert_eq!(sensors.state().motion_report().unwrap().mode, Mode::Fresh);
    let mut motion = robot.motion().unwrap();
    motion.init().unwrap();
    let steps = action("walk-forward", 1);
    let report = motion.play(&steps, &mut PlayOptions::default()).unwrap();
    assert_eq!(report.outcome, Outcome::Done, "{report}");
    let truth = simulator.robot().reading();
    assert!(truth.pose.x_m > 0.05, "{:?}", truth.pose);
    assert!(truth.pose.y_m.abs() < 0.05, "{:?}", truth.pose);
    let evidence = report.evidence.unwrap();
    assert_eq!(usize::from(evidence.steps_ended), steps.len());

    let camera = robot.camera().unwrap();
    camera.home().unwrap();
    let seen = camera.look(-30.0, 12.5, 0).unwrap();
    assert_eq!((seen.pan_centideg, seen.tilt_centideg), (-3000, 1250));
    assert_eq!(sensors.refresh().unwrap().camera_report().unwrap().pan_centideg, -3000);
    simulator.stop();
}

#[test]
fn the_same_over_tcp() {
    let (simulator, _folder) = simulator();
    let address = format!("tcp://{}", simulator.tcp_address().unwrap());
    let robot = open(&address.parse().unwrap());
    let mut motion = robot.motion().unwrap();
    motion.init().unwrap();
    let report = motion.play(&action("bow", 1), &mut PlayOptions::default()).unwrap();
    assert_eq!(report.outcome, Outcome::Done, "{report}");
    assert_eq!(robot.information(Address::Motion).unwrap().queue_length, 32);
    simulator.stop();
}

#[test]
fn a_pulled_cable_ends_motion_and_nothing_resumes_when_it_is_back() {
    let (simulator, _folder) = simulator();
    let robot = open(&terminal(&simulator));
    let mut motion = robot.motion().unwrap();
    motion.init().unwrap();
    let shared = simulator.robot().clone();
    let puller = std::thread::spawn(move || {
        std::thread::sleep(Duration::from_millis(700));
        shared.lock().pull_cable(true);
        let pulled_ms = shared.lock().now_ms();
        let limit = Instant::now() + Duration::from_secs(10);
        while motors_run(&shared) {
            assert!(Instant::now() < limit, "motors still run: {:?}", shared.reading());
            std::thread::sleep(Duration::from_millis(1));
        }
        let silent_ms = shared.lock().now_ms() - pulled_ms;
        std::thread::sleep(Duration::from_millis(800));
        shared.lock().pull_cable(false);
        silent_ms
    });
    let report = motion.play(&action("dance", 5), &mut PlayOptions::default()).unwrap();
    assert!(!report.outcome.is_done(), "{report}");
    let silent_ms = puller.join().unwrap();
    assert!(silent_ms <= 700, "motors off {silent_ms} ms after the cable was pulled");

    std::thread::sleep(Duration::from_millis(1500));
    let after = motion.refresh().unwrap().motion_report().unwrap();
    assert_eq!((after.mode, after.motors), (Mode::Held, 0), "nothing resumes by itself");
    motion.init().unwrap();
    let report = motion.play(&action("wave", 1), &mut PlayOptions::default()).unwrap();
    assert_eq!(report.outcome, Outcome::Done, "{report}");
    simulator.stop();
}

#[test]
fn a_stop_from_another_line_is_told_by_the_player() {
    let (simulator, _folder) = simulator();
    let robot = open(&terminal(&simulator));
    let mut motion = robot.motion().unwrap();
    motion.init().unwrap();
    let other: LinkAddress = format!("tcp://{}", simulator.tcp_address().unwrap()).parse().unwrap();
    let stopper = std::thread::spawn(move || {
        std::thread::sleep(Duration::from_millis(600));
        rsapien::emergency_stop(&other, &rsapien::StopOptions::default()).unwrap()
    });
    let report = motion.play(&action("dance", 5), &mut PlayOptions::default()).unwrap();
    assert_eq!(report.outcome, Outcome::Interrupted { by: Interruption::Stop }, "{report}");
    stopper.join().unwrap();
    assert!(!motors_run(simulator.robot()));
    simulator.stop();
}
