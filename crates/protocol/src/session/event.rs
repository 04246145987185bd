//! What a session tells its user.

#[cfg(doc)]
use super::Session;
use crate::{Address, BadReport, Kind, SynchronizationPackage};

/// Names a request until its outcome is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Ticket(pub(super) u32);

/// Why a request was not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RequestError {
    /// Another package is outstanding on the line.
    #[error("another package is outstanding on the line: wait for its event")]
    Busy,
    /// The kind is executed only in a session, and none is open with this controller.
    #[error("no session is open with the {address} controller: open one first")]
    NoSession {
        /// The controller.
        address: Address,
    },
    /// HELLO goes through [`Session::open`].
    #[error("HELLO is sent by opening a session")]
    HelloByHand,
    /// An argument is out of its range.
    #[error("an argument of {kind} is out of its range")]
    BadArgument {
        /// The kind of the request.
        kind: Kind,
    },
}

/// Why a request has no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Failure {
    /// No answer to any try. The package was not one that acts, or cannot act any more.
    #[error("no answer from the {address} controller to {tries} tries of {kind}")]
    NoAnswer {
        /// The controller.
        address: Address,
        /// The kind of the request.
        kind: Kind,
        /// How often it was sent.
        tries: u8,
    },
    /// Whether the package was executed cannot be known: it was sent, but the answer did not come
    /// or the session was lost in between. It is not sent again.
    #[error(
        "outcome of {kind} by the {address} controller unknown: {reason} (tries: {tries}), and it is not sent again"
    )]
    OutcomeUnknown {
        /// The controller.
        address: Address,
        /// The kind of the request.
        kind: Kind,
        /// How often it was sent.
        tries: u8,
        /// What made it unknown.
        reason: UnknownReason,
    },
    /// STOP took its place on the line before it was sent or, if it does not act, answered.
    #[error("{kind} was given up for STOP")]
    Displaced {
        /// The kind of the request.
        kind: Kind,
    },
}

/// What made an outcome unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum UnknownReason {
    /// No answer came to any try.
    #[error("no answer came")]
    NoAnswer,
    /// The robot was reset, or another program opened a session, after it was sent.
    #[error("the session was lost under it")]
    SessionLost,
    /// STOP took its place on the line after it was sent.
    #[error("STOP took its place before an answer came")]
    Displaced,
}

/// What happened on the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SessionEvent {
    /// A request was answered; the status says how.
    Answered {
        /// The request.
        ticket: Ticket,
        /// The controller that answered.
        address: Address,
        /// The answer. (Where a copy was accepted, but only its refusal heard before: that package,
        /// with the status it had when it was executed.)
        package: SynchronizationPackage,
        /// How often the package was sent.
        tries: u8,
        /// From the first try to the answer, in ms.
        round_trip_ms: u64,
    },
    /// A request ended without an answer that settles it.
    Failed {
        /// The request.
        ticket: Ticket,
        /// The controller asked.
        address: Address,
        /// Why.
        failure: Failure,
    },
    /// The controller was reset since its last report: its session is closed, its queue empty.
    Restarted {
        /// The controller.
        address: Address,
        /// The new boot number.
        boot: u8,
    },
    /// An intact package that means nothing to this version; it answers nothing.
    Incomprehensible {
        /// The controller it came from.
        address: Address,
        /// What is wrong with it.
        error: BadReport,
    },
}
