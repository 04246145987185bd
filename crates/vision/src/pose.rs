//! From an ellipse back to space: where a circle or a ball of known radius stands that a camera sees as this ellipse.
//!
//! **Frame of the camera**: metres from the centre of projection, x to the right, y down, z forward, so that what is seen
//! has a positive z. **Pixels** as everywhere: the centre of the top left pixel is (0, 0). The camera is a pinhole; undo
//! the distortion of a lens first.
//!
//! An ellipse and the centre of projection span a cone. A plane cuts circles out of an elliptic cone in two directions,
//! so a circle has two poses that look alike (D. Forsyth et al., "Invariant descriptors for 3-D object recognition and
//! pose", IEEE PAMI 13, 1991; R. Safaee-Rad et al., "Three-dimensional location estimation of circular features for
//! machine vision", IEEE Trans. Robotics and Automation 8, 1992). A ball's cone is one of revolution and its position
//! unique.
//!
//! ```
//! use rsapien_vision::pose::{Intrinsics, ball_position, project_ball};
//!
//! // 640 x 480 pixels, 60 degrees wide.
//! let camera = Intrinsics::from_field_of_view(640, 480, 60_f64.to_radians())?;
//! // A tennis ball half a metre ahead, to the left and below.
//! let seen = project_ball([-0.1, 0.15, 0.5], 0.033, &camera).expect("it is in front of the camera");
//! let ball = ball_position(&seen, &camera, 0.033)?;
//! assert!((ball.center_m[2] - 0.5).abs() < 1e-6);
//! # Ok::<(), rsapien_vision::pose::PoseError>(())
//! ```

mod project;
#[cfg(test)]
mod tests;

use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use thiserror::Error;

use crate::ellipse::Ellipse;

pub use project::{project_ball, project_circle};

/// Least ratio of the eigenvalues of a cone: a half angle of a microradian. Below it they are lost in rounding.
const RATIO_MIN: f64 = 1e-12;

/// Why there is no pose.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum PoseError {
    /// The radius sets the scale of everything.
    #[error("the radius is {radius_m} m; give the true radius in metres, a positive number")]
    Radius {
        /// The radius given, in metres.
        radius_m: f64,
    },
    /// A field of the camera's intrinsics is not usable.
    #[error(
        "the camera's {field} is {value}, it must be {allowed}; take it from the camera's calibration"
    )]
    Intrinsics {
        /// Name of the field.
        field: &'static str,
        /// The value given.
        value: f64,
        /// What it must be, in words.
        allowed: &'static str,
    },
    /// A field of the ellipse is not usable.
    #[error("the ellipse's {field} is {value}, it must be {allowed}; leave this ellipse out")]
    Ellipse {
        /// Name of the field.
        field: &'static str,
        /// The value given.
        value: f64,
        /// What it must be, in words.
        allowed: &'static str,
    },
    /// The ellipse is a line or a point within the precision of the numbers.
    #[error(
        "the ellipse of {semi_major_px} by {semi_minor_px} px is too thin or too far away to tell a pose; leave this \
         ellipse out"
    )]
    Degenerate {
        /// Its semi-major axis in pixels.
        semi_major_px: f64,
        /// Its semi-minor axis in pixels.
        semi_minor_px: f64,
    },
}

/// A pinhole camera: (x, y, z) is seen at column `center_x_px + focal_x_px * x / z` and row
/// `center_y_px + focal_y_px * y / z`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Intrinsics {
    /// Focal length in widths of a pixel, positive.
    pub focal_x_px: f64,
    /// Focal length in heights of a pixel, positive.
    pub focal_y_px: f64,
    /// Column of the optical axis, pixels from the centre of the leftmost one.
    pub center_x_px: f64,
    /// Row of the optical axis, pixels down from the centre of the topmost one.
    pub center_y_px: f64,
}

impl Intrinsics {
    /// A camera with square pixels whose optical axis meets the middle of its picture. `width_px` and `height_px` are
    /// the picture's, `horizontal_rad` is the angle from its left to its right edge.
    ///
    /// # Errors
    /// The angle must lie between 0 and π.
    pub fn from_field_of_view(
        width_px: u32,
        height_px: u32,
        horizontal_rad: f64,
    ) -> Result<Self, PoseError> {
        if !(horizontal_rad > 0.0 && horizontal_rad < std::f64::consts::PI) {
            return Err(PoseError::Intrinsics {
                field: "horizontal field of view",
                value: horizontal_rad,
                allowed: "more than 0 and less than π radians",
            });
        }
        let (width, height) = (f64::from(width_px), f64::from(height_px));
        let focal_px = width / 2.0 / (horizontal_rad / 2.0).tan();
        let intrinsics = Self {
            focal_x_px: focal_px,
            focal_y_px: focal_px,
            center_x_px: (width - 1.0) / 2.0,
            center_y_px: (height - 1.0) / 2.0,
        };
        intrinsics.validate().map(|()| intrinsics)
    }

