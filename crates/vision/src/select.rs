//! From candidates to the result: doubles go, strokes become one, the rest is sorted by score.

use crate::detection::{DetectedEllipse, Detection};
use crate::edges::EdgeMap;
use crate::ellipse::Ellipse;
use crate::options::{Options, Strokes};
use crate::search::{Candidate, Search};
use crate::shape::Shape;

/// Hits of a candidate that are compared with the contours before it.
const COMPARED: usize = 32;
/// Least share of them that must belong to no better contour.
const EXCLUSIVE_MIN: f64 = 0.5;
/// Overlap from which two ellipses are the same.
const DOUBLE_OVERLAP: f64 = 0.8;
/// Greatest width of a stroke in pixels.
const STROKE_WIDTH_MAX_PX: f64 = 12.0;
/// Least ratio of the areas within the two edges of a stroke.
const STROKE_AREA_RATIO_MIN: f64 = 1.0 / 3.0;

/// Buffers of the selection.
#[derive(Debug, Clone, Default)]
pub(crate) struct Selection {
    kept: Vec<usize>,
    near: Vec<(Shape, f64, f64)>,
    merged: Vec<bool>,
    /// Whether the gradient points inwards, for each ellipse of the result.
    inward: Vec<bool>,
}

pub(crate) fn select(
    Selection { kept, near, merged, inward }: &mut Selection,
    search: &mut Search,
    edges: &EdgeMap,
    options: &Options,
    detection: &mut Detection,
) {
    detection.ellipses.clear();
    detection.support.clear();
    search.candidates.sort_unstable_by(|a, b| {
        b.score.total_cmp(&a.score).then(a.hits.start.cmp(&b.hits.start))
    });
    kept.clear();
    near.clear();
    inward.clear();
    for (at, candidate) in search.candidates.iter().enumerate() {
        let hits = &search.hits[candidate.hits.clone()];
        let count = hits.len().min(COMPARED);
        let alone = (0..count)
            .filter(|i| {
                let point = &edges.points[hits[i * hits.len() / count] as usize];
                let (x, y) = (f64::from(point.x), f64::from(point.y));
                !near.iter().any(|(shape, inner2, outer2)| {
                    let center2 = (x - shape.x).powi(2) + (y - shape.y).powi(2);
                    center2 > *inner2 && center2 < *outer2 && shape.distance(x, y).0.abs() < 1.5
                })
            })
            .count();
        if alone as f64 >= EXCLUSIVE_MIN * count as f64 && candidate.score >= options.score_min {
            kept.push(at);
            let ellipse = candidate.shape.ellipse();
            let inner = (ellipse.semi_minor_px - 2.0).max(0.0);
            near.push((candidate.shape, inner.powi(2), (ellipse.semi_major_px + 2.0).powi(2)));
        }
    }
    merged.clear();
    merged.resize(kept.len(), false);
    for (i, &one_at) in kept.iter().enumerate() {
        if merged[i] {
            continue;
        }
        let one = &search.candidates[one_at];
        let mut ellipse = one.shape.ellipse();
        let mut stroke_width_px = None;
        if options.strokes == Strokes::MiddleLine {
            let partner = kept
                .iter()
                .enumerate()
                .skip(i + 1)
                .filter(|&(j, _)| !merged[j])
                .filter_map(|(j, &other_at)| {
                    let other = &search.candidates[other_at];
                    stroke(one, other).map(|width| (width, j, other_at))
                })
                .min_by(|a, b| a.0.total_cmp(&b.0));
            if let Some((width, j, other_at)) = partner {
                merged[j] = true;
                stroke_width_px = Some(width);
                ellipse = middle(&ellipse, &search.candidates[other_at].shape.ellipse());
            }
        }
        let is_inward = one.inward() > 0.5;
        // The two edges of a narrow stroke overlap too, and are told apart by their sense.
        let is_double = detection.ellipses.iter().zip(&*inward).any(|(found, &sense)| {
            (sense == is_inward || options.strokes == Strokes::MiddleLine)
                && found.ellipse.overlap_star(&ellipse) > DOUBLE_OVERLAP
        });
        if is_double {
            continue;
        }
        inward.push(is_inward);
        detection.ellipses.push(DetectedEllipse {
            ellipse,
            score: one.score,
            support_share: one.support.share,
            gradient_agreement: one.support.agreement,
            log10_false_alarms: one.log10_false_alarms,
            residual_px: one.support.residual,
            stroke_width_px,
            support: 0..0,
            covariance: None,
            dev: one.features,
        });
    }
}

impl Candidate {
    /// Share of its hits whose gradient points inwards.
    fn inward(&self) -> f64 {
        self.support.inward as f64 / self.support.hits.max(1) as f64
    }
}

/// The width of the stroke whose edges two contours are, if they are.
fn stroke(one: &Candidate, other: &Candidate) -> Option<f64> {
    if (one.inward() > 0.5) == (other.inward() > 0.5) {
        return None;
    }
    let (a, b) = (one.shape.ellipse(), other.shape.ellipse());
    let (outer, inner) = if a.semi_major_px + a.semi_minor_px > b.semi_major_px + b.semi_minor_px {
        (a, b)
    } else {
        (b, a)
    };
    let (along, across) =
        (outer.semi_major_px - inner.semi_major_px, outer.semi_minor_px - inner.semi_minor_px);
    let width = (along + across) / 2.0;
    let center =
        (outer.center_x_px - inner.center_x_px).hypot(outer.center_y_px - inner.center_y_px);
    let slack = 1.0 + 0.35 * width;
    let turned = (outer.semi_major_px - outer.semi_minor_px)
        * crate::ellipse::axis_difference_rad(outer.theta_rad, inner.theta_rad).abs();
    (width > 0.5
        && width <= STROKE_WIDTH_MAX_PX
        && inner.area_px2() >= STROKE_AREA_RATIO_MIN * outer.area_px2()
        && (along - across).abs() < slack * 2.0
        && center < slack
        && turned < slack * 2.0)
        .then_some(width)
}

/// The ellipse half way between two that are nearly parallel.
fn middle(one: &Ellipse, other: &Ellipse) -> Ellipse {
    let mean = |a: f64, b: f64| (a + b) / 2.0;
    let turn = crate::ellipse::axis_difference_rad(one.theta_rad, other.theta_rad);
    Ellipse {
        center_x_px: mean(one.center_x_px, other.center_x_px),
        center_y_px: mean(one.center_y_px, other.center_y_px),
        semi_major_px: mean(one.semi_major_px, other.semi_major_px),
        semi_minor_px: mean(one.semi_minor_px, other.semi_minor_px),
        theta_rad: one.theta_rad + turn / 2.0,
    }
    .canonical()
}

#[cfg(test)]
mod tests;
