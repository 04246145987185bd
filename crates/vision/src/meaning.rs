//! What the support of a contour means: how likely it is to be there by chance, and how likely to be an ellipse.

use crate::edges::EdgeMap;
use crate::support::Support;

/// What speaks for a contour. The fields are those of [`DetectedEllipse`](crate::DetectedEllipse).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Evidence {
    pub(crate) support_share: f64,
    pub(crate) inside_share: f64,
    pub(crate) gap_share: f64,
    pub(crate) gradient_agreement: f64,
    pub(crate) residual_px: f64,
    pub(crate) log10_false_alarms: f64,
}

/// Number of features of the score.
pub(crate) const FEATURES: usize = 6;
/// Weights of the features and, last, the constant: a logistic regression, made by the example `score-weights`.
const WEIGHTS: [f64; FEATURES + 1] = [1.267, -5.181, -1.935, -8.564, 0.572, 0.914, -11.811];

impl Evidence {
    pub(crate) fn new(edges: &EdgeMap, support: &Support) -> Self {
        Self {
            support_share: support.share,
            inside_share: support.inside,
            gap_share: support.gap,
            gradient_agreement: support.agreement,
            residual_px: support.residual,
            log10_false_alarms: log10_false_alarms(edges, support),
        }
    }

    /// What the score is computed from.
    pub(crate) fn features(&self, semi_minor_px: f64) -> [f64; FEATURES] {
        [
            (self.support_share * self.inside_share).max(0.01).ln(),
            self.gap_share,
            (1.0 - self.gradient_agreement + 1e-3).ln(),
            self.residual_px,
            (-self.log10_false_alarms).clamp(0.0, 200.0).sqrt(),
            semi_minor_px.ln(),
        ]
    }

    /// The score of a contour, `0..=1`.
    pub(crate) fn score(&self, semi_minor_px: f64) -> f64 {
        let features = self.features(semi_minor_px);
        let sum: f64 = features.iter().zip(&WEIGHTS).map(|(value, weight)| value * weight).sum();
        1.0 / (1.0 + (-(sum + WEIGHTS[FEATURES])).exp())
    }
}

/// Share of directions within the angle of the last look at a contour, 26 of 90 degrees.
const DIRECTION_CHANCE: f64 = 0.29;
/// Bounds of the chance that an edge lies on a step.
const CHANCE_MIN: f64 = 0.01;
const CHANCE_MAX: f64 = 0.1;
/// Width of its band in pixels.
const BAND_WIDTH_PX: f64 = 3.0;
/// Distance at which edge points are independent of each other, in pixels: the smoothing is 5 px wide.
const INDEPENDENT_PX: f64 = 2.0;

/// Decimal logarithm of the expected number of false alarms: the number of ellipses of this size that could be tested in a
/// picture, a centre in each pixel times the length of the contour to the third power for axes and angle, times the
/// chance that one of them has this support. An edge lies on a step of the contour by chance as often as the edge points'
/// density in the picture says, but in a picture crowded with small ellipses the density is their own.
fn log10_false_alarms(edges: &EdgeMap, support: &Support) -> f64 {
    let area_px2 = (edges.map.width() * edges.map.height()) as f64;
    let density = edges.points.len() as f64 / area_px2;
    let chance = (density * BAND_WIDTH_PX * DIRECTION_CHANCE).clamp(CHANCE_MIN, CHANCE_MAX);
    let step_px = support.length / support.steps.max(1) as f64;
    let trials = support.steps as f64 * (step_px / INDEPENDENT_PX).min(1.0);
    let tests = area_px2 * support.length.max(1.0).powi(3);
    tests.log10() + log10_tail(trials, support.share * trials, chance)
}

/// Decimal logarithm of (a bound from above on) the probability of at least `hits` of `trials` at `chance` each
/// (Hoeffding 1963).
fn log10_tail(trials: f64, hits: f64, chance: f64) -> f64 {
    if trials <= 0.0 || hits <= chance * trials {
        return 0.0;
    }
    let share = (hits / trials).min(1.0 - 1e-9);
    let divergence =
        share * (share / chance).ln() + (1.0 - share) * ((1.0 - share) / (1.0 - chance)).ln();
    -trials * divergence / std::f64::consts::LN_10
}

#[cfg(test)]
mod tests;
