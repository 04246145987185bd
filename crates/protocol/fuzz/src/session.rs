//! The PC's session under any sequence of calls, answers and times. Used by the fuzz target and by
//! the test that replays its corpus.
//!
//! Each byte is a call; some take the bytes behind it. What must hold: nothing panics, a ticket is
//! settled at most once, and when the line falls silent everything ends.

use rsapien_protocol::session::{Session, SessionConfig, SessionEvent, Ticket};
use rsapien_protocol::{
    ActionPackage, Address, Direction, Fed, HeaderByte, Kind, LineError, Pose, Receiver, Request,
    Step, frame,
};

struct World {
    session: Session,
    now_ms: u64,
    /// What the session sent last.
    sent: Option<ActionPackage>,
    waiting: Vec<Ticket>,
}

pub(crate) fn drive(input: &[u8]) {
    let mut bytes = input.iter().copied();
    let Some(first_session) = bytes.next() else { return };
    let config = SessionConfig { first_session, ..SessionConfig::default() };
    let mut world =
        World { session: Session::new(config), now_ms: 0, sent: None, waiting: Vec::new() };
    while let Some(call) = bytes.next() {
        let address = Address::ALL[usize::from(call >> 7)];
        match call & 0x0F {
            0 => {
                if let Ok(ticket) = world.session.open(address) {
                    world.waiting.push(ticket);
                }
            }
            1..=5 => world.request(call, address),
            6 => {
                if let Ok(ticket) = world.session.stop(address)
                    && !world.waiting.contains(&ticket)
                {
                    world.waiting.push(ticket);
                }
            }
            7 => world.transmit(),
            8 => world.fetch_events(),
            9 => {
                let wait_ms = u64::from(bytes.next().unwrap_or(0));
                world.now_ms = world.now_ms.saturating_add(wait_ms);
            }
            10 => world.session.handle_timeout(world.now_ms),
            11 => world.answer(address, &mut bytes),
            12 => {
                let line: Vec<u8> = bytes.by_ref().take(25).collect();
                world.session.handle_bytes(&line, world.now_ms);
            }
            13 => world.session.handle_line_error(LineError::Framing),
            14 => {
                if let Some(deadline_ms) = world.session.poll_timeout() {
                    world.now_ms = world.now_ms.max(deadline_ms);
                    world.session.handle_timeout(world.now_ms);
                }
            }
            _ => world.now_ms = world.now_ms.saturating_add(u64::MAX / 4),
        }
    }
    world.fall_silent();
}

impl World {
    fn request(&mut self, call: u8, address: Address) {
        let requests = [
            Request::State,
            Request::Step(Step::new(Pose::MIDDLE, u16::from(call >> 4 & 7))),
            Request::Counters,
            Request::Init,
            Request::Home,
        ];
        let request = requests[usize::from(call & 0x0F) - 1];
        if let Ok(ticket) = self.session.request(address, request) {
            assert!(request.is_valid());
            self.waiting.push(ticket);
        }
    }

    fn transmit(&mut self) {
        let Some(line) = self.session.poll_transmit(self.now_ms) else { return };
        let mut receiver = Receiver::listening(Direction::ToRobot);
        for byte in line {
            if let Fed::Package(content) = receiver.feed(byte, 0) {
                self.sent = ActionPackage::parse(content.action()).ok();
            }
        }
        assert!(self.sent.is_some_and(|package| package.request.is_valid()));
        assert_eq!(self.session.poll_transmit(self.now_ms), None);
    }

    /// An intact package, most often one that answers what was sent last.
    fn answer(&mut self, address: Address, bytes: &mut impl Iterator<Item = u8>) {
        let mut content = [0; 18];
        for byte in &mut content {
            *byte = bytes.next().unwrap_or(0);
        }
        if content[0] & 1 == 0
            && let Some(sent) = self.sent
        {
            (content[0], content[1]) = (sent.session, sent.sequence);
            content[2] = sent.request.kind().byte();
            if content[2] == Kind::Hello.byte() {
                content[3] = 0;
            }
        }
        let header = HeaderByte { direction: Direction::ToPc, address };
        let line: [u8; 25] = frame::encode(header, &content);
        self.session.handle_bytes(&line, self.now_ms);
    }

    fn fetch_events(&mut self) {
        while let Some(event) = self.session.poll_event() {
            let (SessionEvent::Answered { ticket, .. } | SessionEvent::Failed { ticket, .. }) =
                event
            else {
                continue;
            };
            let place = self.waiting.iter().position(|waiting| *waiting == ticket);
            self.waiting.remove(place.expect("a ticket that waits"));
        }
    }

    /// Two packages (what is outstanding, and STOP), one of them with a question behind it, of
    /// six tries each.
    fn fall_silent(&mut self) {
        for _ in 0..4 * 6 {
            self.fetch_events();
            self.transmit();
            if let Some(deadline_ms) = self.session.poll_timeout() {
                self.now_ms = self.now_ms.max(deadline_ms);
                self.session.handle_timeout(self.now_ms);
            }
        }
        self.fetch_events();
        assert!(self.session.is_free() && self.waiting.is_empty(), "{:?}", self.waiting);
    }
}
