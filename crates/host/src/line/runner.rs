//! The line's thread: drives the session over the link.

mod care;
mod events;
mod loss;
mod stops;

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, TrySendError};
use std::time::Duration;

use rsapien_protocol::{
    Address, Direction, Fed, Kind, Parameter, Request, Session, SessionConfig, Status, Ticket,
};

use self::care::Care;
use super::{Answer, Command, LineOptions, Reply, Shared};
use crate::link::{Connect, Link, RealClock};
use crate::{Error, LineEvent, PackageRecord, RobotState};

/// The longest the thread looks at a real link before it looks at its commands again.
const LISTEN_MS_MAX: u64 = 10;

/// A request that is not on the line yet.
struct Pending {
    address: Address,
    work: Work,
    reply: Option<Reply>,
}

#[derive(Clone, Copy)]
enum Work {
    Open,
    Request {
        request: Request,
        stop_generation: u64,
        /// HELLO was sent for it already.
        opened: bool,
    },
}

/// Who waits for what the session does under a ticket. Nobody waits for a heartbeat.
struct Asked {
    ticket: Ticket,
    address: Address,
    kind: Kind,
    /// The new dead-man time, if that is what is asked.
    dead_man_ms: Option<u16>,
    reply: Option<Reply>,
}

struct Wait {
    until_ms: u64,
    newer_than: Option<u64>,
    reply: Sender<()>,
}

pub(super) struct Runner {
    connector: Box<dyn Connect>,
    link: Box<dyn Link>,
    clock: RealClock,
    options: LineOptions,
    shared: Arc<Shared>,
    commands: Receiver<Command>,
    session: Session,
    next_session: u8,
    listener: rsapien_protocol::Receiver,
    pending: VecDeque<Pending>,
    stops: VecDeque<(Address, Option<Reply>)>,
    asked: Vec<Asked>,
    waits: Vec<Wait>,
    subscribers: Vec<SyncSender<RobotState>>,
    care: [Care; 2],
    state: RobotState,
    /// When a lost link is tried again; none while it is up.
    retry_ms: Option<u64>,
    /// The link came back, and whether motors run is not known yet.
    is_suspicious: bool,
    /// The last package but STOP was a heartbeat, so a request goes first now. A robot that does
    /// not answer makes heartbeats take longer than their period.
    was_heartbeat: bool,
    is_closing: bool,
}

impl Runner {
    pub(super) fn new(
        connector: Box<dyn Connect>,
        link: Box<dyn Link>,
        clock: RealClock,
        options: LineOptions,
        shared: Arc<Shared>,
        commands: Receiver<Command>,
    ) -> Runner {
        let session = Session::new(session_config(&options, options.first_session));
        Runner {
            connector,
            link,
            clock,
            next_session: options.first_session,
            options,
            shared,
            commands,
            session,
            listener: rsapien_protocol::Receiver::listening(Direction::ToPc),
            pending: VecDeque::new(),
            stops: VecDeque::new(),
            asked: Vec::new(),
            waits: Vec::new(),
            subscribers: Vec::new(),
            care: [Care::default(); 2],
            state: RobotState::default(),
            retry_ms: None,
            is_suspicious: false,
            was_heartbeat: false,
            is_closing: false,
        }
    }

    pub(super) fn run(mut self) {
        while !self.is_closing {
            while let Ok(command) = self.commands.try_recv() {
                self.take(command);
            }
            // A STOP that came before still goes out. Then nothing may wait: whoever closes the line
            // waits for this thread, and nobody would wake it.
            if self.is_closing {
                let _ = self.pump();
                break;
            }
            let turned = if self.retry_ms.is_some() { self.turn_lost() } else { self.turn() };
            if let Err(error) = turned {
                self.lose(&error);
            }
        }
    }

