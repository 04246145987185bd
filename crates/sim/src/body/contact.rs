//! Bumpers and switches: what presses them, and how they break.

use rsapien_protocol::{BumperMask, Joint};
use serde::{Deserialize, Serialize};

use super::walking::{FOOT_SPACING_M, foot_offset_m};
use crate::geometry::RobotPose;
use crate::world::World;

/// Radius of the round footprint that solid things stop, in metres.
pub const FOOTPRINT_RADIUS_M: f64 = 0.125;
/// From the middle of a foot to its front or back bumper, in metres.
const FOOT_HALF_LENGTH_M: f64 = 0.09;
/// Height of the foot bumpers above the floor, in metres.
const FOOT_BUMPER_HEIGHT_M: f64 = 0.02;
/// Height of the shoulders above the floor, in metres.
const SHOULDER_HEIGHT_M: f64 = 0.22;
/// From the shoulder to the bumper on the front finger of the hand, in metres.
const ARM_LENGTH_M: f64 = 0.13;
/// Distance between the hands, in metres: the robot is 31 cm wide (paper, section 2).
const HAND_SPACING_M: f64 = 0.28;
/// A bumper is pressed by what is nearer than this to its middle, in metres.
const BUMPER_RADIUS_M: f64 = 0.015;
/// No bumper reaches farther than this from the robot's middle, in metres.
pub(super) const REACH_M: f64 = 0.25;

/// How an electric contact (a bumper or a mid-arm switch) behaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Contact {
    /// Closed when pressed.
    #[default]
    Working,
    /// Never closes.
    StuckOpen,
    /// Always closed.
    StuckClosed,
}

impl Contact {
    /// Whether the contact is closed when it is `pressed`.
    pub const fn apply(self, pressed: bool) -> bool {
        match self {
            Self::Working => pressed,
            Self::StuckOpen => false,
            Self::StuckClosed => true,
        }
    }
}

/// The bumpers that solid things press, for a robot at `pose` with its joints at `positions` (fractions of travel).
pub(super) fn pressed_by_world(
    pose: &RobotPose,
    positions: &[f64; Joint::COUNT],
    world: &World,
) -> BumperMask {
    let (sin, cos) = pose.heading_rad.sin_cos();
    let touches = |forward: f64, left: f64, height: f64| {
        let center =
            [pose.x_m + forward * cos - left * sin, pose.y_m + forward * sin + left * cos, height];
        world.first_contact(center, BUMPER_RADIUS_M).is_some()
    };
    let at = |joint: Joint| positions[usize::from(joint.index())];
    let foot = |leg: Joint, left: f64, end: f64| {
        touches(foot_offset_m(at(leg)) + end * FOOT_HALF_LENGTH_M, left, FOOT_BUMPER_HEIGHT_M)
    };
    let hand = |arm: Joint, left: f64| {
        // Up is a quarter turn above the front, down a quarter turn below.
        let (rise, reach) = (std::f64::consts::PI * (0.5 - at(arm))).sin_cos();
        touches(ARM_LENGTH_M * reach, left, SHOULDER_HEIGHT_M + ARM_LENGTH_M * rise)
    };
    let (foot_left, hand_left) = (0.5 * FOOT_SPACING_M, 0.5 * HAND_SPACING_M);
    let pressed = [
        foot(Joint::LeftLeg, foot_left, 1.0),
        foot(Joint::LeftLeg, foot_left, -1.0),
        foot(Joint::RightLeg, -foot_left, 1.0),
        foot(Joint::RightLeg, -foot_left, -1.0),
        hand(Joint::LeftArm, hand_left),
        hand(Joint::RightArm, -hand_left),
    ];
    let bits = pressed.iter().rev().fold(0, |bits, pressed| bits << 1 | u8::from(*pressed));
    BumperMask::from_low_bits(bits)
}
