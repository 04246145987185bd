//! The client of the chips' simulator against a stand-in, and against programs that misbehave.

use std::fs;
use std::io::Write;
use std::os::fd::OwnedFd;
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use rsapien_protocol::{
    Address, AimTarget, BumperMask, Direction, Joint, Mode, Pose, Position, Report, Request,
    Session, SessionConfig, SessionEvent, Status, Step, StopCause,
};

use super::bridge::Bridge;
use super::fake::{self, Commands};
use super::*;
use crate::line::LineFaults;
use crate::robot::{Controllers, Power};
use crate::world::World;
use crate::{VirtualRobot, VirtualRobotConfig};

/// A PC, and a robot whose controllers are stand-ins.
struct Pair {
    session: Session,
    robot: VirtualRobot,
    commands: [Commands; 2],
}

impl Pair {
    fn new(clock_mhz: u8, advances: u64) -> Self {
        let (motion, motion_commands) = fake::chip(Address::Motion, clock_mhz, advances);
        let (camera, camera_commands) = fake::chip(Address::Camera, clock_mhz, advances);
        let firmware = Firmware::with_chips([motion, camera]).expect("wired");
        let config = VirtualRobotConfig { world: World::wall(), ..VirtualRobotConfig::default() };
        let robot = VirtualRobot::with_electronics(config, Box::new(firmware)).expect("a robot");
        let session = Session::new(SessionConfig::default());
        Self { session, robot, commands: [motion_commands, camera_commands] }
    }

    fn ask(&mut self, address: Address, request: Request) -> (Status, Report) {
        self.session.request(address, request).expect("the line is free");
        self.answer()
    }

    fn answer(&mut self) -> (Status, Report) {
        loop {
            while let Some(bytes) = self.session.poll_transmit(self.robot.now_ms()) {
                self.robot.send(&bytes);
            }
            let limit_ms = self.session.poll_timeout().unwrap_or(self.robot.now_ms() + 1);
            self.robot.advance_until_byte(limit_ms);
            let mut bytes = Vec::new();
            self.robot.receive(&mut bytes);
            self.session.handle_bytes(&bytes, self.robot.now_ms());
            self.session.handle_timeout(self.robot.now_ms());
            match self.session.poll_event() {
                Some(SessionEvent::Answered { package, .. }) => {
                    return (package.status, package.report);
                }
                Some(SessionEvent::Restarted { .. }) | None => {}
                Some(event) => panic!("{event:?}, {:?}", self.robot.failure()),
            }
        }
    }

    fn open(&mut self, address: Address) {
        self.session.open(address).expect("the line is free");
        assert_eq!(self.answer().0, Status::Accepted);
    }

    fn mode(&mut self) -> Mode {
        match self.ask(Address::Motion, Request::State).1 {
            Report::Motion(report) => report.mode,
            report => panic!("{report:?}"),
        }
    }

    fn wait_for(&mut self, mode: Mode, limit_ms: u64) {
        let limit_ms = self.robot.now_ms() + limit_ms;
        while self.mode() != mode {
            assert!(self.robot.now_ms() < limit_ms, "never {mode:?}");
            let next_ms = self.robot.now_ms() + 50;
            self.robot.advance_to(next_ms);
        }
    }

    fn init(&mut self) {
        self.open(Address::Motion);
        assert_eq!(self.ask(Address::Motion, Request::Init).0, Status::Accepted);
        self.wait_for(Mode::Idle, 4000);
    }

    fn was_told(&self, controller: usize, command: &str) -> bool {
        let commands = self.commands[controller].lock().expect("the list");
        commands.iter().any(|told| told == command)
    }
}

