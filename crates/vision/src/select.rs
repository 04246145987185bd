//! From candidates to the result: doubles go, the edges of a stroke become one, the rest is sorted by score.

use crate::candidate::{BAND_PX, Candidate, Candidates};
use crate::covariance::{Covariance, covariance};
use crate::detection::{DetectedEllipse, Detection, SupportPoint};
use crate::edges::EdgeMap;
use crate::ellipse::{Ellipse, axis_difference_rad};
use crate::options::{Options, Strokes};
use crate::shape::Shape;

/// Points of a candidate that are compared with the contours before it.
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
    kept: Vec<Kept>,
}

/// A candidate that is no double of a better one.
#[derive(Debug, Clone, Copy)]
struct Kept {
    /// Its number among the candidates.
    at: usize,
    shape: Shape,
    ellipse: Ellipse,
    /// Squares of the distances from the centre between which its contour lies, with the band.
    inner2: f64,
    outer2: f64,
    /// Whether it is the other edge of a stroke already told.
    is_merged: bool,
}

impl Kept {
    fn new(at: usize, shape: Shape) -> Self {
        let ellipse = shape.ellipse();
        let inner = (ellipse.semi_minor_px - 2.0 * BAND_PX).max(0.0);
        let outer = ellipse.semi_major_px + 2.0 * BAND_PX;
        Self { at, shape, ellipse, inner2: inner * inner, outer2: outer * outer, is_merged: false }
    }

    fn is_on(&self, x: f64, y: f64) -> bool {
        let center2 = (x - self.shape.x).powi(2) + (y - self.shape.y).powi(2);
        center2 > self.inner2
            && center2 < self.outer2
            && self.shape.distance(x, y).0.abs() < BAND_PX
    }
}

impl Selection {
    /// Fills `detection` with the best of `candidates`.
    pub(crate) fn run(
        &mut self,
        candidates: &mut Candidates,
        edges: &EdgeMap,
        options: &Options,
        detection: &mut Detection,
    ) {
        detection.ellipses.clear();
        detection.support.clear();
        // Of equals the one found first, so that the order is one only.
        candidates.all.sort_unstable_by(|a, b| {
            b.score.total_cmp(&a.score).then(a.hits.start.cmp(&b.hits.start))
        });
        self.keep(candidates, edges, options);
        for i in 0..self.kept.len() {
            if self.kept[i].is_merged {
                continue;
            }
            let one = self.kept[i];
            let partner = (options.strokes == Strokes::MiddleLine)
                .then(|| self.stroke_partner(candidates, i))
                .flatten();
            let ellipse = match partner {
                Some((_, j)) => {
                    self.kept[j].is_merged = true;
                    middle(&one.ellipse, &self.kept[j].ellipse)
                }
                None => one.ellipse,
            };
            let is_double =
                |found: &DetectedEllipse| found.ellipse.overlap_star(&ellipse) > DOUBLE_OVERLAP;
            if detection.ellipses.iter().any(is_double) {
                continue;
            }
            let edge_of_partner = partner.map(|(_, j)| self.kept[j].at);
            let best = &candidates.all[one.at];
            let start = detection.support.len();
            if options.support_points {
                for at in [Some(one.at), edge_of_partner].into_iter().flatten() {
                    let hits = &candidates.hits[candidates.all[at].hits.clone()];
                    detection.support.extend(hits.iter().map(|&hit| {
                        let point = &edges.points[hit as usize];
                        SupportPoint {
                            x_px: point.x,
                            y_px: point.y,
                            gradient_rad: point.gradient_y.atan2(point.gradient_x),
                        }
                    }));
                }
            }
            let covariance = if options.covariance {
                mean_covariance(candidates, edges, one.at, edge_of_partner)
            } else {
                None
            };
            let evidence = best.evidence;
            detection.ellipses.push(DetectedEllipse {
                ellipse,
                score: best.score,
                support_share: evidence.support_share,
                inside_share: evidence.inside_share,
                gap_share: evidence.gap_share,
                gradient_agreement: evidence.gradient_agreement,
                log10_false_alarms: evidence.log10_false_alarms,
                residual_px: evidence.residual_px,
                stroke_width_px: partner.map(|(width_px, _)| width_px),
                support: start..detection.support.len(),
                covariance,
            });
        }
    }

