//! The whole robot, spoken to by a real session over its line.

use super::*;
use crate::body::Contact;
use crate::line::LineFaults;
use rsapien_protocol::{
    Address, AimTarget, BumperMask, Direction, Failure, Mode, Parameter, Pose, Position, Report,
    Request, Session, SessionConfig, SessionEvent, Status, Step, StopCause,
};

use Joint::{LeftLeg, RightLeg, Tilt};
use Position::{First, Last, Middle};

/// A PC and a robot.
struct Pair {
    session: Session,
    robot: VirtualRobot,
}

impl Pair {
    fn new(config: VirtualRobotConfig) -> Pair {
        let session = Session::new(SessionConfig { baud: config.baud, ..SessionConfig::default() });
        Pair { session, robot: VirtualRobot::new(config).expect("a valid configuration") }
    }

    fn in_world(world: World) -> Pair {
        Pair::new(VirtualRobotConfig { world, ..VirtualRobotConfig::default() })
    }

    /// Runs until something happens.
    fn event(&mut self) -> SessionEvent {
        for _ in 0..10_000 {
            if let Some(event) = self.session.poll_event() {
                return event;
            }
            while let Some(bytes) = self.session.poll_transmit(self.robot.now_ms()) {
                self.robot.send(&bytes);
            }
            let limit_ms = self.session.poll_timeout().unwrap_or(self.robot.now_ms() + 1);
            self.robot.advance_until_byte(limit_ms);
            let mut bytes = Vec::new();
            self.robot.receive(&mut bytes);
            self.session.handle_bytes(&bytes, self.robot.now_ms());
            self.session.handle_timeout(self.robot.now_ms());
        }
        panic!("nothing happens any more");
    }

    fn answer(&mut self) -> (Status, Report) {
        match self.event() {
            SessionEvent::Answered { package, .. } => (package.status, package.report),
            SessionEvent::Restarted { .. } => self.answer(),
            event => panic!("{event:?}"),
        }
    }

    fn ask(&mut self, address: Address, request: Request) -> (Status, Report) {
        self.session.request(address, request).expect("the line is free");
        self.answer()
    }

    fn open(&mut self, address: Address) {
        self.session.open(address).expect("the line is free");
        assert_eq!(self.answer().0, Status::Accepted);
    }

    fn state(&mut self) -> MotionReport {
        match self.ask(Address::Motion, Request::State).1 {
            Report::Motion(report) => report,
            report => panic!("{report:?}"),
        }
    }

    /// Heartbeats until the mode is `mode`; fails after `limit_ms`.
    fn wait_for(&mut self, mode: Mode, limit_ms: u64) -> MotionReport {
        let limit_ms = self.robot.now_ms() + limit_ms;
        loop {
            let report = self.state();
            if report.mode == mode {
                return report;
            }
            assert!(self.robot.now_ms() < limit_ms, "still {report:?}");
            let next_ms = self.robot.now_ms() + 20;
            self.robot.advance_to(next_ms);
        }
    }

    /// Heartbeats to a controller, as the dead-man asks for.
    fn beat(&mut self, address: Address, duration_ms: u64) {
        let end_ms = self.robot.now_ms() + duration_ms;
        while self.robot.now_ms() < end_ms {
            self.ask(address, Request::State);
            let next_ms = self.robot.now_ms() + 100;
            self.robot.advance_to(next_ms);
        }
    }

    fn init(&mut self) {
        self.open(Address::Motion);
        assert_eq!(self.ask(Address::Motion, Request::Init).0, Status::Accepted);
        self.wait_for(Mode::Idle, 4000);
    }

    fn step(&mut self, joints: &[(Joint, Position)], duration_ms: u16) {
        self.step_with(joints, duration_ms, BumperMask::NONE);
    }

    fn step_with(&mut self, joints: &[(Joint, Position)], duration_ms: u16, ends: BumperMask) {
        let pose = joints
            .iter()
            .fold(Pose::EMPTY, |pose, (joint, position)| pose.with(*joint, Some(*position)));
        let step = Step { ending_bumpers: ends, ..Step::new(pose, duration_ms) };
        let (status, report) = self.ask(Address::Motion, Request::Step(step));
        assert_eq!(status, Status::Accepted, "{report:?}");
    }