#[test]
fn the_body_moves_by_the_pins_and_the_pins_feel_the_body() {
    for clock_mhz in [40, 4] {
        let mut pair = Pair::new(clock_mhz, u64::MAX);
        assert_eq!(pair.robot.motion_report().mode, Mode::Fresh);
        pair.init();
        for position in pair.robot.joints() {
            assert!((position - 0.5).abs() < 0.05, "homed to {position}");
        }
        assert_eq!(pair.robot.motion_report().middle_switches, [true, true]);

        let up = Pose::EMPTY.with(Joint::LeftArm, Some(Position::First));
        let step = Step { ending_bumpers: BumperMask::FEET, ..Step::new(up, 1200) };
        pair.ask(Address::Motion, Request::Step(step));
        pair.robot.advance_to(pair.robot.now_ms() + 100);
        let arm = 1 << Joint::LeftArm.index();
        assert_eq!(pair.robot.motors(), MotorPins { towards_first: arm, towards_last: 0 });
        assert_eq!(pair.robot.reading().joints[1].motor, "up");
        pair.robot.press_bumper(2, true);
        pair.wait_for(Mode::Held, 100);
        assert_eq!(pair.robot.motors(), MotorPins::default());
        assert_eq!(pair.robot.motion_report().cause, StopCause::Bumper);
        assert_eq!(pair.robot.reading().motion_mode, "held");
        pair.robot.set_supply_mv(4900);
        pair.mode();
        assert!(pair.robot.motion_report().supply_low);
        assert!(!pair.was_told(CAMERA, "set ra2 0"), "the camera's chip has no such wire");
    }
}

#[test]
fn the_head_follows_the_pulses() {
    let mut pair = Pair::new(40, u64::MAX);
    pair.open(Address::Camera);
    let left_at = pair.robot.camera_angles();
    pair.robot.advance_to(pair.robot.now_ms() + 100);
    assert_eq!(pair.robot.camera_angles(), left_at, "limp without pulses");
    assert_eq!(pair.ask(Address::Camera, Request::Home).0, Status::Accepted);
    let target = AimTarget { pan_centideg: -3050, tilt_centideg: 1210, speed_deg_per_s: 90 };
    assert_eq!(pair.ask(Address::Camera, Request::Aim(target)).0, Status::Accepted);
    let limit_ms = pair.robot.now_ms() + 4000;
    while pair.robot.now_ms() < limit_ms {
        pair.ask(Address::Camera, Request::State);
        pair.robot.advance_to(pair.robot.now_ms() + 100);
    }
    let head = pair.robot.camera_angles();
    assert_eq!((head.pan_centideg, head.tilt_centideg), (-3050, 1210));
    assert_eq!(pair.robot.camera_report().pan_centideg, -3050);
    assert_eq!(pair.robot.reading().camera_mode, "idle");
}

#[test]
fn a_round_trip_takes_hardly_longer_than_with_the_model() {
    let mut pair = Pair::new(40, u64::MAX);
    pair.open(Address::Motion);
    let begin_ms = pair.robot.now_ms();
    pair.mode();
    // 7.47 ms on the line, and the milliseconds into which the ends fall.
    let took_ms = pair.robot.now_ms() - begin_ms;
    assert!((7..=9).contains(&took_ms), "{took_ms} ms");
}

#[test]
fn the_line_is_busy_from_the_first_byte_to_the_end_of_the_answer() {
    let mut pair = Pair::new(40, u64::MAX);
    assert!(!pair.robot.is_line_busy());
    pair.session.request(Address::Motion, Request::State).expect("the line is free");
    let bytes = pair.session.poll_transmit(0).expect("a package");
    pair.robot.send(&bytes);
    let mut answer = Vec::new();
    while pair.robot.is_line_busy() {
        pair.robot.advance_to(pair.robot.now_ms() + 1);
        pair.robot.receive(&mut answer);
        assert!(pair.robot.now_ms() < 50, "busy for ever");
    }
    assert_eq!(answer.len(), rsapien_protocol::SYNCHRONIZATION_PACKAGE_LENGTH);
}

