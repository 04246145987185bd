//! One chip: its time in cycles, and its pins.

use std::path::Path;

use rsapien_firmware_model::ResetCause;

use super::bridge::Bridge;
use super::{FirmwareError, FirmwareImage};
use crate::line::Heard;

/// What happened at the chip's pins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Happened {
    /// It sent a byte, whose stop bit was sampled in this cycle.
    Sent { cycle: u64, byte: u8 },
    /// It sent something without a stop bit.
    Framing { cycle: u64 },
    /// An output changed; `pin` counts in the order in which the outputs were wired.
    Edge { cycle: u64, pin: usize, level: bool },
    /// It was reset.
    Reset { cause: ResetCause },
    /// Something that is of no interest here.
    Other,
}

/// Resets as the simulator calls them.
const RESETS: [(&str, ResetCause); 3] = [
    ("power-on", ResetCause::PowerOn),
    ("brown-out", ResetCause::BrownOut),
    ("watchdog", ResetCause::Watchdog),
];

/// A pin with the level that is known of it.
type Pin = (&'static str, Option<bool>);

/// One chip with the firmware in it.
#[derive(Debug)]
pub(super) struct Chip {
    bridge: Bridge,
    clock_mhz: u8,
    /// The cycle up to which it has run.
    cycle: u64,
    inputs: Vec<Pin>,
    outputs: Vec<Pin>,
}

impl Chip {
    /// Starts the simulator at `program` with an image in it; the chip has just been switched on.
    pub(super) fn start(program: &Path, image: &FirmwareImage) -> Result<Self, FirmwareError> {
        Ok(Self::of(Bridge::start(program, image)?, image.clock_mhz()))
    }

    /// The chip at the other end of a conversation.
    pub(super) fn of(bridge: Bridge, clock_mhz: u8) -> Self {
        Self { bridge, clock_mhz, cycle: 0, inputs: Vec::new(), outputs: Vec::new() }
    }

    /// The clock in MHz; four of its periods are a cycle.
    pub(super) fn clock_mhz(&self) -> u8 {
        self.clock_mhz
    }

    /// Cycles in a millisecond.
    pub(super) fn cycles_per_ms(&self) -> u64 {
        u64::from(self.clock_mhz) * 250
    }

    /// The cycle up to which it has run.
    pub(super) fn cycle(&self) -> u64 {
        self.cycle
    }

    /// The level of an output, in the order in which they were wired.
    pub(super) fn level(&self, output: usize) -> bool {
        self.outputs.get(output).is_some_and(|(_, level)| *level == Some(true))
    }

    /// Connects wires to these pins.
    pub(super) fn wire(
        &mut self,
        inputs: &[&'static str],
        outputs: &[&'static str],
    ) -> Result<(), FirmwareError> {
        let unknown = |pin: &'static str| (pin, None);
        self.inputs = inputs.iter().copied().map(unknown).collect();
        self.outputs = outputs.iter().copied().map(unknown).collect();
        let pins = self.bridge.ask(format_args!("pins"))?;
        let wired = inputs.iter().chain(outputs);
        if let Some(missing) = wired.copied().find(|pin| !pins.split(' ').any(|name| name == *pin))
        {
            return Err(FirmwareError::Answer {
                chip: self.bridge.chip(),
                asked: format!("pins, with {missing} among them"),
                answer: pins,
            });
        }
        self.bridge.ask(format_args!("watch {}", outputs.join(" ")))?;
        self.read_pins()
    }

    /// Starts the chip anew.
    pub(super) fn reset(&mut self, cause: ResetCause) -> Result<(), FirmwareError> {
        let word = RESETS.into_iter().find(|(_, known)| *known == cause);
        let (word, _) = word.unwrap_or(("power-on", cause));
        self.bridge.ask(format_args!("reset {word}"))?;
        self.read_pins()
    }

    fn read_pins(&mut self) -> Result<(), FirmwareError> {
        for input in &mut self.inputs {
            input.1 = None;
        }
        for output in &mut self.outputs {
            let answer = self.bridge.ask(format_args!("get {}", output.0))?;
            output.1 = Some(answer == "1");
        }
        let asked = "cycles";
        let answer = self.bridge.ask(format_args!("{asked}"))?;
        self.cycle = answer.parse().map_err(|_| FirmwareError::Answer {
            chip: self.bridge.chip(),
            asked: asked.to_owned(),
            answer,
        })?;
        Ok(())
    }

    /// What the chip is to hear from `units` of the coming ms on, of which a ms has `units_per_ms`.
    pub(super) fn send(&mut self, heard: Heard, units: u64, units_per_ms: u64) {
        let at = self.cycle + units * self.cycles_per_ms() / units_per_ms.max(1);
        match heard {
            Heard::Byte(byte) => self.bridge.put(format_args!("send {byte:02x} {at}")),
            Heard::FramingError => self.bridge.put(format_args!("send-framing 00 {at}")),
        }
    }

    /// Drives the inputs to these levels, in the order in which they were wired.
    pub(super) fn set(&mut self, levels: &[bool]) {
        for ((pin, known), level) in self.inputs.iter_mut().zip(levels) {
            if *known != Some(*level) {
                *known = Some(*level);
                self.bridge.put(format_args!("set {pin} {}", u8::from(*level)));
            }
        }
    }

    /// Begins to run a millisecond; others may be begun before it is over.
    pub(super) fn begin_ms(&mut self) -> Result<(), FirmwareError> {
        self.bridge.put(format_args!("advance {}", self.cycles_per_ms()));
        self.bridge.write()
    }

    /// Waits for the end of the millisecond and tells what happened in it.
    pub(super) fn end_ms(&mut self) -> Result<Vec<Happened>, FirmwareError> {
        let (outputs, mut happened) = (&self.outputs, Vec::new());
        let mut cycle = None;
        let told = |line: &str| {
            happened.push(parse(line, outputs)?);
            Some(())
        };
        // The last answer is that to `advance`; those before it have no number.
        let answered = |answer: &str| {
            cycle = answer.parse().ok();
            Some(())
        };
        self.bridge.read(told, answered)?;
        self.cycle = cycle.ok_or_else(|| FirmwareError::Answer {
            chip: self.bridge.chip(),
            asked: "advance".to_owned(),
            answer: "ok without a cycle".to_owned(),
        })?;
        for event in &happened {
            if let Happened::Edge { pin, level, .. } = *event
                && let Some(output) = self.outputs.get_mut(pin)
            {
                output.1 = Some(level);
            }
        }
        Ok(happened)
    }
}

/// What a line tells; none where it cannot be read.
fn parse(line: &str, outputs: &[Pin]) -> Option<Happened> {
    let mut words = line.split(' ');
    let name = words.next()?;
    let cycle = words.next()?.parse().ok()?;
    Some(match name {
        "byte" => Happened::Sent { cycle, byte: u8::from_str_radix(words.next()?, 16).ok()? },
        "framing" => Happened::Framing { cycle },
        "edge" => {
            let pin = words.next()?;
            let level = match words.next()? {
                "0" => false,
                "1" => true,
                _ => return None,
            };
            let wired = outputs.iter().position(|(name, _)| *name == pin);
            wired.map_or(Happened::Other, |pin| Happened::Edge { cycle, pin, level })
        }
        "reset" => {
            let word = words.next()?;
            let cause = RESETS.into_iter().find(|(known, _)| *known == word);
            cause.map_or(Happened::Other, |(_, cause)| Happened::Reset { cause })
        }
        _ => Happened::Other,
    })
}
