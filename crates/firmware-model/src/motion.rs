//! The motion controller (paper, section 2: the PIC18F452): its timer routine and its main
//! routine, and what requests do.
//!
//! ```text
//!   reset ──► Fresh
//!   any mode ── INIT ──► Initialising
//!   any mode ── STOP ──► Stopped
//!   any mode in which something moves ── dead-man trips ──► Held
//!
//!                   every joint rests, no step waits
//!   Initialising ───────────────────────────────────────► Idle
//!        │                                                │  ▲
//!        │ every joint rests,                        STEP │  │ duration over, no step waits
//!        │ a step waits                                   ▼  │
//!        └────────────────────────────────────────────► Executing ─┐ duration over, a step waits:
//!                                                         ▲  │ ▲   │ it starts; STEP, replace:
//!   Stopped ── STEP, if INIT has ended since reset ───────┘  │ └───┘ the new one starts
//!                                                            │
//!   Held ◄── ending bumper pressed, or pressed when its step ┘
//!            starts
//! ```
//!
//! The mode tells of the queue: a motor whose joint has not arrived runs on while the mode is
//! already idle, until the joint arrives. The dead-man watches such a motor too.

use rsapien_protocol::{
    Address, BumperMask, Joint, LineError, Mode, MotionReport, Parameter, Pose, Report, Request,
    Status, Step, StopCause,
};

use crate::arm::{self, MiddleSwitches};
use crate::bumper::Bumpers;
use crate::command::Verdict;
use crate::communication::Communication;
use crate::joint::{JointDrive, JointState, MotorOutput};
use crate::queue::{QUEUE_LENGTH, Queue, QueuedStep};
use crate::{Controller, Inputs, ResetCause};

/// The watchdog's time of the motion controller: 18 ms nominal, postscaler 8.
pub const MOTION_WATCHDOG_MS: u8 = 144;

/// Full travel times at reset, in ms, in the order of the joints' indices.
pub const FULL_TRAVEL_MS_DEFAULT: [u16; Joint::COUNT] = Joint::FULL_TRAVEL_MS;

/// The outputs of the seven motors, in the order of the joints' indices.
pub type MotorOutputs = [MotorOutput; Joint::COUNT];

/// The reference model of the motion controller.
#[derive(Clone, Debug)]
pub struct MotionController {
    communication: Communication,
    mode: Mode,
    /// INIT has ended since reset and no other was begun, so STEP is accepted.
    initialised: bool,
    joints: [JointDrive; Joint::COUNT],
    queue: Queue,
    /// Ticks until the running step ends; one runs exactly in mode executing.
    step_remaining_ms: u16,
    /// Bumpers that end the action while the running step runs.
    step_ending_bumpers: BumperMask,
    steps_ended: u16,
    bumpers: Bumpers,
    bumpers_tested_ms: u64,
    switches: MiddleSwitches,
    supply_low: bool,
}

impl MotionController {
    /// The controller as it leaves a reset: every motor off, no session, not initialised.
    /// `eeprom_boot` is the boot number that the EEPROM kept, which becomes one more.
    pub const fn new(reset_cause: ResetCause, eeprom_boot: u8) -> MotionController {
        const JOINTS: [JointDrive; Joint::COUNT] = {
            let mut joints = [const { JointDrive::new(0) }; Joint::COUNT];
            let mut index = 0;
            while index < Joint::COUNT {
                joints[index] = JointDrive::new(FULL_TRAVEL_MS_DEFAULT[index]);
                index += 1;
            }
            joints
        };
        MotionController {
            communication: Communication::new(
                Address::Motion,
                reset_cause,
                eeprom_boot,
                MOTION_WATCHDOG_MS,
            ),
            mode: Mode::Fresh,
            initialised: false,
            joints: JOINTS,
            queue: Queue::new(),
            step_remaining_ms: 0,
            step_ending_bumpers: BumperMask::NONE,
            steps_ended: 0,
            bumpers: Bumpers::new(),
            bumpers_tested_ms: 0,
            switches: MiddleSwitches { left: false, right: false },
            supply_low: false,
        }
    }

    /// The same controller, built for a clock of `clock_mhz` (4, 10, 20 or 40); HELLO tells it.
    #[must_use]
    pub const fn with_clock_mhz(mut self, clock_mhz: u8) -> MotionController {
        self.communication.clock_mhz = clock_mhz;
        self
    }