#[test]
fn power_and_resets_reach_the_chips() {
    let mut pair = Pair::new(40, u64::MAX);
    pair.init();
    pair.robot.power_off();
    pair.session.request(Address::Motion, Request::State).expect("the line is free");
    let bytes = pair.session.poll_transmit(pair.robot.now_ms()).expect("a package");
    pair.robot.send(&bytes);
    pair.robot.advance_to(pair.robot.now_ms() + 100);
    assert!(!pair.robot.has_arrived() && pair.robot.unsent() == 0, "nobody hears it");
    assert_eq!((pair.robot.power(), pair.robot.motors()), (Power::Off, MotorPins::default()));
    assert!(!pair.was_told(MOTION, "reset power-on"));
    pair.robot.power_on();
    assert!(pair.was_told(MOTION, "reset power-on") && pair.was_told(CAMERA, "reset power-on"));
    assert_eq!(pair.robot.motion_report().mode, Mode::Fresh);
    assert!(!pair.was_told(MOTION, "reset brown-out"), "that was none");
    pair.robot.brown_out();
    assert!(pair.was_told(MOTION, "reset brown-out") && pair.was_told(CAMERA, "reset brown-out"));
    assert_eq!(pair.robot.motion_report().cause, StopCause::BrownOut);
    assert_eq!(pair.robot.failure(), None);
}

#[test]
fn what_only_a_model_can_is_refused() {
    let mut pair = Pair::new(40, u64::MAX);
    let refused = pair.robot.hang(Address::Motion).expect_err("refused").to_string();
    assert!(
        refused.contains("hanging a controller") && refused.contains("--firmware"),
        "{refused}"
    );
    assert!(pair.robot.try_clone().is_none());
}

#[test]
fn damage_on_the_line_reaches_the_chips() {
    let mut pair = Pair::new(40, u64::MAX);
    let faults = LineFaults { framing_ppm: 1_000_000, ..LineFaults::NONE };
    pair.robot.set_line_faults(Direction::ToRobot, faults);
    pair.robot.send(&[0xC9]);
    pair.robot.advance_to(3);
    let told = |pair: &Pair, part: &str| {
        let commands = pair.commands[MOTION].lock().expect("the list");
        commands.iter().any(|command| command.starts_with(part))
    };
    assert!(told(&pair, "send-framing 00 ") && !told(&pair, "send c9"));
    pair.robot.set_line_faults(Direction::ToRobot, LineFaults::NONE);
    pair.robot.pull_cable(true);
    pair.robot.send(&[0xC9]);
    pair.robot.advance_to(6);
    assert!(!told(&pair, "send c9"), "a pulled cable carries nothing");
}

#[test]
fn bytes_that_both_send_at_once_garble_each_other() {
    let sent = |at, controller, byte| Sent { at, controller, heard: Heard::Byte(byte) };
    let mut line = Line::new(57_600, 1);
    let (motion, _) = fake::chip(Address::Motion, 40, 0);
    let (camera, _) = fake::chip(Address::Camera, 40, 0);
    let mut firmware = Firmware {
        chips: Some([motion, camera]),
        failure: None,
        servos: [Servo::new(40), Servo::new(40)],
        told: Told::new(ResetCause::PowerOn),
        last_sent: [None; 2],
        idle_ms: 0,
        is_busy: false,
    };
    firmware.deliver(&mut line, vec![sent(20_000, CAMERA, 0b1100), sent(15_000, MOTION, 0b1010)]);
    firmware.deliver(&mut line, vec![sent(29_000, MOTION, 0b0111), sent(60_000, CAMERA, 0x55)]);
    let mut bytes = Vec::new();
    line.receive(&mut bytes);
    assert_eq!(bytes, [0b1000, 0b1000, 0b0100, 0x55]);
}

#[test]
fn a_simulator_that_falls_silent_leaves_a_robot_with_dead_controllers() {
    let mut pair = Pair::new(40, 30);
    let begin = Instant::now();
    pair.robot.advance_to(1000);
    assert!(begin.elapsed() < Duration::from_secs(5), "waits once and not for every ms");
    assert_eq!(pair.robot.now_ms(), 1000);
    let failure = pair.robot.failure().expect("a failure").to_string();
    assert!(failure.contains("motion") && failure.contains("advance 10000"), "{failure}");
    assert_eq!(pair.robot.motors(), MotorPins::default());
    pair.robot.send(&[1, 2, 3]);
    pair.robot.advance_to(1100);
    assert!(!pair.robot.is_line_busy(), "what is sent to it is lost");
    pair.robot.power_cycle();
    assert!(pair.robot.failure().is_some(), "and it stays so");
}

