//! The motion controller: initialises the robot, queues steps, plays actions.

use std::sync::Arc;

use rsapien_protocol::{
    Address, BumperMask, CountersReport, Mode, MotionReport, Parameter, Pose, Primitive, Report,
    Request, Step,
};

use rsapien_registry::CompiledAction;

use super::{Controller, Held, feedback};
use crate::player::{self, CancelToken, PlayOptions, PlayReport, interruption};
use crate::robot::Inner;
use crate::{Error, Interruption};

/// How long initialisation may take, in ms: every joint the slowest way the robot can be told, one
/// after the other.
const INIT_LIMIT_MS: u64 = 120_000;
const POLL_MS: u64 = 50;

/// Moves the robot. See [`Robot::motion`](crate::Robot::motion).
///
/// Whoever lets go of it lets the motors stop: when it is dropped while the robot moves, STOP is
/// sent.
pub struct MotionController {
    held: Held,
}

feedback!(MotionController);

impl MotionController {
    pub(crate) fn take(inner: &Arc<Inner>) -> Result<MotionController, Error> {
        Ok(MotionController { held: Held::take_with_session(inner, Controller::Motion)? })
    }

    /// Initialises the robot and waits until every joint stands at its middle position (paper,
    /// section 2: the robot initialisation). It releases a hold.
    ///
    /// # Errors
    /// [`Error::Interrupted`] by STOP, the dead-man or a reset; [`Error::TimeLimit`]; those of the
    /// line.
    pub fn init(&mut self) -> Result<MotionReport, Error> {
        self.init_unless(&CancelToken::new())
    }

    /// As [`init`](MotionController::init); `cancel` stops the motors and ends it.
    ///
    /// # Errors
    /// As [`init`](MotionController::init).
    pub fn init_unless(&mut self, cancel: &CancelToken) -> Result<MotionReport, Error> {
        let kind = Request::Init.kind();
        let begun = self.request(Request::Init)?;
        let until_ms = self.now_ms().saturating_add(INIT_LIMIT_MS);
        let mut report = begun;
        loop {
            let by = match interruption(&begun, &report, BumperMask::NONE) {
                Some(Interruption::Stop) if cancel.is_cancelled() => Some(Interruption::Cancelled),
                Some(by) => Some(by),
                None if cancel.is_cancelled() => {
                    self.stop()?;
                    Some(Interruption::Cancelled)
                }
                None => None,
            };
            if let Some(by) = by {
                return Err(Error::Interrupted { kind, by });
            }
            if report.mode != Mode::Initialising {
                return Ok(report);
            }
            if self.now_ms() >= until_ms {
                self.stop()?;
                return Err(Error::TimeLimit { what: "initialisation", limit_ms: INIT_LIMIT_MS });
            }
            self.sleep_ms(POLL_MS)?;
            report = self.request(Request::State)?;
        }
    }

    /// Queues one step and does not wait for it.
    ///
    /// # Errors
    /// [`Error::Refused`] when the queue is full (nothing was queued), the robot is held or not
    /// initialised; [`Error::OutOfRange`] for a duration of 0; those of the line.
    pub fn step(&mut self, step: Step) -> Result<MotionReport, Error> {
        if step.duration_ms == 0 {
            let value = "0 ms".to_owned();
            let range = "1 to 65535 ms";
            return Err(Error::OutOfRange { what: "duration of a step", value, range });
        }
        self.request(Request::Step(step))
    }

    /// Plays steps to their end: keeps the robot's queue filled, reports progress, and tells how
    /// it ended. What the robot is doing ends first, unless the first step replaces it.
    ///
    /// # Errors
    /// An action that cannot be played ([`Error::OutOfRange`]), and errors of the line before the
    /// first step was sent. Afterwards, the report's outcome tells what went wrong.
    pub fn play(
        &mut self,
        steps: &[Step],
        options: &mut PlayOptions<'_>,
    ) -> Result<PlayReport, Error> {
        let line = &self.held.inner.line;
        player::play(line, steps, options, line.stop_generation())
    }