    /// The motors' outputs as they stand on the pins.
    pub fn motors(&self) -> MotorOutputs {
        core::array::from_fn(|index| self.joints[index].output())
    }

    /// What `joint` is doing.
    pub const fn joint_state(&self, joint: Joint) -> JointState {
        self.joints[joint.index() as usize].state
    }

    /// The reckoned position of `joint` in ms of travel from its first end stop.
    pub const fn joint_position_ms(&self, joint: Joint) -> u16 {
        self.joints[joint.index() as usize].position_ms
    }

    /// The full travel time of `joint` in ms, as configured.
    pub const fn full_travel_ms(&self, joint: Joint) -> u16 {
        self.joints[joint.index() as usize].full_travel_ms
    }

    /// The number of the open session; 0: none.
    pub const fn session(&self) -> u8 {
        self.communication.command.session()
    }

    /// The last sequence number executed in the open session; 0 when none was.
    pub const fn last_sequence(&self) -> u8 {
        self.communication.command.last_sequence()
    }

    /// The counts that COUNTERS tells.
    pub const fn counters(&self) -> rsapien_protocol::CountersReport {
        self.communication.counters_report()
    }

    /// What the controller would report now.
    pub fn report(&self) -> MotionReport {
        let mut motors = 0;
        let mut pose_reached = Pose::EMPTY;
        for (joint, drive) in Joint::ALL.into_iter().zip(&self.joints) {
            motors |= u8::from(!drive.is_resting()) << joint.index();
            pose_reached = pose_reached.with(joint, drive.reached);
        }
        MotionReport {
            mode: self.mode,
            bumpers: self.bumpers.pressed(),
            middle_switches: [self.switches.left, self.switches.right],
            presses: self.bumpers.presses(),
            motors,
            supply_low: self.supply_low,
            pose_reached,
            queue_free: self.queue.free(),
            steps_ended: self.steps_ended,
            boot: self.communication.boot,
            reception_errors: self.communication.reception_errors(),
            cause: self.communication.cause,
        }
    }

    /// The secondary routine (paper, section 2): the input state of the mid-arm switches has
    /// changed. Nothing happens when it has not.
    pub fn input_change_interrupt(&mut self, inputs: Inputs) {
        let before = self.switches;
        self.switches = inputs.middle_switches;
        for (joint, drive) in Joint::ALL.into_iter().zip(&mut self.joints) {
            if let Some(closed) = self.switches.closed(joint)
                && before.closed(joint) != Some(closed)
            {
                arm::switch_changed(drive, closed);
            }
        }
    }

    /// The timer routine: 1 ms has passed. It moves the robot.
    pub fn timer_interrupt(&mut self) {
        if self.communication.tick() {
            self.reset(ResetCause::Watchdog);
            return;
        }
        for (joint, drive) in Joint::ALL.into_iter().zip(&mut self.joints) {
            drive.advance(self.switches.closed(joint));
        }
        let moving = self.is_moving();
        if self.communication.dead_man.trips_now(moving) {
            self.hold(StopCause::DeadMan);
        }
        match self.mode {
            Mode::Initialising if self.every_joint_rests() => {
                self.initialised = true;
                self.start_next_step();
            }
            Mode::Executing => {
                self.step_remaining_ms = self.step_remaining_ms.saturating_sub(1);
                if self.step_remaining_ms == 0 {
                    self.steps_ended = self.steps_ended.wrapping_add(1);
                    self.start_next_step();
                }
            }
            _ => {}
        }
    }

    /// One pass of the main routine: analyses one request, starts its action, initiates the
    /// response and tests the bumpers.
    pub fn main_routine(&mut self, inputs: Inputs) {
        if self.communication.hung {
            return;
        }
        self.communication.watchdog.clear();
        self.supply_low = inputs.supply_low;
        if let Some(content) = self.communication.next_package() {
            let status = match self.communication.analyse(&content) {
                Verdict::Answered(status) => status,
                Verdict::Execute(request) => {
                    let status = self.execute(request);
                    self.communication.executed(&content, request, status);
                    status
                }
            };
            self.communication.owe_answer(&content, status);
        }
        if let Some(answer) = self.communication.transmission.take_owed() {
            let common = self.communication.common_report(answer, QUEUE_LENGTH);
            let report = common.unwrap_or_else(|| Report::Motion(self.report()));
            self.communication.initiate_response(answer, report);
        }
        if self.bumpers_tested_ms != self.communication.now_ms {
            self.bumpers_tested_ms = self.communication.now_ms;
            self.test_bumpers(inputs.bumpers);
        }
    }

