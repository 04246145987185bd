//! The bench with the image that is flashed on the one side and the reference model on the other.
//!
//! The chip's test point tells the tick, so the model runs event by event beside it: its timer interrupt
//! where the test point turns, its receive interrupt where a byte is complete, its transmit interrupt
//! where the chip's comes. A package ends well inside a tick, so that both see it in the same one; then
//! every byte transmitted must be equal, and the pins at the end of the tick in which they change.
//!
//! ```text
//!   tick ├──┬────────┬───────┬────────────┬─────┤ next tick
//!        0 0.12     0.30    0.40         0.75   1 ms
//!        │  │        │       │            └ bumpers and supply change; time stops here
//!        │  │        │       └ a package's last byte is complete
//!        │  │        └ time stops here when one is on its way
//!        │  └ mid-arm switches change
//!        └ pins of the tick before compared; the model's timer interrupt and first pass
//! ```

mod line;

use super::bench::{Action, Bench, BenchError, World};
use super::event::Event;
use super::gpsim::{Gpsim, GpsimError, Happening, Image};
use super::record::hex;
use super::reference::Reference;
use super::scenario::is_rest;
use rsapien_firmware_model::{Inputs, ResetCause};
use rsapien_protocol::{Address, ByteClass, Joint, LineError};
use std::collections::VecDeque;

/// Parts of a tick, in hundredths.
const SWITCHES_AT: u64 = 12;
const BEFORE_LINE_AT: u64 = 30;
const LINE_AT: u64 = 40;
const BEHIND_LINE_AT: u64 = 52;
const END_AT: u64 = 75;
/// How long the chip takes to build an answer, nearly.
const BUILT_IN: u64 = 35;
/// The longest from power-on to the first tick, in ms: the EEPROM takes its time.
const START_MS_MAX: u64 = 60;
/// Bytes between the chip's memory and its pin: the one on the line and the one that waits.
const IN_FLIGHT: usize = 2;
impl From<GpsimError> for BenchError {
    fn from(error: GpsimError) -> BenchError {
        BenchError(error.to_string())
    }
}

/// What is on the line towards the chip.
#[derive(Clone, Copy, Debug)]
enum Sent {
    Byte(u8),
    Framing,
}

/// A line that has been given to the bridge ahead of time.
#[derive(Clone, Debug)]
struct Scheduled {
    bytes: Vec<u8>,
    end_cycle: u64,
}

/// The bench.
#[derive(Debug)]
pub struct HexBench {
    chip: Gpsim,
    world: World,
    image: Image,
    tick_cycles: u64,
    byte_cycles: u64,
    /// Now.
    cycle: u64,
    /// Where the test point turned last.
    tick_cycle: u64,
    /// Ticks since the start.
    ticks: u64,
    sent: VecDeque<Sent>,
    line_free_at: u64,
    scheduled: Option<Scheduled>,
    /// What the model has handed out and the chip has not said.
    in_flight: VecDeque<u8>,
    /// Where the answer on its way began, and how many of its bytes are out.
    answer_began: u64,
    answer_bytes: u64,
    /// A package has come while an answer was on its way, so that another may wait behind it.
    another_is_owed: bool,
    /// The outputs as they stand on the chip's pins.
    motors: [u8; 2],
    servos: super::servos::Servos,
    /// Bytes that both sides transmitted.
    pub bytes_equal: u64,
    /// Ticks at whose end the pins were compared.
    pub ticks_equal: u64,
    /// Pulses of both servos that were compared.
    pub pulses_equal: u64,
    /// Actions that the chip cannot be made to do.
    pub left_out: u64,
}

