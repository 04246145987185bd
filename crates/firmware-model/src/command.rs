//! How the main routine analyses a request: refusals in the order in which they are told,
//! sessions, sequence numbers and duplicates. What is left is executed by the controller.
//!
//! ```text
//!   package ─► kind known? ─► mine? ─► arguments? ─► HELLO: version? ─► opens its session ─► 0
//!                 │ no: 1       │ no: 8    │ no: 2       │ no: 7
//!                 │             │          │
//!                 │             │          └► STATE, STOP, COUNTERS ─► executed ─► 0
//!                 ▼             ▼          └► numbered ─► session? ─► number?
//!                answered with the status,                  │ no: 4     │ last executed: duplicate, 0
//!                nothing executed                           ▼           │ last + 1: the controller's
//!                                                                       │ own checks 9, 6, 3, else 0
//!                                                                       └ else: 5
//! ```
//!
//! Only a package that was executed uses its number up, and an executed package was told 0, so
//! the status that a duplicate is told again is always 0.

use rsapien_protocol::{ActionView, Address, PROTOCOL_VERSION, Parameter, Request, Status};

/// What is to be done with a package.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Verdict {
    /// Answered with the status; nothing is executed.
    Answered(Status),
    /// The controller executes it, and says how that went.
    Execute(Request),
}

/// The open session and its numbers.
#[derive(Clone, Debug)]
pub(crate) struct Command {
    address: Address,
    /// The number of the open session; 0: none is open.
    session: u8,
    /// The last sequence number executed; 0 when `any_executed` is false.
    last_sequence: u8,
    any_executed: bool,
    duplicates: u16,
}

impl Command {
    pub(crate) const fn new(address: Address) -> Command {
        Command { address, session: 0, last_sequence: 0, any_executed: false, duplicates: 0 }
    }

    /// Analyses a request, up to what only the controller itself can know.
    pub(crate) fn analyse(&mut self, view: ActionView<'_>) -> Verdict {
        let Some(kind) = view.kind() else { return Verdict::Answered(Status::UnknownKind) };
        if !kind.is_served_by(self.address) {
            return Verdict::Answered(Status::NotThisControllers);
        }
        let request = match view.request(kind) {
            Ok(request) => request,
            Err(status) => return Verdict::Answered(status),
        };
        let has_joints = matches!(self.address, Address::Motion);
        if matches!(request, Request::Configure(Parameter::TravelTime { .. })) && !has_joints {
            return Verdict::Answered(Status::BadArgument);
        }
        if let Request::Hello { lowest_version, highest_version, session } = request {
            return Verdict::Answered(self.hello(lowest_version, highest_version, session));
        }
        if !kind.is_numbered() {
            return Verdict::Execute(request);
        }
        if self.session == 0 || view.session() != self.session {
            return Verdict::Answered(Status::NoSession);
        }
        if self.any_executed && view.sequence() == self.last_sequence {
            self.duplicates = self.duplicates.wrapping_add(1);
            return Verdict::Answered(Status::Accepted);
        }
        if view.sequence() != self.last_sequence.wrapping_add(1) {
            return Verdict::Answered(Status::OutOfSequence);
        }
        Verdict::Execute(request)
    }

    /// Uses the number of a numbered package up.
    pub(crate) fn note_executed(&mut self, sequence: u8) {
        self.last_sequence = sequence;
        self.any_executed = true;
    }

    pub(crate) const fn session(&self) -> u8 {
        self.session
    }

    pub(crate) const fn last_sequence(&self) -> u8 {
        self.last_sequence
    }

    pub(crate) const fn duplicates(&self) -> u16 {
        self.duplicates
    }

    fn hello(&mut self, lowest_version: u8, highest_version: u8, session: u8) -> Status {
        if !(lowest_version..=highest_version).contains(&PROTOCOL_VERSION) {
            return Status::VersionNotSpoken;
        }
        if session != self.session {
            self.session = session;
            self.last_sequence = 0;
            self.any_executed = false;
        }
        Status::Accepted
    }
}
