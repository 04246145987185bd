//! Dynamic walking (paper, section 2), as kinematics.
//!
//! The trunk swings left and right like a pendulum. Tilted to the left it puts the weight on the left leg, and the
//! right foot is free; tilted to the right the other way round; near the middle both feet stand. A leg that carries
//! weight keeps its foot where it is on the floor, so when it moves from front to back the body goes forward by as
//! much, and backward the other way. A free leg moves nothing but itself.
//!
//! The push of one foot also turns the body a little towards the other side, as a push beside the middle does, so a
//! symmetric gait goes straight, a gait on one leg goes in a circle, and legs that move against each other under
//! equal weight turn the robot on the spot: left leg to the front and right leg to the back turn it left.

use rsapien_protocol::Joint;

use super::contact::FOOTPRINT_RADIUS_M;
use crate::geometry::RobotPose;
use crate::world::World;

/// How far a foot moves along the body over the full travel of its leg, in metres.
pub const STRIDE_M: f64 = 0.060;
/// Distance between the middles of the feet, in metres.
pub const FOOT_SPACING_M: f64 = 0.16;
/// How much of the turn that rigid feet would enforce is left after the slipping of the soles.
pub const TURN_SHARE: f64 = 0.6;
/// Lean of the trunk at either end stop of the tilt, in radians (12 degrees).
pub const LEAN_MAX_RAD: f64 = 12.0 * std::f64::consts::PI / 180.0;
/// With the tilt below this fraction of travel the left leg alone carries the weight, above one minus it the right.
pub const FREE_TILT: f64 = 0.35;

/// Which legs carry weight at this fraction of the tilt's travel: left, right.
pub fn loaded_legs(tilt: f64) -> [bool; 2] {
    [tilt <= 1.0 - FREE_TILT, tilt >= FREE_TILT]
}

/// Where a foot stands along the body in metres, forward positive, for this fraction of its leg's travel.
pub fn foot_offset_m(leg: f64) -> f64 {
    STRIDE_M * (0.5 - leg)
}

/// How one ms moved the body over the floor.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Push {
    pub(super) forward_m: f64,
    pub(super) turn_rad: f64,
}

impl Push {
    /// The push of legs that moved by these fractions of full travel, in the order of the joints, at this tilt.
    pub(super) fn of(moved: &[f64; Joint::COUNT], tilt: f64) -> Self {
        let right = moved[usize::from(Joint::RightLeg.index())] * STRIDE_M;
        let left = moved[usize::from(Joint::LeftLeg.index())] * STRIDE_M;
        if left == 0.0 && right == 0.0 {
            return Self::default();
        }
        let (forward_m, left, right) = match loaded_legs(tilt) {
            [true, false] => (left, left, 0.0),
            [false, true] => (right, 0.0, right),
            _ => (0.5 * (left + right), left, right),
        };
        Self { forward_m, turn_rad: TURN_SHARE * (right - left) / FOOT_SPACING_M }
    }
}

/// Moves `pose` by `push` until something solid is in the way. Returns how far it went, in metres.
pub(super) fn walk(pose: &mut RobotPose, push: Push, world: &World) -> f64 {
    pose.heading_rad = wrapped(pose.heading_rad + push.turn_rad);
    let (sin, cos) = pose.heading_rad.sin_cos();
    let from_m = [pose.x_m, pose.y_m];
    let to_m = [pose.x_m + push.forward_m * cos, pose.y_m + push.forward_m * sin];
    let [x_m, y_m] = world.blocked_motion(from_m, to_m, FOOTPRINT_RADIUS_M).position_m;
    (pose.x_m, pose.y_m) = (x_m, y_m);
    (x_m - from_m[0]).hypot(y_m - from_m[1])
}

/// The same angle in -π..π.
fn wrapped(angle_rad: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    if angle_rad >= PI {
        angle_rad - TAU
    } else if angle_rad < -PI {
        angle_rad + TAU
    } else {
        angle_rad
    }
}
