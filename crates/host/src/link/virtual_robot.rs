//! The virtual robot, in this process: at the pace of real time, or as fast as it goes.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

pub use rsapien_sim::firmware::{FirmwareConfig, FirmwareImage};
pub use rsapien_sim::robot::Controllers;
pub use rsapien_sim::{VirtualRobot, VirtualRobotConfig};

use crate::Error;
use crate::link::{Connect, Link, RealClock};

/// A virtual robot that the line and others use together: lock it shortly, to take a picture, read
/// the truth, or put in a fault. Time moves on by the line alone.
pub type SharedVirtualRobot = Arc<Mutex<VirtualRobot>>;

/// How time passes for the virtual robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pace {
    /// A virtual second takes a second. With the firmware in a simulator of its chips, it takes at least a second, and
    /// passes only while the program waits for the robot: where the simulation is slower, so is everybody's time.
    #[default]
    Real,
    /// Time passes only while the program waits for the robot, and then as fast as the computer
    /// goes. A program with one thread gets the same packages at the same times every run.
    Fast,
}

/// How the virtual robot is made and paced.
#[derive(Clone, Debug, Default)]
pub struct VirtualOptions {
    /// How time passes.
    pub pace: Pace,
    /// Seed, world, camera, body.
    pub config: VirtualRobotConfig,
}

impl VirtualOptions {
    /// Makes the robot: switched on just now, nobody has spoken to it.
    ///
    /// # Errors
    /// [`Error::VirtualRobot`] names the first value out of its range.
    pub fn build(&self) -> Result<SharedVirtualRobot, Error> {
        Ok(Arc::new(Mutex::new(VirtualRobot::new(self.config.clone())?)))
    }
}

/// Opens the line to a virtual robot.
pub struct VirtualConnector {
    robot: SharedVirtualRobot,
    pace: Pace,
}

impl VirtualConnector {
    /// The line to `robot`.
    pub fn new(robot: SharedVirtualRobot, pace: Pace) -> VirtualConnector {
        VirtualConnector { robot, pace }
    }
}

impl Connect for VirtualConnector {
    fn name(&self) -> String {
        "virtual".to_owned()
    }

    fn connect(&mut self, clock: RealClock) -> Result<Box<dyn Link>, Error> {
        let robot = Arc::clone(&self.robot);
        let is_firmware = {
            let robot = lock(&robot);
            check(&robot)?;
            robot.is_firmware()
        };
        Ok(match self.pace {
            Pace::Fast => Box::new(VirtualLink { robot, waiting: Vec::new(), brake: None }),
            Pace::Real if is_firmware => {
                let brake = Some(Brake::new(lock(&robot).now_ms()));
                Box::new(VirtualLink { robot, waiting: Vec::new(), brake })
            }
            Pace::Real => {
                let lead_ms = lock(&robot).now_ms().saturating_sub(clock.now_ms());
                Box::new(RealLink { robot, waiting: Vec::new(), clock, lead_ms })
            }
        })
    }
}

fn lock(robot: &SharedVirtualRobot) -> MutexGuard<'_, VirtualRobot> {
    robot.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A robot whose controllers' simulator has ended answers nobody any more.
fn check(robot: &VirtualRobot) -> Result<(), Error> {
    match robot.failure() {
        None => Ok(()),
        Some(failure) => {
            Err(Error::LinkLost { link: "virtual".to_owned(), why: failure.to_string() })
        }
    }
}

/// Moves as many bytes as fit from the front of `waiting` into `buffer`.
fn hand_over(waiting: &mut Vec<u8>, buffer: &mut [u8]) -> usize {
    let count = waiting.len().min(buffer.len());
    for (place, byte) in buffer.iter_mut().zip(waiting.drain(..count)) {
        *place = byte;
    }
    count
}

/// The longest that a braked link keeps the robot to itself, in virtual ms.
const BRAKED_TURN_MS: u64 = 5;
/// What a braked clock catches up with after a while in which nobody waited, in ms.
const CATCH_UP_MS: u64 = 20;
/// Slower than real time by so much in all, and by a tenth, it is told.
const TOLD_LAG: Duration = Duration::from_secs(1);

/// Keeps virtual time from running ahead of the wall clock. It may fall behind.
struct Brake {
    /// A moment, and the virtual time that belongs to it.
    at: Instant,
    at_ms: u64,
    /// How long was waited for the robot, and how much of its time passed meanwhile.
    waited: Duration,
    waited_ms: u64,
    is_told: bool,
}

impl Brake {
    fn new(now_ms: u64) -> Brake {
        let (at, waited) = (Instant::now(), Duration::ZERO);
        Brake { at, at_ms: now_ms, waited, waited_ms: 0, is_told: false }
    }

    /// Somebody begins to wait; what passed before is gone, but for a little.
    fn begin(&mut self, now_ms: u64) {
        let due_ms = self.at_ms.saturating_add(whole_ms(self.at.elapsed()));
        if due_ms > now_ms + CATCH_UP_MS {
            (self.at, self.at_ms) = (Instant::now(), now_ms + CATCH_UP_MS);
        }
    }

    /// How long to sleep, so that the wall clock comes to `now_ms`.
    fn ahead(&self, now_ms: u64) -> Duration {
        Duration::from_millis(now_ms.saturating_sub(self.at_ms)).saturating_sub(self.at.elapsed())
    }

