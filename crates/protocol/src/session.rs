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
//!   Free ───────────────────► Sending ─────────────────────► Awaiting
//!    ▲                          ▲                              │   │
//!    │                          │ deadline, tries left          │   │
//!    │                          ├──────────────────────────────┤   │
//!    │                          │ refused for a reason that     │   │
//!    │                          │ passes: now asks with HELLO   │   │
//!    │                          └──────────────────────────────┘   │
//!    └─────────────────────────────────────────────────────────────┘
//!        answered for good, or the deadline and no tries left
//! ```
//!
//! A refused package does not use its number up, and a full queue may have a place a moment later:
//! were the next package sent under the same number while a copy of the refused one (or of the
//! refusal) is on the way, the robot could execute the copy and take the next package for a
//! duplicate of it, or the PC take the old refusal for an answer to the next package. So when a
//! refusal comes for a reason that passes (queue full, held, not initialised), the session asks
//! before it tells: HELLO under the open session changes nothing, its answer comes behind everything
//! said before, and names the last number executed. The crate's tests go through every interleaving of
//! a small model and show that then no action runs twice, none is told accepted that did not run, and
//! none refused that did.

use crate::frame::ActionBytes;
use crate::{
    ActionPackage, Address, Counts, Kind, LineError, PROTOCOL_VERSION, Receiver, Request,
    SynchronizationPackage,
};
pub use config::SessionConfig;
pub use event::{Failure, RequestError, SessionEvent, Ticket, UnknownReason};

mod answer;
mod config;
mod event;
#[cfg(test)]
mod model;
mod outstanding;
#[cfg(test)]
mod tests;

use outstanding::{Outstanding, Phase};

/// What is known of one controller.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
struct Peer {
    session: Option<u8>,
    last_sequence: u8,
    boot: Option<u8>,
}

/// Places for events that wait to be fetched. Two ends of requests can wait at once (of one that
/// STOP displaced, and of STOP), and two restarts (of either controller); the rest is for rubbish.
const EVENTS_MAX: usize = 6;
const INCOMPREHENSIBLE_MAX: usize = EVENTS_MAX - 4;
const RESTARTED_MAX: usize = EVENTS_MAX - 2;

/// The PC's end of a line. See the [module](self) for how it is driven.
#[derive(Clone, Debug)]
pub struct Session {
    config: SessionConfig,
    receiver: Receiver,
    peers: [Peer; 2],
    outstanding: Option<Outstanding>,
    stop: Option<(Ticket, Address)>,
    last_ticket: u32,
    proposal: u8,
    last_tag: u8,
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
            last_ticket: 0,
            proposal: config.first_session.max(1),
            last_tag: 0,
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
        let session = self.proposal;
        self.proposal = if session == u8::MAX { 1 } else { session + 1 };
        self.peer_mut(address).session = None;
        let sequence = self.tag();
        Ok(self.put(address, ActionPackage { session, sequence, request: hello(session) }))
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
        outstanding.phase = Phase::Awaiting { deadline_ms: now_ms.saturating_add(answer_time_ms) };
        let (package, tries) = outstanding.on_line();
        *tries = tries.saturating_add(1);
        Some(package.encode(outstanding.address))
    }

    /// When [`handle_timeout`](Session::handle_timeout) wants to be called next, in ms. None when
    /// only a request can bring something about.
    pub fn poll_timeout(&self) -> Option<u64> {
        match self.outstanding?.phase {
            Phase::Sending => None,
            Phase::Awaiting { deadline_ms } => Some(deadline_ms),
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
        let mut rest = bytes;
        while let (Some(content), behind) = self.receiver.feed_slice(rest, now_ms) {
            rest = behind;
            let address = content.address();
            match SynchronizationPackage::parse(&content) {
                Ok(package) => self.handle_package(address, package, now_ms),
                Err(error) => {
                    let event = SessionEvent::Incomprehensible { address, error };
                    self.push(event, INCOMPREHENSIBLE_MAX);
                }
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
        let Some(outstanding) = &mut self.outstanding else { return };
        let Phase::Awaiting { deadline_ms } = outstanding.phase else { return };
        if now_ms < deadline_ms {
            return;
        }
        let (_, tries) = outstanding.on_line();
        if self.stop.is_none() && *tries < self.config.tries {
            outstanding.phase = Phase::Sending;
            return;
        }
        let outstanding = *outstanding;
        let reason = match self.stop {
            Some(_) => UnknownReason::Displaced,
            None => UnknownReason::NoAnswer,
        };
        self.end_failed(outstanding, reason);
    }

    fn start_stop_if_free(&mut self) {
        let Some((ticket, address)) = self.stop else { return };
        if let Some(outstanding) = self.outstanding {
            let Outstanding { ticket, address, tries, .. } = outstanding;
            if matches!(outstanding.phase, Phase::Awaiting { .. }) {
                return;
            }
            if tries > 0 {
                self.end_failed(outstanding, UnknownReason::Displaced);
            } else {
                let failure = Failure::Displaced { kind: outstanding.package.request.kind() };
                self.push(SessionEvent::Failed { ticket, address, failure }, EVENTS_MAX);
            }
        }
        self.stop = None;
        let session = self.peer(address).session.unwrap_or(0);
        let package = ActionPackage { session, sequence: self.tag(), request: Request::Stop };
        self.outstanding = Some(Outstanding::new(ticket, address, package));
    }

    fn put(&mut self, address: Address, package: ActionPackage) -> Ticket {
        let ticket = self.ticket();
        self.outstanding = Some(Outstanding::new(ticket, address, package));
        ticket
    }

    fn check_free(&self) -> Result<(), RequestError> {
        if self.is_free() { Ok(()) } else { Err(RequestError::Busy) }
    }

    fn ticket(&mut self) -> Ticket {
        self.last_ticket = self.last_ticket.wrapping_add(1);
        Ticket(self.last_ticket)
    }

    /// A number that tells the answers to packages without a turn apart.
    fn tag(&mut self) -> u8 {
        self.last_tag = self.last_tag.wrapping_add(1);
        self.last_tag
    }

    /// Keeps `event` unless `places` events wait already: the ends of requests always find a
    /// place, whatever else comes before they are fetched.
    fn push(&mut self, event: SessionEvent, places: usize) {
        if let Some(place) = self.events.iter_mut().take(places).find(|place| place.is_none()) {
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

const fn hello(session: u8) -> Request {
    Request::Hello { lowest_version: PROTOCOL_VERSION, highest_version: PROTOCOL_VERSION, session }
}
