//! A chip on the measuring bench, with a PC that numbers its packages.

use crate::firmware::gpsim::{Gpsim, GpsimError, Happening, Image};
use crate::read;
use rsapien_protocol::{
    ActionPackage, Address, CountersReport, Fed, Joint, Parameter, Receiver, Report, Request,
    Status, SynchronizationPackage,
};

/// A chip, and what happened to it since somebody looked.
#[derive(Debug)]
pub(super) struct Rig {
    pub(super) chip: Gpsim,
    pub(super) image: Image,
    /// Now.
    pub(super) cycle: u64,
    log: Vec<(u64, Happening)>,
    sequence: u8,
}

const SESSION: u8 = 1;
/// More than the chip takes between a package and what it leads to.
pub(super) const PATIENCE_CYCLES: u64 = 20_000;

impl Rig {
    /// The chip with its power just on; its line rests, nothing is pressed.
    pub(super) fn power_on(image: &Image) -> Result<Rig, GpsimError> {
        let chip = Gpsim::start(image)?;
        let (image, log) = (image.clone(), Vec::new());
        Ok(Rig { chip, image, cycle: 0, log, sequence: 0 })
    }

    /// The chip in an open session, its dead-man off; the motion controller initialised, its joints
    /// so slow that they run for seconds.
    pub(super) fn ready(image: &Image) -> Result<Rig, GpsimError> {
        let mut rig = Rig::power_on(image)?;
        rig.run_ms(30)?;
        let hello = Request::Hello { lowest_version: 1, highest_version: 1, session: SESSION };
        rig.ask(hello)?;
        rig.ask(Request::Configure(Parameter::DeadMan { timeout_ms: 0 }))?;
        match image.address {
            Address::Motion => {
                rig.configure_travel(100)?;
                rig.ask(Request::Init)?;
                rig.run_ms(400)?;
                rig.configure_travel(10_000)?;
            }
            Address::Camera => {
                rig.ask(Request::Home)?;
                rig.run_ms(800)?;
            }
        }
        Ok(rig)
    }

    pub(super) fn configure_travel(&mut self, full_travel_ms: u16) -> Result<(), GpsimError> {
        for joint in Joint::ALL {
            self.ask(Request::Configure(Parameter::TravelTime { joint, full_travel_ms }))?;
        }
        Ok(())
    }

    pub(super) fn cycles_a_ms(&self) -> u64 {
        self.image.cycles_a_ms()
    }

    pub(super) fn run_to(&mut self, cycle: u64) -> Result<(), GpsimError> {
        if let Some(cycles) = cycle.checked_sub(self.cycle).filter(|cycles| *cycles > 0) {
            self.log.extend(self.chip.advance(cycles)?);
            self.cycle = cycle;
        }
        Ok(())
    }

    pub(super) fn run_ms(&mut self, ms: u64) -> Result<(), GpsimError> {
        self.run_to(self.cycle + ms * self.cycles_a_ms())
    }

    /// What happened since this was asked last.
    pub(super) fn take(&mut self) -> Vec<(u64, Happening)> {
        std::mem::take(&mut self.log)
    }

    /// The line bytes of a package in its turn.
    pub(super) fn package(&mut self, request: Request) -> Vec<u8> {
        if request.kind().is_numbered() {
            self.sequence = self.sequence.wrapping_add(1);
        }
        let sequence = self.sequence;
        let package = ActionPackage { session: SESSION, sequence, request };
        package.encode(self.image.address).to_vec()
    }

    /// Cycles that `bytes` take on the line.
    pub(super) fn line_cycles(&self, bytes: usize) -> u64 {
        self.image.cycles_a_byte() * bytes as u64
    }

    /// Puts bytes on the line so that they are complete about `end`.
    pub(super) fn send_until(&mut self, bytes: &[u8], end: u64) -> Result<(), GpsimError> {
        let begin = end.saturating_sub(self.line_cycles(bytes.len()));
        self.chip.send(bytes, begin)
    }

    /// Sends a request and waits for the answer, which has to accept it.
    pub(super) fn ask(&mut self, request: Request) -> Result<SynchronizationPackage, GpsimError> {
        let bytes = self.package(request);
        self.take();
        self.chip.send(&bytes, self.cycle)?;
        let both = bytes.len() + rsapien_protocol::SYNCHRONIZATION_PACKAGE_LENGTH;
        self.run_to(self.cycle + self.line_cycles(both + 2) + PATIENCE_CYCLES)?;
        let answer = answers(&self.take()).pop();
        let answer = answer.filter(|answer| answer.status == Status::Accepted);
        answer.ok_or_else(|| {
            GpsimError::Broken(format!(
                "{}: {request:?} is not accepted: {answer:?}",
                self.image.hex.display()
            ))
        })
    }