    /// Keeps count of what was waited; whether to tell that it is slow.
    fn is_slow_now(&mut self, waited: Duration, passed_ms: u64) -> bool {
        self.waited += waited;
        self.waited_ms += passed_ms;
        let lag = self.waited.saturating_sub(Duration::from_millis(self.waited_ms));
        let is_news = !self.is_told && lag > TOLD_LAG && lag * 10 > self.waited;
        self.is_told |= is_news;
        is_news
    }
}

fn whole_ms(duration: Duration) -> u64 {
    u64::try_from(duration.as_millis()).unwrap_or(u64::MAX)
}

/// A link on the robot's own clock, which passes while somebody waits.
struct VirtualLink {
    robot: SharedVirtualRobot,
    waiting: Vec<u8>,
    /// None: as fast as it goes.
    brake: Option<Brake>,
}

impl VirtualLink {
    /// Lets time pass to `until_ms`, or to the first byte that arrives if those are `wanted`.
    fn pass(&mut self, until_ms: u64, wanted: bool) {
        let advance = |robot: &mut VirtualRobot, limit_ms: u64| {
            if wanted {
                robot.advance_until_byte(limit_ms)
            } else {
                robot.advance_to(limit_ms);
                false
            }
        };
        let Some(brake) = &mut self.brake else {
            advance(&mut lock(&self.robot), until_ms);
            return;
        };
        let (begin, begin_ms) = (Instant::now(), lock(&self.robot).now_ms());
        brake.begin(begin_ms);
        let mut now_ms = begin_ms;
        let mut has_arrived = false;
        while now_ms < until_ms && !has_arrived {
            let mut robot = lock(&self.robot);
            has_arrived = advance(&mut robot, until_ms.min(now_ms + BRAKED_TURN_MS));
            now_ms = robot.now_ms();
            drop(robot);
            std::thread::sleep(brake.ahead(now_ms));
        }
        if brake.is_slow_now(begin.elapsed(), now_ms.saturating_sub(begin_ms)) {
            tracing::warn!(
                "the simulation of the chips is slower than real time here; the robot's time passes more slowly, and all \
                 goes on"
            );
        }
    }
}

impl Link for VirtualLink {
    fn now_ms(&self) -> u64 {
        lock(&self.robot).now_ms()
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Error> {
        let mut robot = lock(&self.robot);
        check(&robot)?;
        robot.send(bytes);
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8], until_ms: u64) -> Result<usize, Error> {
        self.pass(until_ms, true);
        let mut robot = lock(&self.robot);
        robot.receive(&mut self.waiting);
        check(&robot)?;
        Ok(hand_over(&mut self.waiting, buffer))
    }

    fn wait_until(&mut self, until_ms: u64) {
        self.pass(until_ms, false);
    }

    fn flush_input(&mut self) -> Result<(), Error> {
        lock(&self.robot).receive(&mut self.waiting);
        self.waiting.clear();
        Ok(())
    }

    fn is_paced_by_caller(&self) -> bool {
        true
    }
}

struct RealLink {
    robot: SharedVirtualRobot,
    waiting: Vec<u8>,
    clock: RealClock,
    /// What the robot's clock is ahead of the line's.
    lead_ms: u64,
}

impl RealLink {
    /// The robot, as it is now.
    fn robot_now(&self) -> MutexGuard<'_, VirtualRobot> {
        let mut robot = lock(&self.robot);
        robot.advance_to(self.clock.now_ms().saturating_add(self.lead_ms));
        robot
    }
}

impl Link for RealLink {
    fn now_ms(&self) -> u64 {
        self.clock.now_ms()
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Error> {
        self.robot_now().send(bytes);
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8], until_ms: u64) -> Result<usize, Error> {
        loop {
            let mut arrived = Vec::new();
            self.robot_now().receive(&mut arrived);
            self.waiting.append(&mut arrived);
            if !self.waiting.is_empty() || self.clock.now_ms() >= until_ms {
                return Ok(hand_over(&mut self.waiting, buffer));
            }
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    fn flush_input(&mut self) -> Result<(), Error> {
        self.robot_now().receive(&mut Vec::new());
        self.waiting.clear();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_braked_clock_never_runs_ahead_and_makes_up_for_little() {
        let robot = VirtualOptions::default().build().unwrap();
        let brake = Some(Brake::new(0));
        let mut link = VirtualLink { robot, waiting: Vec::new(), brake };
        let begin = Instant::now();
        link.wait_until(60);
        assert!(begin.elapsed() >= Duration::from_millis(60) && link.now_ms() == 60);
        // Nobody waits for a while: that is no time of the robot's.
        std::thread::sleep(Duration::from_millis(100));
        let begin = Instant::now();
        link.wait_until(160);
        let took = begin.elapsed();
        assert!(took >= Duration::from_millis(100 - CATCH_UP_MS), "{took:?}");
        let mut buffer = [0; 8];
        assert_eq!(link.receive(&mut buffer, 170).unwrap(), 0);
        assert_eq!(link.now_ms(), 170);
    }

    #[test]
    fn a_slow_robot_is_told_of_once() {
        let mut brake = Brake::new(0);
        let second = Duration::from_secs(1);
        assert!(!brake.is_slow_now(20 * second, 19_500), "half a second is nothing");
        assert!(!brake.is_slow_now(20 * second, 19_000), "nor is less than a tenth");
        assert!(brake.is_slow_now(20 * second, 10_000));
        assert!(!brake.is_slow_now(20 * second, 10_000), "once");
    }
}