impl HexBench {
    /// Starts a chip with `eeprom_boot` in its EEPROM, and the model with it; ends in its first tick.
    ///
    /// # Errors
    /// When there is no simulator or no image, or nothing ticks.
    pub fn new(image: &Image, eeprom_boot: u8) -> Result<HexBench, BenchError> {
        let mut bench = HexBench {
            chip: Gpsim::start(image)?,
            world: World::new(image.address),
            image: image.clone(),
            tick_cycles: image.cycles_a_ms(),
            byte_cycles: image.cycles_a_byte(),
            cycle: 0,
            tick_cycle: 0,
            ticks: 0,
            sent: VecDeque::new(),
            line_free_at: 0,
            scheduled: None,
            in_flight: VecDeque::new(),
            answer_began: 0,
            answer_bytes: 0,
            another_is_owed: false,
            motors: [0, 0],
            servos: super::servos::Servos::new(image.cycles_a_ms()),
            bytes_equal: 0,
            ticks_equal: 0,
            pulses_equal: 0,
            left_out: 0,
        };
        bench.drive_inputs(None)?;
        bench.chip.tell(&format!("eeprom 0 {eeprom_boot}"))?;
        bench.begin(ResetCause::PowerOn, eeprom_boot)?;
        Ok(bench)
    }

    /// The chip has just been reset, with `eeprom_boot` in its EEPROM: goes on to the end of its first
    /// tick.
    fn begin(&mut self, cause: ResetCause, eeprom_boot: u8) -> Result<(), BenchError> {
        // One that resets once more than it is new, so that it starts for the cause.
        let mut reference = Reference::new(self.image.address, eeprom_boot.wrapping_sub(1))
            .with_clock_mhz(self.image.clock_mhz);
        reference.controller().reset(cause);
        self.world.reference = reference;
        self.servos.reset();
        self.in_flight.clear();
        self.ticks = 0;
        let end = self.cycle + START_MS_MAX * self.tick_cycles;
        while self.ticks == 0 {
            if self.cycle >= end {
                return Err(BenchError("the chip does not tick".to_owned()));
            }
            self.run_to(self.cycle + self.tick_cycles / 10)?;
        }
        self.go_on_to(self.part(END_AT))
    }

    /// The cycle of a part of this tick, in hundredths.
    const fn part(&self, hundredths: u64) -> u64 {
        self.tick_cycle + self.tick_cycles * hundredths / 100
    }

    /// How far into its tick a cycle is, in hundredths.
    const fn hundredths(&self, cycle: u64) -> u64 {
        (cycle - self.tick_cycle) % self.tick_cycles * 100 / self.tick_cycles
    }

    /// Runs on, past ticks if need be, stopping where switches change.
    fn go_on_to(&mut self, cycle: u64) -> Result<(), BenchError> {
        while self.cycle < cycle {
            let ticks = self.ticks;
            let stop = self.part(100 + SWITCHES_AT);
            self.run_to(stop.min(cycle))?;
            if self.ticks != ticks {
                // The tick has just been; the model's switches may lag behind the pins' of the body.
                self.run_to(self.part(SWITCHES_AT).max(self.cycle))?;
                self.change_switches()?;
            } else if self.cycle == stop {
                return Err(BenchError(format!("no tick about cycle {}", self.part(100))));
            }
        }
        Ok(())
    }

    fn run_to(&mut self, cycle: u64) -> Result<(), BenchError> {
        let Some(cycles) = cycle.checked_sub(self.cycle).filter(|cycles| *cycles > 0) else {
            return Ok(());
        };
        let happenings = self.chip.advance(cycles)?;
        self.cycle = cycle;
        for (at, happening) in happenings {
            self.happens(at, &happening)
                .map_err(|error| BenchError(format!("cycle {at}, tick {}: {error}", self.ticks)))?;
        }
        Ok(())
    }

