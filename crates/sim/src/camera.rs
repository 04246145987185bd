//! The camera on the robot's pan/tilt head: what it sees, and the exact truth about it.
//!
//! # Coordinates
//! Picture coordinates: x to the right, y down, pixel centres at integers, so the picture covers -0.5 to
//! `width` - 0.5. Camera axes: x right, y down, z along the optical axis. The lens is a pinhole without distortion.
//! World axes are told in [`crate::world`]. Pan to the right and tilt up are positive, in hundredths of a degree.
//!
//! # One picture
//! [`CameraPose::on_robot`] places the camera, [`Camera::render`] casts a ray through every pixel (several where the
//! pixel lies on a contour), blurs and adds noise; [`ground_truth`] tells every ellipse in the same picture by
//! projecting it exactly. A picture depends on the world, the pose, the settings and the frame number alone, not on
//! the number of threads.

mod error;
mod intrinsics;
mod noise;
mod pose;
mod render;
mod scene;
mod shade;
mod shadow;
mod shape;
#[cfg(test)]
mod tests;
mod texture;
mod truth;

pub use error::CameraError;
pub use intrinsics::Intrinsics;
pub use pose::{CameraPose, HEAD_HEIGHT_M, HeadAngles, TRUNK_PIVOT_HEIGHT_M};
pub use render::{Camera, CameraSettings, Picture};
pub use truth::{ContourKind, VisibleEllipse, ground_truth};
