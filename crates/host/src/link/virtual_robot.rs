//! The virtual robot, in this process: at the pace of real time, or as fast as it goes.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

pub use rsapien_sim::{VirtualRobot, VirtualRobotConfig};

use crate::Error;
use crate::link::{Connect, Link, RealClock};

/// A virtual robot that the line and others use together: lock it shortly, to take a picture, read
/// the truth, or put in a fault. Time moves on by the line alone.
pub type SharedVirtualRobot = Arc<Mutex<VirtualRobot>>;

/// How time passes for the virtual robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pace {
    /// A virtual second takes a second.
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
        Ok(match self.pace {
            Pace::Fast => Box::new(FastLink { robot, waiting: Vec::new() }),
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

/// Moves as many bytes as fit from the front of `waiting` into `buffer`.
fn hand_over(waiting: &mut Vec<u8>, buffer: &mut [u8]) -> usize {
    let count = waiting.len().min(buffer.len());
    for (place, byte) in buffer.iter_mut().zip(waiting.drain(..count)) {
        *place = byte;
    }
    count
}

struct FastLink {
    robot: SharedVirtualRobot,
    waiting: Vec<u8>,
}

impl Link for FastLink {
    fn now_ms(&self) -> u64 {
        lock(&self.robot).now_ms()
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Error> {
        lock(&self.robot).send(bytes);
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8], until_ms: u64) -> Result<usize, Error> {
        let mut robot = lock(&self.robot);
        robot.advance_until_byte(until_ms);
        robot.receive(&mut self.waiting);
        Ok(hand_over(&mut self.waiting, buffer))
    }

    fn wait_until(&mut self, until_ms: u64) {
        lock(&self.robot).advance_to(until_ms);
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