    fn happens(&mut self, at: u64, happening: &Happening) -> Result<(), BenchError> {
        match happening {
            Happening::Edge(pin, level) => self.edge(at, pin, *level),
            Happening::Heard => {
                match self.sent.pop_front() {
                    Some(Sent::Byte(byte)) => self.model(Event::Byte(byte)),
                    Some(Sent::Framing) => self.model(Event::LineError(LineError::Framing)),
                    None => return Err(BenchError("a byte came that nobody sent".to_owned())),
                }
                self.pass(at);
                Ok(())
            }
            // A reset cuts an answer short, and what of it is on the line then is no byte.
            Happening::Byte(_) | Happening::Framing if self.ticks == 0 => Ok(()),
            Happening::Byte(byte) => self.said(at, *byte),
            Happening::Framing => {
                Err(BenchError("the chip sent a byte without stop bit".to_owned()))
            }
            Happening::Reset(why) if why == "watchdog" => {
                Err(BenchError("the chip's watchdog has bitten".to_owned()))
            }
            Happening::Reset(_) | Happening::Mark(_) => Ok(()),
        }
    }

    fn edge(&mut self, at: u64, pin: &str, level: bool) -> Result<(), BenchError> {
        let tick_pin = match self.image.address {
            Address::Motion => "re1",
            Address::Camera => "rb1",
        };
        if pin == tick_pin {
            // Before the first tick the pin comes to its place, which is 0.
            return if self.ticks > 0 || level { self.tick(at) } else { Ok(()) };
        }
        match self.image.address {
            Address::Motion => self.motor_edge(pin, level),
            Address::Camera => {
                self.servos.edge(at, pin, level);
                Ok(())
            }
        }
    }

    fn motor_edge(&mut self, pin: &str, level: bool) -> Result<(), BenchError> {
        let Some((sense, bit)) = motor_of(pin) else { return Ok(()) };
        let outputs = &mut self.motors[sense];
        *outputs = if level { *outputs | 1 << bit } else { *outputs & !(1 << bit) };
        if self.motors[0] & self.motors[1] != 0 {
            let [first, last] = self.motors;
            let told = format!("both outputs of a motor are on: {first:07b} and {last:07b}");
            return Err(BenchError(told));
        }
        Ok(())
    }

    /// The test point has turned: a ms is over for both.
    fn tick(&mut self, at: u64) -> Result<(), BenchError> {
        self.compare_pins()?;
        self.ticks += 1;
        self.tick_cycle = at;
        // The body moved by what the motors were in the ms just past; its switches change later.
        let mut inputs = self.world.inputs;
        self.world.move_body();
        std::mem::swap(&mut inputs, &mut self.world.inputs);
        self.model(Event::Timer);
        self.model(Event::InputChange(self.world.inputs));
        self.servos.tick(self.ticks, &self.world.reference);
        self.pass(at);
        self.world.inputs.middle_switches = inputs.middle_switches;
        Ok(())
    }

    fn compare_pins(&mut self) -> Result<(), BenchError> {
        if self.ticks == 0 {
            return Ok(());
        }
        match self.image.address {
            Address::Motion => {
                let ([first, last], pins) = (self.motors, self.world.reference.outputs());
                if self.motors != pins {
                    return Err(BenchError(format!(
                        "motors towards first and last: {:07b} {:07b} in the model, \
                         {first:07b} {last:07b} on the pins",
                        pins[0], pins[1]
                    )));
                }
            }
            Address::Camera => {
                self.pulses_equal += self.servos.compare().map_err(BenchError)?;
            }
        }
        self.ticks_equal += 1;
        Ok(())
    }

    fn change_switches(&mut self) -> Result<(), BenchError> {
        if self.image.address == Address::Motion {
            let switches = self.world.inputs.middle_switches;
            self.chip.set("rb4", !switches.left)?;
            self.chip.set("rb5", !switches.right)?;
            self.model(Event::InputChange(self.world.inputs));
        }
        self.pass(self.cycle);
        Ok(())
    }

