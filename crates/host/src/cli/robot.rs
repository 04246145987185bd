//! Opening the robot that `--link` names.

use std::io::Write;
use std::str::FromStr;

use clap::Args;
use rsapien_protocol::{Address, Mode};

use super::context::Context;
use super::diagnostics::{Failure, Result};
use super::exit::Status;
use super::signal::Interrupt;
use crate::link::virtual_robot::{Pace, VirtualOptions};
use crate::{
    CameraController, CancelToken, Error, LinkAddress, MotionController, Robot, RobotOptions,
};

/// Options of the commands that move the robot.
#[derive(Debug, Clone, Copy, Default, Args)]
pub(crate) struct PaceOptions {
    /// With the virtual robot: let its time pass as fast as it goes
    #[arg(long)]
    pub(crate) fast: bool,
}

/// A robot that Ctrl-C stops.
pub(crate) struct OpenRobot {
    pub(crate) robot: Robot,
    pub(crate) interrupt: Interrupt,
    /// Cancelled by Ctrl-C, after STOP was asked for.
    pub(crate) cancel: CancelToken,
    is_virtual: bool,
}

/// The link asked for; `auto` where none is.
pub(crate) fn address(context: &Context) -> Result<LinkAddress> {
    let text = context.link.as_deref().unwrap_or("auto");
    Ok(LinkAddress::from_str(text)?)
}

/// Opens the robot. `command` is what others are told who find it held.
pub(crate) fn open(context: &Context, command: &str, pace: PaceOptions) -> Result<OpenRobot> {
    open_at(context, &address(context)?, command, pace)
}

/// Opens the robot at `address`.
pub(crate) fn open_at(
    context: &Context,
    address: &LinkAddress,
    command: &str,
    pace: PaceOptions,
) -> Result<OpenRobot> {
    if pace.fast && *address != LinkAddress::Virtual {
        return Err(fast_needs_virtual());
    }
    let mut options = RobotOptions::for_user(format!("rsapien {command}"));
    if pace.fast {
        options.virtual_robot = VirtualOptions { pace: Pace::Fast, ..VirtualOptions::default() };
    }
    open_with(context, address, options)
}

/// The refusal of `--fast` with a robot that has no virtual time.
pub(crate) fn fast_needs_virtual() -> Failure {
    Failure::new("--fast: only the virtual robot's time can pass faster")
        .hint("leave --fast away, or use --link virtual")
}

/// Opens the robot at `address` with options of one's own.
pub(crate) fn open_with(
    context: &Context,
    address: &LinkAddress,
    mut options: RobotOptions,
) -> Result<OpenRobot> {
    let interrupt = Interrupt::install()?;
    options.baud = context.baud;
    if options.on_package.is_none() {
        options.on_package = Some(Box::new(|record| tracing::debug!("{record}")));
    }
    let pace = options.virtual_robot.pace;
    if let Some(recording) = &context.recording {
        recording.attach(address, &mut options);
    }
    let robot = Robot::open(address, options)?;
    tracing::info!("the link {} is open", robot.link_name());
    if let Some(recording) = &context.recording {
        recording.opened(address, &robot, pace)?;
    }
    let cancel = CancelToken::new();
    let (stop, token) = (robot.stop_handle(), cancel.clone());
    interrupt.stop_first(move || {
        let stopped = stop.stop();
        token.cancel();
        stopped.is_ok()
    });
    Ok(OpenRobot { robot, interrupt, cancel, is_virtual: *address == LinkAddress::Virtual })
}

impl OpenRobot {
    /// The motion controller of a robot that is initialised: a virtual one is initialised first.
    pub(crate) fn ready_motion(
        &self,
        context: &Context,
        out: &mut impl Write,
    ) -> Result<MotionController> {
        let mut motion = self.motion()?;
        let mode = motion.state().motion_report().map(|report| report.mode);
        if mode == Some(Mode::Fresh) {
            if !self.is_virtual {
                return Err(Failure::refused(
                    "the robot is not initialised: it does not know where its joints are",
                )
                .hint("run rsapien init first; it drives every joint to its middle position"));
            }
            context.style.remark(out, "the virtual robot is initialised first")?;
            self.done(motion.init_unless(&self.cancel))?;
        }
        Ok(motion)
    }

    /// The camera controller of a head that is homed: a virtual one is homed first.
    pub(crate) fn ready_camera(
        &self,
        context: &Context,
        out: &mut impl Write,
    ) -> Result<CameraController> {
        let camera = self.done(self.robot.camera())?;
        let mode = camera.state().camera_report().map(|report| report.mode);
        if mode == Some(Mode::Fresh) {
            if !self.is_virtual {
                return Err(Failure::refused(
                    "the head is not homed: it does not know where it looks",
                )
                .hint("run rsapien init first; it drives the head straight ahead, too"));
            }
            context.style.remark(out, "the virtual robot's head is homed first")?;
            self.done(camera.home())?;
        }
        Ok(camera)
    }

    /// The motion controller.
    pub(crate) fn motion(&self) -> Result<MotionController> {
        self.done(self.robot.motion())
    }

    /// The result of something that Ctrl-C may have ended: then that is what is told.
    pub(crate) fn done<T>(&self, result: std::result::Result<T, Error>) -> Result<T> {
        match result {
            Ok(value) => Ok(value),
            Err(_) if self.interrupt.is_raised() => Err(Failure::interrupted()),
            Err(error) => Err(error.into()),
        }
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        let status = if error.is_refusal() { Status::Refused } else { Status::Failed };
        let failure = Self::from_error(&error).status(status);
        match &error {
            Error::NoAnswer { address: Address::Motion, .. } => failure.hint(
                "check power and cable; --baud sets the speed of the line; --link virtual needs no robot",
            ),
            Error::LinkOpen { link, .. } if link.starts_with("tcp://") => {
                failure.hint("is a robot or rsapien sim --tcp listening there?")
            }
            Error::Refused { status: rsapien_protocol::Status::Held, .. } => {
                failure.hint("rsapien state tells why; rsapien init or rsapien stop releases it")
            }
            Error::Refused { status: rsapien_protocol::Status::NotInitialised, .. } => {
                failure.hint("run rsapien init first")
            }
            _ => failure,
        }
    }
}