    /// One turn with the link up: sends what is to be sent, then waits for what comes first.
    fn turn(&mut self) -> Result<(), Error> {
        let now_ms = self.link.now_ms();
        self.session.handle_timeout(now_ms);
        self.pump()?;
        self.end_waits();
        let is_idle = self.link.is_paced_by_caller() && !self.has_callers();
        if is_idle || self.session.is_free() {
            let wake_ms = self.next_wait_ms().min(self.next_heartbeat_ms());
            self.rest(wake_ms);
            return Ok(());
        }
        let now_ms = self.link.now_ms();
        let deadline_ms = self.session.poll_timeout().unwrap_or(now_ms);
        let mut until_ms = deadline_ms.min(self.next_wait_ms().max(now_ms + 1));
        if !self.link.is_paced_by_caller() {
            until_ms = until_ms.min(now_ms + LISTEN_MS_MAX);
        }
        let mut buffer = [0; 256];
        let count = self.link.receive(&mut buffer, until_ms)?;
        let now_ms = self.link.now_ms();
        let bytes = buffer.get(..count).unwrap_or(&buffer);
        if let Some(sink) = self.options.on_line.as_mut().filter(|_| !bytes.is_empty()) {
            sink(&LineEvent::Received { time_ms: now_ms, bytes });
        }
        for byte in bytes {
            if let Fed::Package(content) = self.listener.feed(*byte, now_ms) {
                self.log(PackageRecord::received(now_ms, &content));
            }
        }
        self.session.handle_bytes(bytes, now_ms);
        Ok(())
    }

    /// Waits for a command, or until `wake_ms`.
    fn rest(&mut self, wake_ms: u64) {
        self.publish_clock();
        if self.link.is_paced_by_caller() {
            if self.has_callers() {
                self.link.wait_until(wake_ms);
                self.publish_clock();
            } else {
                match self.commands.recv() {
                    Ok(command) => self.take(command),
                    Err(_) => self.is_closing = true,
                }
            }
            return;
        }
        let left_ms = wake_ms.saturating_sub(self.link.now_ms());
        match self.commands.recv_timeout(Duration::from_millis(left_ms)) {
            Ok(command) => self.take(command),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => self.is_closing = true,
        }
    }

    fn take(&mut self, command: Command) {
        match command {
            Command::Open { address, reply } => {
                self.pending.push_back(Pending { address, work: Work::Open, reply: Some(reply) });
            }
            Command::Request { address, request, stop_generation, reply } => {
                let work = Work::Request { request, stop_generation, opened: false };
                self.pending.push_back(Pending { address, work, reply: Some(reply) });
            }
            Command::Stop { address, reply } => self.stops.push_back((address, Some(reply))),
            Command::Wait { until_ms, newer_than, reply } => {
                self.waits.push(Wait { until_ms, newer_than, reply });
            }
            Command::Subscribe { to } => self.subscribers.push(to),
            Command::Close => self.is_closing = true,
        }
    }

    /// Lets the session act until it has nothing to do but wait.
    fn pump(&mut self) -> Result<(), Error> {
        loop {
            let mut progressed = false;
            while let Some(event) = self.session.poll_event() {
                self.handle_event(event);
                progressed = true;
            }
            progressed |= self.put_stops();
            if self.session.is_free() {
                progressed |= self.put_next();
            }
            let now_ms = self.link.now_ms();
            while let Some(bytes) = self.session.poll_transmit(now_ms) {
                self.transmit(&bytes, now_ms)?;
                progressed = true;
            }
            if !progressed {
                return Ok(());
            }
        }
    }

    /// Puts the next request on the free line: a heartbeat that is due, or what was asked first.
    fn put_next(&mut self) -> bool {
        // With a virtual clock only when someone waits, so that what is sent does not depend on
        // how quickly the program's threads run.
        let is_asked = !self.link.is_paced_by_caller() || self.has_callers();
        let is_its_turn = self.pending.is_empty() || !self.was_heartbeat;
        let now_ms = self.link.now_ms();
        if is_asked
            && is_its_turn
            && let Some(address) = Address::ALL
                .into_iter()
                .find(|address| self.heartbeat_ms(*address).is_some_and(|due_ms| now_ms >= due_ms))
            && let Ok(ticket) = self.session.request(address, Request::State)
        {
            self.asked.push(Asked {
                ticket,
                address,
                kind: Kind::State,
                dead_man_ms: None,
                reply: None,
            });
            self.was_heartbeat = true;
            return true;
        }
        let Some(pending) = self.pending.pop_front() else { return false };
        self.was_heartbeat = false;
        self.put(pending);
        true
    }

