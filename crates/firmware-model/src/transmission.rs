//! The transmit interrupt routine, and how the main routine initiates a response.
//!
//! ```text
//!              main routine: an answer is owed
//!        Idle ────────────────────────────────► Transmitting ──┐ transmit interrupt:
//!          ▲     (report as of this moment)          ▲         │ next byte handed out
//!          │                                         └─────────┤
//!          └───────────── 25th byte handed out ────────────────┘
//! ```
//!
//! A response is never cut off. A package that comes while the response to an earlier one is
//! still on its way is *executed* at once (STOP overtakes everything) and *answered* as soon as
//! the transmitter is idle, with the report of that later moment. There is one place for an owed
//! answer; a newer one takes it over. The PC has one package outstanding, so this happens only
//! to one that gave up waiting.

use rsapien_protocol::{ActionView, SYNCHRONIZATION_PACKAGE_LENGTH, Status, SynchronizationBytes};

/// An answer that is owed: what it echoes, and the status.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Answer {
    pub(crate) session: u8,
    pub(crate) sequence: u8,
    pub(crate) kind_byte: u8,
    pub(crate) status: Status,
}

impl Answer {
    pub(crate) const fn to(view: ActionView<'_>, status: Status) -> Answer {
        Answer {
            session: view.session(),
            sequence: view.sequence(),
            kind_byte: view.kind_byte(),
            status,
        }
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Transmission {
    bytes: SynchronizationBytes,
    /// The next byte to hand out; the package's length when idle.
    next: usize,
    owed: Option<Answer>,
}

impl Transmission {
    pub(crate) const fn new() -> Transmission {
        Transmission {
            bytes: [0; SYNCHRONIZATION_PACKAGE_LENGTH],
            next: SYNCHRONIZATION_PACKAGE_LENGTH,
            owed: None,
        }
    }

    pub(crate) fn owe(&mut self, answer: Answer) {
        self.owed = Some(answer);
    }

    /// The answer that can be initiated now.
    pub(crate) fn take_owed(&mut self) -> Option<Answer> {
        if self.is_idle() { self.owed.take() } else { None }
    }

    pub(crate) fn begin(&mut self, bytes: SynchronizationBytes) {
        self.bytes = bytes;
        self.next = 0;
    }

    pub(crate) const fn is_idle(&self) -> bool {
        self.next >= SYNCHRONIZATION_PACKAGE_LENGTH
    }

    /// The transmit interrupt: the next byte, or none, which switches the interrupt off.
    pub(crate) fn next_byte(&mut self) -> Option<u8> {
        let byte = *self.bytes.get(self.next)?;
        self.next += 1;
        Some(byte)
    }
}
