//! Kalman filters for the five parameters of an ellipse (R. E. Kalman, "A new approach to linear filtering and prediction
//! problems", 1960), each with a velocity that changes by white acceleration.
//!
//! Axes and angle go in as the mean radius `m = (a + b) / 2` and the vector `(a - b) / 2 · (cos 2θ, sin 2θ)`: all in pixels,
//! the same after half a turn, and smooth where a circle has no angle.

use super::TrackerOptions;
use crate::detection::DetectedEllipse;
use crate::ellipse::Ellipse;

/// An innovation of more standard deviations than these is a manoeuvre.
const MANOEUVRE_DEVIATIONS: f64 = 3.0;
/// Velocity and acceleration of size and shape beside those of the centre: what comes near or turns changes slowly.
const SHAPE_PACE: f64 = 0.2;
/// Difference in pixels, and beside it as a share of the mean radius, up to which two sizes or shapes are alike.
const SHAPE_TOLERANCE_PX: f64 = 2.0;
const SHAPE_TOLERANCE_SHARE: f64 = 0.15;
/// Greatest length of the shape's vector beside the mean radius; beyond it there is no minor axis left.
const SHAPE_SHARE_MAX: f64 = 0.95;

/// An ellipse as the filters measure it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sighting {
    pub(super) ellipse: Ellipse,
    pub(super) score: f64,
    values: [f64; 5],
    variances: [f64; 5],
}

impl Sighting {
    pub(super) fn new(detected: &DetectedEllipse, noise_px: f64) -> Self {
        let ellipse = detected.ellipse;
        let floor = noise_px * noise_px;
        let variances = fit_variances(detected).map(|variance| floor + variance);
        Self { ellipse, score: detected.score, values: values(&ellipse), variances }
    }

    /// Whether both are the same contour: no parameter differs by a pixel.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        self.values.iter().zip(&other.values).all(|(one, another)| (one - another).abs() < 1.0)
    }
}

/// Centre, mean radius and shape.
fn values(ellipse: &Ellipse) -> [f64; 5] {
    let half = (ellipse.semi_major_px - ellipse.semi_minor_px) / 2.0;
    let (sin, cos) = (2.0 * ellipse.theta_rad).sin_cos();
    let mean = f64::midpoint(ellipse.semi_major_px, ellipse.semi_minor_px);
    [ellipse.center_x_px, ellipse.center_y_px, mean, half * cos, half * sin]
}

/// The variances of [`values`]: carried over from the covariance, or else what the residual leaves to a fit of five
/// parameters to the visible part of the contour.
fn fit_variances(detected: &DetectedEllipse) -> [f64; 5] {
    let ellipse = &detected.ellipse;
    let visible_px = (detected.support_share * ellipse.perimeter_px()).max(5.0);
    let share = detected.support_share.clamp(0.05, 1.0);
    let from_residual = 5.0 * detected.residual_px.powi(2) / visible_px / (share * share);
    let default = if from_residual.is_finite() { from_residual } else { 1.0 };
    let Some(covariance) = &detected.covariance else { return [default; 5] };
    let twist = ellipse.semi_major_px - ellipse.semi_minor_px;
    let (sin, cos) = (2.0 * ellipse.theta_rad).sin_cos();
    let gradients = [
        [1.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.5, 0.5, 0.0],
        [0.0, 0.0, cos / 2.0, -cos / 2.0, -twist * sin],
        [0.0, 0.0, sin / 2.0, -sin / 2.0, twist * cos],
    ];
    gradients.map(|gradient| {
        let variance: f64 = gradient
            .iter()
            .zip(covariance)
            .map(|(g, row)| g * row.iter().zip(&gradient).map(|(c, h)| c * h).sum::<f64>())
            .sum();
        if variance.is_finite() && variance >= 0.0 { variance } else { default }
    })
}

/// One parameter: value, velocity and their covariance.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Parameter {
    value: f64,
    velocity: f64,
    value_variance: f64,
    covariance: f64,
    velocity_variance: f64,
}

impl Parameter {
    fn new(value: f64, value_variance: f64, speed: f64) -> Self {
        Self {
            value,
            velocity: 0.0,
            value_variance,
            covariance: 0.0,
            velocity_variance: speed * speed,
        }
    }

    fn predict(&mut self, interval_s: f64, acceleration: f64) {
        let (t, q) = (interval_s, acceleration * acceleration);
        self.value += self.velocity * t;
        self.value_variance +=
            t * (2.0 * self.covariance + t * self.velocity_variance) + q * t.powi(4) / 4.0;
        self.covariance += t * self.velocity_variance + q * t.powi(3) / 2.0;
        self.velocity_variance += q * t * t;
    }

    fn correct(&mut self, value: f64, variance: f64, interval_s: f64) {
        let innovation = value - self.value;
        // What the motion so far does not explain is put down to an acceleration since the last picture.
        let unexplained =
            (innovation / MANOEUVRE_DEVIATIONS).powi(2) - self.value_variance - variance;
        if unexplained > 0.0 {
            self.value_variance += unexplained;
            if interval_s > 0.0 {
                self.covariance += unexplained / interval_s;
                self.velocity_variance += unexplained / (interval_s * interval_s);
            }
        }
        let total = self.value_variance + variance;
        let (gain, velocity_gain) = (self.value_variance / total, self.covariance / total);
        self.value += gain * innovation;
        self.velocity += velocity_gain * innovation;
        self.velocity_variance -= velocity_gain * self.covariance;
        self.covariance *= 1.0 - gain;
        self.value_variance *= 1.0 - gain;
    }
}

/// The filters of one track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Filter {
    parameters: [Parameter; 5],
}