    /// Drives the input pins that are not as before; none: all of them.
    fn drive_inputs(&mut self, before: Option<Inputs>) -> Result<(), BenchError> {
        const BUMPERS: [&str; 6] = ["rb0", "rb1", "rb2", "rb3", "ra0", "ra1"];
        if self.image.address != Address::Motion {
            return Ok(());
        }
        let inputs = self.world.inputs;
        for (index, pin) in BUMPERS.into_iter().enumerate() {
            let pressed = inputs.bumpers.contains(index);
            if before.is_none_or(|before| before.bumpers.contains(index) != pressed) {
                self.chip.set(pin, !pressed)?;
            }
        }
        if before.is_none_or(|before| before.supply_low != inputs.supply_low) {
            self.chip.set("ra2", !inputs.supply_low)?;
        }
        if before.is_none() {
            self.chip.set("rb4", !inputs.middle_switches.left)?;
            self.chip.set("rb5", !inputs.middle_switches.right)?;
        }
        Ok(())
    }

    /// The chip has said a byte.
    fn said(&mut self, at: u64, byte: u8) -> Result<(), BenchError> {
        let expected = self.in_flight.pop_front();
        if expected != Some(byte) {
            let expected =
                expected.map_or("nothing".to_owned(), |expected| format!("{expected:02x}"));
            return Err(BenchError(format!(
                "the chip sends {byte:02x} as byte {} of an answer, the model {expected}; \
                 the answer before was {}",
                self.answer_bytes,
                hex(&self.world.answer_bytes)
            )));
        }
        self.bytes_equal += 1;
        let is_first = ByteClass::of(byte) == ByteClass::Header;
        if is_first {
            self.answer_began = at - self.byte_cycles;
        }
        self.answer_bytes = if is_first { 1 } else { self.answer_bytes + 1 };
        self.world.hear(&[byte]);
        self.hand_out(at);
        self.pass(at);
        Ok(())
    }

    /// One pass of the model's main routine, and what its transmitter takes at once.
    fn pass(&mut self, at: u64) {
        self.model(Event::MainRoutine(self.world.inputs));
        self.hand_out(at);
    }

    fn hand_out(&mut self, at: u64) {
        while self.in_flight.len() < IN_FLIGHT && self.world.reference.is_transmitting() {
            let mut unseen = Vec::new();
            let event = Event::Transmit(1);
            let transmitted = self.world.reference.apply(event, &mut unseen);
            self.world.coverage.see(event, &self.world.reference, &transmitted);
            if transmitted.iter().any(|byte| ByteClass::of(*byte) == ByteClass::Header) {
                // Until its first byte is heard: behind what is on its way, or when it has been built.
                self.answer_began = match self.in_flight.len() as u64 {
                    0 => at + self.tick_cycles * BUILT_IN / 100,
                    before => at + before * self.byte_cycles,
                };
            }
            self.in_flight.extend(transmitted);
        }
    }

    fn model(&mut self, event: Event) {
        let mut unseen = Vec::new();
        self.world.reference.apply(event, &mut unseen);
        self.world.coverage.see(event, &self.world.reference, &[]);
    }

    /// A reset for a cause, with another EEPROM or with the one it has. That the watchdog has bitten is
    /// told by RCON as the data sheet has it then, since the chip's main routine does not hang.
    fn reset(&mut self, cause: ResetCause, other_eeprom: Option<u8>) -> Result<(), BenchError> {
        const RCON: &str = "0xFD0";
        let rcon = match cause {
            // TO is 0.
            ResetCause::Watchdog => Some("0x17"),
            ResetCause::PowerOn | ResetCause::BrownOut => None,
        };
        let command = match cause {
            ResetCause::PowerOn => "reset power-on",
            ResetCause::BrownOut => "reset brown-out",
            ResetCause::Watchdog => "reset mclr",
        };
        let mut eeprom_boot = self.world.reference.boot();
        if let Some(other) = other_eeprom {
            self.chip.tell(&format!("eeprom 0 {other}"))?;
            eeprom_boot = other;
        }
        self.sent.clear();
        if let Some(value) = rcon {
            self.chip.tell(&format!("register {RCON} {value}"))?;
        }
        let (happenings, _) = self.chip.command(command)?;
        for (_, happening) in happenings {
            if let Happening::Edge(pin, level) = happening {
                // Pins go to their places at once, which is no tick.
                self.motor_edge(&pin, level)?;
            }
        }
        self.begin(cause, eeprom_boot)
    }
}

