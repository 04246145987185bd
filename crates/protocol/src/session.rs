//! The PC's end of a line as a sans-IO state machine: sessions, sequence numbers, resends and
//! deadlines for both controllers.
//!
//! It owns no port and no clock. The caller, one thread a line,
//!
//! 1. sends what [`poll_transmit`](Session::poll_transmit) gives, until it gives nothing;
//! 2. takes what [`poll_event`](Session::poll_event) gives, until it gives nothing;
//! 3. waits for line bytes, at most until [`poll_timeout`](Session::poll_timeout);
//! 4. hands bytes to [`handle_bytes`](Session::handle_bytes), and the time to
//!    [`handle_timeout`](Session::handle_timeout) when the deadline has come.
//!
//! One package is outstanding on a line at any time. It is sent again, the same bytes, when its
//! answer does not come in the time that both packages take on the line and a margin, six tries
//! in all. STOP has a slot of its own: it goes out as soon as the line is free, at the latest when the
//! deadline of the package under way comes, and that package is not sent again.
//!
//! ```text
//!            request / stop                 poll_transmit
//!   Free ───────────────────► Sending ─────────────────────► Awaiting ──┐ deadline, tries left:
//!    ▲                           ▲                            │   │     │ back to Sending
//!    │                           └────────────────────────────┼───┼─────┘
//!    │  accepted; or refused and no copy on the way           │   │ refused, but copies of it
//!    ├────────────────────────────────────────────────────────┘   │ are still on the way
//!    │  every copy answered, or the deadline                      ▼
//!    └──────────────────────────────────────────────────────── Settling
//! ```
//!
//! Settling exists because a refused package does not use its number up: were the next package sent
//! under the same number while a copy of the refused one is on the way, the robot could execute
//! the copy and take the next package for a duplicate of it.

use crate::frame::{self, ACTION_PACKAGE_LENGTH, ActionBytes, SYNCHRONIZATION_PACKAGE_LENGTH};
use crate::{
    ActionPackage, Address, BadReport, Counts, Fed, Kind, LineError, PROTOCOL_VERSION, Receiver,
    Report, Request, Status, SynchronizationPackage,
};

#[cfg(test)]
mod tests;

/// How the PC's end of a line behaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SessionConfig {
    /// Line speed in bit/s; not 0.
    pub baud: u32,
    /// What is granted to an answer beyond the time both packages take on the line, in ms.
    pub margin_ms: u16,
    /// How often a package is sent before it is given up; not 0.
    pub tries: u8,
    /// The number proposed for the first session; 0 is taken as 1. Draw it at random, so that a
    /// restarted program does not meet its predecessor's session.
    pub first_session: u8,
}

impl Default for SessionConfig {
    /// 57600 baud, 40 ms, six tries, session 1.
    fn default() -> SessionConfig {
        SessionConfig { baud: 57_600, margin_ms: 40, tries: 6, first_session: 1 }
    }
}

impl SessionConfig {
    /// How long an answer may take before the package is sent again, in ms.
    pub fn answer_time_ms(&self) -> u64 {
        let line_bytes = ACTION_PACKAGE_LENGTH + SYNCHRONIZATION_PACKAGE_LENGTH;
        frame::line_time_ms(line_bytes, self.baud.max(1)) + u64::from(self.margin_ms)
    }
}

/// Names a request until its outcome is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Ticket(u32);

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
        "outcome of {kind} unknown: it was sent {tries} times to the {address} controller, and {reason}"
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
    /// The robot was reset, or another program opened a session, between two tries.
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
        /// The answer.
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

/// What is known of one controller.
#[derive(Clone, Copy, Debug, Default)]
struct Peer {
    session: Option<u8>,
    last_sequence: u8,
    boot: Option<u8>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Sending,
    Awaiting { deadline_ms: u64 },
    Settling { deadline_ms: u64, refusal: SynchronizationPackage },
}

#[derive(Clone, Copy, Debug)]
struct Outstanding {
    ticket: Ticket,
    address: Address,
    package: ActionPackage,
    phase: Phase,
    tries: u8,
    answers: u8,
    first_sent_ms: u64,
}

const EVENTS_MAX: usize = 4;

