//! The whole robot: controllers, line, body, head, world and camera on one virtual clock.
//!
//! [`VirtualRobot`] is synchronous and does nothing by itself. Bytes of the PC go in by [`VirtualRobot::send`], the
//! clock is moved by [`VirtualRobot::advance_to`] or [`VirtualRobot::advance_until_byte`], and what the controllers
//! answer comes out of [`VirtualRobot::receive`]. The same configuration and the same calls at the same virtual times
//! give the same bytes, motions and pictures.
//!
//! One virtual millisecond is: bytes that the line completes in it reach both controllers, whose main routines run
//! at once; then both controllers tick; then the body and the head move as the outputs tell them. The controllers are
//! the firmware's reference model, or the firmware itself in a simulator of its chips ([`crate::firmware`]).

mod config;
mod faults;
mod head;
mod power;
mod state;
#[cfg(test)]
mod tests;

pub use crate::electronics::NotWithFirmware;
pub use config::{ConfigError, Controllers, VirtualRobotConfig};
pub use head::HEAD_SPEED_CENTIDEG_PER_MS;
pub use power::Power;
pub use state::{JointReading, RobotReading};

use std::sync::Arc;

use rsapien_firmware_model::{Inputs, MiddleSwitches};
use rsapien_protocol::{CameraReport, Joint, MotionReport};

use crate::body::{Body, LOW_MV, MotorPins};
use crate::camera::{Camera, CameraPose, HeadAngles, Picture, VisibleEllipse, ground_truth};
use crate::electronics::{Electronics, Model};
use crate::firmware::{Firmware, FirmwareError};
use crate::geometry::RobotPose;
use crate::line::Line;
use crate::world::World;
use head::Head;

/// A moment as the camera sees it, to be rendered without holding the robot up.
#[derive(Debug, Clone)]
pub struct View {
    world: Arc<World>,
    camera: Arc<Camera>,
    pose: CameraPose,
    frame: u64,
}

impl View {
    /// Renders the picture.
    pub fn picture(&self) -> Picture {
        self.camera.render(&self.world, &self.pose, self.frame)
    }

    /// Every ellipse that is visible in the picture, exactly.
    pub fn ground_truth(&self) -> Vec<VisibleEllipse> {
        ground_truth(&self.world, &self.camera.settings().intrinsics, &self.pose)
    }
}

/// The virtual robot. See the [module](self).
#[derive(Debug)]
pub struct VirtualRobot {
    now_ms: u64,
    world: Arc<World>,
    camera: Arc<Camera>,
    frame: u64,
    line: Line,
    electronics: Box<dyn Electronics>,
    body: Body,
    head: Head,
    power: Power,
}

impl VirtualRobot {
    /// A robot that was switched on at virtual time 0 and to which nobody has spoken.
    ///
    /// # Errors
    /// [`ConfigError`] names the first value outside its range, or tells why the firmware does not run.
    pub fn new(config: VirtualRobotConfig) -> Result<Self, ConfigError> {
        config.check()?;
        let electronics: Box<dyn Electronics> = match &config.controllers {
            Controllers::Model => Box::new(Model::new(config.clock_mhz)),
            Controllers::Firmware(firmware) => Box::new(Firmware::start(firmware)?),
        };
        Self::with_electronics(config, electronics)
    }

    /// A robot with these controllers, just switched on, whatever the configuration says of them.
    pub(crate) fn with_electronics(
        config: VirtualRobotConfig,
        electronics: Box<dyn Electronics>,
    ) -> Result<Self, ConfigError> {
        let camera = Camera::new(config.camera_settings())?;
        let VirtualRobotConfig { seed, world, baud, body, .. } = config;
        let world = Arc::new(world);
        Ok(Self {
            now_ms: 0,
            camera: Arc::new(camera),
            frame: 0,
            line: Line::new(baud, seed),
            electronics,
            body: Body::new(body, seed, &world),
            head: Head::new(seed),
            power: Power::On,
            world,
        })
    }

    /// A second robot that goes on from here as this one does; none where the controllers run in a simulator of their
    /// chips, which cannot be doubled.
    pub fn try_clone(&self) -> Option<Self> {
        Some(Self {
            now_ms: self.now_ms,
            world: Arc::clone(&self.world),
            camera: Arc::clone(&self.camera),
            frame: self.frame,
            line: self.line.clone(),
            electronics: self.electronics.try_clone()?,
            body: self.body.clone(),
            head: self.head.clone(),
            power: self.power,
        })
    }

    /// Whether the firmware itself runs in a simulator of its chips: a virtual second then takes a good part of a second,
    /// or more where others use the computer, and the reports are those last told on the line.
    pub fn is_firmware(&self) -> bool {
        self.electronics.is_firmware()
    }

    /// Why the simulator of the chips ended while the robot ran on it. The robot is then as one whose controllers are
    /// dead: motors off, silent. None while all is well, and with the model always.
    pub fn failure(&self) -> Option<&FirmwareError> {
        self.electronics.failure()
    }

