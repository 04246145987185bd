//! The RS232 line: bytes that take their time, both ways at once, and what can go wrong with them.
//!
//! 8N1 takes ten bits a byte. Times are integers in *line units*, of which a millisecond has as many as the line has
//! bits a second, so that a byte takes exactly [`BYTE_UNITS`] at any speed and nothing is ever rounded.
//!
//! Both controllers hear every byte of the PC. Their transmitters share the wire back: where both send at once, the
//! PC hears the bytes over each other (the logical and of both, since a line at 0 wins).

use std::collections::VecDeque;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rsapien_protocol::Direction;
use serde::{Deserialize, Serialize};

/// Line units that a byte takes: ten bits.
pub const BYTE_UNITS: u64 = 10_000;

/// The speeds a line may have, in bit/s.
pub const BAUD: std::ops::RangeInclusive<u32> = 1200..=1_000_000;

/// The whole, in parts per million.
const MILLION: u32 = 1_000_000;

/// How often each kind of damage happens, in parts per million, 0 to 1000000. All zero: a perfect line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LineFaults {
    /// Of the data bits, flipped.
    pub bit_error_ppm: u32,
    /// Of the bytes, lost.
    pub lost_ppm: u32,
    /// Of the bytes, heard twice.
    pub duplicated_ppm: u32,
    /// Of the bytes, with a random byte before them.
    pub noise_ppm: u32,
    /// Of the bytes, received without a stop bit. A PC reads 0 then, as terminals do.
    pub framing_ppm: u32,
}

impl LineFaults {
    /// A line that loses nothing and adds nothing.
    pub const NONE: LineFaults = LineFaults {
        bit_error_ppm: 0,
        lost_ppm: 0,
        duplicated_ppm: 0,
        noise_ppm: 0,
        framing_ppm: 0,
    };

    /// Whether every value is a share of a million.
    pub fn is_in_range(&self) -> bool {
        let Self { bit_error_ppm, lost_ppm, duplicated_ppm, noise_ppm, framing_ppm } = *self;
        [bit_error_ppm, lost_ppm, duplicated_ppm, noise_ppm, framing_ppm]
            .into_iter()
            .all(|parts| parts <= MILLION)
    }
}

/// What a receiver hears.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Heard {
    Byte(u8),
    FramingError,
}

/// What a PC reads, as terminals do.
const fn as_read(heard: Heard) -> u8 {
    match heard {
        Heard::Byte(byte) => byte,
        Heard::FramingError => 0,
    }
}

/// Damage done to the bytes of one direction.
#[derive(Debug, Clone)]
struct Damage {
    faults: LineFaults,
    random: Pcg64,
}

impl Damage {
    fn new(seed: u64) -> Self {
        Self { faults: LineFaults::NONE, random: Pcg64::seed_from_u64(seed) }
    }

    fn happens(&mut self, ppm: u32) -> bool {
        ppm > 0 && self.random.random_range(0..MILLION) < ppm
    }

    /// What is heard of one byte: noise before it, itself, and itself again.
    fn carry(&mut self, byte: u8) -> [Option<Heard>; 3] {
        let faults = self.faults;
        if faults == LineFaults::NONE {
            return [None, Some(Heard::Byte(byte)), None];
        }
        let noise = self.happens(faults.noise_ppm).then(|| Heard::Byte(self.random.random()));
        if self.happens(faults.lost_ppm) {
            return [noise, None, None];
        }
        if self.happens(faults.framing_ppm) {
            return [noise, Some(Heard::FramingError), None];
        }
        let flipped =
            (0..8).fold(0, |bits, bit| bits | u8::from(self.happens(faults.bit_error_ppm)) << bit);
        let heard = Some(Heard::Byte(byte ^ flipped));
        [noise, heard, if self.happens(faults.duplicated_ppm) { heard } else { None }]
    }
}

/// A byte on its way out of a transmitter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Shifting {
    byte: u8,
    done_at: u64,
}

/// The next thing to happen on the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum LineEvent {
    /// A byte of the PC has arrived.
    ToRobot([Option<Heard>; 3]),
    /// The transmitter of this controller (0 motion, 1 camera) has sent its byte; the next one may follow.
    Sent(usize),
}

/// The line. All times are absolute, in line units.
#[derive(Debug, Clone)]
pub(crate) struct Line {
    baud: u32,
    /// Bytes of the PC that wait for their turn.
    waiting: VecDeque<u8>,
    from_pc: Option<Shifting>,
    from_controllers: [Option<Shifting>; 2],
    /// Bytes that have arrived at the PC.
    arrived: Vec<u8>,
    damage_to_robot: Damage,
    damage_to_pc: Damage,
    pub(crate) pulled: bool,
}

