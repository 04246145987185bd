//! What the support of a contour means: how likely it is to be there by chance, and how likely to be an ellipse.

use crate::edges::EdgeMap;
use crate::ellipse::Ellipse;
use crate::support::Support;

/// Number of features of the score.
pub(crate) const FEATURES: usize = 7;
/// Weights of the features and, last, the constant.
const WEIGHTS: [f64; FEATURES + 1] = [2.291, -5.032, -1.380, -11.671, 0.520, 0.932, 0.125, -7.395];

/// What the score is computed from.
pub(crate) fn features(
    ellipse: &Ellipse,
    support: &Support,
    log10_false_alarms: f64,
) -> [f64; FEATURES] {
    [
        (support.share * support.inside).max(0.01).ln(),
        support.gap,
        (1.0 - support.agreement + 1e-3).ln(),
        support.residual,
        (-log10_false_alarms).max(0.0).min(200.0).sqrt(),
        ellipse.semi_minor_px.ln(),
        (support.clutter + 0.05).ln(),
    ]
}

/// The score of a contour.
pub(crate) fn score(features: &[f64; FEATURES]) -> f64 {
    let sum: f64 = features.iter().zip(&WEIGHTS).map(|(feature, weight)| feature * weight).sum();
    1.0 / (1.0 + (-(sum + WEIGHTS[FEATURES])).exp())
}

/// Decimal logarithm of the expected number of false alarms.
pub(crate) fn log10_false_alarms(edges: &EdgeMap, support: &Support) -> f64 {
    let area = (edges.map.width() * edges.map.height()) as f64;
    let density = edges.points.len() as f64 / area;
    // A band of 3 px, and an angle of 26 of 90 degrees.
    let chance = (density * 3.0 * 0.29).clamp(0.01, 0.5);
    // Neighbours two pixels apart are taken as independent.
    let spacing = (support.length / support.steps.max(1) as f64).max(1e-6);
    let per = (spacing / 2.0).min(1.0);
    let n = support.steps as f64 * per;
    let k = support.share * n;
    let tests = 2.5 * area.log10();
    tests + log10_tail(n, k, chance)
}

/// Decimal logarithm of the probability of at least `k` of `n` at `p` each (Hoeffding's bound).
fn log10_tail(n: f64, k: f64, p: f64) -> f64 {
    if n <= 0.0 || k <= p * n {
        return 0.0;
    }
    let r = (k / n).min(1.0 - 1e-9);
    -n * (r * (r / p).ln() + (1.0 - r) * ((1.0 - r) / (1.0 - p)).ln()) / std::f64::consts::LN_10
}

#[cfg(test)]
mod tests;
