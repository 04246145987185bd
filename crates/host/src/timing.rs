//! Where the time goes between a request and its answer: PC, adapter, line, firmware.
//!
//! Measured are three moments of each request: when it is asked for, when its bytes are handed to the system, and when
//! the last byte of the answer is there; and when the answer reaches whoever asked. What the line takes is reckoned from
//! bytes and speed. What is left is the adapter's (with its driver) and the firmware's, whose share is bounded by what
//! the simulator of the chips measured (`docs/firmware-timing.md`).

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use rsapien_protocol::{ACTION_PACKAGE_LENGTH, Address, SYNCHRONIZATION_PACKAGE_LENGTH};

use crate::record::{LineEvent, LineSink};
use crate::{Error, Robot, SensorsController};

/// The longest pass of the motion controller's main routine, interrupts inside, with everything at once, in µs, by its
/// clock in MHz (`docs/firmware-timing.md`, "Routines"): the longest that a whole package waits for its answer to begin.
const FIRMWARE_PASS_US: [(u8, u32); 4] = [(40, 533), (20, 1130), (10, 2890), (4, 16_650)];
/// Bits a byte takes on the line: start, eight, stop (8N1).
const BITS_PER_BYTE: usize = 10;

/// The moments of one request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Trip {
    /// From the request to its bytes handed to the system, and from the last byte of the answer to whoever asked.
    pub pc: Duration,
    /// From the bytes handed to the system to the last byte of the answer: adapter, line and firmware.
    pub outside: Duration,
}

/// The smallest, middle and greatest of a share.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Spread {
    /// The smallest.
    pub best: Duration,
    /// The middle one.
    pub median: Duration,
    /// The greatest.
    pub worst: Duration,
}

/// Where the time goes between a request and its answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timing {
    /// How many requests were measured.
    pub requests: usize,
    /// This program and this computer: measured.
    pub pc: Spread,
    /// Both packages on the line, at its speed: reckoned.
    pub line: Duration,
    /// The most that the firmware takes, by its clock; none for a clock that was never simulated.
    pub firmware_at_most: Option<Duration>,
    /// What is left of the measured time, the firmware's share in it: the adapter, its driver, and the firmware.
    pub rest: Spread,
    /// All of it: measured.
    pub total: Spread,
}

/// Watches a line for its moments: its [`sink`](TimingProbe::sink) goes into the options that the robot is opened with.
#[derive(Clone, Debug, Default)]
pub struct TimingProbe {
    moments: Arc<Mutex<Moments>>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Moments {
    sent: Option<Instant>,
    received: Option<Instant>,
}

impl TimingProbe {
    /// What [`RobotOptions::on_line`](crate::RobotOptions::on_line) takes.
    pub fn sink(&self) -> LineSink {
        let probe = self.clone();
        Box::new(move |event| match event {
            LineEvent::Sent { .. } => probe.moments().sent = Some(Instant::now()),
            LineEvent::Received { .. } => probe.moments().received = Some(Instant::now()),
            _ => {}
        })
    }

    fn moments(&self) -> MutexGuard<'_, Moments> {
        self.moments.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Asks the motion controller `requests` times for its state, 1 at least, and tells where the time went. `on_trip` is
    /// told of each, and ends the measurement when it says false.
    ///
    /// # Errors
    /// Those of the line.
    pub fn measure(
        &self,
        robot: &Robot,
        sensors: &SensorsController,
        baud: u32,
        requests: usize,
        mut on_trip: impl FnMut(Trip) -> bool,
    ) -> Result<Timing, Error> {
        let clock_mhz = robot.information(Address::Motion)?.clock_mhz;
        let mut trips = Vec::with_capacity(requests);
        for _ in 0..requests.max(1) {
            let asked = Instant::now();
            sensors.refresh()?;
            let told = Instant::now();
            let Moments { sent: Some(sent), received: Some(received) } = *self.moments() else {
                continue;
            };
            let outside = received.saturating_duration_since(sent);
            let pc = told.saturating_duration_since(asked).saturating_sub(outside);
            let trip = Trip { pc, outside };
            trips.push(trip);
            if !on_trip(trip) {
                break;
            }
        }
        Ok(Timing::of(&trips, baud, clock_mhz))
    }
}

impl Timing {
    /// What these trips over a line of `baud` bit/s to a firmware at `clock_mhz` show.
    pub fn of(trips: &[Trip], baud: u32, clock_mhz: u8) -> Timing {
        let bits = (ACTION_PACKAGE_LENGTH + SYNCHRONIZATION_PACKAGE_LENGTH) * BITS_PER_BYTE;
        let bits = u32::try_from(bits).unwrap_or(u32::MAX);
        let line = Duration::from_secs(1) * bits / baud.max(1);
        let pass = FIRMWARE_PASS_US.into_iter().find(|(mhz, _)| *mhz == clock_mhz);
        Timing {
            requests: trips.len(),
            pc: Spread::of(trips.iter().map(|trip| trip.pc)),
            line,
            firmware_at_most: pass.map(|(_, us)| Duration::from_micros(u64::from(us))),
            rest: Spread::of(trips.iter().map(|trip| trip.outside.saturating_sub(line))),
            total: Spread::of(trips.iter().map(|trip| trip.pc + trip.outside)),
        }
    }
}

impl Spread {
    fn of(values: impl Iterator<Item = Duration>) -> Spread {
        let mut values: Vec<Duration> = values.collect();
        values.sort_unstable();
        let at = |index: usize| values.get(index).copied().unwrap_or_default();
        Spread {
            best: at(0),
            median: at(values.len() / 2),
            worst: values.last().copied().unwrap_or_default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shares_make_up_the_whole() {
        let ms = Duration::from_micros;
        let trips = [
            Trip { pc: ms(100), outside: ms(8_900) },
            Trip { pc: ms(300), outside: ms(8_000) },
            Trip { pc: ms(200), outside: ms(24_000) },
        ];
        let timing = Timing::of(&trips, 57_600, 40);
        // 43 bytes of 10 bits at 57600 bit/s (PROTOCOL: 3.13 ms and 4.34 ms).
        assert_eq!(timing.line.as_micros(), 7465);
        assert_eq!(timing.pc.median, ms(200));
        assert_eq!(timing.rest.median.as_micros(), 8_900 - 7_466);
        assert_eq!((timing.total.best, timing.total.worst), (ms(8_300), ms(24_200)));
        assert_eq!(timing.firmware_at_most, Some(ms(533)));
        assert_eq!(Timing::of(&trips, 57_600, 8).firmware_at_most, None);
    }

    #[test]
    fn the_bounds_of_the_firmware_are_those_of_its_page() {
        let page = include_str!("../../../docs/firmware-timing.md");
        let motion = page.split("### Motion").nth(1).unwrap().split("###").next().unwrap();
        for (mhz, bound_us) in FIRMWARE_PASS_US {
            let head = format!("| one pass of the main routine, interrupts inside | {mhz} MHz |");
            let row = motion.lines().find(|line| line.starts_with(&head)).unwrap();
            let worst = row.split('|').nth(4).unwrap().trim();
            let (number, unit) = worst.split_once(' ').unwrap();
            let us = number.parse::<f64>().unwrap() * if unit == "ms" { 1000.0 } else { 1.0 };
            assert!((f64::from(bound_us) - us).abs() <= 1.0, "{mhz} MHz: {worst}");
        }
    }
}