    fn put(&mut self, mut pending: Pending) {
        let address = pending.address;
        let mut dead_man_ms = None;
        let (kind, ticket) = match &mut pending.work {
            Work::Open => (Kind::Hello, self.session.open(address)),
            Work::Request { request, stop_generation, opened } => {
                let kind = request.kind();
                let stop_now = self.shared.stop_generation.load(Ordering::SeqCst);
                if *stop_generation != stop_now {
                    return reply_to(pending.reply, Err(Error::Displaced { kind }));
                }
                let needs_session =
                    kind.is_numbered() && self.session.open_session(address).is_none();
                if needs_session && !*opened {
                    *opened = true;
                    self.pending.push_front(pending);
                    let hello = Pending { address, work: Work::Open, reply: None };
                    return self.put(hello);
                }
                if let Request::Configure(Parameter::DeadMan { timeout_ms }) = request {
                    dead_man_ms = Some(*timeout_ms);
                }
                (kind, self.session.request(address, *request))
            }
        };
        match ticket {
            Ok(ticket) => {
                let reply = pending.reply;
                self.asked.push(Asked { ticket, address, kind, dead_man_ms, reply });
            }
            // Either no session could be opened for it, or its arguments are out of range, which
            // the controllers' methods have ruled out; the robot would say the same.
            Err(error) => {
                let status = match error {
                    rsapien_protocol::RequestError::BadArgument { .. } => Status::BadArgument,
                    _ => Status::NoSession,
                };
                reply_to(pending.reply, Err(Error::Refused { address, kind, status }));
            }
        }
    }

    fn transmit(&mut self, bytes: &[u8], now_ms: u64) -> Result<(), Error> {
        // Before they are on their way: what comes of them is recorded behind them.
        if let Some(sink) = self.options.on_line.as_mut() {
            sink(&LineEvent::Sent { time_ms: now_ms, bytes });
        }
        self.link.send(bytes)?;
        let mut receiver = rsapien_protocol::Receiver::listening(Direction::ToRobot);
        let content = bytes.iter().find_map(|byte| match receiver.feed(*byte, now_ms) {
            Fed::Package(content) => Some(content),
            _ => None,
        });
        let Some(content) = content else { return Ok(()) };
        let address = content.address();
        let care = self.care_mut(address);
        care.last_sent_ms = now_ms;
        self.state.counts.sent += 1;
        let direction = Direction::ToRobot;
        self.log(PackageRecord { time_ms: now_ms, direction, address, bytes: bytes.to_vec() });
        Ok(())
    }

    fn publish(&mut self, now_ms: u64) {
        self.state.time_ms = now_ms;
        self.state.version += 1;
        self.state.sessions = Address::ALL.map(|address| self.session.open_session(address));
        self.state.counts.reception_errors = self.session.counts().errors;
        *self.shared.state() = self.state.clone();
        if let Some(sink) = self.options.on_line.as_mut() {
            sink(&LineEvent::State(&self.state));
        }
        self.publish_clock();
        let state = &self.state;
        // One that is too slow misses states; one that is gone is forgotten.
        self.subscribers.retain(|subscriber| {
            !matches!(subscriber.try_send(state.clone()), Err(TrySendError::Disconnected(_)))
        });
    }

    fn publish_clock(&self) {
        self.shared.virtual_now_ms.store(self.link.now_ms(), Ordering::SeqCst);
    }

    fn log(&mut self, record: PackageRecord) {
        if let Some(sink) = self.options.on_package.as_mut() {
            sink(&record);
        }
        if let Some(sink) = self.options.on_line.as_mut() {
            sink(&LineEvent::Package(&record));
        }
        self.shared.log().push(record);
    }

    fn end_waits(&mut self) {
        let now_ms = self.link.now_ms();
        let version = self.state.version;
        self.publish_clock();
        self.waits.retain(|wait| {
            let is_over =
                now_ms >= wait.until_ms || wait.newer_than.is_some_and(|seen| version > seen);
            !(is_over && {
                let _ = wait.reply.send(());
                true
            })
        });
    }

    /// Whether someone waits for the line. A virtual clock stands still when nobody does, even with
    /// a package on the way: what its user reads then does not depend on how fast threads run.
    fn has_callers(&self) -> bool {
        !self.waits.is_empty()
            || !self.pending.is_empty()
            || !self.stops.is_empty()
            || self.asked.iter().any(|asked| asked.reply.is_some())
    }

    fn next_wait_ms(&self) -> u64 {
        self.waits.iter().map(|wait| wait.until_ms).min().unwrap_or(u64::MAX)
    }
}

fn session_config(options: &LineOptions, first_session: u8) -> SessionConfig {
    SessionConfig { baud: options.baud, first_session, ..SessionConfig::default() }
}

fn reply_to(reply: Option<Reply>, outcome: Result<Answer, Error>) {
    if let Some(reply) = reply {
        // Who asked may have gone; the outcome stands in the state all the same.
        let _ = reply.send(outcome);
    }
}