/// A folder with images, empty ones, and a program in place of the simulator.
fn folder(script: &str, images: &[&str]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    for image in images {
        fs::write(folder.path().join(image), ":00000001FF\n").expect("written");
    }
    let program = folder.path().join("rsapien-gpsim");
    fs::write(&program, format!("#!/bin/sh\n{script}\n")).expect("written");
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).expect("executable");
    (folder, program)
}

const IMAGES: [&str; 3] = [
    "rsapien-camera-18f2320-40mhz-57600.hex",
    "rsapien-motion-18f452-40mhz-57600.hex",
    "rsapien-motion-18f452-10mhz-57600.hex",
];

fn robot_of(config: FirmwareConfig, baud: u32) -> Result<VirtualRobot, String> {
    let controllers = Controllers::Firmware(config);
    VirtualRobot::new(VirtualRobotConfig { baud, controllers, ..VirtualRobotConfig::default() })
        .map_err(|error| error.to_string())
}

#[test]
fn images_are_found_by_their_names() {
    let (folder, program) = folder("", &IMAGES);
    fs::write(folder.path().join("sha256"), "").expect("written");
    let config = FirmwareConfig::find(folder.path(), &program, 57_600).expect("found");
    assert_eq!(config.motion.path(), folder.path().join(IMAGES[1]), "the fastest clock");
    assert_eq!((config.camera.clock_mhz(), config.camera.baud()), (40, 57_600));
    assert_eq!(config.motion.processor(), "p18f452");
    assert_eq!(config.camera.processor(), "p18f2321");

    let refused = |folder: &Path, baud| {
        FirmwareConfig::find(folder, &program, baud).expect_err("refused").to_string()
    };
    let other = refused(folder.path(), 115_200);
    assert!(other.contains("115200") && other.contains("--baud 57600"), "{other}");
    let nowhere = refused(Path::new("/nowhere"), 57_600);
    assert!(nowhere.contains("/nowhere") && nowhere.contains("firmware-pic/hex"), "{nowhere}");
    for name in [
        "rsapien-motion.hex",
        "rsapien-head-18f452-40mhz-57600.hex",
        "a.hex",
        "rsapien-motion-18f452-41mhz-57600.hex",
        "rsapien-motion-18f452-40mhz-57600-2.hex",
    ] {
        assert!(FirmwareImage::at(name).is_err(), "{name}");
    }

    let mismatched = robot_of(config.clone(), 19_200).expect_err("refused");
    assert!(mismatched.contains("--baud 57600"), "{mismatched}");
    let swapped = FirmwareConfig { motion: config.camera.clone(), ..config.clone() };
    assert!(
        robot_of(swapped, 57_600).expect_err("refused").contains("not the firmware of the motion")
    );
    fs::remove_file(folder.path().join(IMAGES[0])).expect("removed");
    let missing = robot_of(config, 57_600).expect_err("refused");
    assert!(missing.contains("camera") && missing.contains("make -C"), "{missing}");
}

#[test]
fn programs_that_are_no_simulator_are_told_of() {
    for (script, told) in [
        ("echo 'rsapien-gpsim: cannot load the hex' >&2; echo >&2; exit 3", "cannot load the hex"),
        ("exit 3", "has ended: exit status: 3"),
        ("kill -9 $$", "has ended: signal: 9"),
        ("read command; echo ok rb0 rb1", "rb2 among them"),
        ("read command; echo error busy", "error busy"),
        ("read command; echo what", "answered \"pins\" with \"what\""),
    ] {
        let (folder, program) = folder(script, &IMAGES);
        let config = FirmwareConfig::find(folder.path(), &program, 57_600).expect("found");
        let error = robot_of(config, 57_600).expect_err("no robot");
        assert!(error.contains("motion") && error.contains(told), "{script}: {error}");
    }
    let (folder, _) = folder("", &IMAGES);
    let config =
        FirmwareConfig::find(folder.path(), "/nowhere/rsapien-gpsim", 57_600).expect("found");
    let error = robot_of(config, 57_600).expect_err("no robot");
    assert!(error.contains("/nowhere") && error.contains("make -C firmware-pic/sim"), "{error}");
}