/// The sense (0: towards first) and the joint that a pin of the motion controller drives.
pub(super) fn motor_of(pin: &str) -> Option<(usize, usize)> {
    let bit = usize::from(pin.as_bytes().get(2)?.checked_sub(b'0')?);
    match pin.get(..2)? {
        "rd" if bit < Joint::COUNT => Some((0, bit)),
        "rc" if bit + 1 < Joint::COUNT => Some((1, bit)),
        "re" if bit == 0 => Some((1, Joint::COUNT - 1)),
        _ => None,
    }
}

impl Bench for HexBench {
    fn world(&mut self) -> &mut World {
        &mut self.world
    }

    fn ticks(&mut self, count: u32, then: Option<&[u8]>) -> Result<(), BenchError> {
        if count == 0 {
            return Ok(());
        }
        let target_tick = self.ticks + u64::from(count);
        let away = u64::from(count) * self.tick_cycles;
        if let Some(bytes) = then.filter(|bytes| !bytes.is_empty()) {
            let end = self.schedule(bytes, self.tick_cycle + away)?;
            self.scheduled = Some(Scheduled { bytes: bytes.to_vec(), end_cycle: end });
            // Time stops before the package is complete, in the tick in which it will be.
            let stop = if is_rest(bytes) { SWITCHES_AT } else { BEFORE_LINE_AT };
            while self.ticks < target_tick || !is_rest(bytes) && self.part(BEHIND_LINE_AT) < end {
                self.go_on_to(self.part(100 + stop))?;
            }
            return Ok(());
        }
        while self.ticks < target_tick {
            self.go_on_to(self.part(100 + BEFORE_LINE_AT))?;
        }
        self.go_on_to(self.part(END_AT))
    }

    fn perform(&mut self, action: Action) -> Result<(), BenchError> {
        let before = self.world.inputs;
        match action {
            Action::Line(bytes) => self.line(&bytes),
            Action::LineError(LineError::Framing) => self.framing_error(),
            Action::Event(Event::Reset(cause)) => self.reset(cause, None),
            Action::Event(Event::Anew(boot)) => self.reset(ResetCause::PowerOn, Some(boot)),
            // The chip makes passes all the time.
            Action::Event(Event::MainRoutine(_)) => Ok(()),
            Action::LineError(LineError::Overrun) | Action::Event(_) => {
                self.left_out += 1;
                Ok(())
            }
            pins => {
                self.world.change_pins(&pins);
                self.drive_inputs(Some(before))?;
                self.pass(self.cycle);
                Ok(())
            }
        }
    }

    fn line_takes(&mut self, _bytes_a_tick: u8) {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use rsapien_protocol::{ActionPackage, Request};

    /// What the bench is told and what it does without telling the model must be told apart.
    #[test]
    fn a_pin_that_the_model_does_not_know_of_is_seen() {
        for (pin, is_seen) in [(None, false), (Some("rb2"), true), (Some("ra0"), true)] {
            let mut bench = HexBench::new(&Image::committed(Address::Motion), 7).unwrap();
            if let Some(pin) = pin {
                bench.chip.set(pin, false).unwrap();
            }
            bench.ticks(10, None).unwrap();
            let package = ActionPackage { session: 0, sequence: 0, request: Request::State };
            let line = package.encode(Address::Motion).to_vec();
            let compared = bench.perform(Action::Line(line)).and_then(|()| bench.ticks(8, None));
            assert_eq!(compared.is_err(), is_seen, "{pin:?}: {compared:?}");
        }
    }
}
