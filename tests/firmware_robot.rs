//! The robot with the real firmware: both committed hex files in a simulator of their chips, in the virtual robot's body.
//! What the host library and the command do with the model they do with it, and the body tells the truth.
//!
//! `make -C firmware-pic/sim` builds the simulator of the chips.
#![cfg(feature = "firmware-simulator")]

use rsapien::link::virtual_robot::{
    Controllers, FirmwareConfig, Pace, SharedVirtualRobot, VirtualOptions, VirtualRobot,
    VirtualRobotConfig,
};
use rsapien::protocol::{Address, BumperMask, Joint, Mode, Pose, Position, Step, StopCause};
use rsapien::{Outcome, PlayOptions, Robot, RobotOptions};
use rsapien_registry::{CompileOptions, Registry};
use rsapien_sim::server::{Simulator, SimulatorConfig};
use rsapien_sim::world::World;
use rsapien_tests::{read, workspace};
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::Command;
use std::sync::{MutexGuard, PoisonError};

/// How far a joint may be from where it was sent, as a fraction of travel: what the body's travel times deviate from
/// those that the firmware reckons with.
const POSITION_TOLERANCE: f64 = 0.1;

fn hex_folder() -> PathBuf {
    workspace().join("firmware-pic/hex")
}

/// The built simulator of the chips, or the one of the command's variable.
fn simulator_of_chips() -> PathBuf {
    std::env::var_os("RSAPIEN_GPSIM")
        .map_or_else(|| workspace().join("target/firmware/sim/rsapien-gpsim"), PathBuf::from)
}

fn config(world: World) -> VirtualRobotConfig {
    let firmware = FirmwareConfig::find(&hex_folder(), simulator_of_chips(), 57_600).unwrap();
    let controllers = Controllers::Firmware(firmware);
    VirtualRobotConfig { world, controllers, ..VirtualRobotConfig::default() }
}

/// A robot with the firmware, as fast as it goes.
struct Tried {
    robot: Robot,
    shared: SharedVirtualRobot,
}

impl Tried {
    fn new(world: World) -> Tried {
        let mut options = RobotOptions::new("firmware");
        options.virtual_robot = VirtualOptions { pace: Pace::Fast, config: config(world) };
        let shared = options.virtual_robot.build().unwrap();
        let robot = Robot::virtual_with(shared.clone(), Pace::Fast, options).unwrap();
        Tried { robot, shared }
    }

    fn truth(&self) -> MutexGuard<'_, VirtualRobot> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }

    #[track_caller]
    fn joint_is_at(&self, joint: Joint, fraction: f64) {
        let position = self.truth().body().position(joint);
        assert!((position - fraction).abs() <= POSITION_TOLERANCE, "{joint} at {position}");
    }
}

fn action(name: &str) -> Vec<Step> {
    let registry = Registry::open_in_memory().unwrap();
    registry.compile(name, &CompileOptions::default()).unwrap().steps
}

#[test]
fn the_firmware_initialises_walks_and_looks() {
    let tried = Tried::new(World::empty());
    let hello = tried.robot.information(Address::Motion).unwrap();
    assert_eq!((hello.clock_mhz, hello.queue_length), (40, 32));
    let mut motion = tried.robot.motion().unwrap();
    assert_eq!(motion.refresh().unwrap().motion_report().unwrap().cause, StopCause::PowerOn);
    motion.init().unwrap();
    for joint in Joint::ALL {
        tried.joint_is_at(joint, 0.5);
    }
    assert_eq!(tried.truth().body().middle_switches(), [true, true]);
    assert_eq!(tried.truth().motors().running(), 0);

    let before = tried.truth().pose();
    let steps = action("walk-forward");
    let report = motion.play(&steps, &mut PlayOptions::default()).unwrap();
    assert_eq!(report.outcome, Outcome::Done, "{report}");
    assert_eq!(report.steps_ended, steps.len());
    let after = tried.truth().pose();
    assert!(after.x_m - before.x_m > 0.05, "{before:?} to {after:?}");
    assert!((after.y_m - before.y_m).abs() < 0.02, "{before:?} to {after:?}");

    let camera = tried.robot.camera().unwrap();
    camera.home().unwrap();
    let head = tried.truth().camera_angles();
    assert_eq!((head.pan_centideg, head.tilt_centideg), (0, 0));
    for (pan_deg, tilt_deg) in [(-30.01, 12.5), (90.0, -45.0), (0.37, 0.0)] {
        let told = camera.look(pan_deg, tilt_deg, 0).unwrap();
        let head = tried.truth().camera_angles();
        assert_eq!(
            (head.pan_centideg, head.tilt_centideg),
            (told.pan_centideg, told.tilt_centideg),
            "the head is where the controller says"
        );
        assert!((f64::from(told.pan_centideg) / 100.0 - pan_deg).abs() < 1e-9);
    }
}

