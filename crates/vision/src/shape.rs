//! The ellipse as a centre and a symmetric matrix, the form in which fitting has no corner cases, and the fits.
//!
//! A point at offset `d` from the centre lies on the contour where `dᵀ Q d = 1`. Unlike semi-axes and an angle, the
//! three entries of `Q` stay well defined for a circle.

use nalgebra::{Matrix5, SMatrix, SVector, Vector5};

use crate::ellipse::Ellipse;

/// Centre in pixels, and the entries `xx`, `xy`, `yy` of `Q` per square pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Shape {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) xx: f64,
    pub(crate) xy: f64,
    pub(crate) yy: f64,
}

/// A point of a contour, for the fits.
pub(crate) type Point = (f64, f64);

/// The fit has settled when no point moves more than this relative to the semi-axes.
const SETTLED: f64 = 1e-5;

impl Shape {
    /// The ellipse, in canonical form.
    pub(crate) fn ellipse(&self) -> Ellipse {
        let mean = f64::midpoint(self.xx, self.yy);
        let half_difference = (self.xx - self.yy) / 2.0;
        let root = half_difference.hypot(self.xy);
        // The smaller eigenvalue belongs to the major axis. From the determinant, so that a flat ellipse loses no digits.
        let large = mean + root;
        let small = (self.xx * self.yy - self.xy * self.xy) / large;
        let theta_rad = 0.5 * (-self.xy).atan2(-half_difference);
        Ellipse {
            center_x_px: self.x,
            center_y_px: self.y,
            semi_major_px: small.max(f64::MIN_POSITIVE).sqrt().recip(),
            semi_minor_px: large.max(f64::MIN_POSITIVE).sqrt().recip(),
            theta_rad,
        }
        .canonical()
    }

    pub(crate) fn from_ellipse(ellipse: &Ellipse) -> Self {
        let (sin, cos) = ellipse.theta_rad.sin_cos();
        let (large, small) = (ellipse.semi_minor_px.powi(-2), ellipse.semi_major_px.powi(-2));
        Self {
            x: ellipse.center_x_px,
            y: ellipse.center_y_px,
            xx: small * cos * cos + large * sin * sin,
            xy: (small - large) * sin * cos,
            yy: small * sin * sin + large * cos * cos,
        }
    }

    /// From `a x² + b x y + c y² + d x + e y + f = 0`; `None` unless that is a real ellipse.
    pub(crate) fn from_conic([a, b, c, d, e, f]: [f64; 6]) -> Option<Self> {
        let determinant = 4.0 * a * c - b * b;
        if determinant <= 0.0 || !determinant.is_finite() {
            return None;
        }
        let x = (b * e - 2.0 * c * d) / determinant;
        let y = (b * d - 2.0 * a * e) / determinant;
        let level = -(f + 0.5 * (d * x + e * y));
        let shape = Self { x, y, xx: a / level, xy: b / (2.0 * level), yy: c / level };
        shape.is_ellipse().then_some(shape)
    }

    pub(crate) fn is_ellipse(&self) -> bool {
        self.xx > 0.0
            && self.yy > 0.0
            && self.xx * self.yy > self.xy * self.xy
            && (self.xx + self.yy + self.x + self.y).is_finite()
    }

    /// Approximate distance of a point from the contour in pixels, negative inside, and the unit normal there (outwards).
    #[inline(always)]
    pub(crate) fn distance(&self, x: f64, y: f64) -> (f64, f64, f64) {
        let (dx, dy) = (x - self.x, y - self.y);
        let (gx, gy) = (self.xx * dx + self.xy * dy, self.xy * dx + self.yy * dy);
        let rho = (gx * dx + gy * dy).max(0.0).sqrt();
        let length = (gx * gx + gy * gy).sqrt().max(1e-300);
        // (rho - 1) over the length of its gradient, which is |Q d| / rho.
        ((rho - 1.0) * rho / length, gx / length, gy / length)
    }