    /// The paper's dynamic walking: the trunk swings, and the leg that is free swings to the front.
    fn queue_walk(&mut self, cycles: u32, ends: BumperMask) {
        for _ in 0..cycles {
            self.step_with(&[(Tilt, First)], 650, ends);
            self.step_with(&[(RightLeg, First), (LeftLeg, Last)], 750, ends);
            self.step_with(&[(Tilt, Last)], 650, ends);
            self.step_with(&[(LeftLeg, First), (RightLeg, Last)], 750, ends);
        }
    }
}

fn position_of(pair: &Pair, joint: Joint) -> f64 {
    pair.robot.body().position(joint)
}

#[test]
fn a_state_round_trip_takes_the_time_of_both_packages_on_the_line() {
    for (baud, expected_ms) in [(19_200, 22.4), (57_600, 7.47), (115_200, 3.73)] {
        let mut pair = Pair::new(VirtualRobotConfig { baud, ..VirtualRobotConfig::default() });
        for address in Address::ALL {
            pair.open(address);
            pair.session.request(address, Request::State).expect("the line is free");
            let bytes = pair.session.poll_transmit(pair.robot.now_ms()).expect("a package");
            let start_ms = pair.robot.now_ms();
            pair.robot.send(&bytes);
            let mut received = Vec::new();
            while received.len() < rsapien_protocol::SYNCHRONIZATION_PACKAGE_LENGTH {
                let limit_ms = pair.robot.now_ms() + 50;
                assert!(pair.robot.advance_until_byte(limit_ms), "{baud}: an answer");
                pair.robot.receive(&mut received);
            }
            let took_ms = f64::from(u32::try_from(pair.robot.now_ms() - start_ms).expect("short"));
            assert!((expected_ms..expected_ms + 1.0).contains(&took_ms), "{baud}: {took_ms}");
            pair.session.handle_bytes(&received, pair.robot.now_ms());
            pair.answer();
        }
    }
}

#[test]
fn init_homes_every_joint_of_every_body() {
    for seed in 0..8 {
        let mut pair = Pair::new(VirtualRobotConfig { seed, ..VirtualRobotConfig::default() });
        pair.init();
        let report = pair.state();
        assert_eq!(report.pose_reached, Pose::MIDDLE, "seed {seed}");
        for joint in Joint::ALL {
            let position = position_of(&pair, joint);
            assert!((position - 0.5).abs() < 0.05, "seed {seed}: {joint} at {position}");
        }
        assert_eq!(report.middle_switches, [true, true], "seed {seed}");
    }
}

#[test]
fn primitives_reach_their_end_stops_and_motors_stop() {
    let mut pair = Pair::in_world(World::empty());
    pair.init();
    for (position, fraction) in [(First, 0.0), (Last, 1.0), (Middle, 0.5)] {
        pair.step(&Joint::ALL.map(|joint| (joint, position)), 1400);
        let report = pair.wait_for(Mode::Idle, 2000);
        for joint in Joint::ALL {
            assert_eq!(report.position(joint), Some(position), "{joint}");
            assert!((position_of(&pair, joint) - fraction).abs() < 0.05, "{joint}");
        }
        assert_eq!(pair.robot.motors(), MotorPins::default());
    }
}

#[test]
fn walking_goes_forward_and_straight() {
    let mut pair = Pair::in_world(World::empty());
    pair.init();
    pair.queue_walk(1, BumperMask::NONE);
    pair.wait_for(Mode::Idle, 5000);
    let start = pair.robot.pose();
    for _ in 0..5 {
        pair.queue_walk(1, BumperMask::NONE);
        pair.wait_for(Mode::Idle, 5000);
    }
    let end = pair.robot.pose();
    let way_m = (end.x_m - start.x_m).hypot(end.y_m - start.y_m);
    assert!((0.5..0.7).contains(&way_m), "{way_m} m in ten steps of 60 mm");
    assert!((end.heading_rad - start.heading_rad).abs() < 0.05, "{start:?} to {end:?}");
}

