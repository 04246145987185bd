//! How certain an ellipse is: the covariance of its parameters from the distances of its support points.

use nalgebra::{Matrix5, Vector5};

use crate::edges::EdgePoint;
use crate::ellipse::Ellipse;
use crate::shape::Shape;

/// Variance of an angle of which nothing is known, in square radians: that of the uniform one, π² / 12.
const ANGLE_VARIANCE: f64 = std::f64::consts::PI * std::f64::consts::PI / 12.0;
/// Length along a contour over which the errors of edge points go together, in pixels: the sum of the autocorrelation of
/// the smoothing kernel, 256 / 70.
const CORRELATION_PX: f64 = 256.0 / 70.0;

/// Covariance of centre, semi-axes and angle.
pub(crate) type Covariance = [[f64; 5]; 5];

/// Covariance of `[center_x_px, center_y_px, semi_major_px, semi_minor_px, theta_rad]` from the `points` that the ellipse
/// was fitted to, `spacing_px` apart; `None` when they do not determine it.
///
/// To first order the parameters move by `(JᵀJ)⁻¹ Jᵀ e` when the points move by `e` across the contour; the variance of
/// `e` is that of the distances. Neighbours share pixels, so fewer errors are independent than there are points.
pub(crate) fn covariance<'a>(
    ellipse: &Ellipse,
    points: impl Iterator<Item = &'a EdgePoint>,
    spacing_px: f64,
) -> Option<Covariance> {
    let shape = Shape::from_ellipse(ellipse);
    let (sin, cos) = ellipse.theta_rad.sin_cos();
    let mut normal = Matrix5::zeros();
    let (mut squares, mut count) = (0.0, 0.0);
    for point in points {
        let (x, y) = (f64::from(point.x), f64::from(point.y));
        let (distance, normal_x, normal_y) = shape.distance(x, y);
        // The nearest point of the contour, in the frame of the axes.
        let (dx, dy) = (
            x - distance * normal_x - ellipse.center_x_px,
            y - distance * normal_y - ellipse.center_y_px,
        );
        let (u, v) = (dx * cos + dy * sin, dy * cos - dx * sin);
        let row = Vector5::new(
            normal_x,
            normal_y,
            (normal_x * cos + normal_y * sin) * u / ellipse.semi_major_px,
            (normal_y * cos - normal_x * sin) * v / ellipse.semi_minor_px,
            normal_y * dx - normal_x * dy,
        );
        normal += row * row.transpose();
        squares += distance * distance;
        count += 1.0;
    }
    if count < 6.0 {
        return None;
    }
    let together = (CORRELATION_PX / spacing_px.max(1e-6)).max(1.0);
    // At least what rounding to pixel values leaves.
    let variance = (squares / (count - 5.0)).max(1e-6) * together;
    // What is known of an angle beforehand keeps that of a circle finite.
    normal[(4, 4)] += variance / ANGLE_VARIANCE;
    let covariance = normal.cholesky()?.inverse() * variance;
    Some(std::array::from_fn(|i| std::array::from_fn(|j| covariance[(i, j)])))
}
