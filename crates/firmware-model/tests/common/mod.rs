//! A bench for either controller: a PC that sends and hears, a clock, and a simple body.
#![allow(dead_code, unreachable_pub, reason = "each test file uses its part of the bench")]

use rsapien_firmware_model::{
    CameraController, Controller, FULL_TRAVEL_MS_DEFAULT, Inputs, MiddleSwitches, MotionController,
    MotorOutput, ResetCause, switch_half_window_ms,
};
use rsapien_protocol::{
    ActionPackage, Address, CameraReport, Direction, Fed, HeaderByte, HelloReport, Joint,
    MotionReport, Pose, Position, Receiver, Report, Request, Status, Step, SynchronizationPackage,
    frame,
};

pub const SESSION: u8 = 7;

/// What a mid-arm switch of the body does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Switch {
    Works,
    StuckOpen,
    StuckClosed,
}

/// Joints that move by their motors' outputs, with end stops and mid-arm switches.
#[derive(Clone, Debug)]
pub struct Body {
    /// In thousandths of the way from the first end stop, times the default travel time.
    pub position_us: [i64; 7],
    /// How fast each joint truly is, in thousandths of what the firmware reckons.
    pub speed_permille: [i64; 7],
    pub switch: Switch,
}

impl Body {
    pub fn at_first() -> Body {
        Body { position_us: [0; 7], speed_permille: [1000; 7], switch: Switch::Works }
    }

    pub fn travel_us(joint: usize) -> i64 {
        i64::from(FULL_TRAVEL_MS_DEFAULT[joint]) * 1000
    }

    fn advance(&mut self, motors: [MotorOutput; 7]) {
        for (joint, motor) in motors.into_iter().enumerate() {
            let way = match motor {
                MotorOutput::Off => 0,
                MotorOutput::TowardsFirst => -self.speed_permille[joint],
                MotorOutput::TowardsLast => self.speed_permille[joint],
            };
            let position = self.position_us[joint] + way;
            self.position_us[joint] = position.clamp(0, Body::travel_us(joint));
        }
    }

    fn switches(&self) -> MiddleSwitches {
        let closed = |joint: Joint| match self.switch {
            Switch::Works => {
                let index = usize::from(joint.index());
                let window_ms = switch_half_window_ms(FULL_TRAVEL_MS_DEFAULT[index]);
                let off_middle = self.position_us[index] - Body::travel_us(index) / 2;
                off_middle.abs() <= i64::from(window_ms) * 1000
            }
            Switch::StuckOpen => false,
            Switch::StuckClosed => true,
        };
        MiddleSwitches { left: closed(Joint::LeftArm), right: closed(Joint::RightArm) }
    }

    /// How far `joint` is from its middle, in thousandths of its travel.
    pub fn off_middle_permille(&self, joint: usize) -> i64 {
        let travel_us = Body::travel_us(joint);
        (self.position_us[joint] - travel_us / 2).abs() * 1000 / travel_us
    }
}

/// The motion controller on the bench.
pub struct Motion {
    pub controller: MotionController,
    pub inputs: Inputs,
    pub body: Body,
    pub sequence: u8,
    now_ms: u64,
    epoch_ms: u64,
    heard: Receiver,
}

impl Motion {
    /// Just powered on.
    pub fn fresh() -> Motion {
        Motion {
            controller: MotionController::new(ResetCause::PowerOn, 0),
            inputs: Inputs::default(),
            body: Body::at_first(),
            sequence: 0,
            now_ms: 0,
            epoch_ms: 0,
            heard: Receiver::for_pc(),
        }
    }

    /// With [`SESSION`] open and nothing executed in it.
    pub fn in_session() -> Motion {
        let mut motion = Motion::fresh();
        motion.hello(SESSION);
        motion.begin();
        motion
    }

