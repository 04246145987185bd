//! How virtual time passes when nobody advances it by hand.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use crate::shared::SharedRobot;

/// What moves the virtual clock.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Clock {
    /// The wall clock, times a factor within [`FACTOR`]; 1 is real time.
    Paced {
        /// Virtual seconds a second.
        factor: f64,
    },
    /// Nothing holds it back. Who speaks to the robot has to be quick or to switch the dead-man off: its half second
    /// is over in a few milliseconds.
    Free,
    /// Nothing but [`VirtualRobot::advance_to`](crate::VirtualRobot::advance_to) and the control channel.
    Manual,
}

impl Default for Clock {
    /// Real time.
    fn default() -> Self {
        Clock::Paced { factor: 1.0 }
    }
}

/// Factors that a paced clock may have.
pub const FACTOR: std::ops::RangeInclusive<f64> = 0.01..=1000.0;

/// What a stalled machine may make the clock catch up with, in wall time; what is beyond is let go.
const CATCH_UP: Duration = Duration::from_millis(250);
/// How often the clock is looked at.
const TICK: Duration = Duration::from_millis(1);
/// How far a free clock goes before it lets others have the robot, in virtual ms.
const FREE_RUN_MS: u64 = 20;
/// How long a free clock lets others have the robot.
const FREE_PAUSE: Duration = Duration::from_micros(20);

/// Where virtual time should be, from wall time.
#[derive(Debug, Clone, Copy)]
struct Pace {
    factor: f64,
    start: Instant,
    start_ms: u64,
}

impl Pace {
    /// The virtual time for `now`; a lag beyond [`CATCH_UP`] is dropped, so that the clock never races after a stall.
    fn target_ms(&mut self, now: Instant, now_ms: u64) -> u64 {
        let most_ms = now_ms + whole_ms(CATCH_UP.as_secs_f64() * 1000.0 * self.factor).max(1);
        let elapsed_ms = now.saturating_duration_since(self.start).as_secs_f64() * 1000.0;
        let target_ms = self.start_ms + whole_ms(elapsed_ms * self.factor);
        if target_ms > most_ms {
            (self.start, self.start_ms) = (now, most_ms);
            return most_ms;
        }
        target_ms
    }
}

/// Milliseconds, rounded down.
fn whole_ms(ms: f64) -> u64 {
    // Times are not negative and far below 2^53 ms.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let whole = ms as u64;
    whole
}

/// Runs `clock` in a thread of its own until `stop` is set. After every turn `arrived` gets the bytes that have
/// arrived at the PC, if any.
pub fn run(
    robot: SharedRobot,
    clock: Clock,
    stop: Arc<AtomicBool>,
    mut arrived: impl FnMut(&[u8]) + Send + 'static,
) -> JoinHandle<()> {
    thread::spawn(move || {
        let mut pace = match clock {
            Clock::Paced { factor } => Some(Pace {
                factor: factor.clamp(*FACTOR.start(), *FACTOR.end()),
                start: Instant::now(),
                start_ms: robot.lock().now_ms(),
            }),
            Clock::Free | Clock::Manual => None,
        };
        let mut bytes = Vec::new();
        while !stop.load(Ordering::Relaxed) {
            let mut locked = robot.lock();
            let now_ms = locked.now_ms();
            match (clock, pace.as_mut()) {
                (Clock::Paced { .. }, Some(pace)) => {
                    locked.advance_to(pace.target_ms(Instant::now(), now_ms));
                }
                (Clock::Free, _) => locked.advance_to(now_ms + FREE_RUN_MS),
                _ => {}
            }
            locked.receive(&mut bytes);
            drop(locked);
            if !bytes.is_empty() {
                arrived(&bytes);
                bytes.clear();
            }
            thread::sleep(if clock == Clock::Free { FREE_PAUSE } else { TICK });
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_follows_the_wall_clock_and_never_races_after_a_stall() {
        let start = Instant::now();
        let mut pace = Pace { factor: 10.0, start, start_ms: 100 };
        let at = |ms| start + Duration::from_millis(ms);
        assert_eq!(pace.target_ms(at(7), 100), 170);
        assert_eq!(pace.target_ms(at(200), 170), 2100);
        // A stall of an hour is worth the 250 ms that may be caught up with.
        assert_eq!(pace.target_ms(at(3_600_000), 2100), 4600);
        assert_eq!(pace.target_ms(at(3_600_001), 4600), 4610);
    }
}
