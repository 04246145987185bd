//! The camera controller (paper, section 2: the PIC18F2320): one routine for each axis, one that
//! monitors the global position, and a main routine like that of the motion controller.
//!
//! ```text
//!                     HOME                           at zero, no AIM waits
//!   Fresh, Idle, ─────────────► Initialising ───────────────────────────────► Idle
//!   Executing,                      │ at zero, an AIM waits              AIM   │  ▲ both axes
//!   Stopped, Held                   ▼                                          │  │ arrived
//!       ▲     ▲                 Executing ◄────────────────────────────────────┘  │
//!       │     │ dead-man            │  └──────────────────────────────────────────┘
//!       │ STOP└─────── Held ◄───────┘          Stopped ── AIM, if homed ──► Executing
//!    Stopped                                   Held ── AIM: refused; HOME and STOP release
//! ```
//!
//! The axes are hobby servos. At reset they get no pulses and may stand anywhere. The first HOME
//! gives both the pulses of zero and waits [`HOME_SETTLE_MS`], by when the slowest has come from
//! its limit; a later HOME goes to zero at full speed. An AIM that comes during HOME waits for
//! its end; a newer one takes its place. Stopped and held axes keep the pulses of where they
//! are, since a servo without pulses lets the camera sag; before the first HOME has ended they
//! lose them, since only that stops a servo that is on its way from an unknown place.

use rsapien_protocol::{
    Address, AimTarget, AxisFlags, CameraReport, CountersReport, LineError, Mode, Parameter,
    Report, Request, Status, StopCause,
};

use crate::axis::Axis;
use crate::command::Verdict;
use crate::communication::Communication;
use crate::{Controller, Inputs, ResetCause};

/// The watchdog's time of the camera controller: 4 ms nominal, postscaler 32.
pub const CAMERA_WATCHDOG_MS: u8 = 128;

/// How long the first HOME waits for the servos to come to zero, in ms: 90 degrees at the
/// speed the head can, and half as much again.
pub const HOME_SETTLE_MS: u16 = 750;

/// The position commanded to each servo, in 0.01 degree; none: no pulses, the servo is limp.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct CameraOutputs {
    /// Right of straight ahead, -9000..=9000.
    pub pan_centideg: Option<i16>,
    /// Above straight ahead, -4500..=4500.
    pub tilt_centideg: Option<i16>,
}

/// The reference model of the camera controller.
#[derive(Clone, Debug)]
pub struct CameraController {
    communication: Communication,
    mode: Mode,
    /// A HOME has ended since reset, so AIM is accepted.
    homed: bool,
    /// The servos get pulses.
    driven: bool,
    pan: Axis,
    tilt: Axis,
    /// Ticks that the first HOME waits still.
    settle_ms: u16,
    /// The AIM that waits for the end of HOME.
    waiting: Option<AimTarget>,
}

impl CameraController {
    /// The controller as it leaves a reset: no pulses, no session, not homed. `eeprom_boot` is
    /// the boot number that the EEPROM kept, which becomes one more.
    pub const fn new(reset_cause: ResetCause, eeprom_boot: u8) -> CameraController {
        CameraController {
            communication: Communication::new(
                Address::Camera,
                reset_cause,
                eeprom_boot,
                CAMERA_WATCHDOG_MS,
            ),
            mode: Mode::Fresh,
            homed: false,
            driven: false,
            pan: Axis::PAN,
            tilt: Axis::TILT,
            settle_ms: 0,
            waiting: None,
        }
    }

    /// The same controller, built for a clock of `clock_mhz` (4, 10, 20 or 40); HELLO tells it.
    #[must_use]
    pub const fn with_clock_mhz(mut self, clock_mhz: u8) -> CameraController {
        self.communication.clock_mhz = clock_mhz;
        self
    }

