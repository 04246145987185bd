//! The control interface architecture of the paper (section 3, Fig. 6): the user has to hold a
//! controller in order to issue requests to the robot or to read feedback from it.
//!
//! A controller has one holder at a time. It is released when it is dropped.

mod camera;
mod motion;
mod sensors;

use std::sync::Arc;

use rsapien_protocol::{Address, Request};

pub use camera::CameraController;
pub use motion::MotionController;
pub use sensors::SensorsController;

use crate::robot::Inner;
use crate::{Error, RobotState};

/// One of the controllers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Controller {
    Motion = 0,
    Camera = 1,
    Sensors = 2,
}

impl Controller {
    pub(crate) const COUNT: usize = 3;

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Controller::Motion => "motion",
            Controller::Camera => "camera",
            Controller::Sensors => "sensors",
        }
    }

    /// The controller on the line behind it. The bumpers are the motion controller's.
    const fn address(self) -> Address {
        match self {
            Controller::Motion | Controller::Sensors => Address::Motion,
            Controller::Camera => Address::Camera,
        }
    }
}

/// A controller that is held: what all of them have in common.
pub(crate) struct Held {
    pub(crate) inner: Arc<Inner>,
    controller: Controller,
}

impl Held {
    fn take(inner: &Arc<Inner>, controller: Controller) -> Result<Held, Error> {
        inner.take(controller)?;
        Ok(Held { inner: Arc::clone(inner), controller })
    }

    fn take_with_session(inner: &Arc<Inner>, controller: Controller) -> Result<Held, Error> {
        let held = Held::take(inner, controller)?;
        let address = controller.address();
        let is_open = {
            let state = inner.line.state();
            let index = usize::from(address == Address::Camera);
            state.sessions.get(index).is_some_and(Option::is_some)
        };
        if !is_open {
            inner.line.open(address)?.accepted()?;
        }
        // HELLO is answered with another report than the state's.
        held.refresh()?;
        Ok(held)
    }

    fn refresh(&self) -> Result<RobotState, Error> {
        self.inner.line.request(self.controller.address(), Request::State)?.accepted()?;
        Ok(self.inner.line.state())
    }
}

impl Drop for Held {
    fn drop(&mut self) {
        self.inner.release(self.controller);
    }
}

/// Gives a controller what all of them have in common.
macro_rules! feedback {
    ($controller:ty) => {
        impl $controller {
            /// The newest state of the whole robot, as it was reported last.
            pub fn state(&self) -> $crate::RobotState {
                self.held.inner.line.state()
            }

            /// Asks for the state now, and waits for it.
            ///
            /// # Errors
            /// [`Error::NoAnswer`](crate::Error::NoAnswer) and others of the line.
            pub fn refresh(&self) -> Result<$crate::RobotState, $crate::Error> {
                self.held.refresh()
            }

            /// Waits, at most `limit_ms` of the line's clock, for a state that fulfils
            /// `condition`. None when the limit passed.
            ///
            /// # Errors
            /// [`Error::Closed`](crate::Error::Closed).
            pub fn wait_for(
                &self,
                limit_ms: u64,
                condition: impl FnMut(&$crate::RobotState) -> bool,
            ) -> Result<Option<$crate::RobotState>, $crate::Error> {
                self.held.inner.line.wait_for(limit_ms, condition)
            }

            /// The line's clock in ms.
            pub fn now_ms(&self) -> u64 {
                self.held.inner.line.now_ms()
            }

            /// Lets `duration_ms` pass on the line's clock, with heartbeats going on.
            ///
            /// # Errors
            /// [`Error::Closed`](crate::Error::Closed).
            pub fn sleep_ms(&self, duration_ms: u64) -> Result<(), $crate::Error> {
                self.held.inner.line.sleep_ms(duration_ms)
            }
        }
    };
}
use feedback;