    /// Keeps the candidates that have a contour of their own, best first.
    fn keep(&mut self, candidates: &Candidates, edges: &EdgeMap, options: &Options) {
        self.kept.clear();
        for (at, candidate) in candidates.all.iter().enumerate() {
            if candidate.score < options.score_min {
                break;
            }
            let hits = &candidates.hits[candidate.hits.clone()];
            let count = hits.len().min(COMPARED);
            let is_alone = |i: &usize| {
                let point = &edges.points[hits[i * hits.len() / count] as usize];
                let (x, y) = (f64::from(point.x), f64::from(point.y));
                !self.kept.iter().any(|kept| kept.is_on(x, y))
            };
            let alone = (0..count).filter(is_alone).count();
            if alone as f64 >= EXCLUSIVE_MIN * count as f64 {
                self.kept.push(Kept::new(at, candidate.shape));
            }
        }
    }

    /// The nearest contour that makes a stroke with number `i`, and its width in pixels.
    fn stroke_partner(&self, candidates: &Candidates, i: usize) -> Option<(f64, usize)> {
        let one = &self.kept[i];
        let others = self.kept.iter().enumerate().skip(i + 1).filter(|(_, other)| !other.is_merged);
        others
            .filter_map(|(j, other)| {
                let edges = [&candidates.all[one.at], &candidates.all[other.at]];
                stroke_width_px(edges, [&one.ellipse, &other.ellipse]).map(|width| (width, j))
            })
            .min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

/// Covariance of an ellipse from one contour, or of the mean of two.
fn mean_covariance(
    candidates: &Candidates,
    edges: &EdgeMap,
    one: usize,
    other: Option<usize>,
) -> Option<Covariance> {
    let of = |at: usize| {
        let candidate = &candidates.all[at];
        let hits = &candidates.hits[candidate.hits.clone()];
        let spacing_px =
            candidate.support.length * candidate.support.share / hits.len().max(1) as f64;
        let points = hits.iter().map(|&hit| &edges.points[hit as usize]);
        covariance(&candidate.shape.ellipse(), points, spacing_px)
    };
    let first = of(one)?;
    let Some(second) = other.map(of) else { return Some(first) };
    let second = second?;
    Some(std::array::from_fn(|i| std::array::from_fn(|j| (first[i][j] + second[i][j]) / 4.0)))
}

impl Candidate {
    /// Whether most gradients point inwards.
    fn is_bright_inside(&self) -> bool {
        2 * self.support.inward > self.support.hits
    }
}

/// The width of the stroke whose edges two contours are, if they are: nearly parallel, of opposite sense, not too wide.
fn stroke_width_px(edges: [&Candidate; 2], ellipses: [&Ellipse; 2]) -> Option<f64> {
    if edges[0].is_bright_inside() == edges[1].is_bright_inside() {
        return None;
    }
    let [mut outer, mut inner] = ellipses;
    if outer.semi_major_px + outer.semi_minor_px < inner.semi_major_px + inner.semi_minor_px {
        std::mem::swap(&mut outer, &mut inner);
    }
    let along = outer.semi_major_px - inner.semi_major_px;
    let across = outer.semi_minor_px - inner.semi_minor_px;
    let width = f64::midpoint(along, across);
    let (dx, dy) = (outer.center_x_px - inner.center_x_px, outer.center_y_px - inner.center_y_px);
    let turned = (outer.semi_major_px - outer.semi_minor_px)
        * axis_difference_rad(outer.theta_rad, inner.theta_rad).abs();
    // The two fits are each off by a little, more so where less of the contour is seen.
    let slack = 1.0 + 0.35 * width;
    let is_stroke = width > 0.5
        && width <= STROKE_WIDTH_MAX_PX
        && inner.area_px2() >= STROKE_AREA_RATIO_MIN * outer.area_px2()
        && (along - across).abs() < 2.0 * slack
        && (dx * dx + dy * dy).sqrt() < slack
        && turned < 2.0 * slack;
    is_stroke.then_some(width)
}

/// The ellipse half way between two that are nearly parallel.
fn middle(one: &Ellipse, other: &Ellipse) -> Ellipse {
    let mean = f64::midpoint;
    let turn = axis_difference_rad(one.theta_rad, other.theta_rad);
    Ellipse {
        center_x_px: mean(one.center_x_px, other.center_x_px),
        center_y_px: mean(one.center_y_px, other.center_y_px),
        semi_major_px: mean(one.semi_major_px, other.semi_major_px),
        semi_minor_px: mean(one.semi_minor_px, other.semi_minor_px),
        theta_rad: one.theta_rad + turn / 2.0,
    }
    .canonical()
}
