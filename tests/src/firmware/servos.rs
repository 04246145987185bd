//! The camera's servo pins: pulses measured on the chip against positions of the model.
//!
//! Every 20 ms a pulse begins, 0.95 ms after a tick; it tells where the axis was in that tick or, since the
//! main routine reckons it somewhere in a tick, in the one before or behind. Whether there is a pulse at
//! all was settled with the pulse before it.

use super::reference::Reference;
use std::collections::VecDeque;

/// Ticks between two pulses.
const FRAME_TICKS: u64 = 20;
/// A pulse may be longer or shorter by so many hundredths of a degree: the counts of the timer.
const TOLERANCE_CENTIDEG: i64 = 1;
/// Pulse of 0 degrees, in us, and us a degree.
const NEUTRAL_US: i64 = 1500;
const CENTIDEG_A_US: i64 = 10;

/// What the model commanded in a tick.
#[derive(Clone, Copy, Debug)]
struct Commanded {
    tick: u64,
    is_driven: bool,
    /// Pan and tilt, in 0.01 degree.
    centideg: [i16; 2],
}

/// A pulse that has ended.
#[derive(Clone, Copy, Debug)]
struct Pulse {
    axis: usize,
    tick: u64,
    cycles: u64,
}

/// Both servo pins.
#[derive(Debug)]
pub struct Servos {
    cycles_a_ms: u64,
    commanded: VecDeque<Commanded>,
    tick: u64,
    /// Tick and cycle of the rising edge of the pulse under way.
    rising: [Option<(u64, u64)>; 2],
    pulses: Vec<Pulse>,
    /// The last tick in which each axis had a pulse.
    seen: [u64; 2],
}

impl Servos {
    /// Pins without pulses.
    pub fn new(cycles_a_ms: u64) -> Servos {
        Servos {
            cycles_a_ms,
            commanded: VecDeque::new(),
            tick: 0,
            rising: [None, None],
            pulses: Vec::new(),
            seen: [0, 0],
        }
    }

    /// The chip was reset.
    pub fn reset(&mut self) {
        *self = Servos::new(self.cycles_a_ms);
    }

    /// The model after its timer interrupt of tick `tick`.
    pub fn tick(&mut self, tick: u64, reference: &Reference) {
        let Some(camera) = reference.camera() else { return };
        self.tick = tick;
        let report = camera.report();
        self.commanded.push_back(Commanded {
            tick,
            is_driven: camera.outputs().pan_centideg.is_some(),
            centideg: [report.pan_centideg, report.tilt_centideg],
        });
        if self.commanded.len() as u64 > 2 * FRAME_TICKS {
            self.commanded.pop_front();
        }
    }

    /// A pin has changed.
    pub fn edge(&mut self, at: u64, pin: &str, level: bool) {
        let axis = match pin {
            "rc2" => 0,
            "rc1" => 1,
            _ => return,
        };
        self.seen[axis] = self.tick;
        if level {
            self.rising[axis] = Some((self.tick, at));
        } else if let Some((tick, risen)) = self.rising[axis].take() {
            self.pulses.push(Pulse { axis, tick, cycles: at - risen });
        }
    }

    fn between(&self, first: u64, last: u64) -> impl Iterator<Item = &Commanded> {
        self.commanded.iter().filter(move |commanded| (first..=last).contains(&commanded.tick))
    }

    /// Whether a pulse that begins behind `tick` ends when Timer1 is 0: there alone gpsim's compare unit
    /// sees no match, and the pulse goes on to the next frame's end. The chip's unit sees it.
    fn ends_at_zero(&self, tick: u64, centideg: i16) -> bool {
        const LEAD_TENTHS_US: i64 = 9_500;
        // The timer counts cycles from the start, with which the ticks began.
        let counts = |tenths_us: i64| tenths_us * self.cycles_a_ms.cast_signed() / 10_000;
        let begins = tick.cast_signed() * self.cycles_a_ms.cast_signed() + counts(LEAD_TENTHS_US);
        let ends = begins + counts(NEUTRAL_US * CENTIDEG_A_US + i64::from(centideg));
        ends.rem_euclid(1 << 16) == 0
    }

    /// Compares the pulses that ended since, and whether there are any. Gives how many were equal.
    ///
    /// # Errors
    /// What differs.
    pub fn compare(&mut self) -> Result<u64, String> {
        const NAMES: [&str; 2] = ["pan", "tilt"];
        let pulses = std::mem::take(&mut self.pulses);
        for pulse in &pulses {
            let tenths_of_us = pulse.cycles * 10_000 / self.cycles_a_ms;
            let tenths_of_us = i64::try_from(tenths_of_us).unwrap_or(i64::MAX);
            let centideg = tenths_of_us - NEUTRAL_US * CENTIDEG_A_US;
            let Pulse { axis, tick, .. } = *pulse;
            let told = |what: &str| {
                Err(format!("the {} pulse of tick {tick} says {centideg}: {what}", NAMES[axis]))
            };
            if !self.between(tick.saturating_sub(FRAME_TICKS), tick + 1).any(|was| was.is_driven) {
                return told("the model drives no servo");
            }
            let near: Vec<i16> = self
                .between(tick.saturating_sub(1), tick + 1)
                .map(|commanded| commanded.centideg[axis])
                .collect();
            let is_near = |at: &i16| (i64::from(*at) - centideg).abs() <= TOLERANCE_CENTIDEG;
            if near.iter().any(|at| self.ends_at_zero(tick, *at)) {
                continue;
            }
            if !near.iter().any(is_near) {
                return told(&format!("the model was at {near:?}"));
            }
        }
        // An axis that was driven two frames long has had a pulse in the last one.
        for (axis, name) in NAMES.into_iter().enumerate() {
            let is_full = self.commanded.len() as u64 >= 2 * FRAME_TICKS;
            let is_driven = self.commanded.iter().all(|commanded| commanded.is_driven);
            if is_full && is_driven && self.tick > self.seen[axis] + FRAME_TICKS + 1 {
                return Err(format!(
                    "the {name} servo has had no pulse since tick {}",
                    self.seen[axis]
                ));
            }
        }
        Ok(pulses.len() as u64)
    }
}