    /// Virtual time in ms since the robot was made.
    pub fn now_ms(&self) -> u64 {
        self.now_ms
    }

    /// Puts bytes of the PC on the line, where they leave one after the other at its pace from now on.
    pub fn send(&mut self, bytes: &[u8]) {
        self.line.send(bytes, self.line.units(self.now_ms));
    }

    /// How many bytes of [`send`](VirtualRobot::send) have not left the PC yet.
    pub fn unsent(&self) -> usize {
        self.line.waiting()
    }

    /// Whether bytes are on their way, either way.
    pub fn is_line_busy(&self) -> bool {
        !self.line.is_idle() || self.electronics.is_busy()
    }

    /// Moves the clock to `ms`; a time that has passed does nothing.
    pub fn advance_to(&mut self, ms: u64) {
        while self.now_ms < ms {
            self.advance_one_ms();
        }
    }

    /// Moves the clock until bytes wait for the PC, at most to `limit_ms`. Returns whether bytes wait.
    pub fn advance_until_byte(&mut self, limit_ms: u64) -> bool {
        while self.now_ms < limit_ms && !self.line.has_arrived() {
            self.advance_one_ms();
        }
        self.line.has_arrived()
    }

    /// Moves the bytes that have arrived at the PC to the end of `bytes`.
    pub fn receive(&mut self, bytes: &mut Vec<u8>) {
        self.line.receive(bytes);
    }

    /// Whether bytes have arrived at the PC.
    pub fn has_arrived(&self) -> bool {
        self.line.has_arrived()
    }

    fn advance_one_ms(&mut self) {
        let (inputs, is_powered) = (self.inputs(), self.power.is_on());
        self.electronics.run_ms(&mut self.line, self.now_ms, inputs, is_powered);
        let pins = self.motors();
        self.body.step(pins, &self.world);
        if is_powered {
            self.head.step(self.electronics.servos());
        }
        self.now_ms += 1;
        self.watch_supply();
    }

    fn inputs(&self) -> Inputs {
        let [left, right] = self.body.middle_switches();
        Inputs {
            bumpers: self.body.bumpers(),
            middle_switches: MiddleSwitches { left, right },
            supply_low: self.body.supply_mv() < LOW_MV,
        }
    }

    fn watch_supply(&mut self) {
        match self.power.after_ms(self.body.supply_mv()) {
            Some(Power::On) => self.come_back(),
            Some(power) => self.power = power,
            None => {}
        }
    }

    fn come_back(&mut self) {
        let cause = self.power.reset_cause();
        self.power = Power::On;
        self.electronics.reset(&mut self.line, cause);
    }

    /// The motors' pins as they stand now; all off while the controllers are held in reset.
    pub fn motors(&self) -> MotorPins {
        if self.power.is_on() { self.electronics.motors() } else { MotorPins::default() }
    }

    /// Where every joint truly is, in the order of the joints: 0 at the first position of the paper's Table 1, 1 at
    /// the last. [`crate::body`] tells what that is in metres and radians.
    pub fn joints(&self) -> [f64; Joint::COUNT] {
        self.body.positions()
    }

    /// The body, to read the truth from.
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// Where the robot stands and how its trunk leans.
    pub fn pose(&self) -> RobotPose {
        self.body.pose()
    }

    /// Where the head truly points.
    pub fn camera_angles(&self) -> HeadAngles {
        self.head.angles()
    }

    /// What the motion controller would report now. Of a firmware in a simulator nobody knows more than it tells: there
    /// it is the last report that it sent since its reset, and that of a fresh controller until it sends one.
    pub fn motion_report(&self) -> MotionReport {
        self.electronics.motion_report()
    }

    /// What the camera controller would report now; of a firmware as for [`motion_report`](Self::motion_report).
    pub fn camera_report(&self) -> CameraReport {
        self.electronics.camera_report()
    }

    /// The world it stands in.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The camera's settings.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The place of the camera in the world.
    pub fn camera_pose(&self) -> CameraPose {
        CameraPose::on_robot(&self.pose(), self.camera_angles())
    }

    /// Freezes the next picture, with a frame number (and so a noise) of its own.
    pub fn view(&mut self) -> View {
        self.frame += 1;
        View {
            world: Arc::clone(&self.world),
            camera: Arc::clone(&self.camera),
            pose: self.camera_pose(),
            frame: self.frame,
        }
    }

    /// What the camera sees now. Every call is a new picture with noise of its own.
    pub fn picture(&mut self) -> Picture {
        self.view().picture()
    }

    /// Every ellipse that the camera can see now, exactly.
    pub fn ground_truth(&self) -> Vec<VisibleEllipse> {
        ground_truth(&self.world, &self.camera.settings().intrinsics, &self.camera_pose())
    }

    /// Whether and why the controllers are running.
    pub fn power(&self) -> Power {
        self.power
    }
}
