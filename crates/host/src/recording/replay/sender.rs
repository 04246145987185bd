//! The PC's end of the line in a replay: recorded packages, numbered anew.

use rsapien_protocol::{
    ActionPackage, Address, Direction, Fed, Mode, Receiver, Request, SessionConfig,
    SynchronizationPackage,
};

use super::{Exchange, ReplayError, mode_of};
use crate::CancelToken;
use crate::link::Link;
use crate::recording::exchange::is_answer;

/// How often cancelling is looked for, in ms.
const LOOK_MS: u64 = 10;
/// How often a package is sent that has an answer in the recording.
const TRIES: u8 = 6;

/// How one controller's packages are numbered.
#[derive(Clone, Copy, Default)]
struct Numbering {
    /// The recorded session that is open.
    recorded_session: Option<u8>,
    /// What is added to recorded sequence numbers.
    shift: u8,
    /// The last own number.
    last: u8,
}

/// Sends packages and waits for their answers.
pub(super) struct Sender {
    link: Box<dyn Link>,
    answer_time_ms: u64,
    receiver: Receiver,
    numbering: [Numbering; 2],
    /// What is added to recorded session numbers: a robot may know the recorded ones.
    session_shift: u8,
    /// From the recorded clock to the link's; none until the first package.
    clock_shift_ms: Option<i64>,
    cancel: CancelToken,
    is_stopping: bool,
    /// As told last: motion, camera.
    modes: [Option<Mode>; 2],
}

impl Sender {
    /// `keeps_clock`: the link's clock begins where the recorded one did, and nobody spoke to the robot before.
    pub(super) fn new(
        link: Box<dyn Link>,
        baud: u32,
        keeps_clock: bool,
        cancel: CancelToken,
    ) -> Sender {
        let config = SessionConfig { baud, ..SessionConfig::default() };
        Sender {
            link,
            answer_time_ms: config.answer_time_ms(),
            receiver: Receiver::listening(Direction::ToPc),
            numbering: Default::default(),
            session_shift: if keeps_clock { 0 } else { crate::robot::random_session() },
            clock_shift_ms: keeps_clock.then_some(0),
            cancel,
            is_stopping: false,
            modes: [None; 2],
        }
    }

    /// Lets this moment stand for a recorded one; without one, for that of the next package.
    pub(super) fn begin_clock_at(&mut self, recorded_ms: Option<u64>) {
        self.clock_shift_ms = None;
        if let Some(recorded_ms) = recorded_ms {
            self.due_ms(recorded_ms);
        }
    }

    /// The time of the link's clock at which a package of this recorded time is due. The first is due now.
    pub(super) fn due_ms(&mut self, recorded_ms: u64) -> u64 {
        let now_ms = self.link.now_ms();
        let shift_ms = *self
            .clock_shift_ms
            .get_or_insert(now_ms.cast_signed().saturating_sub(recorded_ms.cast_signed()));
        recorded_ms.saturating_add_signed(shift_ms)
    }

    /// The controller's mode, as it told last.
    pub(super) fn mode(&self, address: Address) -> Option<Mode> {
        self.modes[usize::from(address == Address::Camera)]
    }

    pub(super) fn now_ms(&self) -> u64 {
        self.link.now_ms()
    }

    /// Lets time pass.
    pub(super) fn wait_until(&mut self, until_ms: u64) -> Result<(), ReplayError> {
        loop {
            self.check()?;
            let now_ms = self.link.now_ms();
            if now_ms >= until_ms {
                return Ok(());
            }
            self.link.wait_until(until_ms.min(now_ms + LOOK_MS));
        }
    }

    /// Sends a recorded package. Without an answer in the recording it is not sent twice: its copies, if
    /// there were any, follow by themselves.
    pub(super) fn send(
        &mut self,
        exchange: &Exchange,
    ) -> Result<Option<SynchronizationPackage>, ReplayError> {
        let package = self.renumbered(exchange.address, exchange.package)?;
        let tries = if exchange.answer.is_some() { TRIES } else { 1 };
        self.exchange(exchange.address, package, tries)
    }

    /// Sends a request of the replay's own; none when no answer comes.
    pub(super) fn ask(
        &mut self,
        address: Address,
        request: Request,
    ) -> Result<Option<SynchronizationPackage>, ReplayError> {
        let numbering = self.numbering_mut(address);
        let session = numbering.recorded_session.unwrap_or(0);
        let mut sequence = 0;
        if request.kind().is_numbered() {
            numbering.last = numbering.last.wrapping_add(1);
            sequence = numbering.last;
        }
        let session = self.session(session);
        self.exchange(address, ActionPackage { session, sequence, request }, TRIES)
    }

