//! The ellipse and its conventions, shared by every stage.
//!
//! Coordinates are pixels with the centre of the top left pixel at (0, 0), x to the right and y **down**. Angles are
//! radians from +x towards +y, so a positive angle turns clockwise as seen on a screen.

use std::f64::consts::{PI, TAU};

mod overlap;

/// An ellipse by centre, semi-axes and angle: the five values of the paper's feature vector (9).
///
/// The paper's tables say "major axis" and "minor axis" where they print semi-axes; here the word is always spelled out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipse {
    /// Centre, pixels from the centre of the leftmost pixel column (equation 3).
    pub center_x_px: f64,
    /// Centre, pixels down from the centre of the topmost pixel row (equation 4).
    pub center_y_px: f64,
    /// Half of the major axis in pixels (equation 5).
    pub semi_major_px: f64,
    /// Half of the minor axis in pixels (equation 7).
    pub semi_minor_px: f64,
    /// Angle of the major axis from +x towards +y, radians; `[0, π)` in canonical form.
    pub theta_rad: f64,
}

impl Ellipse {
    /// The same ellipse with `semi_major_px >= semi_minor_px` and `theta_rad` in `[0, π)`.
    #[must_use]
    pub fn canonical(self) -> Self {
        let (major, minor, theta) = if self.semi_minor_px > self.semi_major_px {
            (self.semi_minor_px, self.semi_major_px, self.theta_rad + PI / 2.0)
        } else {
            (self.semi_major_px, self.semi_minor_px, self.theta_rad)
        };
        let wrapped = theta.rem_euclid(PI);
        Self {
            semi_major_px: major,
            semi_minor_px: minor,
            // A tiny negative angle is rounded up to π itself, and the sum makes of -0 a 0.
            theta_rad: if wrapped >= PI { 0.0 } else { wrapped + 0.0 },
            ..self
        }
    }

    /// The point of the contour at parameter `t_rad` (0 and π are the ends of the major axis), as `(x, y)` in pixels.
    pub fn point_at(&self, t_rad: f64) -> (f64, f64) {
        let (along, across) = (self.semi_major_px * t_rad.cos(), self.semi_minor_px * t_rad.sin());
        let (sin, cos) = self.theta_rad.sin_cos();
        (
            self.center_x_px + along * cos - across * sin,
            self.center_y_px + along * sin + across * cos,
        )
    }

    /// The same ellipse, told from a picture whose part it was found in: `origin` is where that part begins.
    pub(crate) fn shifted(self, origin: (usize, usize)) -> Self {
        Self {
            center_x_px: self.center_x_px + origin.0 as f64,
            center_y_px: self.center_y_px + origin.1 as f64,
            ..self
        }
    }

    /// The offset of (`x_px`, `y_px`) from the centre, along the major axis and across it, in pixels.
    fn local(&self, x_px: f64, y_px: f64) -> (f64, f64) {
        let (sin, cos) = self.theta_rad.sin_cos();
        let (dx, dy) = (x_px - self.center_x_px, y_px - self.center_y_px);
        (dx * cos + dy * sin, dy * cos - dx * sin)
    }

    /// Whether (`x_px`, `y_px`) lies inside or on the contour. An ellipse without extent contains nothing.
    pub fn contains(&self, x_px: f64, y_px: f64) -> bool {
        let (u, v) = self.local(x_px, y_px);
        (u / self.semi_major_px).powi(2) + (v / self.semi_minor_px).powi(2) <= 1.0
    }

    /// Approximate distance in pixels from (`x_px`, `y_px`) to the contour: negative inside, exact to first order near
    /// the contour (the implicit equation divided by the length of its gradient).
    pub fn distance_px(&self, x_px: f64, y_px: f64) -> f64 {
        let (u, v) = self.local(x_px, y_px);
        let (p, q) = (u / self.semi_major_px, v / self.semi_minor_px);
        let radius = p.hypot(q);
        let gradient = (p / self.semi_major_px).hypot(q / self.semi_minor_px);
        if gradient == 0.0 { -self.semi_minor_px } else { radius * (radius - 1.0) / gradient }
    }

    /// Area in square pixels.
    pub fn area_px2(&self) -> f64 {
        PI * self.semi_major_px * self.semi_minor_px
    }

    /// Length of the contour in pixels, by Ramanujan's first approximation (relative error below 0.5 %).
    pub fn perimeter_px(&self) -> f64 {
        let (a, b) = (self.semi_major_px, self.semi_minor_px);
        PI * (3.0 * (a + b) - ((3.0 * a + b) * (a + 3.0 * b)).sqrt())
    }

    /// Half width and half height of the upright bounding box, in pixels.
    pub fn half_extent_px(&self) -> (f64, f64) {
        let (sin, cos) = self.theta_rad.sin_cos();
        (
            (self.semi_major_px * cos).hypot(self.semi_minor_px * sin),
            (self.semi_major_px * sin).hypot(self.semi_minor_px * cos),
        )
    }

    /// The number that the paper's equation (6) gives, taken literally: the tangent of the slope of the major axis,
    /// which its Table 2 lists under "Alfa (rad)". For small angles it is close to [`theta_rad`](Self::theta_rad);
    /// `None` where the axis is vertical and the slope infinite.
    pub fn paper_alpha(&self) -> Option<f64> {
        let (sin, cos) = self.theta_rad.sin_cos();
        (cos.abs() > 1e-9).then(|| (sin / cos).tan())
    }