/// The PC's end of a line. See the [module](self) for how it is driven.
#[derive(Clone, Debug)]
pub struct Session {
    config: SessionConfig,
    receiver: Receiver,
    peers: [Peer; 2],
    outstanding: Option<Outstanding>,
    stop: Option<(Ticket, Address)>,
    next_ticket: u32,
    next_session: u8,
    next_tag: u8,
    events: [Option<SessionEvent>; EVENTS_MAX],
}

impl Session {
    /// The end of a line on which nothing was said yet.
    pub fn new(config: SessionConfig) -> Session {
        Session {
            config,
            receiver: Receiver::for_pc(),
            peers: [Peer::default(); 2],
            outstanding: None,
            stop: None,
            next_ticket: 0,
            next_session: config.first_session.max(1),
            next_tag: 0,
            events: [None; EVENTS_MAX],
        }
    }

    /// The session open with `address`, as far as the PC knows.
    pub fn open_session(&self, address: Address) -> Option<u8> {
        self.peer(address).session
    }

    /// Whether no package is outstanding and no STOP waits: a request would be taken now.
    pub fn is_free(&self) -> bool {
        self.outstanding.is_none() && self.stop.is_none()
    }

    /// What reception counted at the PC's end.
    pub fn counts(&self) -> Counts {
        self.receiver.counts()
    }

    /// Opens a session with `address` by HELLO, under a number not used before by this program.
    ///
    /// # Errors
    /// [`RequestError::Busy`].
    pub fn open(&mut self, address: Address) -> Result<Ticket, RequestError> {
        self.check_free()?;
        let session = self.next_session;
        self.next_session = if session == u8::MAX { 1 } else { session + 1 };
        self.peer_mut(address).session = None;
        let request = Request::Hello {
            lowest_version: PROTOCOL_VERSION,
            highest_version: PROTOCOL_VERSION,
            session,
        };
        let sequence = self.tag();
        Ok(self.put(address, ActionPackage { session, sequence, request }))
    }

    /// Puts a request on the line.
    ///
    /// # Errors
    /// [`RequestError`] when it was not taken; nothing is sent then.
    pub fn request(&mut self, address: Address, request: Request) -> Result<Ticket, RequestError> {
        let kind = request.kind();
        if kind == Kind::Hello {
            return Err(RequestError::HelloByHand);
        }
        if !request.is_valid() {
            return Err(RequestError::BadArgument { kind });
        }
        self.check_free()?;
        let peer = *self.peer(address);
        let (session, sequence) = if kind.is_numbered() {
            let session = peer.session.ok_or(RequestError::NoSession { address })?;
            (session, peer.last_sequence.wrapping_add(1))
        } else {
            (peer.session.unwrap_or(0), self.tag())
        };
        Ok(self.put(address, ActionPackage { session, sequence, request }))
    }

    /// Puts STOP in its own slot: it overtakes what is outstanding. A STOP that already waits for
    /// the same controller is not doubled; one for the other controller goes first.
    ///
    /// # Errors
    /// [`RequestError::Busy`] when a STOP to the other controller still waits for its turn.
    pub fn stop(&mut self, address: Address) -> Result<Ticket, RequestError> {
        match self.stop {
            Some((ticket, waiting)) if waiting == address => Ok(ticket),
            Some(_) => Err(RequestError::Busy),
            None => {
                let ticket = self.ticket();
                self.stop = Some((ticket, address));
                Ok(ticket)
            }
        }
    }

    /// The bytes to put on the line now, if any. Call again until it gives nothing.
    pub fn poll_transmit(&mut self, now_ms: u64) -> Option<ActionBytes> {
        if self.events.iter().any(Option::is_some) {
            return None;
        }
        self.start_stop_if_free();
        let answer_time_ms = self.config.answer_time_ms();
        let outstanding = self.outstanding.as_mut()?;
        if outstanding.phase != Phase::Sending {
            return None;
        }
        if outstanding.tries == 0 {
            outstanding.first_sent_ms = now_ms;
        }
        outstanding.tries += 1;
        outstanding.phase = Phase::Awaiting { deadline_ms: now_ms.saturating_add(answer_time_ms) };
        Some(outstanding.package.encode(outstanding.address))
    }