impl Filter {
    pub(super) fn new(sighting: &Sighting, options: &TrackerOptions) -> Self {
        let parameter = |index: usize| {
            let speed = options.speed_px_per_s * pace(index);
            Parameter::new(sighting.values[index], sighting.variances[index], speed)
        };
        Self { parameters: std::array::from_fn(parameter) }
    }

    /// Forgets the velocities.
    pub(super) fn rest(&mut self, options: &TrackerOptions) {
        for (index, parameter) in self.parameters.iter_mut().enumerate() {
            let speed = options.speed_px_per_s * pace(index);
            *parameter = Parameter::new(parameter.value, parameter.value_variance, speed);
        }
    }

    pub(super) fn predict(&mut self, interval_s: f64, options: &TrackerOptions) {
        for (index, parameter) in self.parameters.iter_mut().enumerate() {
            parameter.predict(interval_s, options.acceleration_px_per_s2 * pace(index));
        }
    }

    pub(super) fn correct(&mut self, sighting: &Sighting, interval_s: f64) {
        let measured = sighting.values.iter().zip(&sighting.variances);
        for (parameter, (&value, &variance)) in self.parameters.iter_mut().zip(measured) {
            parameter.correct(value, variance, interval_s);
        }
    }

    /// Takes over the centre after the camera jumped: where it was says nothing any more, how it moves still does.
    pub(super) fn jump(&mut self, sighting: &Sighting) {
        for (index, parameter) in self.parameters.iter_mut().enumerate().take(2) {
            parameter.value = sighting.values[index];
            parameter.value_variance = sighting.variances[index];
            parameter.covariance = 0.0;
        }
    }

    /// How far a sighting's centre is from the predicted one, in standard deviations. What moves may also have stopped or
    /// bounced since the last picture.
    pub(super) fn center_deviations(&self, sighting: &Sighting, interval_s: f64) -> f64 {
        let [vx, vy] = self.velocity_px_per_s();
        let stop = (vx * vx + vy * vy) * interval_s * interval_s;
        let share = |index: usize| {
            let parameter = &self.parameters[index];
            (sighting.values[index] - parameter.value).powi(2)
                / (parameter.value_variance + sighting.variances[index] + stop)
        };
        (share(0) + share(1)).sqrt()
    }

    /// Whether a sighting has the size and shape predicted, wherever it is.
    pub(super) fn has_shape_of(&self, sighting: &Sighting) -> bool {
        let [_, _, mean, p, q] = self.parameters.map(|parameter| parameter.value);
        let [_, _, seen_mean, seen_p, seen_q] = sighting.values;
        let reach_px = SHAPE_TOLERANCE_PX.max(SHAPE_TOLERANCE_SHARE * mean);
        (seen_mean - mean).abs() <= reach_px && (seen_p - p).hypot(seen_q - q) <= reach_px
    }

    pub(super) fn ellipse(&self) -> Ellipse {
        let [x, y, mean, p, q] = self.parameters.map(|parameter| parameter.value);
        let mean = mean.max(1.0);
        let half = p.hypot(q).min(SHAPE_SHARE_MAX * mean);
        Ellipse {
            center_x_px: x,
            center_y_px: y,
            semi_major_px: mean + half,
            semi_minor_px: mean - half,
            theta_rad: q.atan2(p) / 2.0,
        }
        .canonical()
    }

    pub(super) fn velocity_px_per_s(&self) -> [f64; 2] {
        [self.parameters[0].velocity, self.parameters[1].velocity]
    }

    pub(super) fn center_deviation_px(&self) -> [f64; 2] {
        [0, 1].map(|index| self.parameters[index].value_variance.max(0.0).sqrt())
    }
}

fn pace(index: usize) -> f64 {
    if index < 2 { 1.0 } else { SHAPE_PACE }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::super::tests::{detected, ellipse};
    use super::*;

    #[test]
    fn a_covariance_is_carried_over_to_what_the_filters_measure() {
        // Standard deviations 0.2, 0.3, 0.4, 0.1 pixels and 0.02 radians, the axes' errors of opposite sign.
        let deviations: [f64; 5] = [0.2, 0.3, 0.4, 0.1, 0.02];
        let mut covariance = [[0.0; 5]; 5];
        for (index, deviation) in deviations.iter().enumerate() {
            covariance[index][index] = deviation * deviation;
        }
        (covariance[2][3], covariance[3][2]) = (-0.02, -0.02);
        let center = [100.0, 80.0, 40.0, 30.0, 0.5];
        let detected = DetectedEllipse {
            covariance: Some(covariance),
            ..detected(ellipse(100.0, 80.0, 40.0, 30.0, 0.5))
        };
        let sighting = Sighting::new(&detected, 0.0);
        let mut random = Pcg64Mcg::seed_from_u64(5);
        let mut sums = [0.0; 5];
        let count = 20_000;
        for _ in 0..count {
            let unit: [f64; 5] =
                std::array::from_fn(|_| 12.0_f64.sqrt() * (random.random::<f64>() - 0.5));
            // The minor axis follows the major one by -0.5 of its deviation.
            let minor = -0.5 * unit[2] + 0.75_f64.sqrt() * unit[3];
            let errors = [unit[0], unit[1], unit[2], minor, unit[4]];
            let drawn: [f64; 5] =
                std::array::from_fn(|index| center[index] + deviations[index] * errors[index]);
            let drawn = ellipse(drawn[0], drawn[1], drawn[2], drawn[3], drawn[4]);
            for (sum, (one, other)) in
                sums.iter_mut().zip(values(&drawn).iter().zip(&sighting.values))
            {
                *sum += (one - other).powi(2);
            }
        }
        for (sum, variance) in sums.iter().zip(sighting.variances) {
            let spread = sum / f64::from(count);
            assert!((spread / variance - 1.0).abs() < 0.05, "{spread} {variance}");
        }
    }
}
