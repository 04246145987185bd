//! The robot's body: seven motors between end stops, switches, bumpers, batteries, and where it stands.
//!
//! [`Body::step`] takes the pins of the motors for one ms and moves everything by as much. What the controllers can
//! sense of it is told by [`Body::bumpers`], [`Body::middle_switches`] and [`Body::supply_mv`]; the rest is the truth
//! that only the simulation knows. Everything may be set or broken from outside.
//!
//! Positions of joints are fractions of full travel: 0 at the first position of the paper's Table 1 (arm up, hand in,
//! tilt left, leg front), 1 at the last (arm down, hand open, tilt right, leg back).

mod contact;
mod joint;
mod supply;
#[cfg(test)]
mod tests;
mod walking;

pub use contact::{Contact, FOOTPRINT_RADIUS_M};
pub use joint::{SWITCH_HALF_WINDOW, nominal_travel_ms};
pub use supply::{BROWN_OUT_MV, Drain, FRESH_CONTROLLER_MV, HIGHEST_MV, LOW_MV, NOMINAL_MOTOR_MV};
pub use walking::{
    FOOT_SPACING_M, FREE_TILT, LEAN_MAX_RAD, STRIDE_M, TURN_SHARE, foot_offset_m, loaded_legs,
};

use rand::SeedableRng;
use rand_pcg::Pcg64;
use rsapien_protocol::{BumperMask, Joint};

use crate::geometry::RobotPose;
use crate::world::World;
use joint::{BodyJoint, Drive};
use supply::Supply;
use walking::Push;

/// The direction pins of the seven motors; bit `j` belongs to joint `j`. Both pins together brake.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MotorPins {
    /// Driven towards the first position.
    pub towards_first: u8,
    /// Driven towards the last position.
    pub towards_last: u8,
}

impl MotorPins {
    /// The motors that turn.
    pub const fn running(self) -> u8 {
        (self.towards_first ^ self.towards_last) & 0x7F
    }

    fn drive(self, index: usize) -> Drive {
        match ((self.towards_first >> index) & 1, (self.towards_last >> index) & 1) {
            (1, 0) => Drive::TowardsFirst,
            (0, 1) => Drive::TowardsLast,
            _ => Drive::Off,
        }
    }
}

/// How a body is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyConfig {
    /// How far true travel times lie from the nominal ones at most, as a fraction, 0 to 0.2.
    pub travel_deviation: f64,
    /// How fast the batteries drain.
    pub drain: Drain,
    /// Where it stands first.
    pub start: RobotPose,
}

impl Default for BodyConfig {
    /// 3 percent, default drain, at the world's origin.
    fn default() -> Self {
        Self { travel_deviation: 0.03, drain: Drain::default(), start: RobotPose::default() }
    }
}

/// Where the joints of a robot out of its box are: arms and hands hanging open, trunk and legs near the middle.
const AT_REST: [f64; Joint::COUNT] = [1.0, 1.0, 1.0, 1.0, 0.55, 0.45, 0.6];

/// The body. See the [module](self).
#[derive(Debug, Clone)]
pub struct Body {
    joints: [BodyJoint; Joint::COUNT],
    supply: Supply,
    pose: RobotPose,
    bumpers: [Contact; BumperMask::COUNT],
    /// Bumpers pressed by somebody from outside.
    held: u8,
    /// Bumpers pressed by the world.
    touching: BumperMask,
    /// Solid things are at least this far from the middle of the robot, metres.
    clearance_m: f64,
    /// Whether something moved since the bumpers were last compared with the world.
    disturbed: bool,
}

impl Body {
    /// A body that stands in `world`, with deviations drawn from `seed`.
    pub fn new(config: BodyConfig, seed: u64, world: &World) -> Self {
        let mut random = Pcg64::seed_from_u64(seed);
        let deviation = config.travel_deviation.clamp(0.0, 0.2);
        let joints = Joint::ALL.map(|joint| {
            let position = AT_REST[usize::from(joint.index())];
            BodyJoint::new(joint, position, deviation, &mut random)
        });
        let mut body = Self {
            joints,
            supply: Supply::new(config.drain),
            pose: config.start,
            bumpers: [Contact::Working; BumperMask::COUNT],
            held: 0,
            touching: BumperMask::NONE,
            clearance_m: 0.0,
            disturbed: true,
        };
        body.lean();
        body.feel(world);
        body
    }

    /// Moves everything by one ms with the motors driven by `pins`.
    pub fn step(&mut self, pins: MotorPins, world: &World) {
        let running = pins.running();
        self.supply.step(running.count_ones());
        if running != 0 {
            self.drive(pins, world);
        }
        if self.disturbed {
            self.feel(world);
        }
    }

    fn drive(&mut self, pins: MotorPins, world: &World) {
        let vigour = self.supply.vigour();
        let mut moved = [0.0; Joint::COUNT];
        for (index, (joint, moved)) in self.joints.iter_mut().zip(&mut moved).enumerate() {
            *moved = joint.step(pins.drive(index), vigour);
            self.disturbed |= *moved != 0.0;
        }
        if moved[usize::from(Joint::Tilt.index())] != 0.0 {
            self.lean();
        }
        let push = Push::of(&moved, self.position(Joint::Tilt));
        if push != Push::default() {
            self.clearance_m -= walking::walk(&mut self.pose, push, world);
        }
    }