    /// When [`handle_timeout`](Session::handle_timeout) wants to be called next, in ms. None when
    /// only a request can bring something about.
    pub fn poll_timeout(&self) -> Option<u64> {
        match self.outstanding?.phase {
            Phase::Sending => None,
            Phase::Awaiting { deadline_ms } | Phase::Settling { deadline_ms, .. } => {
                Some(deadline_ms)
            }
        }
    }

    /// The next event, oldest first.
    pub fn poll_event(&mut self) -> Option<SessionEvent> {
        let event = self.events[0].take();
        self.events.rotate_left(1);
        event
    }

    /// Takes line bytes that came at `now_ms`. Bytes that make no package are counted.
    pub fn handle_bytes(&mut self, bytes: &[u8], now_ms: u64) {
        for byte in bytes {
            let Fed::Package(content) = self.receiver.feed(*byte, now_ms) else { continue };
            let address = content.address();
            match SynchronizationPackage::parse(&content) {
                Ok(package) => self.handle_package(address, package, now_ms),
                Err(error) => self.push(SessionEvent::Incomprehensible { address, error }),
            }
        }
    }

    /// Takes note of a byte that the UART could not receive.
    pub fn handle_line_error(&mut self, error: LineError) {
        self.receiver.line_error(error);
    }

    /// Acts on the deadline if it has come; earlier calls do nothing.
    pub fn handle_timeout(&mut self, now_ms: u64) {
        self.receiver.expire(now_ms);
        let Some(outstanding) = self.outstanding else { return };
        match outstanding.phase {
            Phase::Awaiting { deadline_ms } if now_ms >= deadline_ms => {
                self.handle_no_answer(outstanding);
            }
            Phase::Settling { deadline_ms, refusal } if now_ms >= deadline_ms => {
                self.end_answered(outstanding, refusal, now_ms);
            }
            _ => {}
        }
    }

    fn handle_no_answer(&mut self, outstanding: Outstanding) {
        if self.stop.is_none() && outstanding.tries < self.config.tries {
            if let Some(outstanding) = self.outstanding.as_mut() {
                outstanding.phase = Phase::Sending;
            }
            return;
        }
        let reason = match self.stop {
            Some(_) => UnknownReason::Displaced,
            None => UnknownReason::NoAnswer,
        };
        self.end_failed(outstanding, reason);
    }

    fn handle_package(&mut self, address: Address, package: SynchronizationPackage, now_ms: u64) {
        self.note_boot(address, &package.report);
        let Some(mut outstanding) = self.outstanding else { return };
        let asked = outstanding.package;
        let answers_it = outstanding.tries > 0
            && address == outstanding.address
            && package.session == asked.session
            && package.sequence == asked.sequence
            && package.kind_byte == asked.request.kind().byte();
        if !answers_it {
            return;
        }
        outstanding.answers = outstanding.answers.saturating_add(1);
        let is_final = package.status.is_accepted()
            || !asked.request.kind().is_numbered()
            || outstanding.answers >= outstanding.tries;
        if is_final {
            self.end_answered(outstanding, package, now_ms);
            return;
        }
        let deadline_ms = match outstanding.phase {
            Phase::Awaiting { deadline_ms } | Phase::Settling { deadline_ms, .. } => deadline_ms,
            // The deadline has passed, the next copy is not sent yet: the copies before it had
            // their time.
            Phase::Sending => return self.end_answered(outstanding, package, now_ms),
        };
        outstanding.phase = Phase::Settling { deadline_ms, refusal: package };
        self.outstanding = Some(outstanding);
    }

