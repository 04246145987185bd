//! Packages, and what is no package, made of the recorded bytes.

use std::fmt;

use rsapien_protocol::{
    Address, Content, Direction, Fed, Joint, Kind, Mode, MotionReport, Receiver, ReceptionState,
    Report, StopCause, SynchronizationPackage,
};

use super::BytesMessage;
use super::json::hex;
use crate::PackageRecord;

/// What some bytes on the line are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum What {
    /// An intact package.
    Package(Content),
    /// A package whose checksum is wrong: some of its bytes were changed on the way.
    CrcError,
    /// A package that broke off: a byte that has no place there, or the header of the next one, came.
    BrokenOff,
    /// A package whose next byte did not come in time.
    Gap,
    /// Bytes outside any package.
    Stray,
}

/// What is remarkable about a package.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineMark {
    /// The same bytes as before, because no answer came.
    Resent {
        /// Which try it is, from 2 on.
        try_number: u32,
    },
    /// The request before it, to the same controller, was never answered.
    LeftUnanswered,
    /// It answers another request than the last one: it is late, or one of another program's.
    Unasked,
    /// The controller was reset since its last report.
    Restarted {
        /// Why.
        cause: StopCause,
    },
}

impl fmt::Display for LineMark {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LineMark::Resent { try_number } => write!(formatter, "sent again, try {try_number}"),
            LineMark::LeftUnanswered => formatter.write_str("the request before has no answer"),
            LineMark::Unasked => formatter.write_str("answers nothing that was just asked"),
            LineMark::Restarted { cause } => {
                write!(formatter, "the controller was reset ({})", cause.name())
            }
        }
    }
}

/// One line of a log: a package, or bytes that are none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LineEntry {
    /// When it was complete, or when it was seen to be none, in ms of the line's clock.
    pub time_ms: u64,
    /// Which way it went.
    pub direction: Direction,
    /// What it is.
    pub what: What,
    /// Its bytes.
    pub bytes: Vec<u8>,
    /// What is remarkable about it.
    pub marks: Vec<LineMark>,
}

impl LineEntry {
    /// The controller that it goes to or comes from; none where that cannot be known.
    pub fn address(&self) -> Option<Address> {
        match &self.what {
            What::Package(content) => Some(content.address()),
            _ => None,
        }
    }

    /// Whether something went wrong on the line.
    pub fn is_error(&self) -> bool {
        !matches!(self.what, What::Package(_))
    }

    /// What it says, in words.
    pub fn words(&self) -> String {
        let what = match &self.what {
            What::Package(content) => return self.package_words(content),
            What::CrcError => "CRC error: a package came changed",
            What::BrokenOff => "reception reset: a package broke off",
            What::Gap => "gap: the rest of a package did not come in time",
            What::Stray => "stray bytes outside any package",
        };
        format!("{what} [{}]", hex(&self.bytes))
    }

    fn package_words(&self, content: &Content) -> String {
        let parsed = SynchronizationPackage::parse(content);
        match (self.direction, parsed) {
            (
                Direction::ToPc,
                Ok(SynchronizationPackage { report: Report::Motion(report), .. }),
            ) => {
                let record = self.record(content);
                let meaning = record.meaning();
                let head = meaning.split_once(": ").map_or(meaning.as_str(), |(head, _)| head);
                format!("{head}: {}", motion_words(&report))
            }
            _ => self.record(content).meaning(),
        }
    }

    fn record(&self, content: &Content) -> PackageRecord {
        PackageRecord {
            time_ms: self.time_ms,
            direction: self.direction,
            address: content.address(),
            bytes: self.bytes.clone(),
        }
    }
}

/// One line: time in s, direction, controller, words, marks.
impl fmt::Display for LineEntry {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let arrow = match self.direction {
            Direction::ToRobot => "->",
            Direction::ToPc => "<-",
        };
        let (seconds, thousandths) = (self.time_ms / 1000, self.time_ms % 1000);
        let address = self.address().map_or("?", Address::name);
        let flag = if self.is_error() || !self.marks.is_empty() { '!' } else { ' ' };
        let words = self.words();
        write!(formatter, "{seconds:4}.{thousandths:03} {arrow} {address:<6} {flag} {words}")?;
        for mark in &self.marks {
            write!(formatter, "; {mark}")?;
        }
        Ok(())
    }
}

/// `executing; motors right-arm; bumpers left-hand; 7 free, 2 ended`.
pub(super) fn motion_words(report: &MotionReport) -> String {
    let mut words = report.mode.name().to_owned();
    // Otherwise it tells of a hold or a reset that is long over.
    if matches!(report.mode, Mode::Fresh | Mode::Held) {
        words = format!("{words} ({})", report.cause.name());
    }
    let mut add = |what: &str, names: &[&str]| {
        if !names.is_empty() {
            words = format!("{words}; {what} {}", names.join(" "));
        }
    };
    let running = |joint: &Joint| report.is_running(*joint);
    let motors: Vec<&str> = Joint::ALL.into_iter().filter(running).map(Joint::name).collect();
    add("motors", &motors);
    add("bumpers", &report.bumpers.names().collect::<Vec<_>>());
    if report.supply_low {
        add("supply", &["low"]);
    }
    format!("{words}; {} free, {} ended", report.queue_free, report.steps_ended)
}

/// One direction of the line.
struct Side {
    direction: Direction,
    receiver: Receiver,
    raw: Vec<u8>,
    /// When the last of them came.
    last_ms: u64,
}

/// Stray bytes that come further apart do not belong together.
const STRAY_GAP_MS: u64 = rsapien_protocol::GAP_MS_PC;