    fn lean(&mut self) {
        self.pose.roll_rad = LEAN_MAX_RAD * (2.0 * self.position(Joint::Tilt) - 1.0);
    }

    /// Compares the bumpers with the world, where anything solid is near enough.
    fn feel(&mut self, world: &World) {
        self.disturbed = false;
        if self.clearance_m > contact::REACH_M {
            self.touching = BumperMask::NONE;
            return;
        }
        let middle = [self.pose.x_m, self.pose.y_m];
        let distances = world.solids().iter().map(|solid| solid.distance_m(middle));
        self.clearance_m = distances.fold(f64::INFINITY, f64::min);
        self.touching = if self.clearance_m > contact::REACH_M {
            BumperMask::NONE
        } else {
            contact::pressed_by_world(&self.pose, &self.positions(), world)
        };
    }

    /// Where a joint truly is, 0..=1.
    pub fn position(&self, joint: Joint) -> f64 {
        self.joints[usize::from(joint.index())].position()
    }

    /// Where every joint truly is, 0..=1, in the order of the joints.
    pub fn positions(&self) -> [f64; Joint::COUNT] {
        std::array::from_fn(|index| self.joints[index].position())
    }

    /// True full travel time of a joint at the nominal motor voltage, in ms.
    pub fn travel_ms(&self, joint: Joint) -> f64 {
        self.joints[usize::from(joint.index())].travel_ms()
    }

    /// Motors that ran against an end stop or a jam in the last ms, bit `j` = joint `j`.
    pub fn stalled(&self) -> u8 {
        let bits = self.joints.iter().rev();
        bits.fold(0, |bits, joint| bits << 1 | u8::from(joint.is_stalled()))
    }

    /// Whether the mid-arm switches are closed: left, right.
    pub fn middle_switches(&self) -> [bool; 2] {
        [Joint::LeftArm, Joint::RightArm]
            .map(|arm| self.joints[usize::from(arm.index())].is_switch_closed())
    }

    /// Bumpers whose contacts are closed.
    pub fn bumpers(&self) -> BumperMask {
        let pressed = self.held | self.touching.bits();
        let closed =
            |index: usize| u8::from(self.bumpers[index].apply(pressed >> index & 1 != 0)) << index;
        BumperMask::from_low_bits((0..BumperMask::COUNT).map(closed).sum())
    }

    /// Where the robot stands and how its trunk leans.
    pub fn pose(&self) -> RobotPose {
        self.pose
    }

    /// Voltage of the controllers' supply in mV.
    pub fn supply_mv(&self) -> u32 {
        self.supply.controller_mv()
    }

    /// Voltage of the motors' supply in mV.
    pub fn motor_supply_mv(&self) -> u32 {
        self.supply.motor_mv()
    }

    /// Sets the controllers' voltage in mV, at most [`HIGHEST_MV`].
    pub fn set_supply_mv(&mut self, millivolts: u32) {
        self.supply.set_controller_mv(millivolts);
    }

    /// Sets the motors' voltage in mV, at most [`HIGHEST_MV`]; motors turn in proportion to it.
    pub fn set_motor_supply_mv(&mut self, millivolts: u32) {
        self.supply.set_motor_mv(millivolts);
    }

    /// Sets how fast the batteries drain.
    pub fn set_drain(&mut self, drain: Drain) {
        self.supply.drain = drain;
    }

    /// Jams a joint, or frees it. The motor of a jammed joint runs and moves nothing.
    pub fn stick_joint(&mut self, joint: Joint, stuck: bool) {
        self.joints[usize::from(joint.index())].stuck = stuck;
    }

    /// Moves a joint by hand to a fraction of its travel, clamped to 0..=1. The feet do not push the body then.
    pub fn move_joint(&mut self, joint: Joint, position: f64) {
        if position.is_finite() {
            self.joints[usize::from(joint.index())].set_position(position);
            self.lean();
            self.disturbed = true;
        }
    }

    /// Breaks or repairs the mid-arm switch of an arm; other joints have none and are left alone.
    pub fn set_switch(&mut self, arm: Joint, contact: Contact) {
        self.joints[usize::from(arm.index())].switch = contact;
    }

    /// Presses or releases a bumper from outside; an index above 5 does nothing.
    pub fn press_bumper(&mut self, index: usize, held: bool) {
        if index < BumperMask::COUNT {
            let bit = 1 << index;
            self.held = if held { self.held | bit } else { self.held & !bit };
        }
    }

    /// Breaks or repairs a bumper; an index above 5 does nothing.
    pub fn set_bumper(&mut self, index: usize, contact: Contact) {
        if let Some(bumper) = self.bumpers.get_mut(index) {
            *bumper = contact;
        }
    }

    /// Lifts the robot and puts it down elsewhere. The lean stays what the trunk makes it.
    pub fn put_at(&mut self, x_m: f64, y_m: f64, heading_rad: f64) {
        self.pose = RobotPose { x_m, y_m, heading_rad, roll_rad: self.pose.roll_rad };
        self.clearance_m = 0.0;
        self.disturbed = true;
    }
}