    /// Makes sure that everything sent in its turn was executed.
    pub(super) fn expect_all_executed(&mut self) -> Result<(), GpsimError> {
        let hello = Request::Hello { lowest_version: 1, highest_version: 1, session: SESSION };
        let report = self.ask(hello)?.report;
        match report {
            Report::Hello(report) if report.last_sequence == self.sequence => Ok(()),
            other => {
                let (image, sequence) = (self.image.hex.display(), self.sequence);
                Err(GpsimError::Broken(format!(
                    "{image}: executed up to {other:?}, not {sequence}"
                )))
            }
        }
    }

    /// What the chip has counted.
    pub(super) fn counters(&mut self) -> Result<CountersReport, GpsimError> {
        match self.ask(Request::Counters)?.report {
            Report::Counters(counters) => Ok(counters),
            other => Err(GpsimError::Broken(format!("COUNTERS is answered with {other:?}"))),
        }
    }

    /// The last turn of the test point, in this rig's time: where the present tick began, nearly.
    pub(super) fn tick_edge(&mut self) -> Result<u64, GpsimError> {
        self.take();
        self.run_ms(2)?;
        let pin = tick_pin(self.image.address);
        let edge = self.take().into_iter().rev().find_map(|(at, happening)| match happening {
            Happening::Edge(name, _) if name == pin => Some(at),
            _ => None,
        });
        edge.ok_or_else(|| GpsimError::Broken("the chip does not tick".to_owned()))
    }

    /// Marks the addresses where something begins, by the names of the image's symbols, and where
    /// interrupts return.
    pub(super) fn mark(&mut self, symbols: &[&str]) -> Result<(), GpsimError> {
        for symbol in symbols {
            self.chip.tell(&format!("mark {symbol} {symbol}"))?;
        }
        Ok(())
    }

    /// Where the routine of a symbol returns from its interrupt.
    pub(super) fn interrupt_return(&self, symbol: &str) -> Result<u32, GpsimError> {
        const RETFIE: [u16; 2] = [0x0010, 0x0011];
        let missing = || GpsimError::Broken(format!("{symbol} is not in the image's symbols"));
        let symbols = self.symbols().ok_or_else(missing)?;
        let begin = symbols.iter().find(|(name, _)| name == symbol).ok_or_else(missing)?.1;
        let end = symbols.iter().map(|(_, address)| *address).filter(|at| *at > begin).min();
        let code = program(&read(&self.image.hex));
        let mut returns = code.into_iter().filter(|(address, word)| {
            (begin..end.unwrap_or(u32::MAX)).contains(address) && RETFIE.contains(word)
        });
        match (returns.next(), returns.next()) {
            (Some((address, _)), None) => Ok(address),
            _ => Err(GpsimError::Broken(format!("{symbol} does not return in one place"))),
        }
    }

    fn symbols(&self) -> Option<Vec<(String, u32)>> {
        let text = read(self.image.symbols.as_ref()?);
        let symbol = |line: &str| {
            let (name, address) = line.split_once(' ')?;
            let address = u32::from_str_radix(address.trim().strip_prefix("0x")?, 16).ok()?;
            Some((name.to_owned(), address))
        };
        Some(text.lines().filter_map(symbol).collect())
    }
}

/// The test point that turns every ms.
pub(super) const fn tick_pin(address: Address) -> &'static str {
    match address {
        Address::Motion => "re1",
        Address::Camera => "rb1",
    }
}

/// The intact answers among what the chip said.
pub(super) fn answers(log: &[(u64, Happening)]) -> Vec<SynchronizationPackage> {
    let mut receiver = Receiver::for_pc();
    let answer = |(_, happening): &(u64, Happening)| match happening {
        Happening::Byte(byte) => match receiver.feed(*byte, 0) {
            Fed::Package(content) => SynchronizationPackage::parse(&content).ok(),
            _ => None,
        },
        _ => None,
    };
    log.iter().filter_map(answer).collect()
}

/// The words of program memory of an Intel HEX text, with their addresses.
fn program(text: &str) -> Vec<(u32, u16)> {
    const DATA: u8 = 0;
    const UPPER_ADDRESS: u8 = 4;
    let mut words = Vec::new();
    let mut upper = 0;
    for line in text.lines().filter_map(|line| line.trim().strip_prefix(':')) {
        let bytes: Vec<u8> = line
            .as_bytes()
            .chunks(2)
            .filter_map(|pair| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok())
            .collect();
        let [_, high, low, sort, data @ .., _] = bytes.as_slice() else { continue };
        let address = upper + u32::from(u16::from_be_bytes([*high, *low]));
        match (*sort, data) {
            (DATA, data) => words.extend(
                data.chunks_exact(2)
                    .zip((address..).step_by(2))
                    .map(|(pair, address)| (address, u16::from_le_bytes([pair[0], pair[1]]))),
            ),
            (UPPER_ADDRESS, [high, low]) => {
                upper = u32::from(u16::from_be_bytes([*high, *low])) << 16;
            }
            _ => {}
        }
    }
    words
}
