//! Ellipses, their dual conics, and the robot's place on the floor.
//!
//! The dual conic of a curve is the symmetric 3x3 matrix `D` with `lᵀ D l = 0` for every tangent line `l`. Spheres
//! and 3-D circles both project to a dual conic by products alone, without inverting anything (Hartley and Zisserman,
//! *Multiple View Geometry*, 2nd edition, sections 2.2.3 and 8.3), which is why the ground truth uses it.

use nalgebra::Matrix3;
use serde::{Deserialize, Serialize};

/// Where the robot stands and how its trunk leans.
///
/// The point (`x_m`, `y_m`) lies on the floor midway between the feet.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotPose {
    /// Metres forward of the start.
    pub x_m: f64,
    /// Metres to the left of the start.
    pub y_m: f64,
    /// Direction the robot faces in radians, counter-clockwise seen from above; 0 faces along +x.
    pub heading_rad: f64,
    /// Lean of the trunk in radians about the robot's forward axis; positive leans to the robot's right.
    #[serde(default)]
    pub roll_rad: f64,
}

/// An ellipse in picture coordinates (x right, y down, pixel centres at integers).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Ellipse {
    /// Centre, pixels from the left.
    pub center_x: f64,
    /// Centre, pixels from the top.
    pub center_y: f64,
    /// Major semi-axis in pixels, at least `semi_minor`.
    pub semi_major: f64,
    /// Minor semi-axis in pixels, above zero.
    pub semi_minor: f64,
    /// Direction of the major axis in radians from +x towards +y, in (-π/2, π/2].
    pub theta: f64,
}

/// A projection thinner than this (pixels) is a line to any camera and no ellipse.
const THINNEST_SEMI_AXIS_PX: f64 = 1e-3;

impl Ellipse {
    /// The ellipse whose dual conic is `dual`, up to any non-zero factor.
    ///
    /// `None` where the conic is a hyperbola, a parabola, empty, not finite, or so thin that it is a line.
    pub fn from_dual_conic(dual: &Matrix3<f64>) -> Option<Self> {
        let scale = dual[(2, 2)];
        let normal = dual / scale;
        let (center_x, center_y) = (normal[(0, 2)], normal[(1, 2)]);
        // The squared distance of the tangents from the centre is nᵀ S n for a unit normal n, so the
        // eigenvalues of S are the squared semi-axes.
        let along_x = center_x * center_x - normal[(0, 0)];
        let along_y = center_y * center_y - normal[(1, 1)];
        let mixed = center_x * center_y - normal[(0, 1)];
        let mean = 0.5 * (along_x + along_y);
        let spread = (0.5 * (along_x - along_y)).hypot(mixed);
        let semi_minor = (mean - spread).sqrt();
        let semi_major = (mean + spread).sqrt();
        let usable = semi_minor > THINNEST_SEMI_AXIS_PX
            && semi_major.is_finite()
            && center_x.is_finite()
            && center_y.is_finite();
        usable.then(|| Self {
            center_x,
            center_y,
            semi_major,
            semi_minor,
            theta: 0.5 * (2.0 * mixed).atan2(along_x - along_y),
        })
    }

    /// The dual conic of this ellipse, scaled so that its last element is 1.
    pub fn dual_conic(&self) -> Matrix3<f64> {
        let (sin, cos) = self.theta.sin_cos();
        let (major, minor) = (self.semi_major.powi(2), self.semi_minor.powi(2));
        let (x, y) = (self.center_x, self.center_y);
        let along_x = major * cos * cos + minor * sin * sin;
        let along_y = major * sin * sin + minor * cos * cos;
        let mixed = (major - minor) * sin * cos;
        Matrix3::new(
            x * x - along_x,
            x * y - mixed,
            x,
            x * y - mixed,
            y * y - along_y,
            y,
            x,
            y,
            1.0,
        )
    }