    /// The positions commanded to the servos.
    pub fn outputs(&self) -> CameraOutputs {
        CameraOutputs {
            pan_centideg: self.driven.then_some(self.pan.position_centideg),
            tilt_centideg: self.driven.then_some(self.tilt.position_centideg),
        }
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
    pub const fn counters(&self) -> CountersReport {
        self.communication.counters_report()
    }

    /// What the controller would report now.
    pub const fn report(&self) -> CameraReport {
        let settling = self.settle_ms > 0;
        CameraReport {
            mode: self.mode,
            pan_centideg: self.pan.position_centideg,
            tilt_centideg: self.tilt.position_centideg,
            pan_target_centideg: self.pan.target_centideg,
            tilt_target_centideg: self.tilt.target_centideg,
            axes: AxisFlags {
                pan_moving: settling || self.pan.is_moving(),
                tilt_moving: settling || self.tilt.is_moving(),
                pan_at_limit: self.pan.is_at_limit(),
                tilt_at_limit: self.tilt.is_at_limit(),
            },
            boot: self.communication.boot,
            reception_errors: self.communication.reception_errors(),
            cause: self.communication.cause,
        }
    }

    /// The timer routine: 1 ms has passed. It runs the routines of both axes and the monitor.
    pub fn timer_interrupt(&mut self) {
        if self.communication.tick() {
            self.reset(ResetCause::Watchdog);
            return;
        }
        self.pan.advance();
        self.tilt.advance();
        self.monitor_global_position();
    }

    /// One pass of the main routine: analyses one request, starts its action and initiates the
    /// response.
    pub fn main_routine(&mut self) {
        if self.communication.hung {
            return;
        }
        self.communication.watchdog.clear();
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
            let common = self.communication.common_report(answer, 0);
            let report = common.unwrap_or_else(|| Report::Camera(self.report()));
            self.communication.initiate_response(answer, report);
        }
    }

    /// The routine that monitors the global position of the camera (paper, section 2).
    fn monitor_global_position(&mut self) {
        let moving = matches!(self.mode, Mode::Initialising | Mode::Executing);
        self.settle_ms = self.settle_ms.saturating_sub(1);
        if self.communication.dead_man.trips_now(moving) {
            self.communication.cause = StopCause::DeadMan;
            self.stop_axes(Mode::Held);
            return;
        }
        if !moving || self.settle_ms > 0 || self.pan.is_moving() || self.tilt.is_moving() {
            return;
        }
        self.homed = true;
        match self.waiting.take() {
            Some(target) => self.aim(target),
            None => self.mode = Mode::Idle,
        }
    }

    fn execute(&mut self, request: Request) -> Status {
        match request {
            Request::Stop => self.stop_axes(Mode::Stopped),
            Request::Home => self.home(),
            Request::Aim(target) => return self.accept_aim(target),
            Request::Configure(Parameter::DeadMan { timeout_ms }) => {
                self.communication.dead_man.configure(timeout_ms);
            }
            // STATE and COUNTERS ask for nothing but their answer; the others never come here.
            Request::Configure(Parameter::TravelTime { .. })
            | Request::State
            | Request::Counters
            | Request::Hello { .. }
            | Request::Init
            | Request::Step(_) => {}
        }
        Status::Accepted
    }

    fn home(&mut self) {
        self.mode = Mode::Initialising;
        self.driven = true;
        self.waiting = None;
        if !self.homed {
            self.settle_ms = HOME_SETTLE_MS;
        }
        self.pan.send(0, 0);
        self.tilt.send(0, 0);
    }

    fn accept_aim(&mut self, target: AimTarget) -> Status {
        if !self.homed && self.mode != Mode::Initialising {
            return Status::NotInitialised;
        }
        match self.mode {
            Mode::Held => return Status::Held,
            Mode::Initialising => self.waiting = Some(target),
            _ => self.aim(target),
        }
        Status::Accepted
    }

    fn aim(&mut self, target: AimTarget) {
        self.mode = Mode::Executing;
        self.pan.send(target.pan_centideg, target.speed_deg_per_s);
        self.tilt.send(target.tilt_centideg, target.speed_deg_per_s);
    }

    fn stop_axes(&mut self, mode: Mode) {
        self.pan.stop();
        self.tilt.stop();
        self.settle_ms = 0;
        self.waiting = None;
        self.driven = self.homed;
        self.mode = mode;
    }
}

impl Controller for CameraController {
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

    fn tick(&mut self, _inputs: Inputs) {
        self.timer_interrupt();
        self.main_routine();
    }

    fn reset(&mut self, cause: ResetCause) {
        let clock_mhz = self.communication.clock_mhz;
        *self = CameraController::new(cause, self.communication.boot).with_clock_mhz(clock_mhz);
    }

    fn hang(&mut self) {
        self.communication.hung = true;
    }

    fn eeprom_boot(&self) -> u8 {
        self.communication.boot
    }
}
