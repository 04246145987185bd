//! The sensors: bumpers on feet and hands, mid-arm switches, supply, and states as they come.

use std::sync::Arc;
use std::sync::mpsc::Receiver;

use rsapien_protocol::{Address, BumperMask, Kind, MotionReport};

use super::{Controller, Held, feedback};
use crate::robot::Inner;
use crate::{Error, RobotState};

/// How many states wait for a subscriber before it misses some.
const STATES_WAITING: usize = 64;

/// Feedback from the robot's sensors. See [`Robot::sensors`](crate::Robot::sensors).
pub struct SensorsController {
    held: Held,
}

feedback!(SensorsController);

impl SensorsController {
    pub(crate) fn take(inner: &Arc<Inner>) -> Result<SensorsController, Error> {
        Ok(SensorsController { held: Held::take(inner, Controller::Sensors)? })
    }

    /// Asks the motion controller now.
    fn report(&self) -> Result<MotionReport, Error> {
        let report = self.refresh()?.motion_report();
        report.ok_or(Error::BadReport { address: Address::Motion, kind: Kind::State })
    }

    /// The bumpers pressed now.
    ///
    /// # Errors
    /// [`Error::NoAnswer`] and others of the line; the same for the methods below.
    pub fn bumpers(&self) -> Result<BumperMask, Error> {
        Ok(self.report()?.bumpers)
    }

    /// How often each bumper was pressed since reset, modulo 16, in the order of the bumpers' bits.
    ///
    /// # Errors
    /// As [`bumpers`](SensorsController::bumpers).
    pub fn presses(&self) -> Result<[u8; BumperMask::COUNT], Error> {
        Ok(self.report()?.presses)
    }

    /// The mid-arm switches closed now: left, right.
    ///
    /// # Errors
    /// As [`bumpers`](SensorsController::bumpers).
    pub fn middle_switches(&self) -> Result<[bool; 2], Error> {
        Ok(self.report()?.middle_switches)
    }

    /// Whether the supply is below 5 V.
    ///
    /// # Errors
    /// As [`bumpers`](SensorsController::bumpers).
    pub fn supply_low(&self) -> Result<bool, Error> {
        Ok(self.report()?.supply_low)
    }

    /// Every state from now on, as it comes. Who reads too slowly misses the newest ones: 64 wait.
    /// With a virtual clock, states come while someone waits on the line.
    ///
    /// # Errors
    /// [`Error::Closed`].
    pub fn subscribe(&self) -> Result<Receiver<RobotState>, Error> {
        self.held.inner.line.subscribe(STATES_WAITING)
    }
}