    /// Least squares fit of a conic with trace 1, the second time with each point weighted by the inverse square of the
    /// gradient of its residual, which takes the distance for the algebraic residual (Sampson 1982).
    pub(crate) fn fit_conic(points: &[Point]) -> Option<Self> {
        let frame = Frame::of(points)?;
        let mut weights_from: Option<Self> = None;
        for _ in 0..2 {
            let mut normal = SMatrix::<f64, 5, 5>::zeros();
            let mut right = SVector::<f64, 5>::zeros();
            for &point in points {
                let (x, y) = frame.enter(point);
                let weight = weights_from.map_or(1.0, |shape| {
                    let (dx, dy) = (x - shape.x, y - shape.y);
                    let (gx, gy) = (shape.xx * dx + shape.xy * dy, shape.xy * dx + shape.yy * dy);
                    1.0 / (gx * gx + gy * gy).max(1e-6)
                });
                let row = Vector5::new(x * x - y * y, x * y, x, y, 1.0);
                let target = -y * y;
                normal.syger(weight, &row, &row, 1.0);
                right.axpy(weight * target, &row, 1.0);
            }
            normal.fill_upper_triangle_with_lower_triangle();
            let solution = normal.cholesky()?.solve(&right);
            let [a, b, d, e, f] = solution.into();
            weights_from = Some(Self::from_conic([a, b, 1.0 - a, d, e, f])?);
        }
        weights_from.map(|shape| frame.leave(&shape))
    }

    /// Moves the shape towards the least sum of squared distances of `points` (Levenberg and Marquardt's method on the
    /// approximate distance, `rounds_max` rounds at the most).
    /// `None` when the points do not determine an ellipse.
    pub(crate) fn fit_distance(&self, points: &[Point], rounds_max: usize) -> Option<Self> {
        if points.len() < 6 {
            return None;
        }
        let scale = (self.xx * self.yy - self.xy * self.xy).powf(-0.25);
        if !scale.is_finite() {
            return None;
        }
        let frame = Frame { x: self.x, y: self.y, scale };
        let mut shape = frame.shape_entered(self);
        let mut damping = 1e-9;
        let (mut normal, mut right, mut cost) = normal_equations(&shape, points, &frame);
        for _ in 0..rounds_max {
            let mut damped = normal;
            for i in 0..5 {
                damped[(i, i)] *= 1.0 + damping;
            }
            let step = damped.cholesky()?.solve(&right);
            let moved = shape.minus(&step);
            let size = step.amax();
            let tried = moved.is_ellipse().then(|| normal_equations(&moved, points, &frame));
            match tried {
                Some((new_normal, new_right, new_cost)) if new_cost <= cost => {
                    (shape, normal, right, cost) = (moved, new_normal, new_right, new_cost);
                    damping = (damping * 0.1).max(1e-9);
                    if size < SETTLED {
                        break;
                    }
                }
                _ => {
                    if size < SETTLED {
                        break;
                    }
                    damping = (damping * 100.0).max(1e-3);
                }
            }
        }
        Some(frame.leave(&shape))
    }

    /// One Gauss-Newton step towards the least sum of squared distances, unchecked: for rounds that look again afterwards.
    pub(crate) fn step(&self, points: &[Point]) -> Option<Self> {
        let scale = (self.xx * self.yy - self.xy * self.xy).powf(-0.25);
        if points.len() < 6 || !scale.is_finite() {
            return None;
        }
        let frame = Frame { x: self.x, y: self.y, scale };
        let shape = frame.shape_entered(self);
        let (normal, right, _) = normal_equations(&shape, points, &frame);
        let step = normal.cholesky()?.solve(&right);
        let moved = shape.minus(&step);
        moved.is_ellipse().then(|| frame.leave(&moved))
    }

    fn minus(&self, step: &Vector5<f64>) -> Self {
        Self {
            x: self.x - step[0],
            y: self.y - step[1],
            xx: self.xx - step[2],
            xy: self.xy - step[3],
            yy: self.yy - step[4],
        }
    }

    /// Root mean square and greatest distance of `points`.
    pub(crate) fn deviation(&self, points: &[Point]) -> (f64, f64) {
        let (mut sum, mut greatest) = (0.0, 0.0_f64);
        for &(x, y) in points {
            let distance = self.distance(x, y).0;
            sum += distance * distance;
            greatest = greatest.max(distance.abs());
        }
        ((sum / points.len().max(1) as f64).sqrt(), greatest)
    }
}

/// Points that are summed side by side.
const LANES: usize = 4;
/// Sums of a Gauss-Newton step: the lower triangle of the normal matrix, the right side, and the squares.
const SUMS: usize = 15 + 5 + 1;

