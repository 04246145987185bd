//! Where the camera is, where it looks, and how to make it look at something.

use nalgebra::{Matrix3, Rotation3, Vector3};
use serde::{Deserialize, Serialize};

use super::{CameraError, Intrinsics};
use crate::geometry::RobotPose;

/// Height in metres of the point in which the pan axis, the tilt axis and the lens meet, on an upright robot (which
/// is 0.34 m high, paper section 2).
pub const HEAD_HEIGHT_M: f64 = 0.30;

/// Height in metres of the hip axis about which the trunk leans left and right.
pub const TRUNK_PIVOT_HEIGHT_M: f64 = 0.10;

/// Farthest pan to either side, in hundredths of a degree.
const PAN_LIMIT_CENTIDEG: i16 = 9_000;
/// Farthest tilt up or down, in hundredths of a degree.
const TILT_LIMIT_CENTIDEG: i16 = 4_500;

/// Where the head points, as the link tells it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeadAngles {
    /// Pan in 0.01 degree, right positive, -9000 to 9000 within the head's reach.
    pub pan_centideg: i16,
    /// Tilt in 0.01 degree, up positive, -4500 to 4500 within the head's reach.
    pub tilt_centideg: i16,
}

impl HeadAngles {
    /// Rounds angles in radians to the head's hundredths of a degree.
    ///
    /// # Errors
    /// [`CameraError::OutOfReach`] where either is beyond the head's reach or not finite.
    pub fn from_radians(pan_rad: f64, tilt_rad: f64) -> Result<Self, CameraError> {
        let round = |angle_rad: f64, limit: i16| -> Option<i16> {
            let centideg = (angle_rad.to_degrees() * 100.0).round();
            // Within the limit the value is a small whole number, so the cast is exact.
            #[allow(clippy::cast_possible_truncation)]
            (centideg.abs() <= f64::from(limit)).then_some(centideg as i16)
        };
        match (round(pan_rad, PAN_LIMIT_CENTIDEG), round(tilt_rad, TILT_LIMIT_CENTIDEG)) {
            (Some(pan_centideg), Some(tilt_centideg)) => Ok(Self { pan_centideg, tilt_centideg }),
            _ => Err(CameraError::OutOfReach {
                pan_degrees: pan_rad.to_degrees(),
                tilt_degrees: tilt_rad.to_degrees(),
            }),
        }
    }

    /// The angles that point the optical axis along `direction` (trunk axes: x forward, y left, z up; any length).
    fn towards(direction: &Vector3<f64>) -> Result<Self, CameraError> {
        Self::from_radians(
            (-direction.y).atan2(direction.x),
            direction.z.atan2(direction.x.hypot(direction.y)),
        )
    }

    /// The angles that bring to the picture's middle what is now seen at the picture point (`x`, `y`).
    ///
    /// Exact while the robot stands still, since both axes of the head pass through the lens.
    ///
    /// # Errors
    /// [`CameraError::OutOfReach`] where the head cannot turn that far.
    pub fn centering(self, intrinsics: &Intrinsics, x: f64, y: f64) -> Result<Self, CameraError> {
        Self::towards(&(self.camera_to_trunk() * intrinsics.direction(x, y)))
    }

    /// The angles that centre a world point (metres) for a robot standing at `robot`.
    ///
    /// # Errors
    /// [`CameraError::OutOfReach`] where the head cannot turn that far.
    pub fn aim_at(robot: &RobotPose, point_m: [f64; 3]) -> Result<Self, CameraError> {
        let from_lens = Vector3::from(point_m) - lens_position(robot);
        Self::towards(&(trunk_to_world(robot).inverse() * from_lens))
    }

    /// Rotation from camera axes (right, down, forward) to trunk axes (forward, left, up).
    fn camera_to_trunk(self) -> Rotation3<f64> {
        let (pan_sin, pan_cos) = (f64::from(self.pan_centideg) / 100.0).to_radians().sin_cos();
        let (tilt_sin, tilt_cos) = (f64::from(self.tilt_centideg) / 100.0).to_radians().sin_cos();
        let right = Vector3::new(-pan_sin, -pan_cos, 0.0);
        let forward = Vector3::new(tilt_cos * pan_cos, -tilt_cos * pan_sin, tilt_sin);
        let down = forward.cross(&right);
        Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[right, down, forward]))
    }
}

fn trunk_to_world(robot: &RobotPose) -> Rotation3<f64> {
    let heading = Rotation3::from_axis_angle(&Vector3::z_axis(), robot.heading_rad);
    heading * Rotation3::from_axis_angle(&Vector3::x_axis(), robot.roll_rad)
}

fn lens_position(robot: &RobotPose) -> Vector3<f64> {
    let hip = Vector3::new(robot.x_m, robot.y_m, TRUNK_PIVOT_HEIGHT_M);
    hip + trunk_to_world(robot) * Vector3::new(0.0, 0.0, HEAD_HEIGHT_M - TRUNK_PIVOT_HEIGHT_M)
}

/// Place and direction of the camera in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraPose {
    /// The lens, in world axes, metres.
    pub position: Vector3<f64>,
    /// Rotation from camera axes (x right, y down, z forward) to world axes.
    pub rotation: Rotation3<f64>,
}

impl CameraPose {
    /// The camera of a robot that stands at `robot` with its head at `head`.
    pub fn on_robot(robot: &RobotPose, head: HeadAngles) -> Self {
        Self {
            position: lens_position(robot),
            rotation: trunk_to_world(robot) * head.camera_to_trunk(),
        }
    }

    /// A world point (metres) in camera axes.
    pub fn to_camera(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.inverse() * (point - self.position)
    }
}