    /// Checks every field.
    ///
    /// # Errors
    /// The first field that is not finite, and a focal length that is not positive.
    pub fn validate(&self) -> Result<(), PoseError> {
        for (field, value) in [("focal_x_px", self.focal_x_px), ("focal_y_px", self.focal_y_px)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(PoseError::Intrinsics { field, value, allowed: "a positive number" });
            }
        }
        for (field, value) in [("center_x_px", self.center_x_px), ("center_y_px", self.center_y_px)]
        {
            if !value.is_finite() {
                return Err(PoseError::Intrinsics { field, value, allowed: "a number" });
            }
        }
        Ok(())
    }
}

/// Where a circle stands and where it faces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CirclePose {
    /// Its centre `[x, y, z]` in metres, in the frame of the camera. It is seen off the centre of the ellipse.
    pub center_m: [f64; 3],
    /// The unit normal of its plane, of the two the one on the camera's side.
    pub normal: [f64; 3],
}

/// Where a ball is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BallPosition {
    /// Its centre `[x, y, z]` in metres, in the frame of the camera.
    pub center_m: [f64; 3],
    /// How far the ellipse is from a ball's outline, in radians at the camera: what the half angle of its cone is off, at
    /// most, from that of the cone of revolution taken instead. A ball's is that of the noise.
    pub misfit_rad: f64,
}

/// The two poses of a circle of `radius_m` metres that is seen as `ellipse`. Both have the same distance and the same
/// angle between normal and line of sight, and only knowledge of the scene decides. The first is the one whose normal
/// points further up: that of a plate's or a cup's rim on a table seen from above. Of a circle that is looked at straight,
/// along its normal, both are the same; near that, the tilt is uncertain by about the square root of the relative error of
/// the ratio of the axes.
///
/// # Errors
/// What of the arguments is not usable; an ellipse so thin that its numbers do not tell.
pub fn circle_poses(
    ellipse: &Ellipse,
    intrinsics: &Intrinsics,
    radius_m: f64,
) -> Result<[CirclePose; 2], PoseError> {
    let cone = Cone::new(ellipse, intrinsics, radius_m)?;
    let [first, second, third] = cone.values;
    // In the cone's own frame the planes of circles hold the second axis and lean to either side of the third.
    let lean = ((first - second) / (first - third)).sqrt();
    let upright = ((second - third) / (first - third)).sqrt();
    let scale_m = radius_m / (-first * third).sqrt();
    let mut poses = [lean, -lean].map(|lean| {
        let normal = cone.axes[0] * lean + cone.axes[2] * upright;
        let center_m = (cone.axes[0] * (third * lean) + cone.axes[2] * (first * upright)) * scale_m;
        let center_m = if center_m.z < 0.0 { -center_m } else { center_m };
        let normal = if normal.dot(&center_m) > 0.0 { -normal } else { normal };
        CirclePose { center_m: center_m.into(), normal: normal.normalize().into() }
    });
    if poses.iter().any(|pose| pose.center_m.iter().chain(&pose.normal).any(|v| !v.is_finite())) {
        return Err(degenerate(ellipse));
    }
    if poses[1].normal[1] < poses[0].normal[1] {
        poses.swap(0, 1);
    }
    Ok(poses)
}

/// The position of a ball of `radius_m` metres whose outline is `ellipse`. The cone of an outline that is not quite a
/// ball's is replaced by the cone of revolution about the same axis whose half angle is the mean of its two: the nearest
/// by the angles at the camera.
///
/// # Errors
/// What of the arguments is not usable; an ellipse so thin that its numbers do not tell.
pub fn ball_position(
    ellipse: &Ellipse,
    intrinsics: &Intrinsics,
    radius_m: f64,
) -> Result<BallPosition, PoseError> {
    let cone = Cone::new(ellipse, intrinsics, radius_m)?;
    let [first, second, third] = cone.values;
    let (narrow_rad, wide_rad) = ((-third / first).sqrt().atan(), (-third / second).sqrt().atan());
    let distance_m = radius_m / f64::midpoint(narrow_rad, wide_rad).sin();
    let center_m = cone.axes[2] * (distance_m * cone.axes[2].z.signum());
    if !center_m.iter().all(|value| value.is_finite()) {
        return Err(degenerate(ellipse));
    }
    Ok(BallPosition { center_m: center_m.into(), misfit_rad: (wide_rad - narrow_rad) / 2.0 })
}