impl Line {
    pub(crate) fn new(baud: u32, seed: u64) -> Self {
        Self {
            baud,
            waiting: VecDeque::new(),
            from_pc: None,
            from_controllers: [None; 2],
            arrived: Vec::new(),
            damage_to_robot: Damage::new(seed),
            damage_to_pc: Damage::new(seed ^ 0x5DEE_CE66),
            pulled: false,
        }
    }

    /// Line units up to the end of `ms` milliseconds.
    pub(crate) fn units(&self, ms: u64) -> u64 {
        ms * u64::from(self.baud)
    }

    pub(crate) fn set_faults(&mut self, direction: Direction, faults: LineFaults) {
        match direction {
            Direction::ToRobot => self.damage_to_robot.faults = faults,
            Direction::ToPc => self.damage_to_pc.faults = faults,
        }
    }

    /// Bytes of the PC, which leave it one after the other from `now` on.
    pub(crate) fn send(&mut self, bytes: &[u8], now: u64) {
        self.waiting.extend(bytes);
        if self.from_pc.is_none() {
            self.shift_next(now);
        }
    }

    fn shift_next(&mut self, now: u64) {
        let next = self.waiting.pop_front();
        self.from_pc = next.map(|byte| Shifting { byte, done_at: now + BYTE_UNITS });
    }

    /// Whether the transmitter of a controller can take a byte.
    pub(crate) fn can_transmit(&self, controller: usize) -> bool {
        self.from_controllers[controller].is_none()
    }

    /// A byte from a controller (0 motion, 1 camera) whose transmitter is free.
    pub(crate) fn transmit(&mut self, controller: usize, byte: u8, now: u64) {
        let mut byte = byte;
        if let Some(other) = self.from_controllers[1 - controller].as_mut() {
            other.byte &= byte;
            byte = other.byte;
        }
        self.from_controllers[controller] = Some(Shifting { byte, done_at: now + BYTE_UNITS });
    }

    /// Cuts off what a controller is sending, as its reset does.
    pub(crate) fn silence(&mut self, controller: usize) {
        self.from_controllers[controller] = None;
    }

    /// Whether nothing is on its way.
    pub(crate) fn is_idle(&self) -> bool {
        self.from_pc.is_none() && self.from_controllers == [None; 2]
    }

    /// The next event up to `end` with its time; none when nothing happens until then.
    pub(crate) fn next_event(&mut self, end: u64) -> Option<(u64, LineEvent)> {
        let at = |shifting: &Option<Shifting>| shifting.map_or(u64::MAX, |byte| byte.done_at);
        let [motion, camera] = [at(&self.from_controllers[0]), at(&self.from_controllers[1])];
        let pc = at(&self.from_pc);
        let now = pc.min(motion).min(camera);
        if now > end {
            return None;
        }
        if now == pc {
            let byte = self.from_pc.take()?.byte;
            self.shift_next(now);
            let heard = if self.pulled { [None; 3] } else { self.damage_to_robot.carry(byte) };
            return Some((now, LineEvent::ToRobot(heard)));
        }
        let controller = usize::from(now != motion);
        let byte = self.from_controllers[controller].take()?.byte;
        self.arrive(Heard::Byte(byte));
        Some((now, LineEvent::Sent(controller)))
    }

    /// The next byte of the PC that begins to leave it before `end`, with the time of its start bit, for receivers that
    /// hear it bit by bit. Not to be mixed with [`next_event`](Line::next_event).
    pub(crate) fn next_begun(&mut self, end: u64) -> Option<(u64, [Option<Heard>; 3])> {
        let Shifting { byte, done_at } =
            self.from_pc.take_if(|byte| byte.done_at < end + BYTE_UNITS)?;
        self.shift_next(done_at);
        let heard = if self.pulled { [None; 3] } else { self.damage_to_robot.carry(byte) };
        Some((done_at - BYTE_UNITS, heard))
    }

    /// The PC's end of the line gets what a controller has sent, less what the line does to it.
    pub(crate) fn arrive(&mut self, sent: Heard) {
        if self.pulled {
            return;
        }
        match sent {
            Heard::Byte(byte) => {
                for heard in self.damage_to_pc.carry(byte).into_iter().flatten() {
                    self.arrived.push(as_read(heard));
                }
            }
            Heard::FramingError => self.arrived.push(as_read(sent)),
        }
    }