    /// Opens the session that stands for a recorded one.
    pub(super) fn open(
        &mut self,
        address: Address,
        recorded_session: u8,
    ) -> Result<(), ReplayError> {
        let session = self.session(recorded_session);
        let version = rsapien_protocol::PROTOCOL_VERSION;
        let request = Request::Hello { lowest_version: version, highest_version: version, session };
        self.exchange(address, ActionPackage { session, sequence: 0, request }, TRIES)?;
        let recorded_session = Some(recorded_session);
        *self.numbering_mut(address) = Numbering { recorded_session, shift: 0, last: 0 };
        Ok(())
    }

    /// Lets recorded numbers go on behind the own ones: `next` is the next recorded one.
    pub(super) fn go_on(&mut self, address: Address, next: u8) {
        let numbering = self.numbering_mut(address);
        numbering.shift = numbering.last.wrapping_add(1).wrapping_sub(next);
    }

    /// At the end: what still moves is stopped.
    pub(super) fn rest(&mut self) {
        if matches!(self.mode(Address::Motion), Some(Mode::Initialising | Mode::Executing)) {
            self.stop();
        }
    }

    /// Stops the motors, whatever was cancelled.
    fn stop(&mut self) {
        self.is_stopping = true;
        // Without an answer, the dead-man is left to stop the robot.
        let _ = self.ask(Address::Motion, Request::Stop);
        let _ = self.ask(Address::Camera, Request::Stop);
    }

    /// Ends the replay when that is asked for, motors off first.
    fn check(&mut self) -> Result<(), ReplayError> {
        if self.is_stopping || !self.cancel.is_cancelled() {
            return Ok(());
        }
        self.stop();
        Err(ReplayError::Cancelled)
    }

    fn renumbered(
        &mut self,
        address: Address,
        recorded: ActionPackage,
    ) -> Result<ActionPackage, ReplayError> {
        let mut request = recorded.request;
        let session = self.session(recorded.session);
        let mut sequence = recorded.sequence;
        if let Request::Hello { session: proposed, .. } = &mut request {
            let numbering = self.numbering_mut(address);
            // Naming the open session changes nothing; another one begins to count.
            if numbering.recorded_session.replace(*proposed) != Some(*proposed) {
                (numbering.shift, numbering.last) = (0, 0);
            }
            *proposed = self.session(*proposed);
        } else if request.kind().is_numbered() {
            if self.numbering_mut(address).recorded_session != Some(recorded.session) {
                // The recording began in the middle of a session.
                self.open(address, recorded.session)?;
                self.go_on(address, recorded.sequence);
            }
            let numbering = self.numbering_mut(address);
            sequence = recorded.sequence.wrapping_add(numbering.shift);
            numbering.last = sequence;
        }
        Ok(ActionPackage { session, sequence, request })
    }

    /// The session that stands for a recorded one; 0 is none.
    fn session(&self, recorded: u8) -> u8 {
        match recorded.checked_sub(1) {
            None => 0,
            Some(index) => {
                let shifted = (u16::from(index) + u16::from(self.session_shift)) % 255 + 1;
                u8::try_from(shifted).unwrap_or(1)
            }
        }
    }

    fn exchange(
        &mut self,
        address: Address,
        package: ActionPackage,
        tries: u8,
    ) -> Result<Option<SynchronizationPackage>, ReplayError> {
        let bytes = package.encode(address);
        for _ in 0..tries {
            self.check()?;
            self.link.send(&bytes)?;
            let deadline_ms = self.link.now_ms() + self.answer_time_ms;
            if let Some(answer) = self.listen(address, &package, deadline_ms)? {
                return Ok(Some(answer));
            }
        }
        Ok(None)
    }

    /// Waits for the answer to `package`.
    fn listen(
        &mut self,
        address: Address,
        package: &ActionPackage,
        deadline_ms: u64,
    ) -> Result<Option<SynchronizationPackage>, ReplayError> {
        loop {
            // A STOP goes out as soon as the line is free: an answer is never far.
            let now_ms = self.link.now_ms();
            if now_ms >= deadline_ms {
                return Ok(None);
            }
            let mut buffer = [0; 256];
            let count = self.link.receive(&mut buffer, deadline_ms)?;
            let now_ms = self.link.now_ms();
            let mut found = None;
            for byte in buffer.get(..count).unwrap_or(&buffer) {
                let Fed::Package(content) = self.receiver.feed(*byte, now_ms) else { continue };
                let Ok(answer) = SynchronizationPackage::parse(&content) else { continue };
                if content.address() == address && is_answer(&answer, package) {
                    found = Some(answer);
                }
            }
            if let Some(answer) = found {
                self.modes[usize::from(address == Address::Camera)] =
                    mode_of(&answer).or(self.mode(address));
                return Ok(Some(answer));
            }
        }
    }

    fn numbering_mut(&mut self, address: Address) -> &mut Numbering {
        let [motion, camera] = &mut self.numbering;
        match address {
            Address::Motion => motion,
            Address::Camera => camera,
        }
    }
}
