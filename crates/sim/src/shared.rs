//! One robot for several threads.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::camera::{Picture, VisibleEllipse};
use crate::robot::{RobotReading, VirtualRobot};

/// A handle to a robot that several threads share: a link, a pacer, a camera. Clones are the same robot.
#[derive(Debug, Clone)]
pub struct SharedRobot(Arc<Mutex<VirtualRobot>>);

impl SharedRobot {
    /// Shares a robot.
    pub fn new(robot: VirtualRobot) -> Self {
        Self(Arc::new(Mutex::new(robot)))
    }

    /// The robot, for this thread alone until the guard is dropped. Keep it short: time stands still for the others.
    pub fn lock(&self) -> MutexGuard<'_, VirtualRobot> {
        // A thread that panicked left a robot at most a ms apart; the others may go on with it.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What the camera sees now, rendered while the others go on.
    pub fn picture(&self) -> Picture {
        let view = self.lock().view();
        view.picture()
    }

    /// Every ellipse that the camera can see now, exactly.
    pub fn ground_truth(&self) -> Vec<VisibleEllipse> {
        let view = self.lock().view();
        view.ground_truth()
    }

    /// The truth about the robot now.
    pub fn reading(&self) -> RobotReading {
        self.lock().reading()
    }
}
