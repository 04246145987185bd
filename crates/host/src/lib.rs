//! A toy humanoid as a laboratory robot: open it, hold a controller, move it, watch it.
//!
//! ```text
//!   Robot ── open(address) ──► line: one thread, session (sans-IO), link (serial, TCP, virtual)
//!     │
//!     ├── motion()  ──► MotionController   initialise, queue steps, play actions
//!     ├── camera()  ──► CameraController   home, aim
//!     ├── sensors() ──► SensorsController  bumpers, switches, supply, states as they come
//!     └── stop()        needs no controller
//! ```
//!
//! As in the control interface architecture of the paper (section 3, Fig. 6), a controller has to
//! be held in order to issue requests to the robot or to read feedback from it. Each has one holder,
//! in this program and among all programs of this user; a second one is told who holds it.
//!
//! Times are milliseconds of the line's clock; the virtual robot has a clock of its own that may
//! run as fast as the computer goes.
//!
#![cfg_attr(feature = "virtual", doc = "```")]
#![cfg_attr(not(feature = "virtual"), doc = "```ignore")]
//! use rsapien::link::virtual_robot::Pace;
//! use rsapien::protocol::Primitive;
//! use rsapien::{LinkAddress, PlayOptions, Robot, RobotOptions};
//!
//! # fn main() -> Result<(), rsapien::Error> {
//! let mut options = RobotOptions::new("example");
//! options.virtual_robot.pace = Pace::Fast;
//! let robot = Robot::open(&LinkAddress::Virtual, options)?;
//!
//! let mut motion = robot.motion()?;
//! motion.init()?;
//! let arms_up = [1, 4].map(|number| Primitive::from_number(number).expect("one of 21"));
//! let report = motion.do_primitives(&arms_up, 1500, &mut PlayOptions::default())?;
//! assert!(report.outcome.is_done());
//! # Ok(())
//! # }
//! ```
//!
//! Features: `serial` (default), `virtual` (the virtual robot), `registry` (actions by name),
//! `sharing` (one robot for several programs; Unix), `recording` (MCAP files), `vision`, `video` (films and streams),
//! `webcam` (of these, on Linux), and `cli`, which brings the
//! `rsapien` command and all of them but `webcam`.

#[doc = include_str!("../README.md")]
#[cfg(doctest)]
struct ReadmeIsCompiled;

mod address;
#[cfg(feature = "vision")]
pub mod behaviour;
#[cfg(feature = "cli")]
pub mod cli;
mod control;
pub mod data;
pub mod doctor;
mod error;
mod line;
pub mod link;
mod lock;
mod player;
mod ports;
mod record;
#[cfg(feature = "recording")]
pub mod recording;
mod robot;
#[cfg(feature = "sharing")]
pub mod sharing;
mod stage;
mod state;
mod stop;
pub mod timing;
#[cfg(feature = "trial")]
pub mod trial;
#[cfg(feature = "video")]
pub mod video;

pub use address::LinkAddress;
pub use control::{CameraController, MotionController, SensorsController};
pub use error::Error;
pub use lock::{Holder, LineLock};
pub use player::{
    CancelToken, Outcome, PauseSwitch, PlayOptions, PlayReport, Progress, ProgressSink, StepReached,
};
pub use ports::{PortInformation, Probe, ProbeResult, find_robot, list_ports, probe_ports};
pub use record::{LineEvent, LineSink, PackageRecord, PackageSink};
pub use robot::{Robot, RobotOptions, StopHandle};
/// Bytes, packages, joints, primitives, steps, reports: the vocabulary of the link.
pub use rsapien_protocol as protocol;
/// Compiled actions, and the language they are written in.
pub use rsapien_registry as registry;
/// The virtual robot: its world, its camera, its faults.
#[cfg(feature = "virtual")]
pub use rsapien_sim as sim;
pub use stage::{Admission, Claim, Policy, Stage, Terms};
pub use state::{Interruption, LineCounts, LinkState, RobotState, Stamped};
pub use stop::{StopOptions, StopReport, StopSeen, emergency_stop};
