//! The pinhole.

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

use super::CameraError;
use super::error::within;

/// Picture size and pinhole of a camera.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Intrinsics {
    /// Pixels across, 16 to 1920.
    pub width: u32,
    /// Pixels down, 16 to 1080.
    pub height: u32,
    /// Focal length in pixels along x, above zero.
    pub fx: f64,
    /// Focal length in pixels along y, above zero.
    pub fy: f64,
    /// Where the optical axis meets the picture, x.
    pub cx: f64,
    /// Where the optical axis meets the picture, y.
    pub cy: f64,
}

impl Default for Intrinsics {
    /// A webcam of 2006: 320x240 and 60 degrees across.
    fn default() -> Self {
        Self::from_size_and_view(320, 240, 60.0)
    }
}

impl Intrinsics {
    /// A camera with square pixels and its optical axis in the middle of the picture.
    ///
    /// # Errors
    /// [`CameraError::OutOfRange`] unless `width` is 16 to 1920, `height` 16 to 1080 and the horizontal field of view
    /// 5 to 140 degrees.
    pub fn with_field_of_view(
        width: u32,
        height: u32,
        horizontal_degrees: f64,
    ) -> Result<Self, CameraError> {
        within("the horizontal field of view (degrees)", horizontal_degrees, 5.0, 140.0)?;
        let intrinsics = Self::from_size_and_view(width, height, horizontal_degrees);
        intrinsics.check()?;
        Ok(intrinsics)
    }

    fn from_size_and_view(width: u32, height: u32, horizontal_degrees: f64) -> Self {
        let focal = 0.5 * f64::from(width) / (0.5 * horizontal_degrees).to_radians().tan();
        let (cx, cy) = (0.5 * (f64::from(width) - 1.0), 0.5 * (f64::from(height) - 1.0));
        Self { width, height, fx: focal, fy: focal, cx, cy }
    }

    pub(super) fn check(&self) -> Result<(), CameraError> {
        within("the picture's width (pixels)", f64::from(self.width), 16.0, 1920.0)?;
        within("the picture's height (pixels)", f64::from(self.height), 16.0, 1080.0)?;
        within("the focal length fx (pixels)", self.fx, 1.0, 100_000.0)?;
        within("the focal length fy (pixels)", self.fy, 1.0, 100_000.0)?;
        within("the principal point cx (pixels)", self.cx, -10_000.0, 10_000.0)?;
        within("the principal point cy (pixels)", self.cy, -10_000.0, 10_000.0)
    }

    /// The matrix K that takes camera coordinates to homogeneous picture coordinates.
    pub fn matrix(&self) -> Matrix3<f64> {
        Matrix3::new(self.fx, 0.0, self.cx, 0.0, self.fy, self.cy, 0.0, 0.0, 1.0)
    }

    /// The direction in camera axes, of depth z = 1, that is seen at the picture point (`x`, `y`).
    pub fn direction(&self, x: f64, y: f64) -> Vector3<f64> {
        Vector3::new((x - self.cx) / self.fx, (y - self.cy) / self.fy, 1.0)
    }

    /// The picture point (x, y) of a point in camera axes, or `None` for one that is not in front of the camera.
    pub fn project(&self, point: &Vector3<f64>) -> Option<(f64, f64)> {
        (point.z > 1e-9)
            .then(|| (self.fx * point.x / point.z + self.cx, self.fy * point.y / point.z + self.cy))
    }

    /// Whether the picture point (`x`, `y`) lies in the picture.
    pub fn contains(&self, x: f64, y: f64) -> bool {
        x >= -0.5
            && y >= -0.5
            && x < f64::from(self.width) - 0.5
            && y < f64::from(self.height) - 0.5
    }
}