    /// The contour point (x, y) at the eccentric angle `angle_rad`, counted from the major axis towards +y.
    pub fn point_at(&self, angle_rad: f64) -> (f64, f64) {
        let (sin, cos) = self.theta.sin_cos();
        let (along, across) =
            (self.semi_major * angle_rad.cos(), self.semi_minor * angle_rad.sin());
        (self.center_x + along * cos - across * sin, self.center_y + along * sin + across * cos)
    }

    /// The unit normal pointing outward at the eccentric angle `angle_rad`.
    pub fn normal_at(&self, angle_rad: f64) -> (f64, f64) {
        let (sin, cos) = self.theta.sin_cos();
        let (along, across) =
            (self.semi_minor * angle_rad.cos(), self.semi_major * angle_rad.sin());
        let length = along.hypot(across);
        ((along * cos - across * sin) / length, (along * sin + across * cos) / length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, TAU};

    proptest! {
        #[test]
        fn an_ellipse_survives_the_way_through_its_dual_conic(
            center_x in -500.0..500.0f64, center_y in -500.0..500.0f64, semi_minor in 1.0..200.0f64,
            elongation in 1.01..5.0f64, theta in -1.57..1.57f64, factor in prop_oneof![-9.0..-0.1f64, 0.1..9.0f64],
        ) {
            let ellipse = Ellipse { center_x, center_y, semi_major: semi_minor * elongation, semi_minor, theta };
            let back = Ellipse::from_dual_conic(&(ellipse.dual_conic() * factor)).expect("an ellipse");
            prop_assert!((back.center_x - center_x).abs() < 1e-6 && (back.center_y - center_y).abs() < 1e-6);
            prop_assert!((back.semi_major - ellipse.semi_major).abs() < 1e-5, "{back:?}");
            prop_assert!((back.semi_minor - semi_minor).abs() < 1e-5, "{back:?}");
            // Directions are equal modulo half a turn.
            prop_assert!((back.theta - theta).sin().abs() < 1e-6, "{} for {theta}", back.theta);
        }

        #[test]
        fn tangents_at_contour_points_satisfy_the_dual_conic(
            semi_minor in 1.0..200.0f64, elongation in 1.0..5.0f64, theta in -1.57..1.57f64, angle in 0.0..TAU,
        ) {
            let ellipse = Ellipse { center_x: 30.0, center_y: -20.0, semi_major: semi_minor * elongation, semi_minor, theta };
            let ((x, y), (normal_x, normal_y)) = (ellipse.point_at(angle), ellipse.normal_at(angle));
            let tangent = nalgebra::Vector3::new(normal_x, normal_y, -(normal_x * x + normal_y * y));
            let residual = (tangent.transpose() * ellipse.dual_conic() * tangent)[0];
            prop_assert!(residual.abs() < 1e-9 * (1.0 + ellipse.semi_major.powi(2)) * 100.0, "{residual}");
        }
    }

    #[test]
    fn a_hyperbola_and_a_line_are_no_ellipse() {
        assert_eq!(
            Ellipse::from_dual_conic(&Matrix3::from_diagonal(&nalgebra::Vector3::new(
                4.0, -1.0, 1.0
            ))),
            None
        );
        assert_eq!(
            Ellipse::from_dual_conic(&Matrix3::from_diagonal(&nalgebra::Vector3::new(
                -4.0, 0.0, 1.0
            ))),
            None
        );
        assert_eq!(Ellipse::from_dual_conic(&Matrix3::zeros()), None);
    }

    #[test]
    fn the_major_axis_of_a_standing_ellipse_points_down() {
        let standing = Matrix3::from_diagonal(&nalgebra::Vector3::new(-4.0, -9.0, 1.0));
        let ellipse = Ellipse::from_dual_conic(&standing).expect("an ellipse");
        assert!(
            (ellipse.semi_major - 3.0).abs() < 1e-12 && (ellipse.semi_minor - 2.0).abs() < 1e-12
        );
        assert!((ellipse.theta - FRAC_PI_2).abs() < 1e-12);
    }
}