#[test]
fn one_leg_alone_goes_in_a_circle() {
    let mut pair = Pair::in_world(World::empty());
    pair.init();
    let start_rad = pair.robot.pose().heading_rad;
    for _ in 0..3 {
        // The right leg pushes while it carries the weight, and comes back while it is free.
        pair.step(&[(Tilt, First)], 650);
        pair.step(&[(RightLeg, First)], 750);
        pair.step(&[(Tilt, Last)], 650);
        pair.step(&[(RightLeg, Last)], 750);
        pair.wait_for(Mode::Idle, 5000);
    }
    let turned_rad = pair.robot.pose().heading_rad - start_rad;
    assert!(turned_rad > 0.3, "turned left by {turned_rad} rad");
}

#[test]
fn a_wall_ends_an_action_that_its_bumpers_may_end() {
    let mut pair = Pair::in_world(World::wall());
    pair.init();
    for _ in 0..12 {
        pair.queue_walk(1, BumperMask::FEET);
        let report = loop {
            let report = pair.state();
            if report.mode != Mode::Executing {
                break report;
            }
        };
        if report.mode == Mode::Held {
            assert_eq!(report.cause, StopCause::Bumper);
            assert_eq!(pair.robot.motors(), MotorPins::default());
            assert!(pair.robot.pose().x_m > 0.3, "{:?}", pair.robot.pose());
            return;
        }
    }
    panic!("walked through the wall to {:?}", pair.robot.pose());
}

#[test]
fn a_pulled_cable_ends_motion_within_the_dead_man_time() {
    let mut pair = Pair::in_world(World::empty());
    pair.init();
    pair.queue_walk(4, BumperMask::NONE);
    assert_ne!(pair.robot.motors().running(), 0);
    pair.robot.pull_cable(true);
    let pulled_ms = pair.robot.now_ms();
    while pair.robot.motors().running() != 0 || pair.robot.motion_report().mode != Mode::Held {
        let next_ms = pair.robot.now_ms() + 1;
        pair.robot.advance_to(next_ms);
        assert!(next_ms - pulled_ms <= u64::from(Parameter::DEAD_MAN_MS_DEFAULT), "still moving");
    }
    pair.session.request(Address::Motion, Request::State).expect("the line is free");
    assert!(matches!(
        pair.event(),
        SessionEvent::Failed { failure: Failure::NoAnswer { tries: 6, .. }, .. }
    ));
    pair.robot.pull_cable(false);
    let report = pair.state();
    assert_eq!((report.mode, report.cause), (Mode::Held, StopCause::DeadMan));
}

#[test]
fn the_head_homes_and_aims_and_the_picture_moves_with_it() {
    let mut pair = Pair::in_world(World::demo());
    assert_ne!(pair.robot.camera_angles(), HeadAngles::default(), "left somewhere");
    pair.open(Address::Camera);
    assert_eq!(pair.ask(Address::Camera, Request::Home).0, Status::Accepted);
    pair.beat(Address::Camera, 2000);
    assert_eq!(pair.robot.camera_angles(), HeadAngles::default());
    let ball_m = pair.robot.world().description().balls[0].center_m;
    let head = HeadAngles::aim_at(&pair.robot.pose(), ball_m).expect("in reach");
    let target = AimTarget {
        pan_centideg: head.pan_centideg,
        tilt_centideg: head.tilt_centideg,
        speed_deg_per_s: 90,
    };
    assert_eq!(pair.ask(Address::Camera, Request::Aim(target)).0, Status::Accepted);
    pair.beat(Address::Camera, 2000);
    assert_eq!(pair.robot.camera_angles(), head);
    let picture = pair.robot.picture();
    let ball = pair.robot.ground_truth().into_iter().find(|truth| truth.object == "ball");
    let ellipse = ball.expect("the ball is seen").ellipse;
    let middle = (f64::from(picture.width) / 2.0, f64::from(picture.height) / 2.0);
    let off = (ellipse.center_x - middle.0).hypot(ellipse.center_y - middle.1);
    assert!(off < 3.0, "the ball is {off} pixels off the middle");
    assert_ne!(picture, pair.robot.picture(), "every picture has noise of its own");
}