/// Sums of the Gauss-Newton step: normal matrix, right side, and sum of squares, in the units of the frame.
fn normal_equations(
    shape: &Shape,
    points: &[Point],
    frame: &Frame,
) -> (Matrix5<f64>, Vector5<f64>, f64) {
    let sums = pulp::Arch::new().dispatch(Summed { shape, points, frame });
    let mut normal = Matrix5::zeros();
    let mut at = 0;
    for i in 0..5 {
        for j in 0..=i {
            normal[(i, j)] = sums[at];
            normal[(j, i)] = sums[at];
            at += 1;
        }
    }
    (normal, Vector5::from_column_slice(&sums[15..20]), sums[20])
}

/// The summing, to be compiled for an instruction set.
struct Summed<'a> {
    shape: &'a Shape,
    points: &'a [Point],
    frame: &'a Frame,
}

impl pulp::WithSimd for Summed<'_> {
    type Output = [f64; SUMS];

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _instructions: S) -> Self::Output {
        let Self { shape, points, frame } = self;
        let mut sums = [[0.0; LANES]; SUMS];
        for group in points.chunks(LANES) {
            // Lanes without a point get weight 0.
            let mut x = [0.0; LANES];
            let mut y = [0.0; LANES];
            let mut weight = [0.0; LANES];
            for (lane, &point) in group.iter().enumerate() {
                (x[lane], y[lane]) = frame.enter(point);
                weight[lane] = 1.0;
            }
            add_group(shape, &x, &y, &weight, &mut sums);
        }
        sums.map(|lanes| (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]))
    }
}

/// Adds four points to the sums.
#[inline(always)]
fn add_group(
    shape: &Shape,
    x: &[f64; LANES],
    y: &[f64; LANES],
    weight: &[f64; LANES],
    sums: &mut [[f64; LANES]; SUMS],
) {
    // Rows of the Jacobian, and the residual.
    let mut rows = [[0.0; LANES]; 6];
    for lane in 0..LANES {
        let (dx, dy) = (x[lane] - shape.x, y[lane] - shape.y);
        let (gx, gy) = (shape.xx * dx + shape.xy * dy, shape.xy * dx + shape.yy * dy);
        let rho = (gx * dx + gy * dy).max(1e-12).sqrt();
        let inverse = weight[lane] / (gx * gx + gy * gy).max(1e-12).sqrt();
        // Derivatives of rho over the length of its gradient |Q d| / rho.
        rows[0][lane] = -gx * inverse;
        rows[1][lane] = -gy * inverse;
        rows[2][lane] = 0.5 * dx * dx * inverse;
        rows[3][lane] = dx * dy * inverse;
        rows[4][lane] = 0.5 * dy * dy * inverse;
        rows[5][lane] = (rho - 1.0) * rho * inverse;
    }
    let mut at = 0;
    for i in 0..6 {
        for j in 0..=i {
            // The triangle of the five rows, then the residual with each of them and with itself.
            for lane in 0..LANES {
                sums[at][lane] += rows[i][lane] * rows[j][lane];
            }
            at += 1;
        }
    }
}

/// Coordinates in which the points are near the origin and of size 1.
struct Frame {
    x: f64,
    y: f64,
    scale: f64,
}

impl Frame {
    fn of(points: &[Point]) -> Option<Self> {
        let count = points.len() as f64;
        if points.len() < 5 {
            return None;
        }
        let (x, y) = points.iter().fold((0.0, 0.0), |sum, p| (sum.0 + p.0, sum.1 + p.1));
        let (x, y) = (x / count, y / count);
        let spread: f64 =
            points.iter().map(|p| (p.0 - x).powi(2) + (p.1 - y).powi(2)).sum::<f64>() / count;
        let scale = spread.sqrt();
        (scale > 1e-6).then_some(Self { x, y, scale })
    }

    #[inline(always)]
    fn enter(&self, (x, y): Point) -> Point {
        ((x - self.x) / self.scale, (y - self.y) / self.scale)
    }

    fn shape_entered(&self, shape: &Shape) -> Shape {
        let scale2 = self.scale * self.scale;
        let (x, y) = self.enter((shape.x, shape.y));
        Shape { x, y, xx: shape.xx * scale2, xy: shape.xy * scale2, yy: shape.yy * scale2 }
    }

    fn leave(&self, shape: &Shape) -> Shape {
        let scale2 = self.scale * self.scale;
        Shape {
            x: shape.x * self.scale + self.x,
            y: shape.y * self.scale + self.y,
            xx: shape.xx / scale2,
            xy: shape.xy / scale2,
            yy: shape.yy / scale2,
        }
    }
}

#[cfg(test)]
mod tests;
