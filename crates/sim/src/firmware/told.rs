//! What the controllers told of themselves on the line.

use rsapien_firmware_model::{CameraController, MotionController, ResetCause};
use rsapien_protocol::{
    CameraReport, Direction, Fed, MotionReport, Receiver, Report, SynchronizationPackage,
};

use crate::electronics::MOTION;

/// The last report of each controller since its reset. One that has not answered anything has executed nothing, so a
/// fresh controller's stands there until then.
#[derive(Debug)]
pub(super) struct Told {
    /// An ear at each transmitter, before anything on the line can damage what it sends.
    ears: [Receiver; 2],
    motion: MotionReport,
    camera: CameraReport,
}

impl Told {
    /// Nothing yet, after a reset for this reason.
    pub(super) fn new(cause: ResetCause) -> Self {
        Self {
            ears: [Receiver::listening(Direction::ToPc), Receiver::listening(Direction::ToPc)],
            motion: MotionController::new(cause, 0).report(),
            camera: CameraController::new(cause, 0).report(),
        }
    }

    /// A controller has reset itself.
    pub(super) fn restart(&mut self, controller: usize, cause: ResetCause) {
        let fresh = Self::new(cause);
        if controller == MOTION {
            self.motion = fresh.motion;
        } else {
            self.camera = fresh.camera;
        }
    }

    /// A byte that the transmitter of `controller` has sent.
    pub(super) fn take(&mut self, controller: usize, byte: u8) {
        // Gaps need no watching: a header begins every package anew.
        let Some(Fed::Package(content)) =
            self.ears.get_mut(controller).map(|ear| ear.feed(byte, 0))
        else {
            return;
        };
        let package = SynchronizationPackage::parse(&content);
        match package.map(|package| package.report) {
            Ok(Report::Motion(report)) => self.motion = report,
            Ok(Report::Camera(report)) => self.camera = report,
            _ => {}
        }
    }

    pub(super) fn motion(&self) -> MotionReport {
        self.motion
    }

    pub(super) fn camera(&self) -> CameraReport {
        self.camera
    }
}
