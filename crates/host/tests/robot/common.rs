//! A robot to test with: virtual, on a virtual clock, in a world without obstacles.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};

use rsapien::link::virtual_robot::{
    Pace, SharedVirtualRobot, VirtualConnector, VirtualOptions, VirtualRobot,
};
use rsapien::link::{Connect, Link, RealClock};
use rsapien::protocol::{ActionPackage, Address, Primitive, Request, Step};
use rsapien::{Error, Interruption, MotionController, Outcome, PlayOptions, Robot, RobotOptions};

pub(crate) const SESSION_OF_ANOTHER: u8 = 200;

pub(crate) fn virtual_robot() -> SharedVirtualRobot {
    VirtualOptions::default().build().unwrap()
}

/// A robot on a virtual clock, and the virtual robot behind it.
pub(crate) fn open() -> (Robot, SharedVirtualRobot) {
    let shared = virtual_robot();
    let options = RobotOptions::new("test");
    let robot = Robot::virtual_with(Arc::clone(&shared), Pace::Fast, options).unwrap();
    (robot, shared)
}

/// As [`open`], with the motion controller held and the robot initialised.
pub(crate) fn open_initialised() -> (Robot, SharedVirtualRobot, MotionController) {
    let (robot, shared) = open();
    let mut motion = robot.motion().unwrap();
    motion.init().unwrap();
    (robot, shared, motion)
}

pub(crate) fn lock(shared: &SharedVirtualRobot) -> MutexGuard<'_, VirtualRobot> {
    shared.lock().unwrap()
}

/// `count` steps of `duration_ms` in which the arms go up and down, so that motors run.
pub(crate) fn arms(count: usize, duration_ms: u16) -> Vec<Step> {
    let pose = |names: [&str; 2]| {
        names
            .iter()
            .map(|name| Primitive::parse(name).unwrap())
            .fold(rsapien::protocol::Pose::EMPTY, |pose, primitive| {
                pose.with(primitive.joint(), Some(primitive.position()))
            })
    };
    let up = Step::new(pose(["right-arm-up", "left-arm-up"]), duration_ms);
    let down = Step::new(pose(["right-arm-down", "left-arm-down"]), duration_ms);
    (0..count).map(|index| if index % 2 == 0 { up } else { down }).collect()
}

/// Options of a player that does `fault` once when `steps` steps have ended.
pub(crate) fn at_step<'a>(steps: usize, fault: impl FnOnce() + Send + 'a) -> PlayOptions<'a> {
    let mut fault = Some(fault);
    PlayOptions {
        on_progress: Some(Box::new(move |progress| {
            if progress.steps_ended >= steps
                && let Some(fault) = fault.take()
            {
                fault();
            }
        })),
        ..PlayOptions::default()
    }
}

pub(crate) fn interrupted(by: Interruption) -> Outcome {
    Outcome::Interrupted { by }
}

pub(crate) fn motors_are_off(shared: &SharedVirtualRobot) -> bool {
    let pins = lock(shared).motors();
    pins.towards_first == 0 && pins.towards_last == 0
}

/// Puts a package of another program on the robot's line.
pub(crate) fn send_from_outside(shared: &SharedVirtualRobot, request: Request) {
    let package = ActionPackage { session: SESSION_OF_ANOTHER, sequence: 9, request };
    lock(shared).send(&package.encode(Address::Motion));
}

/// The line to a virtual robot, which breaks as long as `broken` says so.
pub(crate) struct BreakableConnector {
    inner: VirtualConnector,
    broken: Arc<AtomicBool>,
}

struct BreakableLink {
    inner: Box<dyn Link>,
    broken: Arc<AtomicBool>,
}

impl BreakableConnector {
    pub(crate) fn open() -> (Robot, SharedVirtualRobot, Arc<AtomicBool>) {
        let shared = virtual_robot();
        let broken = Arc::new(AtomicBool::new(false));
        let inner = VirtualConnector::new(Arc::clone(&shared), Pace::Fast);
        let connector = BreakableConnector { inner, broken: Arc::clone(&broken) };
        let robot = Robot::open_with(Box::new(connector), RobotOptions::new("test")).unwrap();
        (robot, shared, broken)
    }
}

fn check(broken: &AtomicBool) -> Result<(), Error> {
    if !broken.load(Ordering::SeqCst) {
        return Ok(());
    }
    Err(Error::LinkLost { link: "breakable".into(), why: "unplugged".into() })
}

impl Connect for BreakableConnector {
    fn name(&self) -> String {
        "breakable".to_owned()
    }

    fn connect(&mut self, clock: RealClock) -> Result<Box<dyn Link>, Error> {
        check(&self.broken)?;
        let broken = Arc::clone(&self.broken);
        Ok(Box::new(BreakableLink { inner: self.inner.connect(clock)?, broken }))
    }
}

impl Link for BreakableLink {
    fn now_ms(&self) -> u64 {
        self.inner.now_ms()
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Error> {
        check(&self.broken)?;
        self.inner.send(bytes)
    }

    fn receive(&mut self, buffer: &mut [u8], until_ms: u64) -> Result<usize, Error> {
        check(&self.broken)?;
        self.inner.receive(buffer, until_ms)
    }

    fn wait_until(&mut self, until_ms: u64) {
        self.inner.wait_until(until_ms);
    }

    fn flush_input(&mut self) -> Result<(), Error> {
        check(&self.broken)?;
        self.inner.flush_input()
    }

    fn is_paced_by_caller(&self) -> bool {
        true
    }
}

/// A list that a package sink or a callback fills.
pub(crate) type Shared<T> = Arc<Mutex<Vec<T>>>;
