//! The link between a PC and the rsapien robot, without a clock, a port or an allocator.
//!
//! Three layers, each usable by itself:
//!
//! * bytes: [`ByteClass`], [`frame`] (the only place that knows a byte offset) and [`crc`];
//! * packages: [`Receiver`] turns line bytes into checked contents; [`ActionPackage`] and
//!   [`SynchronizationPackage`] give the contents a meaning ([`Request`], [`Report`],
//!   [`Status`], [`Joint`], [`Primitive`], [`Pose`], [`Step`]);
//! * the PC's [`session`]: a sans-IO state machine with session and sequence numbers, resends
//!   and deadlines. It takes bytes and a time and gives bytes, events and the next deadline.
//!
//! `SPEC.md` beside this crate's manifest is the specification with worked bytes.
//!
//! ```
//! use rsapien_protocol::{ActionPackage, Address, Fed, Receiver, Request};
//!
//! let package = ActionPackage { session: 7, sequence: 0, request: Request::State };
//! let line_bytes = package.encode(Address::Motion);
//!
//! let mut receiver = Receiver::for_robot(Address::Motion);
//! let mut received = None;
//! for byte in line_bytes {
//!     if let Fed::Package(content) = receiver.feed(byte, 0) {
//!         received = Some(content);
//!     }
//! }
//! let content = received.expect("an intact package is accepted at its last byte");
//! assert_eq!(ActionPackage::parse(content.action()), Ok(package));
//! ```
#![no_std]

/// The examples of the README, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

#[cfg(test)]
extern crate std;

mod action;
mod byte;
pub mod crc;
pub mod frame;
mod joint;
mod kind;
mod pose;
mod primitive;
mod reception;
mod report;
pub mod session;
mod status;
mod synchronization;

pub use action::{ActionPackage, ActionView, AimTarget, Parameter, Request};
pub use byte::{Address, ByteClass, Direction, HeaderByte, PROTOCOL_VERSION};
pub use frame::{
    ACTION_CONTENT_LENGTH, ACTION_PACKAGE_LENGTH, ActionBytes, SYNCHRONIZATION_CONTENT_LENGTH,
    SYNCHRONIZATION_PACKAGE_LENGTH, SynchronizationBytes,
};
pub use joint::{Joint, Position};
pub use kind::Kind;
pub use pose::{BadPose, BumperMask, Pose, Step};
pub use primitive::{Primitive, UnknownPrimitive};
pub use reception::{
    Content, Counts, Fed, GAP_MS_PC, GAP_MS_ROBOT, LineError, Receiver, ReceptionState,
};
pub use report::{
    AxisFlags, CameraReport, CountersReport, HelloReport, Mode, MotionReport, Report, StopCause,
};
pub use session::{
    Failure, RequestError, Session, SessionConfig, SessionEvent, Ticket, UnknownReason,
};
pub use status::Status;
pub use synchronization::{BadReport, SynchronizationPackage};