    /// Whether bytes have arrived at the PC that it has not taken.
    pub(crate) fn has_arrived(&self) -> bool {
        !self.arrived.is_empty()
    }

    /// Moves the bytes that have arrived at the PC to the end of `bytes`.
    pub(crate) fn receive(&mut self, bytes: &mut Vec<u8>) {
        bytes.append(&mut self.arrived);
    }

    /// Bytes of the PC that have not left it yet.
    pub(crate) fn waiting(&self) -> usize {
        self.waiting.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs a line on which the controllers are silent and returns what they heard with the times.
    fn heard(line: &mut Line) -> Vec<(u64, Heard)> {
        let mut heard = Vec::new();
        while let Some((at, event)) = line.next_event(u64::MAX - 1) {
            if let LineEvent::ToRobot(bytes) = event {
                heard.extend(bytes.into_iter().flatten().map(|byte| (at, byte)));
            }
        }
        heard
    }

    #[test]
    fn bytes_take_ten_bits_each_at_every_speed() {
        for baud in [19_200_u32, 38_400, 57_600, 115_200] {
            let mut line = Line::new(baud, 1);
            let start = line.units(7);
            line.send(&[0xC9; 18], start);
            let last = heard(&mut line).last().expect("a byte").0;
            // 18 bytes of ten bits in microseconds, without rounding.
            assert_eq!((last - start) * 1000 / u64::from(baud), 180_000_000 / u64::from(baud));
        }
    }

    #[test]
    fn bytes_sent_later_wait_for_those_before() {
        let mut line = Line::new(57_600, 1);
        line.send(&[1, 2], 0);
        line.send(&[3], BYTE_UNITS);
        let times: Vec<_> = heard(&mut line).into_iter().map(|(at, _)| at).collect();
        assert_eq!(times, [BYTE_UNITS, 2 * BYTE_UNITS, 3 * BYTE_UNITS]);
    }

    #[test]
    fn every_fault_happens_about_as_often_as_asked_and_the_same_for_one_seed() {
        let run = |seed: u64, faults: LineFaults| {
            let mut line = Line::new(57_600, seed);
            line.set_faults(Direction::ToRobot, faults);
            line.send(&vec![0xAA; 20_000], 0);
            heard(&mut line).into_iter().map(|(_, heard)| heard).collect::<Vec<_>>()
        };
        let ppm = 50_000;
        let lost = run(1, LineFaults { lost_ppm: ppm, ..LineFaults::NONE });
        assert!((18_800..19_200).contains(&lost.len()), "{}", lost.len());
        let twice = run(1, LineFaults { duplicated_ppm: ppm, ..LineFaults::NONE });
        assert!((20_800..21_200).contains(&twice.len()), "{}", twice.len());
        let noisy = run(1, LineFaults { noise_ppm: ppm, ..LineFaults::NONE });
        assert!((20_800..21_200).contains(&noisy.len()), "{}", noisy.len());
        let framing = run(1, LineFaults { framing_ppm: ppm, ..LineFaults::NONE });
        let errors = framing.iter().filter(|heard| **heard == Heard::FramingError).count();
        assert!((800..1200).contains(&errors), "{errors}");
        let faults = LineFaults { bit_error_ppm: ppm, ..LineFaults::NONE };
        let flipped: u32 = run(1, faults)
            .iter()
            .map(|heard| match heard {
                Heard::Byte(byte) => (byte ^ 0xAA).count_ones(),
                Heard::FramingError => 0,
            })
            .sum();
        assert!((7_600..8_400).contains(&flipped), "{flipped}");
        assert_eq!(run(3, faults), run(3, faults));
        assert_ne!(run(3, faults), run(4, faults));
    }

    #[test]
    fn a_pulled_cable_carries_nothing_either_way() {
        let mut line = Line::new(57_600, 1);
        line.pulled = true;
        line.send(&[1, 2, 3], 0);
        line.transmit(0, 9, 0);
        assert!(heard(&mut line).is_empty() && !line.has_arrived() && line.is_idle());
    }

    #[test]
    fn two_transmitters_at_once_garble_each_other() {
        let mut line = Line::new(57_600, 1);
        line.transmit(0, 0b1100, 0);
        line.transmit(1, 0b1010, 100);
        while line.next_event(u64::MAX - 1).is_some() {}
        let mut bytes = Vec::new();
        line.receive(&mut bytes);
        assert_eq!(bytes, [0b1000, 0b1000]);
    }
}
