//! The whole robot: controllers, line, body, head, world and camera on one virtual clock.
//!
//! [`VirtualRobot`] is synchronous and does nothing by itself. Bytes of the PC go in by [`VirtualRobot::send`], the
//! clock is moved by [`VirtualRobot::advance_to`] or [`VirtualRobot::advance_until_byte`], and what the controllers
//! answer comes out of [`VirtualRobot::receive`]. The same configuration and the same calls at the same virtual times
//! give the same bytes, motions and pictures.
//!
//! One virtual millisecond is: bytes that the line completes in it reach both controllers, whose main routines run
//! at once; then both controllers tick; then the body and the head move as the outputs tell them.

mod config;
mod faults;
mod head;
mod power;
mod state;
#[cfg(test)]
mod tests;

pub use config::{ConfigError, VirtualRobotConfig};
pub use head::HEAD_SPEED_CENTIDEG_PER_MS;
pub use power::Power;
pub use state::{JointReading, RobotReading};

use std::sync::Arc;

use rsapien_firmware_model::{
    CameraController, Controller, Inputs, MiddleSwitches, MotionController, MotorOutput, ResetCause,
};
use rsapien_protocol::{CameraReport, Joint, LineError, MotionReport};

use crate::body::{Body, LOW_MV, MotorPins};
use crate::camera::{Camera, CameraPose, HeadAngles, Picture, VisibleEllipse, ground_truth};
use crate::geometry::RobotPose;
use crate::line::{Heard, Line, LineEvent};
use crate::world::World;
use head::Head;

/// Controllers in the order in which the line knows them.
const MOTION: usize = 0;
const CAMERA: usize = 1;

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
#[derive(Debug, Clone)]
pub struct VirtualRobot {
    now_ms: u64,
    world: Arc<World>,
    camera: Arc<Camera>,
    frame: u64,
    line: Line,
    motion: MotionController,
    camera_controller: CameraController,
    body: Body,
    head: Head,
    power: Power,
}

impl VirtualRobot {
    /// A robot that was switched on at virtual time 0 and to which nobody has spoken.
    ///
    /// # Errors
    /// [`ConfigError`] names the first value outside its range.
    pub fn new(config: VirtualRobotConfig) -> Result<Self, ConfigError> {
        config.check()?;
        let camera = Camera::new(config.camera_settings())?;
        let VirtualRobotConfig { seed, world, baud, clock_mhz, body, .. } = config;
        let world = Arc::new(world);
        Ok(Self {
            now_ms: 0,
            camera: Arc::new(camera),
            frame: 0,
            line: Line::new(baud, seed),
            motion: MotionController::new(ResetCause::PowerOn, 0).with_clock_mhz(clock_mhz),
            camera_controller: CameraController::new(ResetCause::PowerOn, 0)
                .with_clock_mhz(clock_mhz),
            body: Body::new(body, seed, &world),
            head: Head::new(seed),
            power: Power::On,
            world,
        })
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
        !self.line.is_idle()
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
        let end = self.line.units(self.now_ms + 1);
        if !self.line.is_idle() {
            self.carry_bytes(end);
        }
        if self.power.is_on() {
            let inputs = self.inputs();
            self.motion.tick(inputs);
            self.camera_controller.tick(inputs);
            self.start_transmitters(end);
        }
        let pins = self.motors();
        self.body.step(pins, &self.world);
        if self.power.is_on() {
            self.head.step(self.camera_controller.outputs());
        }
        self.now_ms += 1;
        self.watch_supply();
    }

    fn carry_bytes(&mut self, end: u64) {
        while let Some((now, event)) = self.line.next_event(end) {
            match event {
                LineEvent::ToRobot(heard) if self.power.is_on() => {
                    for heard in heard.into_iter().flatten() {
                        self.hear(heard);
                    }
                    let inputs = self.inputs();
                    self.motion.main_routine(inputs);
                    self.camera_controller.main_routine();
                    self.start_transmitters(now);
                }
                LineEvent::ToRobot(_) => {}
                LineEvent::Sent(_) => self.start_transmitters(now),
            }
        }
    }

    fn hear(&mut self, heard: Heard) {
        match heard {
            Heard::Byte(byte) => {
                self.motion.receive_interrupt(byte);
                self.camera_controller.receive_interrupt(byte);
            }
            Heard::FramingError => {
                self.motion.receive_error(LineError::Framing);
                self.camera_controller.receive_error(LineError::Framing);
            }
        }
    }

    fn start_transmitters(&mut self, now: u64) {
        if self.motion.is_transmitting()
            && self.line.can_transmit(MOTION)
            && let Some(byte) = self.motion.transmit_interrupt()
        {
            self.line.transmit(MOTION, byte, now);
        }
        if self.camera_controller.is_transmitting()
            && self.line.can_transmit(CAMERA)
            && let Some(byte) = self.camera_controller.transmit_interrupt()
        {
            self.line.transmit(CAMERA, byte, now);
        }
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
        self.motion.reset(cause);
        self.camera_controller.reset(cause);
        self.line.silence(MOTION);
        self.line.silence(CAMERA);
    }

    /// The motors' pins as they stand now; all off while the controllers are held in reset.
    pub fn motors(&self) -> MotorPins {
        let mut pins = MotorPins::default();
        if self.power.is_on() {
            for (index, output) in self.motion.motors().into_iter().enumerate() {
                match output {
                    MotorOutput::Off => {}
                    MotorOutput::TowardsFirst => pins.towards_first |= 1 << index,
                    MotorOutput::TowardsLast => pins.towards_last |= 1 << index,
                }
            }
        }
        pins
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

    /// What the motion controller would report now.
    pub fn motion_report(&self) -> MotionReport {
        self.motion.report()
    }

    /// What the camera controller would report now.
    pub fn camera_report(&self) -> CameraReport {
        self.camera_controller.report()
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