    fn test_bumpers(&mut self, pins: BumperMask) {
        self.bumpers.test(pins);
        if self.mode == Mode::Executing && self.bumper_ends(self.step_ending_bumpers) {
            self.hold(StopCause::Bumper);
        }
    }

    fn bumper_ends(&self, ending_bumpers: BumperMask) -> bool {
        !self.bumpers.pressed().intersection(ending_bumpers).is_empty()
    }

    fn execute(&mut self, request: Request) -> Status {
        match request {
            Request::Stop => self.all_off(Mode::Stopped),
            Request::Init => self.initialise(),
            Request::Step(step) => return self.accept_step(step),
            Request::Configure(Parameter::DeadMan { timeout_ms }) => {
                self.communication.dead_man.configure(timeout_ms);
            }
            Request::Configure(Parameter::TravelTime { joint, full_travel_ms }) => {
                self.joints[usize::from(joint.index())].configure(full_travel_ms);
            }
            // STATE and COUNTERS ask for nothing but their answer; the others never come here.
            Request::State
            | Request::Counters
            | Request::Hello { .. }
            | Request::Aim(_)
            | Request::Home => {}
        }
        Status::Accepted
    }

    fn initialise(&mut self) {
        self.queue.clear();
        self.initialised = false;
        self.steps_ended = 0;
        self.mode = Mode::Initialising;
        for drive in &mut self.joints {
            drive.home();
        }
    }

    fn accept_step(&mut self, step: Step) -> Status {
        if !self.initialised && self.mode != Mode::Initialising {
            return Status::NotInitialised;
        }
        if self.mode == Mode::Held {
            return Status::Held;
        }
        if step.replace {
            self.queue.clear();
        }
        if !self.queue.append(step) {
            return Status::QueueFull;
        }
        let waits = match self.mode {
            Mode::Initialising => true,
            Mode::Executing => !step.replace,
            _ => false,
        };
        if !waits {
            self.start_next_step();
        }
        Status::Accepted
    }

    /// Starts the next step, or is idle when none waits.
    fn start_next_step(&mut self) {
        let Some(step) = self.queue.take() else {
            self.mode = Mode::Idle;
            return;
        };
        let QueuedStep { pose, duration_ms, ending_bumpers } = step;
        if self.bumper_ends(ending_bumpers) {
            self.hold(StopCause::Bumper);
            return;
        }
        self.mode = Mode::Executing;
        self.step_remaining_ms = duration_ms;
        self.step_ending_bumpers = ending_bumpers;
        for (joint, drive) in Joint::ALL.into_iter().zip(&mut self.joints) {
            if let Some(position) = pose.get(joint) {
                drive.send(position, self.switches.closed(joint));
            }
        }
    }

    fn hold(&mut self, cause: StopCause) {
        self.communication.cause = cause;
        self.all_off(Mode::Held);
    }

    fn all_off(&mut self, mode: Mode) {
        for drive in &mut self.joints {
            drive.stop();
        }
        self.queue.clear();
        self.mode = mode;
    }

    fn every_joint_rests(&self) -> bool {
        self.joints.iter().all(JointDrive::is_resting)
    }

    fn is_moving(&self) -> bool {
        matches!(self.mode, Mode::Initialising | Mode::Executing) || !self.every_joint_rests()
    }
}

impl Controller for MotionController {
    fn address(&self) -> Address {
        self.communication.address
    }

    fn mode(&self) -> Mode {
        self.mode
    }

    fn receive_interrupt(&mut self, byte: u8) {
        self.communication.reception.receive_byte(byte);
    }

    fn receive_error(&mut self, error: LineError) {
        self.communication.reception.receive_error(error);
    }

    fn transmit_interrupt(&mut self) -> Option<u8> {
        self.communication.transmission.next_byte()
    }

    fn is_transmitting(&self) -> bool {
        !self.communication.transmission.is_idle()
    }

    fn tick(&mut self, inputs: Inputs) {
        self.timer_interrupt();
        self.input_change_interrupt(inputs);
        self.main_routine(inputs);
    }

    fn reset(&mut self, cause: ResetCause) {
        let clock_mhz = self.communication.clock_mhz;
        *self = MotionController::new(cause, self.communication.boot).with_clock_mhz(clock_mhz);
    }

    fn hang(&mut self) {
        self.communication.hung = true;
    }

    fn eeprom_boot(&self) -> u8 {
        self.communication.boot
    }
}