    /// Plays a compiled action to its end: its steps, its waits for bumpers, and what it does when one
    /// is met.
    ///
    /// # Errors
    /// As [`play`](MotionController::play), and [`Error::UnknownLabel`].
    pub fn perform(
        &mut self,
        action: &CompiledAction,
        options: &mut PlayOptions<'_>,
    ) -> Result<PlayReport, Error> {
        player::perform(&self.held.inner.line, action, options)
    }

    /// Plays an action of `RoboRegistry` by its name: compiles it, then as
    /// [`perform`](MotionController::perform).
    ///
    /// # Errors
    /// [`Error::Registry`] when there is no such action or it cannot be compiled; otherwise as
    /// [`perform`](MotionController::perform).
    #[cfg(feature = "registry")]
    pub fn play_action(
        &mut self,
        registry: &rsapien_registry::Registry,
        name: &str,
        compile: &rsapien_registry::CompileOptions,
        options: &mut PlayOptions<'_>,
    ) -> Result<PlayReport, Error> {
        let action = registry.compile(name, compile)?;
        self.perform(&action, options)
    }

    /// Does motion primitives together for `duration_ms`, and waits for them.
    ///
    /// # Errors
    /// [`Error::OppositePrimitives`]; otherwise as [`play`](MotionController::play).
    pub fn do_primitives(
        &mut self,
        primitives: &[Primitive],
        duration_ms: u16,
        options: &mut PlayOptions<'_>,
    ) -> Result<PlayReport, Error> {
        self.play(&[Step::new(pose_of(primitives)?, duration_ms)], options)
    }

    /// Sets the dead-man time, or a joint's travel time.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], and those of the line.
    pub fn configure(&mut self, parameter: Parameter) -> Result<(), Error> {
        if !parameter.is_in_range() {
            let (what, value_ms, range) = match parameter {
                Parameter::DeadMan { timeout_ms } => {
                    ("dead-man time", timeout_ms, "0 for off, or 100 to 10000 ms")
                }
                Parameter::TravelTime { full_travel_ms, .. } => {
                    ("travel time", full_travel_ms, "100 to 10000 ms")
                }
            };
            return Err(Error::OutOfRange { what, value: format!("{value_ms} ms"), range });
        }
        self.request(Request::Configure(parameter)).map(|_| ())
    }

    /// What the controller counted since its reset.
    ///
    /// # Errors
    /// Those of the line.
    pub fn counters(&self) -> Result<CountersReport, Error> {
        let kind = Request::Counters.kind();
        let answer = self.held.inner.line.request(Address::Motion, Request::Counters)?;
        match answer.accepted()?.report {
            Report::Counters(report) => Ok(report),
            _ => Err(Error::BadReport { address: Address::Motion, kind }),
        }
    }

    /// Stops every motor at once. It releases a hold.
    ///
    /// # Errors
    /// [`Error::NoAnswer`] or [`Error::LinkLost`]: the robot's dead-man is left to stop it.
    pub fn stop(&self) -> Result<(), Error> {
        self.held.inner.line.stop()
    }

    pub(crate) fn inner(&self) -> &Arc<Inner> {
        &self.held.inner
    }

    fn request(&self, request: Request) -> Result<MotionReport, Error> {
        let kind = request.kind();
        let answer = self.held.inner.line.request(Address::Motion, request)?;
        match answer.accepted()?.report {
            Report::Motion(report) => Ok(report),
            _ => Err(Error::BadReport { address: Address::Motion, kind }),
        }
    }
}

impl Drop for MotionController {
    fn drop(&mut self) {
        if self.state().is_moving() {
            // Without an answer, the dead-man is left to stop the robot.
            let _ = self.stop();
        }
    }
}

/// The pose that primitives make together.
fn pose_of(primitives: &[Primitive]) -> Result<Pose, Error> {
    primitives.iter().try_fold(Pose::EMPTY, |pose, primitive| {
        let joint = primitive.joint();
        match pose.get(joint) {
            Some(position) if position != primitive.position() => Err(Error::OppositePrimitives {
                first: Primitive::new(joint, position).to_string(),
                second: primitive.to_string(),
            }),
            _ => Ok(pose.with(joint, Some(primitive.position()))),
        }
    })
}
