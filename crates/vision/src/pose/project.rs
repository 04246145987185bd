//! What a camera sees of a circle and of a ball.

use nalgebra::{Matrix3, Vector3};

use super::{CirclePose, Intrinsics};
use crate::ellipse::Ellipse;

/// The ellipse that a circle of `radius_m` metres is seen as, in canonical form. `None` where it is none: the circle is
/// not in front of the camera with all of itself, the camera is in its plane, or an argument is not usable.
pub fn project_circle(
    pose: &CirclePose,
    radius_m: f64,
    intrinsics: &Intrinsics,
) -> Option<Ellipse> {
    let normal = Vector3::from(pose.normal).try_normalize(f64::MIN_POSITIVE)?;
    let disc = (Matrix3::identity() - normal * normal.transpose()) * radius_m.powi(2);
    project(&disc, pose.center_m, radius_m, intrinsics)
}

/// The ellipse that is the outline of a ball of `radius_m` metres, in canonical form. `center_m` is `[x, y, z]` in the
/// frame of the camera. `None` where it is none: the ball is not in front of the camera with all of itself, or an argument
/// is not usable.
pub fn project_ball(center_m: [f64; 3], radius_m: f64, intrinsics: &Intrinsics) -> Option<Ellipse> {
    project(&(Matrix3::identity() * radius_m.powi(2)), center_m, radius_m, intrinsics)
}

/// Of a flat or solid body around a centre, whose tangent planes `n` through the centre of projection are those with
/// `nᵀ (body - center centerᵀ) n = 0` (the dual conic: R. Hartley and A. Zisserman, "Multiple View Geometry", 2004,
/// sections 2.2.3 and 8.3). On the plane at z = 1 the same matrix holds the ellipse's centre and the products of its axes.
fn project(
    body: &Matrix3<f64>,
    center_m: [f64; 3],
    radius_m: f64,
    intrinsics: &Intrinsics,
) -> Option<Ellipse> {
    let center = Vector3::from(center_m);
    if intrinsics.validate().is_err() || !(radius_m > 0.0 && center.z > 0.0) {
        return None;
    }
    let dual = body - center * center.transpose();
    let depth = -dual[(2, 2)];
    if !(depth > 0.0 && depth.is_finite()) {
        return None;
    }
    let (x, y) = (-dual[(0, 2)] / depth, -dual[(1, 2)] / depth);
    let (fx, fy) = (intrinsics.focal_x_px, intrinsics.focal_y_px);
    let xx = (dual[(0, 0)] / depth + x * x) * fx * fx;
    let xy = (dual[(0, 1)] / depth + x * y) * fx * fy;
    let yy = (dual[(1, 1)] / depth + y * y) * fy * fy;
    let (mean, difference) = (f64::midpoint(xx, yy), ((xx - yy) / 2.0).hypot(xy));
    let ellipse = Ellipse {
        center_x_px: intrinsics.center_x_px + fx * x,
        center_y_px: intrinsics.center_y_px + fy * y,
        semi_major_px: (mean + difference).sqrt(),
        // The product of the axes is better known than a small difference.
        semi_minor_px: ((xx * yy - xy * xy) / (mean + difference)).sqrt(),
        theta_rad: (2.0 * xy).atan2(xx - yy) / 2.0,
    };
    (ellipse.semi_minor_px > 0.0 && ellipse.semi_major_px.is_finite()).then(|| ellipse.canonical())
}