    /// Idle after INIT, every joint at its middle.
    pub fn initialised() -> Motion {
        let mut motion = Motion::in_session();
        motion.accepts(Request::Init);
        motion.finish_initialising();
        motion.begin();
        motion
    }

    pub fn finish_initialising(&mut self) {
        for _ in 0..100 {
            self.wait(50);
            let (_, report) = self.sends(Request::State);
            if report.mode != rsapien_protocol::Mode::Initialising {
                return;
            }
        }
        panic!("INIT does not end");
    }

    /// Calls now 0 ms, and lets the dead-man's silence begin here.
    pub fn begin(&mut self) {
        self.epoch_ms = self.now_ms;
        self.sends(Request::State);
    }

    /// Waits until `ms` after [`begin`](Motion::begin).
    #[track_caller]
    pub fn at(&mut self, ms: u64) -> &mut Motion {
        let ticks = (self.epoch_ms + ms).checked_sub(self.now_ms).expect("times go forwards");
        self.wait(ticks);
        self
    }

    pub fn wait(&mut self, ticks: u64) {
        for _ in 0..ticks {
            self.body.advance(self.controller.motors());
            self.inputs.middle_switches = self.body.switches();
            self.controller.tick(self.inputs);
            self.now_ms += 1;
        }
    }

    /// The line brings `bytes`, and the main routine makes a pass, all in the present tick.
    pub fn line_brings(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.controller.receive_interrupt(*byte);
        }
        self.controller.main_routine(self.inputs);
    }

    /// Everything the controller transmits now, as packages.
    pub fn hears(&mut self) -> Vec<SynchronizationPackage> {
        let mut packages = Vec::new();
        while let Some(byte) = self.controller.transmit_interrupt() {
            if let Fed::Package(content) = self.heard.feed(byte, self.now_ms) {
                packages.push(SynchronizationPackage::parse(&content).expect("a sound report"));
            }
        }
        packages
    }

    /// Sends a content and gives the answer to it.
    #[track_caller]
    pub fn sends_content(&mut self, content: [u8; 12]) -> SynchronizationPackage {
        let header = HeaderByte { direction: Direction::ToRobot, address: Address::Motion };
        self.line_brings(&frame::encode::<12, 18>(header, &content));
        let answers = self.hears();
        assert_eq!(answers.len(), 1, "one package, one answer");
        assert_eq!(answers[0].session, content[0]);
        assert_eq!(answers[0].sequence, content[1]);
        assert_eq!(answers[0].kind_byte, content[2]);
        answers[0]
    }

    #[track_caller]
    pub fn sends_numbered(&mut self, sequence: u8, request: Request) -> (Status, MotionReport) {
        let package = ActionPackage { session: SESSION, sequence, request };
        let answer = self.sends_content(package.content());
        let Report::Motion(report) = answer.report else { panic!("not the own report") };
        (answer.status, report)
    }

    /// Sends a request under the next sequence number, which an accepted one uses up.
    #[track_caller]
    pub fn sends(&mut self, request: Request) -> (Status, MotionReport) {
        let sequence = self.sequence.wrapping_add(1);
        let answer = self.sends_numbered(sequence, request);
        if answer.0.is_accepted() && request.kind().is_numbered() {
            self.sequence = sequence;
        }
        answer
    }

    #[track_caller]
    pub fn accepts(&mut self, request: Request) -> MotionReport {
        let (status, report) = self.sends(request);
        assert_eq!(status, Status::Accepted);
        report
    }

    #[track_caller]
    pub fn refuses(&mut self, request: Request, expected: Status) -> MotionReport {
        let (status, report) = self.sends(request);
        assert_eq!(status, expected);
        report
    }

    #[track_caller]
    pub fn hello(&mut self, session: u8) -> HelloReport {
        let request = Request::Hello { lowest_version: 1, highest_version: 1, session };
        let content = ActionPackage { session: 0, sequence: 0, request }.content();
        let answer = self.sends_content(content);
        assert_eq!(answer.status, Status::Accepted);
        let Report::Hello(report) = answer.report else { panic!("not HELLO's report") };
        report
    }

    pub fn motor(&self, joint: Joint) -> MotorOutput {
        self.controller.motors()[usize::from(joint.index())]
    }

    #[track_caller]
    pub fn all_off(&self) {
        assert_eq!(self.controller.motors(), [MotorOutput::Off; 7]);
    }
}

