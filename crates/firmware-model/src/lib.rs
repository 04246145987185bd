#![doc = include_str!("../README.md")]
#![no_std]

mod arm;
mod axis;
mod bumper;
mod camera;
mod command;
mod communication;
mod deadman;
mod joint;
mod motion;
mod queue;
mod reception;
mod transmission;
mod watchdog;

pub use arm::{MiddleSwitches, switch_half_window_ms};
pub use axis::AXIS_SPEED_MAX_DEG_PER_S;
pub use bumper::BUMPER_DEBOUNCE_TESTS;
pub use camera::{CAMERA_WATCHDOG_MS, CameraController, CameraOutputs, HOME_SETTLE_MS};
pub use joint::{DEAD_TIME_MS, JointState, MotorOutput, overrun_ms};
pub use motion::{FULL_TRAVEL_MS_DEFAULT, MOTION_WATCHDOG_MS, MotionController, MotorOutputs};
pub use queue::QUEUE_LENGTH;
pub use reception::RECEIVE_RING_LENGTH;

use rsapien_protocol::{Address, BumperMask, LineError, Mode, StopCause};

/// The firmware's version that HELLO tells: major, minor, patch.
pub const FIRMWARE_VERSION: [u8; 3] = [0, 1, 0];

/// The clock that the firmware is built for when nothing else is said, in MHz.
pub const CLOCK_MHZ_DEFAULT: u8 = 40;

/// Why a controller starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ResetCause {
    /// The power came on, or somebody pressed the reset button.
    PowerOn,
    /// The supply sagged below what the controller needs.
    BrownOut,
    /// The main routine did not run for the watchdog's time.
    Watchdog,
}

impl ResetCause {
    /// How a report tells it.
    pub const fn stop_cause(self) -> StopCause {
        match self {
            ResetCause::PowerOn => StopCause::PowerOn,
            ResetCause::BrownOut => StopCause::BrownOut,
            ResetCause::Watchdog => StopCause::Watchdog,
        }
    }
}

/// The input pins of the motion controller, as the robot's body drives them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Inputs {
    /// Bumpers pressed, not yet debounced.
    pub bumpers: BumperMask,
    /// The mid-arm switches.
    pub middle_switches: MiddleSwitches,
    /// The supply is below 5 V.
    pub supply_low: bool,
}

/// What a simulator or a comparison does with either controller. One millisecond is: the bytes
/// that came on the line by [`receive_interrupt`](Controller::receive_interrupt), then
/// [`tick`](Controller::tick), then as many bytes out of
/// [`transmit_interrupt`](Controller::transmit_interrupt) as the line carries.
pub trait Controller {
    /// The controller's address on the line.
    fn address(&self) -> Address;

    /// What the controller is doing.
    fn mode(&self) -> Mode;

    /// The receive interrupt routine: the UART has received `byte`.
    fn receive_interrupt(&mut self, byte: u8);

    /// The receive interrupt routine: the UART could not receive a byte.
    fn receive_error(&mut self, error: LineError);

    /// The transmit interrupt routine: the UART can take the next byte. None when there is none
    /// to send.
    fn transmit_interrupt(&mut self) -> Option<u8>;

    /// Whether bytes of a response wait to be handed out.
    fn is_transmitting(&self) -> bool;

    /// One millisecond in the defined order: timer interrupt, input change interrupt, one pass
    /// of the main routine. The camera controller has no input pins and does not look at
    /// `inputs`.
    fn tick(&mut self, inputs: Inputs);

    /// Resets the controller. Everything is as after `new`, but for the boot number, which is
    /// one more, and the clock.
    fn reset(&mut self, cause: ResetCause);

    /// A fault: from now on the main routine does not run, until a reset. Interrupts do.
    fn hang(&mut self);

    /// The boot number, as it stands in the EEPROM.
    fn eeprom_boot(&self) -> u8;
}