#[test]
fn a_simulator_ends_with_its_robot() {
    // It tells its process and its arguments, then waits for ever, whatever becomes of its input.
    let script = "echo $$ > \"$0.process\"; echo \"$@\" > \"$0.arguments\"; exec sleep 1000";
    let (folder, program) = folder(script, &IMAGES);
    let config = FirmwareConfig::find(folder.path(), &program, 57_600).expect("found");
    let chip = Chip::start(&program, &config.motion).expect("started");
    let read = |ending: &str| {
        let limit = Instant::now() + Duration::from_secs(5);
        loop {
            let path = folder.path().join(format!("rsapien-gpsim.{ending}"));
            match fs::read_to_string(path) {
                Ok(text) if text.ends_with('\n') => return text.trim().to_owned(),
                _ => assert!(Instant::now() < limit, "it never ran"),
            }
            std::thread::sleep(Duration::from_millis(5));
        }
    };
    let (process, arguments) = (read("process"), read("arguments"));
    for part in ["--lockstep", "--processor p18f452", "--clock-mhz 40", "--baud 57600", "--hex "] {
        assert!(arguments.contains(part), "{arguments}");
    }
    let place = Path::new("/proc").join(process);
    assert!(place.exists());
    drop(chip);
    assert!(!place.exists(), "it lives on");
}

#[test]
fn what_happens_in_a_millisecond_is_read_from_its_lines() {
    let run = |answer: &str| {
        let (ours, mut theirs) = UnixStream::pair().expect("a pair of sockets");
        theirs
            .write_all(format!("ok re0 rd0\nok\nok 1\nok 500\n{answer}").as_bytes())
            .expect("written");
        let from = OwnedFd::from(ours.try_clone().expect("a second handle"));
        let patience = Duration::from_millis(50);
        let mut chip = Chip::of(Bridge::with("motion", ours.into(), from, patience), 40);
        chip.wire(&[], &["rd0"]).expect("wired");
        assert!(chip.level(0) && chip.cycle() == 500);
        chip.begin_ms()?;
        let happened = chip.end_ms()?;
        Ok((happened, chip.level(0), chip.cycle()))
    };
    let told = "byte 700 C9\nedge 800 rd0 0\nedge 900 rd7 1\nframing 1000\nheard 1100\nmark 1200 loop\n\
                reset 1300 watchdog\nok 10500\n";
    let expected = vec![
        Happened::Sent { cycle: 700, byte: 0xC9 },
        Happened::Edge { cycle: 800, pin: 0, level: false },
        Happened::Other,
        Happened::Framing { cycle: 1000 },
        Happened::Other,
        Happened::Other,
        Happened::Reset { cause: ResetCause::Watchdog },
    ];
    assert_eq!(run(told), Ok((expected, false, 10_500)));
    for (answer, part) in [
        ("error the firmware has stopped\n", "the firmware has stopped"),
        ("byte 700 XX\nok 10500\n", "byte 700 XX"),
        ("edge 700 rd0 Z\nok 10500\n", "rd0 Z"),
        ("ok\n", "without a cycle"),
        ("ok 105", "has not answered \"advance 10000\""),
    ] {
        let error: FirmwareError = run(answer).expect_err(answer);
        assert!(error.to_string().contains(part), "{answer:?}: {error}");
    }
    let mut told = Told::new(ResetCause::PowerOn);
    told.restart(MOTION, ResetCause::Watchdog);
    assert_eq!(told.motion().cause, StopCause::Watchdog);
    assert_eq!(told.camera().cause, StopCause::PowerOn);
}