/// The cone through an ellipse from the centre of projection: the rays `r` with `rᵀ Q r = 0`, by the eigenvalues of `Q`
/// in falling order, of which two are positive and one negative, and its eigenvectors.
struct Cone {
    values: [f64; 3],
    axes: [Vector3<f64>; 3],
}

impl Cone {
    fn new(ellipse: &Ellipse, intrinsics: &Intrinsics, radius_m: f64) -> Result<Self, PoseError> {
        // The iteration ends after a handful of steps; the bound is for numbers nobody thought of.
        const STEPS_MAX: usize = 1000;
        if !(radius_m > 0.0 && radius_m.is_finite()) {
            return Err(PoseError::Radius { radius_m });
        }
        intrinsics.validate()?;
        check_ellipse(ellipse)?;
        let matrix = cone_matrix(ellipse, intrinsics);
        if !matrix.iter().all(|value| value.is_finite()) {
            return Err(degenerate(ellipse));
        }
        let eigen = SymmetricEigen::try_new(matrix, f64::EPSILON, STEPS_MAX)
            .ok_or_else(|| degenerate(ellipse))?;
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        let values = order.map(|index| eigen.eigenvalues[index]);
        let least = RATIO_MIN * values[0];
        if !(values[1] > least && -values[2] > least) {
            return Err(degenerate(ellipse));
        }
        Ok(Self { values, axes: order.map(|index| eigen.eigenvectors.column(index).into_owned()) })
    }
}

/// `Q` of the cone in the frame of the camera, scaled by whatever keeps its numbers near 1.
fn cone_matrix(ellipse: &Ellipse, intrinsics: &Intrinsics) -> Matrix3<f64> {
    let (fx, fy) = (intrinsics.focal_x_px, intrinsics.focal_y_px);
    let x = (ellipse.center_x_px - intrinsics.center_x_px) / fx;
    let y = (ellipse.center_y_px - intrinsics.center_y_px) / fy;
    // The axes as vectors on the plane at z = 1: the contour is where (p - c)ᵀ S⁻¹ (p - c) = 1 with S their products.
    let (sin, cos) = ellipse.theta_rad.sin_cos();
    let major = (ellipse.semi_major_px * cos / fx, ellipse.semi_major_px * sin / fy);
    let minor = (-ellipse.semi_minor_px * sin / fx, ellipse.semi_minor_px * cos / fy);
    let xx = major.0 * major.0 + minor.0 * minor.0;
    let xy = major.0 * major.1 + minor.0 * minor.1;
    let yy = major.1 * major.1 + minor.1 * minor.1;
    let trace = xx + yy;
    let determinant = (major.0 * minor.1 - major.1 * minor.0).powi(2) / trace;
    // S⁻¹ times the determinant and over the trace.
    let (ixx, ixy, iyy) = (yy / trace, -xy / trace, xx / trace);
    let (dx, dy) = (ixx * x + ixy * y, ixy * x + iyy * y);
    Matrix3::new(ixx, ixy, -dx, ixy, iyy, -dy, -dx, -dy, x * dx + y * dy - determinant)
}

fn check_ellipse(ellipse: &Ellipse) -> Result<(), PoseError> {
    let axes = [("semi_major_px", ellipse.semi_major_px), ("semi_minor_px", ellipse.semi_minor_px)];
    for (field, value) in axes {
        if !(value > 0.0 && value.is_finite()) {
            return Err(PoseError::Ellipse { field, value, allowed: "a positive number" });
        }
    }
    let others = [
        ("center_x_px", ellipse.center_x_px),
        ("center_y_px", ellipse.center_y_px),
        ("theta_rad", ellipse.theta_rad),
    ];
    for (field, value) in others {
        if !value.is_finite() {
            return Err(PoseError::Ellipse { field, value, allowed: "a number" });
        }
    }
    Ok(())
}

fn degenerate(ellipse: &Ellipse) -> PoseError {
    PoseError::Degenerate {
        semi_major_px: ellipse.semi_major_px,
        semi_minor_px: ellipse.semi_minor_px,
    }
}
