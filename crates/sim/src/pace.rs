//! How virtual time passes when nobody advances it by hand.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use crate::robot::VirtualRobot;
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
    /// As fast as it goes while the robot is spoken to: the time that bytes take, and a head start of
    /// [`HEAD_START_MS`] after every answer, pass at once. Beyond that it is real time, so that a program that speaks
    /// often enough for the dead-man on a robot does so here.
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
/// The longest that a clock keeps the robot to itself in one turn: a firmware in a simulator may take as long for a
/// virtual ms as a ms.
const TURN: Duration = Duration::from_millis(5);
/// How often the clock is looked at.
const TICK: Duration = Duration::from_millis(1);
/// How far a free clock runs ahead of the wall clock after every answer, in virtual ms: less than the half second of
/// the dead-man.
pub const HEAD_START_MS: u64 = 200;
/// How far a free clock goes before it lets others have the robot, in virtual ms.
const FREE_RUN_MS: u64 = 20;
/// How long a free clock lets others have the robot, and how often it looks for bytes of the PC when it has run its
/// head start.
const FREE_PAUSES: [Duration; 2] = [Duration::from_micros(20), Duration::from_micros(250)];

/// Where virtual time should be, from wall time.
#[derive(Debug, Clone, Copy)]
struct Pace {
    factor: f64,
    start: Instant,
    start_ms: u64,
    /// Virtual ms that were dropped.
    lost_ms: u64,
}

impl Pace {
    fn new(factor: f64, now_ms: u64) -> Self {
        Self { factor, start: Instant::now(), start_ms: now_ms, lost_ms: 0 }
    }

    /// The virtual time for `now`; a lag beyond [`CATCH_UP`] is dropped, so that the clock never races after a stall.
    fn target_ms(&mut self, now: Instant, now_ms: u64) -> u64 {
        let most_ms = now_ms + whole_ms(CATCH_UP.as_secs_f64() * 1000.0 * self.factor).max(1);
        let elapsed_ms = now.saturating_duration_since(self.start).as_secs_f64() * 1000.0;
        let target_ms = self.start_ms + whole_ms(elapsed_ms * self.factor);
        if target_ms > most_ms {
            self.lost_ms += target_ms - most_ms;
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

/// Moves the clock to `target_ms`, or as far as it comes in a turn. Returns whether it came there.
fn run_turn(robot: &mut VirtualRobot, target_ms: u64) -> bool {
    let end = Instant::now() + TURN;
    while robot.now_ms() < target_ms && Instant::now() < end {
        robot.advance_to(robot.now_ms() + 1);
    }
    robot.now_ms() >= target_ms
}

/// Moves a free clock for one turn. Returns whether it went on.
fn run_freely(robot: &mut VirtualRobot, pace: &mut Pace) -> bool {
    let begin_ms = robot.now_ms();
    let most_ms = begin_ms + FREE_RUN_MS;
    while robot.is_line_busy() && robot.now_ms() < most_ms {
        robot.advance_to(robot.now_ms() + 1);
    }
    if robot.has_arrived() {
        (pace.start, pace.start_ms) = (Instant::now(), robot.now_ms());
    }
    let target_ms = pace.target_ms(Instant::now(), robot.now_ms());
    robot.advance_until_byte(target_ms.max(pace.start_ms + HEAD_START_MS).min(most_ms));
    robot.now_ms() > begin_ms
}

/// Runs `clock` in a thread of its own until `stop` is set. After every turn `arrived` gets the bytes that have
/// arrived at the PC, if any. `lost_ms` is set to the virtual ms that were dropped so far because the machine could not
/// keep up with a paced clock.
pub fn run(
    robot: SharedRobot,
    clock: Clock,
    stop: Arc<AtomicBool>,
    lost_ms: Arc<AtomicU64>,
    mut arrived: impl FnMut(&[u8]) + Send + 'static,
) -> JoinHandle<()> {
    thread::spawn(move || {
        let factor = match clock {
            Clock::Paced { factor } => factor.clamp(*FACTOR.start(), *FACTOR.end()),
            Clock::Free | Clock::Manual => 1.0,
        };
        let mut pace = Pace::new(factor, robot.lock().now_ms());
        let mut bytes = Vec::new();
        while !stop.load(Ordering::Relaxed) {
            let mut locked = robot.lock();
            let pause = match clock {
                Clock::Paced { .. } => {
                    let target_ms = pace.target_ms(Instant::now(), locked.now_ms());
                    lost_ms.store(pace.lost_ms, Ordering::Relaxed);
                    if run_turn(&mut locked, target_ms) { TICK } else { FREE_PAUSES[0] }
                }
                Clock::Free if run_freely(&mut locked, &mut pace) => FREE_PAUSES[0],
                Clock::Free => FREE_PAUSES[1],
                Clock::Manual => TICK,
            };
            locked.receive(&mut bytes);
            drop(locked);
            if !bytes.is_empty() {
                arrived(&bytes);
                bytes.clear();
            }
            thread::sleep(pause);
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::VirtualRobotConfig;
    use crate::world::World;

    fn robot() -> VirtualRobot {
        let world = World::empty();
        VirtualRobot::new(VirtualRobotConfig { world, ..VirtualRobotConfig::default() })
            .expect("a valid configuration")
    }

    #[test]
    fn time_follows_the_wall_clock_and_never_races_after_a_stall() {
        let start = Instant::now();
        let mut pace = Pace { start, ..Pace::new(10.0, 100) };
        let at = |ms| start + Duration::from_millis(ms);
        assert_eq!(pace.target_ms(at(7), 100), 170);
        assert_eq!(pace.target_ms(at(200), 170), 2100);
        // A stall of an hour is worth the 250 ms that may be caught up with.
        assert_eq!(pace.lost_ms, 0);
        assert_eq!(pace.target_ms(at(3_600_000), 2100), 4600);
        assert_eq!(pace.lost_ms, 36_000_100 - 4600);
        assert_eq!(pace.target_ms(at(3_600_001), 4600), 4610);
    }

    #[test]
    fn a_free_clock_runs_its_head_start_after_an_answer_and_no_farther() {
        let mut robot = robot();
        // Far enough ahead that the wall clock does not catch up during the test.
        let start = Instant::now() + Duration::from_hours(1);
        let mut pace = Pace { start, ..Pace::new(1.0, 0) };
        while run_freely(&mut robot, &mut pace) {}
        assert_eq!(robot.now_ms(), HEAD_START_MS);
        // Half a package: the rest may still come, so its time passes and no more.
        robot.send(&[0xC9, 0x80, 0x2A]);
        while run_freely(&mut robot, &mut pace) {}
        assert!(robot.now_ms() < HEAD_START_MS + 2 * FREE_RUN_MS, "{}", robot.now_ms());
        let package = rsapien_protocol::ActionPackage {
            session: 0,
            sequence: 1,
            request: rsapien_protocol::Request::State,
        };
        robot.send(&package.encode(rsapien_protocol::Address::Motion));
        while !robot.has_arrived() {
            assert!(run_freely(&mut robot, &mut pace), "the line carries bytes at once");
        }
        let (answered_ms, mut answer) = (robot.now_ms(), Vec::new());
        robot.receive(&mut answer);
        assert_eq!(pace.start_ms, answered_ms, "the head start counts from the answer");
        while robot.now_ms() < answered_ms + HEAD_START_MS {
            assert!(run_freely(&mut robot, &mut pace), "the head start takes no time");
        }
        assert!(!run_freely(&mut robot, &mut pace), "and is over then");
        assert_eq!(answer.len(), rsapien_protocol::SYNCHRONIZATION_PACKAGE_LENGTH);
    }
}