#[test]
fn resets_of_every_cause_are_told_and_close_the_session() {
    let mut pair = Pair::in_world(World::empty());
    pair.init();
    pair.robot.power_cycle();
    assert_eq!(pair.state().cause, StopCause::PowerOn);
    pair.robot.brown_out();
    assert_eq!(pair.state().cause, StopCause::BrownOut);
    pair.robot.hang(Address::Motion).expect("the model hangs");
    let later_ms = pair.robot.now_ms() + 1000;
    pair.robot.advance_to(later_ms);
    let report = pair.state();
    assert_eq!((report.cause, report.mode, report.boot), (StopCause::Watchdog, Mode::Fresh, 4));
    assert_eq!(pair.session.open_session(Address::Motion), None);
}

#[test]
fn a_low_supply_is_told_and_an_empty_one_holds_in_reset() {
    let mut pair = Pair::in_world(World::empty());
    pair.init();
    assert!(!pair.state().supply_low);
    pair.robot.set_supply_mv(4900);
    assert!(pair.state().supply_low);
    pair.queue_walk(1, BumperMask::NONE);
    pair.robot.set_supply_mv(3900);
    let later_ms = pair.robot.now_ms() + 5;
    pair.robot.advance_to(later_ms);
    assert_eq!((pair.robot.power(), pair.robot.motors()), (Power::BrownOut, MotorPins::default()));
    pair.robot.set_supply_mv(5200);
    let report = pair.state();
    assert_eq!((report.cause, report.mode), (StopCause::BrownOut, Mode::Fresh));
}