#[test]
fn bumpers_stops_and_silence_end_motion() {
    let tried = Tried::new(World::empty());
    let mut motion = tried.robot.motion().unwrap();
    motion.init().unwrap();
    let up = Pose::EMPTY.with(Joint::LeftArm, Some(Position::First));
    let step = Step { ending_bumpers: BumperMask::FEET, ..Step::new(up, 1500) };
    motion.step(step).unwrap();
    tried.robot.sleep_ms(200).unwrap();
    assert_eq!(tried.truth().motors().towards_first, 1 << Joint::LeftArm.index());
    tried.truth().press_bumper(2, true);
    let begin_ms = tried.robot.now_ms();
    let held = motion.wait_for(100, |state| {
        state.motion_report().is_some_and(|report| report.mode == Mode::Held)
    });
    assert!(held.unwrap().is_some(), "never held");
    assert!(tried.robot.now_ms() - begin_ms < 120);
    let report = motion.refresh().unwrap().motion_report().unwrap();
    assert_eq!(report.cause, StopCause::Bumper);
    assert_eq!(tried.truth().motors().running(), 0);
    tried.truth().press_bumper(2, false);

    motion.init().unwrap();
    motion.step(Step::new(up, 1500)).unwrap();
    tried.robot.sleep_ms(200).unwrap();
    assert_ne!(tried.truth().motors().running(), 0);
    motion.stop().unwrap();
    assert_eq!(tried.truth().motors().running(), 0);
    assert_eq!(motion.refresh().unwrap().motion_report().unwrap().mode, Mode::Stopped);

    // All the way down takes the arm a second.
    let down = Pose::EMPTY.with(Joint::LeftArm, Some(Position::Last));
    motion.init().unwrap();
    motion.play(&[Step::new(up, 800)], &mut PlayOptions::default()).unwrap();
    motion.step(Step::new(down, 1500)).unwrap();
    tried.robot.sleep_ms(100).unwrap();
    assert_ne!(tried.truth().motors().running(), 0);
    let mut truth = tried.truth();
    truth.pull_cable(true);
    let pulled_ms = truth.now_ms();
    while truth.motors().running() != 0 {
        let next_ms = truth.now_ms() + 1;
        truth.advance_to(next_ms);
        assert!(next_ms - pulled_ms <= 502, "the dead-man does not stop the motors");
    }
    assert!(truth.now_ms() - pulled_ms >= 300, "the last package came within the heartbeat");
    truth.pull_cable(false);
    drop(truth);
    let report = motion.refresh().unwrap().motion_report().unwrap();
    assert_eq!((report.mode, report.cause), (Mode::Held, StopCause::DeadMan));
    assert_eq!(tried.truth().failure(), None);
}

#[test]
fn the_supply_and_the_switch_reach_the_chips() {
    let tried = Tried::new(World::empty());
    let motion = tried.robot.motion().unwrap();
    let report = || motion.refresh().unwrap().motion_report().unwrap();
    let boot = report().boot;
    assert!(!report().supply_low);
    tried.truth().set_supply_mv(4900);
    assert!(report().supply_low);
    tried.truth().set_supply_mv(5500);
    // A start of its own takes a while until it can answer.
    for (number, cause) in [(1, StopCause::BrownOut), (2, StopCause::PowerOn)] {
        if cause == StopCause::BrownOut {
            tried.truth().brown_out();
        } else {
            tried.truth().power_cycle();
        }
        tried.robot.sleep_ms(200).unwrap();
        assert_eq!((report().cause, report().boot), (cause, boot.wrapping_add(number)));
        assert_eq!(report().mode, Mode::Fresh);
    }
    let refused = tried.truth().hang(Address::Motion).unwrap_err().to_string();
    assert!(refused.contains("model"), "{refused}");
}

#[test]
fn a_run_is_the_same_each_time() {
    let run = || {
        let tried = Tried::new(World::empty());
        let mut motion = tried.robot.motion().unwrap();
        motion.init().unwrap();
        motion.play(&action("wave"), &mut PlayOptions::default()).unwrap();
        let packages: Vec<String> =
            tried.robot.packages().iter().map(ToString::to_string).collect();
        let joints = tried.truth().joints().map(f64::to_bits);
        (packages, joints)
    };
    assert_eq!(run(), run());
}

#[test]
fn the_demo_passes_with_the_firmware() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let arguments: [OsString; 8] = [
        "rsapien".into(),
        "demo".into(),
        "--fast".into(),
        "--firmware".into(),
        hex_folder().into(),
        "--simulator".into(),
        simulator_of_chips().into(),
        format!("--out={}", out.display()).into(),
    ];
    assert_eq!(rsapien::cli::main(arguments), 0, "the ball is found and centred");
    let log = read(&out.join("packages.txt"));
    assert!(log.contains("-> motion INIT") && log.contains("<- camera AIM"), "{log}");
}

#[test]
fn the_client_of_the_protocol_page_talks_to_the_firmware() {
    let page = read(&workspace().join("docs/protocol.md"));
    let program = page.split("```python\n").nth(1).and_then(|rest| rest.split("```").next());
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("client.py");
    std::fs::write(&file, program.expect("the page has a Python program")).unwrap();
    let link = folder.path().join("robot");
    let simulator = Simulator::start(SimulatorConfig {
        robot: config(World::empty()),
        pty: Some(link.clone()),
        ..SimulatorConfig::default()
    })
    .unwrap();
    let output = Command::new("python3").arg(&file).arg(&link).output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
    assert!(said.contains("steps ended: 1"), "{said}");
    let right_arm = simulator.robot().lock().joints()[0];
    assert!(
        right_arm < 0.01,
        "the arm it sent up is at {right_arm} of its travel; it said: {said}"
    );
    simulator.stop();
}