    /// Area of the intersection over area of the union, by the radii of both contours around this one's centre at 32
    /// angles; 0 when the centre lies outside the other ellipse, where the overlap is below one half or so.
    pub(crate) fn overlap_star(&self, other: &Self) -> f64 {
        let (u, v) = other.local(self.center_x_px, self.center_y_px);
        let (a2, b2) = (other.semi_major_px.powi(2), other.semi_minor_px.powi(2));
        let level = u * u / a2 + v * v / b2 - 1.0;
        if level >= 0.0 {
            return 0.0;
        }
        let (sin, cos) = axis_difference_rad(other.theta_rad, self.theta_rad).sin_cos();
        let (mut both, mut either) = (0.0, 0.0);
        for i in 0..32 {
            let (across, along) = (TAU * f64::from(i) / 32.0).sin_cos();
            // At equal steps of the parameter of this ellipse, scaled to the unit circle, areas are sums of squares.
            let (x, y) = (along * self.semi_major_px, across * self.semi_minor_px);
            let (du, dv) = (x * cos - y * sin, x * sin + y * cos);
            let quadratic = du * du / a2 + dv * dv / b2;
            let half = u * du / a2 + v * dv / b2;
            let reach = ((half * half - quadratic * level).sqrt() - half) / quadratic;
            both += reach.min(1.0).powi(2);
            either += reach.max(1.0).powi(2);
        }
        both / either
    }

    /// `count` points of the contour at equal steps of the parameter, as `(x, y)` in pixels, starting at an end of the
    /// major axis.
    pub fn outline(&self, count: u32) -> impl Iterator<Item = (f64, f64)> + '_ {
        (0..count).map(move |i| self.point_at(TAU * f64::from(i) / f64::from(count)))
    }
}

/// The smallest angle between two axes (lines without direction), radians in `(-π/2, π/2]`: `to - from` modulo π.
pub(crate) fn axis_difference_rad(from_rad: f64, to_rad: f64) -> f64 {
    let turn = (to_rad - from_rad).rem_euclid(PI);
    if turn > PI / 2.0 { turn - PI } else { turn }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SAMPLE: Ellipse = Ellipse {
        center_x_px: 235.5,
        center_y_px: 164.5,
        semi_major_px: 60.0,
        semi_minor_px: 37.0,
        theta_rad: 0.253,
    };

    #[test]
    fn the_angle_turns_from_x_towards_y_which_is_down() {
        let quarter = Ellipse { theta_rad: PI / 2.0, ..SAMPLE };
        let (x, y) = quarter.point_at(0.0);
        assert!((x - 235.5).abs() < 1e-9 && (y - 224.5).abs() < 1e-9, "{x} {y}");
    }

    #[test]
    fn canonical_swaps_the_axes_and_wraps_the_angle() {
        let swapped =
            Ellipse { semi_major_px: 37.0, semi_minor_px: 60.0, theta_rad: -1.0, ..SAMPLE }
                .canonical();
        assert!(
            (swapped.semi_major_px - 60.0).abs() < 1e-12
                && (swapped.semi_minor_px - 37.0).abs() < 1e-12
        );
        assert!((swapped.theta_rad - (PI / 2.0 - 1.0)).abs() < 1e-12);
        assert!(Ellipse { theta_rad: -1e-18, ..SAMPLE }.canonical().theta_rad < PI);
    }

    #[test]
    fn paper_alpha_is_the_tangent_of_the_slope() {
        let slope = 0.25_f64;
        let alpha = Ellipse { theta_rad: slope.atan(), ..SAMPLE }.paper_alpha();
        assert!((alpha.unwrap() - 0.255_341_92).abs() < 1e-8, "{alpha:?}");
        assert_eq!(Ellipse { theta_rad: PI / 2.0, ..SAMPLE }.paper_alpha(), None);
    }

    #[test]
    fn overlap_of_a_circle_with_one_of_half_the_radius_is_a_quarter() {
        let outer = Ellipse { semi_major_px: 40.0, semi_minor_px: 40.0, ..SAMPLE };
        let inner = Ellipse { semi_major_px: 20.0, semi_minor_px: 20.0, ..SAMPLE };
        assert!((outer.overlap(&inner) - 0.25).abs() < 0.005);
        assert!((outer.overlap(&outer) - 1.0).abs() < 1e-12);
        assert!(outer.overlap(&Ellipse { center_x_px: 900.0, ..outer }) < 1e-12);
    }

    proptest! {
        #[test]
        fn contour_points_are_at_distance_zero_and_scaled_ones_on_their_side(
            theta in 0.0..PI, t in 0.0..TAU, minor in 5.0..60.0_f64,
        ) {
            let ellipse = Ellipse { semi_minor_px: minor, theta_rad: theta, ..SAMPLE };
            let (x, y) = ellipse.point_at(t);
            prop_assert!(ellipse.distance_px(x, y).abs() < 1e-9);
            let towards = |scale: f64| {
                (235.5 + (x - 235.5) * scale, 164.5 + (y - 164.5) * scale)
            };
            let (inside, outside) = (towards(0.98), towards(1.02));
            prop_assert!(ellipse.contains(inside.0, inside.1) && ellipse.distance_px(inside.0, inside.1) < 0.0);
            prop_assert!(!ellipse.contains(outside.0, outside.1) && ellipse.distance_px(outside.0, outside.1) > 0.0);
        }

        #[test]
        fn axis_difference_ignores_half_turns(from in -7.0..7.0_f64, difference in -1.5..1.5_f64, turns in -3_i32..3) {
            let to = from + difference + PI * f64::from(turns);
            prop_assert!((axis_difference_rad(from, to) - difference).abs() < 1e-9);
        }
    }
}
