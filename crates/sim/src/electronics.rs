//! The robot's electronics: what stands between the line and the body.
//!
//! [`VirtualRobot`](crate::VirtualRobot) holds one implementation of [`Electronics`] and asks it for nothing but what
//! wires carry: bytes of the line, levels of the inputs, the motors' pins and the servos' pulses. There are two: the
//! firmware's reference model ([`Model`]), and the firmware itself in a simulator of its chips
//! ([`Firmware`](crate::firmware::Firmware)).

mod model;

pub(crate) use model::Model;

use std::fmt::Debug;

use rsapien_firmware_model::{CameraOutputs, Inputs, ResetCause};
use rsapien_protocol::{Address, CameraReport, MotionReport};

use crate::body::MotorPins;
use crate::firmware::FirmwareError;
use crate::line::Line;

/// Controllers in the order in which the line knows them.
pub(crate) const MOTION: usize = 0;
/// See [`MOTION`].
pub(crate) const CAMERA: usize = 1;

/// What was asked can be done to the model of the firmware only.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{what} works with the model of the firmware only: leave --firmware away for it")]
pub struct NotWithFirmware {
    /// What was asked.
    pub what: &'static str,
}

/// Both controllers, wired to the line and to the body.
pub(crate) trait Electronics: Debug + Send {
    /// Lives through the millisecond that begins at `start_ms`, with the inputs at these levels: takes the PC's bytes
    /// from the line and gives it the controllers'. Without power nothing is heard and nothing runs.
    fn run_ms(&mut self, line: &mut Line, start_ms: u64, inputs: Inputs, is_powered: bool);

    /// The motors' pins at the end of the last millisecond.
    fn motors(&self) -> MotorPins;

    /// The positions that the servos' pulses ask for.
    fn servos(&self) -> CameraOutputs;

    /// Power comes (back) for this reason: both controllers start anew.
    fn reset(&mut self, line: &mut Line, cause: ResetCause);

    /// Hangs the main routine of a controller until its watchdog resets it.
    fn hang(&mut self, controller: Address) -> Result<(), NotWithFirmware>;

    /// What the motion controller tells of itself: the model now, a firmware when it was last asked.
    fn motion_report(&self) -> MotionReport;

    /// What the camera controller tells of itself, as [`motion_report`](Electronics::motion_report).
    fn camera_report(&self) -> CameraReport;

    /// Whether bytes are on their way that the line does not know of.
    fn is_busy(&self) -> bool;

    /// Whether a firmware runs in a simulator of its chips, which takes about as long as the robot itself.
    fn is_firmware(&self) -> bool;

    /// Why the controllers are dead for good; none while they work.
    fn failure(&self) -> Option<&FirmwareError>;

    /// The same again, where that can be had.
    fn try_clone(&self) -> Option<Box<dyn Electronics>>;
}
