//! What the program knows of the robot, in one typed value.

use rsapien_protocol::{
    Address, BumperMask, CameraReport, HelloReport, Mode, MotionReport, StopCause,
};

/// A report with the time it came.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamped<T> {
    /// When the report came, in ms of the line's clock.
    pub time_ms: u64,
    /// The report.
    pub report: T,
}

/// How the link to the robot stands.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum LinkState {
    /// The last package was answered.
    #[default]
    Up,
    /// The link is open, but packages are not answered: the cable is out, or the power off.
    Silent {
        /// Since when, in ms of the line's clock.
        since_ms: u64,
    },
    /// The link broke, and is tried again until it comes back.
    Lost {
        /// Since when, in ms of the line's clock.
        since_ms: u64,
        /// What the system said.
        why: String,
    },
}

/// What happened on the line so far, at this program's end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LineCounts {
    /// Action packages sent, resends among them.
    pub sent: u64,
    /// Action packages sent again because their answer did not come.
    pub resent: u64,
    /// Synchronization packages that settled a request.
    pub answered: u64,
    /// Requests given up without an answer.
    pub unanswered: u64,
    /// Reception errors at this end: packages abandoned or dropped.
    pub reception_errors: u16,
    /// Resets of a controller noticed.
    pub restarts: u64,
    /// How often a lost link was opened again.
    pub reconnects: u64,
}

/// What the program knows of the robot at one moment.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RobotState {
    /// Host time stamp: when this was last renewed, in ms of the line's clock, whose origin is the
    /// opening of the line (virtual robot: the robot's start).
    pub time_ms: u64,
    /// One more at each renewal.
    pub version: u64,
    /// How the link stands.
    pub link: LinkState,
    /// What the motion controller reported last.
    pub motion: Option<Stamped<MotionReport>>,
    /// What the camera controller reported last.
    pub camera: Option<Stamped<CameraReport>>,
    /// How the motion controller answered HELLO last, if a session was opened with it; with the
    /// dead-man time that was configured since.
    pub motion_information: Option<HelloReport>,
    /// How the camera controller answered HELLO last, if a session was opened with it; with the
    /// dead-man time that was configured since.
    pub camera_information: Option<HelloReport>,
    /// The sessions open as far as this program knows: motion, camera.
    pub sessions: [Option<u8>; 2],
    /// What happened on the line.
    pub counts: LineCounts,
}

impl RobotState {
    /// The motion controller's last report.
    pub fn motion_report(&self) -> Option<MotionReport> {
        self.motion.map(|stamped| stamped.report)
    }

    /// The camera controller's last report.
    pub fn camera_report(&self) -> Option<CameraReport> {
        self.camera.map(|stamped| stamped.report)
    }

    /// How the controller at `address` answered HELLO last.
    pub fn information(&self, address: Address) -> Option<HelloReport> {
        match address {
            Address::Motion => self.motion_information,
            Address::Camera => self.camera_information,
        }
    }

    /// Whether motors may be running: the motion controller initialises, executes, or says so.
    pub fn is_moving(&self) -> bool {
        self.motion_report().is_some_and(|report| {
            report.motors != 0 || matches!(report.mode, Mode::Initialising | Mode::Executing)
        })
    }
}

/// What ended an action, an initialisation or a camera movement before its time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Interruption {
    /// Bumpers that end the action were pressed.
    #[error("{}", bumper_text(*.0))]
    Bumper(BumperMask),
    /// STOP, from this program or another.
    #[error("STOP")]
    Stop,
    /// The dead-man: the robot heard nothing for too long.
    #[error("the dead-man (the robot heard nothing for too long)")]
    DeadMan,
    /// The controller was reset.
    #[error("a reset of the controller ({})", .0.name())]
    Reset(StopCause),
    /// The link broke, or the robot fell silent.
    #[error("the loss of the link")]
    LinkLost,
    /// The caller cancelled it.
    #[error("its caller")]
    Cancelled,
    /// Another action replaced it.
    #[error("an action that replaced it")]
    Replaced,
    /// None of these bumpers was pressed while the action waited for one.
    #[error("a wait in vain for {}", bumper_text(*.0))]
    WaitInVain(BumperMask),
}

fn bumper_text(mask: BumperMask) -> String {
    let names: Vec<&str> = mask.names().collect();
    if names.is_empty() { "a bumper".to_owned() } else { format!("bumper {}", names.join(", ")) }
}