    fn end_answered(
        &mut self,
        outstanding: Outstanding,
        package: SynchronizationPackage,
        now_ms: u64,
    ) {
        let Outstanding { ticket, address, tries, .. } = outstanding;
        let is_numbered = outstanding.package.request.kind().is_numbered();
        let session_lost =
            is_numbered && matches!(package.status, Status::NoSession | Status::OutOfSequence);
        if session_lost {
            self.peer_mut(address).session = None;
            if tries > 1 {
                return self.end_failed(outstanding, UnknownReason::SessionLost);
            }
        }
        if package.status.is_accepted() {
            if let Report::Hello(report) = package.report {
                *self.peer_mut(address) = Peer {
                    session: Some(package.session),
                    last_sequence: report.last_sequence,
                    boot: Some(report.boot),
                };
            } else if is_numbered {
                self.peer_mut(address).last_sequence = package.sequence;
            }
        }
        self.outstanding = None;
        let round_trip_ms = now_ms.saturating_sub(outstanding.first_sent_ms);
        self.push(SessionEvent::Answered { ticket, address, package, tries, round_trip_ms });
    }

    fn end_failed(&mut self, outstanding: Outstanding, reason: UnknownReason) {
        let Outstanding { ticket, address, tries, .. } = outstanding;
        let kind = outstanding.package.request.kind();
        let failure = match (kind.is_numbered(), reason) {
            (true, reason) => Failure::OutcomeUnknown { address, kind, tries, reason },
            (false, UnknownReason::Displaced) => Failure::Displaced { kind },
            (false, _) => Failure::NoAnswer { address, kind, tries },
        };
        if kind.is_numbered() {
            // Whether the number was used up cannot be known, so the session ends with it.
            self.peer_mut(address).session = None;
        }
        self.outstanding = None;
        self.push(SessionEvent::Failed { ticket, address, failure });
    }

    fn note_boot(&mut self, address: Address, report: &Report) {
        let Some(boot) = report.boot() else { return };
        let known = self.peer_mut(address).boot.replace(boot);
        if known.is_some_and(|known| known != boot) {
            self.peer_mut(address).session = None;
            self.push(SessionEvent::Restarted { address, boot });
        }
    }

    fn start_stop_if_free(&mut self) {
        let Some((ticket, address)) = self.stop else { return };
        if let Some(outstanding) = self.outstanding {
            if outstanding.phase != Phase::Sending {
                return;
            }
            let kind = outstanding.package.request.kind();
            if outstanding.tries > 0 {
                self.end_failed(outstanding, UnknownReason::Displaced);
            } else {
                self.outstanding = None;
                self.push(SessionEvent::Failed {
                    ticket: outstanding.ticket,
                    address: outstanding.address,
                    failure: Failure::Displaced { kind },
                });
            }
        }
        self.stop = None;
        let session = self.peer(address).session.unwrap_or(0);
        let sequence = self.tag();
        self.outstanding = Some(Outstanding {
            ticket,
            address,
            package: ActionPackage { session, sequence, request: Request::Stop },
            phase: Phase::Sending,
            tries: 0,
            answers: 0,
            first_sent_ms: 0,
        });
    }

    fn put(&mut self, address: Address, package: ActionPackage) -> Ticket {
        let ticket = self.ticket();
        self.outstanding = Some(Outstanding {
            ticket,
            address,
            package,
            phase: Phase::Sending,
            tries: 0,
            answers: 0,
            first_sent_ms: 0,
        });
        ticket
    }

    fn check_free(&self) -> Result<(), RequestError> {
        if self.is_free() { Ok(()) } else { Err(RequestError::Busy) }
    }

    fn ticket(&mut self) -> Ticket {
        self.next_ticket = self.next_ticket.wrapping_add(1);
        Ticket(self.next_ticket)
    }

    /// A number that tells the answers to packages without a turn apart.
    fn tag(&mut self) -> u8 {
        self.next_tag = self.next_tag.wrapping_add(1);
        self.next_tag
    }

    fn push(&mut self, event: SessionEvent) {
        // An outstanding package ends with at most two events and nothing is sent before they are
        // fetched, so only rubbish that happens to be intact can fill the places; it is let go.
        if let Some(place) = self.events.iter_mut().find(|place| place.is_none()) {
            *place = Some(event);
        }
    }

    fn peer(&self, address: Address) -> &Peer {
        match address {
            Address::Motion => &self.peers[0],
            Address::Camera => &self.peers[1],
        }
    }

    fn peer_mut(&mut self, address: Address) -> &mut Peer {
        match address {
            Address::Motion => &mut self.peers[0],
            Address::Camera => &mut self.peers[1],
        }
    }
}