/// A step that sends one joint.
pub fn step(joint: Joint, position: Position, duration_ms: u16) -> Step {
    Step::new(Pose::EMPTY.with(joint, Some(position)), duration_ms)
}

/// A step that sends no joint.
pub fn pause(duration_ms: u16) -> Step {
    Step::new(Pose::EMPTY, duration_ms)
}

/// The camera controller on the bench.
pub struct Camera {
    pub controller: CameraController,
    pub sequence: u8,
    now_ms: u64,
    epoch_ms: u64,
    heard: Receiver,
}

impl Camera {
    pub fn in_session() -> Camera {
        let mut camera = Camera {
            controller: CameraController::new(ResetCause::PowerOn, 41),
            sequence: 0,
            now_ms: 0,
            epoch_ms: 0,
            heard: Receiver::for_pc(),
        };
        let request = Request::Hello { lowest_version: 1, highest_version: 1, session: SESSION };
        assert_eq!(camera.answer_to(1, request).status, Status::Accepted);
        camera
    }

    pub fn homed() -> Camera {
        let mut camera = Camera::in_session();
        camera.accepts(Request::Home);
        for ms in (0..=800).step_by(100) {
            camera.at(ms).accepts(Request::State);
        }
        camera.begin();
        camera
    }

    pub fn begin(&mut self) {
        self.epoch_ms = self.now_ms;
        self.accepts(Request::State);
    }

    #[track_caller]
    pub fn at(&mut self, ms: u64) -> &mut Camera {
        let ticks = (self.epoch_ms + ms).checked_sub(self.now_ms).expect("times go forwards");
        for _ in 0..ticks {
            self.controller.tick(Inputs::default());
            self.now_ms += 1;
        }
        self
    }

    #[track_caller]
    pub fn answer_to(&mut self, sequence: u8, request: Request) -> SynchronizationPackage {
        self.sends_content(ActionPackage { session: SESSION, sequence, request }.content())
    }

    #[track_caller]
    pub fn sends_content(&mut self, content: [u8; 12]) -> SynchronizationPackage {
        let header = HeaderByte { direction: Direction::ToRobot, address: Address::Camera };
        for byte in frame::encode::<12, 18>(header, &content) {
            self.controller.receive_interrupt(byte);
        }
        self.controller.main_routine();
        let mut answers = Vec::new();
        while let Some(byte) = self.controller.transmit_interrupt() {
            if let Fed::Package(content) = self.heard.feed(byte, self.now_ms) {
                assert_eq!(content.address(), Address::Camera);
                answers.push(SynchronizationPackage::parse(&content).expect("a sound report"));
            }
        }
        assert_eq!(answers.len(), 1, "one package, one answer");
        answers[0]
    }

    #[track_caller]
    pub fn sends(&mut self, request: Request) -> (Status, CameraReport) {
        let sequence = self.sequence.wrapping_add(1);
        let answer = self.answer_to(sequence, request);
        if answer.status.is_accepted() && request.kind().is_numbered() {
            self.sequence = sequence;
        }
        let Report::Camera(report) = answer.report else { panic!("not the own report") };
        (answer.status, report)
    }

    #[track_caller]
    pub fn accepts(&mut self, request: Request) -> CameraReport {
        let (status, report) = self.sends(request);
        assert_eq!(status, Status::Accepted);
        report
    }

    #[track_caller]
    pub fn refuses(&mut self, request: Request, expected: Status) {
        assert_eq!(self.sends(request).0, expected);
    }
}