/// FNV-1a.
fn hash(state: u64, bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(state, |state, byte| (state ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

/// A run with every kind of fault, as one number.
fn trace(seed: u64) -> u64 {
    let world = World::random(seed);
    let mut pair = Pair::new(VirtualRobotConfig { seed, world, ..VirtualRobotConfig::default() });
    pair.init();
    let faults = LineFaults {
        bit_error_ppm: 200,
        lost_ppm: 2000,
        duplicated_ppm: 2000,
        noise_ppm: 5000,
        framing_ppm: 1000,
    };
    pair.robot.set_line_faults(Direction::ToRobot, faults);
    pair.robot.set_line_faults(Direction::ToPc, faults);
    let (mut state, mut bytes) = (0xcbf2_9ce4_8422_2325, Vec::new());
    let step = Step::new(Pose::MIDDLE.with(Tilt, Some(First)).with(LeftLeg, Some(Last)), 300);
    for turn in 0..60_u64 {
        let request = if turn % 3 == 0 { Request::Step(step) } else { Request::State };
        // A session lost to a fault is part of the run: it is opened again.
        if pair.session.request(Address::Motion, request).is_err() && pair.session.is_free() {
            pair.session.open(Address::Motion).expect("the line is free");
        }
        while let Some(package) = pair.session.poll_transmit(pair.robot.now_ms()) {
            pair.robot.send(&package);
        }
        for _ in 0..100 {
            let next_ms = pair.robot.now_ms() + 1;
            pair.robot.advance_to(next_ms);
            bytes.clear();
            pair.robot.receive(&mut bytes);
            pair.session.handle_bytes(&bytes, next_ms);
            pair.session.handle_timeout(next_ms);
            while pair.session.poll_event().is_some() {}
            state = hash(state, &bytes);
            let pins = pair.robot.motors();
            state = hash(state, &[pins.towards_first, pins.towards_last]);
            for position in pair.robot.joints() {
                state = hash(state, &position.to_bits().to_le_bytes());
            }
            let pose = pair.robot.pose();
            for value in [pose.x_m, pose.y_m, pose.heading_rad, pose.roll_rad] {
                state = hash(state, &value.to_bits().to_le_bytes());
            }
        }
        if turn % 30 == 29 {
            state = hash(state, &pair.robot.picture().rgb);
        }
    }
    state
}

#[test]
fn the_same_seed_gives_the_same_run() {
    assert_eq!(trace(11), trace(11));
    assert_ne!(trace(11), trace(12));
}

#[test]
fn values_out_of_range_make_no_robot() {
    let with = |change: fn(&mut VirtualRobotConfig)| {
        let mut config = VirtualRobotConfig::default();
        change(&mut config);
        VirtualRobot::new(config).expect_err("refused").to_string()
    };
    assert!(with(|config| config.baud = 0).contains("0 baud"));
    assert!(with(|config| config.clock_mhz = 41).contains("4, 10, 20 and 40"));
    assert!(with(|config| config.camera.noise_sigma = f64::NAN).contains("noise"));
}

/// Something that happens to a robot from outside.
#[derive(Debug, Clone)]
enum Happening {
    Bytes(Vec<u8>),
    Press(usize, bool),
    Bumper(usize, Contact),
    Switch(Joint, Contact),
    Stick(Joint, bool),
    Move(Joint, f64),
    Put(f64, f64, f64),
    Supply(u32),
    MotorSupply(u32),
    Hang(Address),
    PowerCycle,
    BrownOut,
}

fn happenings() -> impl proptest::strategy::Strategy<Value = Vec<Happening>> {
    use proptest::prelude::*;
    let joint = || proptest::sample::select(Joint::ALL.as_slice());
    let contact = || {
        proptest::sample::select(vec![Contact::Working, Contact::StuckOpen, Contact::StuckClosed])
    };
    let one = prop_oneof![
        proptest::collection::vec(any::<u8>(), 0..60).prop_map(Happening::Bytes),
        (0..8_usize, any::<bool>()).prop_map(|(index, held)| Happening::Press(index, held)),
        (0..8_usize, contact()).prop_map(|(index, contact)| Happening::Bumper(index, contact)),
        (joint(), contact()).prop_map(|(joint, contact)| Happening::Switch(joint, contact)),
        (joint(), any::<bool>()).prop_map(|(joint, stuck)| Happening::Stick(joint, stuck)),
        (joint(), any::<f64>()).prop_map(|(joint, to)| Happening::Move(joint, to)),
        (-3.0..3.0, -3.0..3.0, -4.0..4.0).prop_map(|(x, y, heading)| Happening::Put(x, y, heading)),
        (0..9000_u32).prop_map(Happening::Supply),
        (0..9000_u32).prop_map(Happening::MotorSupply),
        proptest::sample::select(Address::ALL.as_slice()).prop_map(Happening::Hang),
        Just(Happening::PowerCycle),
        Just(Happening::BrownOut),
    ];
    proptest::collection::vec(one, 0..12)
}

proptest::proptest! {
    #![proptest_config(proptest::test_runner::Config::with_cases(64))]

    #[test]
    fn whatever_happens_silence_ends_motion_and_joints_stay_between_their_stops(
        happenings in happenings(),
        pause_ms in 0..120_u64,
    ) {
        let mut pair = Pair::in_world(World::demo());
        pair.init();
        pair.queue_walk(2, BumperMask::NONE);
        let robot = &mut pair.robot;
        for happening in happenings {
            match happening {
                Happening::Bytes(bytes) => robot.send(&bytes),
                Happening::Press(index, held) => robot.press_bumper(index, held),
                Happening::Bumper(index, contact) => robot.set_bumper(index, contact),
                Happening::Switch(arm, contact) => robot.set_switch(arm, contact),
                Happening::Stick(joint, stuck) => robot.stick_joint(joint, stuck),
                Happening::Move(joint, to) => robot.move_joint(joint, to),
                Happening::Put(x_m, y_m, heading_rad) => robot.put_at(x_m, y_m, heading_rad),
                Happening::Supply(millivolts) => robot.set_supply_mv(millivolts),
                Happening::MotorSupply(millivolts) => robot.set_motor_supply_mv(millivolts),
                Happening::Hang(controller) => robot.hang(controller).expect("the model hangs"),
                Happening::PowerCycle => robot.power_cycle(),
                Happening::BrownOut => robot.brown_out(),
            }
            robot.advance_to(robot.now_ms() + pause_ms);
        }
        // What was sent is through, and then the dead-man's time passes.
        while robot.is_line_busy() {
            robot.advance_to(robot.now_ms() + 1);
        }
        robot.advance_to(robot.now_ms() + u64::from(Parameter::DEAD_MAN_MS_DEFAULT));
        proptest::prop_assert_eq!(robot.motors(), MotorPins::default());
        for position in robot.joints() {
            proptest::prop_assert!((0.0..=1.0).contains(&position));
        }
        let pose = robot.pose();
        proptest::prop_assert!(pose.x_m.is_finite() && pose.y_m.is_finite());
    }
}
