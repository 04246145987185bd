//! The package outstanding on a line.

use super::Ticket;
use crate::{ActionPackage, Address, SynchronizationPackage};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Phase {
    Sending,
    Awaiting { deadline_ms: u64 },
}

/// HELLO that asks whether a copy of a refused package was executed after all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Question {
    pub(super) package: ActionPackage,
    pub(super) tries: u8,
    /// The best answer to the refused package so far: an acceptance, else the latest refusal.
    pub(super) answer: SynchronizationPackage,
    pub(super) answered_ms: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Outstanding {
    pub(super) ticket: Ticket,
    pub(super) address: Address,
    pub(super) package: ActionPackage,
    pub(super) phase: Phase,
    pub(super) tries: u8,
    /// Whether the controller told of a reset since the first try.
    pub(super) was_reset: bool,
    pub(super) first_sent_ms: u64,
    pub(super) question: Option<Question>,
}

impl Outstanding {
    pub(super) fn new(ticket: Ticket, address: Address, package: ActionPackage) -> Outstanding {
        Outstanding {
            ticket,
            address,
            package,
            phase: Phase::Sending,
            tries: 0,
            was_reset: false,
            first_sent_ms: 0,
            question: None,
        }
    }

    /// What goes over the line now, and how often it did.
    pub(super) fn on_line(&mut self) -> (ActionPackage, &mut u8) {
        match &mut self.question {
            Some(question) => (question.package, &mut question.tries),
            None => (self.package, &mut self.tries),
        }
    }
}