impl Side {
    fn new(direction: Direction) -> Side {
        Side { direction, receiver: Receiver::listening(direction), raw: Vec::new(), last_ms: 0 }
    }

    fn entry(&mut self, time_ms: u64, what: What) -> LineEntry {
        let bytes = std::mem::take(&mut self.raw);
        LineEntry { time_ms, direction: self.direction, what, bytes, marks: Vec::new() }
    }

    /// The stray bytes that have come, if there are some.
    fn stray(&mut self) -> Option<LineEntry> {
        let is_stray = self.receiver.state() == ReceptionState::Hunting && !self.raw.is_empty();
        is_stray.then(|| self.entry(self.last_ms, What::Stray))
    }

    fn feed(&mut self, byte: u8, time_ms: u64, to: &mut Vec<LineEntry>) {
        if self.receiver.expire(time_ms) {
            to.push(self.entry(time_ms, What::Gap));
        }
        if time_ms.saturating_sub(self.last_ms) > STRAY_GAP_MS {
            to.extend(self.stray());
        }
        self.last_ms = time_ms;
        let was_hunting = self.receiver.state() == ReceptionState::Hunting;
        let resets = self.receiver.counts().resets;
        let fed = self.receiver.feed(byte, time_ms);
        let is_header_in_package = fed != Fed::Reset && self.receiver.counts().resets != resets;
        if is_header_in_package {
            to.push(self.entry(time_ms, What::BrokenOff));
        } else if was_hunting && fed == Fed::More && !self.raw.is_empty() {
            to.push(self.entry(time_ms, What::Stray));
        }
        self.raw.push(byte);
        let what = match fed {
            Fed::More | Fed::Skipped => return,
            Fed::Package(content) => What::Package(content),
            Fed::CrcError => What::CrcError,
            Fed::Reset => What::BrokenOff,
        };
        to.push(self.entry(time_ms, what));
    }
}

/// What was sent to a controller last.
struct Sent {
    bytes: Vec<u8>,
    tries: u32,
    is_answered: bool,
}

/// Makes packages of the recorded bytes, with the reception of the ends of the line.
pub struct LineDecoder {
    to_robot: Side,
    to_pc: Side,
    sent: [Option<Sent>; 2],
    boots: [Option<u8>; 2],
}

impl Default for LineDecoder {
    fn default() -> LineDecoder {
        LineDecoder::new()
    }
}

impl LineDecoder {
    /// At the begin of a recording.
    pub fn new() -> LineDecoder {
        LineDecoder {
            to_robot: Side::new(Direction::ToRobot),
            to_pc: Side::new(Direction::ToPc),
            sent: [None, None],
            boots: [None; 2],
        }
    }

    /// What the bytes complete.
    pub fn feed(&mut self, message: &BytesMessage) -> Vec<LineEntry> {
        let mut entries = Vec::new();
        let (side, other) = match message.direction {
            Direction::ToRobot => (&mut self.to_robot, &mut self.to_pc),
            Direction::ToPc => (&mut self.to_pc, &mut self.to_robot),
        };
        entries.extend(other.stray());
        for byte in &message.bytes {
            side.feed(*byte, message.time_ms, &mut entries);
        }
        for entry in &mut entries {
            self.mark(entry);
        }
        entries
    }

    /// What is left when the recording ends.
    pub fn finish(&mut self, time_ms: u64) -> Vec<LineEntry> {
        let sides = [&mut self.to_robot, &mut self.to_pc];
        let left = sides.into_iter().filter(|side| !side.raw.is_empty());
        left.map(|side| side.stray().unwrap_or_else(|| side.entry(time_ms, What::Gap))).collect()
    }

    fn mark(&mut self, entry: &mut LineEntry) {
        let What::Package(content) = &entry.what else { return };
        let index = usize::from(content.address() == Address::Camera);
        let Some(sent) = self.sent.get_mut(index) else { return };
        if entry.direction == Direction::ToRobot {
            match sent {
                Some(sent) if sent.bytes == entry.bytes => {
                    sent.tries += 1;
                    entry.marks.push(LineMark::Resent { try_number: sent.tries });
                }
                _ => {
                    if sent.as_ref().is_some_and(|sent| !sent.is_answered) {
                        entry.marks.push(LineMark::LeftUnanswered);
                    }
                    let bytes = entry.bytes.clone();
                    *sent = Some(Sent { bytes, tries: 1, is_answered: false });
                }
            }
            return;
        }
        let Ok(answer) = SynchronizationPackage::parse(content) else { return };
        match sent {
            Some(sent) if answers(&answer, &sent.bytes) => sent.is_answered = true,
            _ => entry.marks.push(LineMark::Unasked),
        }
        if let Some(boot) = answer.report.boot()
            && let Some(known) = self.boots.get_mut(index)
            && known.replace(boot).is_some_and(|before| before != boot)
        {
            let cause = match answer.report {
                Report::Motion(report) => report.cause,
                Report::Camera(report) => report.cause,
                Report::Hello(report) => report.cause,
                Report::Counters(_) => StopCause::Nothing,
            };
            entry.marks.push(LineMark::Restarted { cause });
        }
    }
}

/// Whether `answer` names the request whose line bytes these are.
fn answers(answer: &SynchronizationPackage, request: &[u8]) -> bool {
    let mut receiver = Receiver::listening(Direction::ToRobot);
    request.iter().any(|byte| match receiver.feed(*byte, 0) {
        Fed::Package(content) => {
            let view = rsapien_protocol::ActionView::new(content.action());
            let Some(kind) = view.kind() else { return false };
            (answer.session, answer.sequence) == (view.session(), view.sequence())
                && Kind::from_byte(answer.kind_byte) == Some(kind)
        }
        _ => false,
    })
}
