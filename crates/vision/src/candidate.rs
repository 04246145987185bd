//! Candidates: ellipses drawn to the edge points along them, with what speaks for them.

use std::ops::Range;

use crate::edges::EdgeMap;
use crate::meaning::Evidence;
use crate::options::Options;
use crate::shape::{Point, Shape};
use crate::support::{Along, Hit, STEPS_MAX, Support};

/// Candidates looked at in one picture at the most.
const TRIED_MAX: usize = 6_000;
/// Steps of the coarse rounds along a contour.
const COARSE_STEPS: usize = 64;
/// Least hits of a coarse round and of a candidate.
const HITS_MIN: usize = 8;
/// Candidates that score less before the last fit are not followed further.
const HOPELESS_SCORE: f64 = 0.02;
/// Least share of the contour that a coarse round finds.
const COARSE_SHARE_MIN: f64 = 0.15;
/// Greatest semi-major axis, as a share of the picture's longer side: of a larger ellipse too little is seen.
const SEMI_MAJOR_SHARE_MAX: f64 = 0.75;
/// Band of the last look, in pixels on either side, and its least cosine between gradient and normal.
pub(crate) const BAND_PX: f64 = 1.5;
const COS_MIN: f64 = 0.9;

/// A round of drawing near: band in pixels on either side, least cosine, steps.
type Round = (f64, f64, usize);
/// From arcs, which are near already.
const ROUNDS: [Round; 3] =
    [(2.0, 0.8, COARSE_STEPS), (BAND_PX, 0.87, COARSE_STEPS), (BAND_PX, COS_MIN, STEPS_MAX)];
/// From a prediction, which may be some pixels off.
const FAR_ROUNDS: [Round; 4] = [
    (7.0, 0.8, COARSE_STEPS),
    (3.0, 0.8, COARSE_STEPS),
    (BAND_PX, 0.87, COARSE_STEPS),
    (BAND_PX, COS_MIN, STEPS_MAX),
];

/// An ellipse with what speaks for it.
#[derive(Debug, Clone)]
pub(crate) struct Candidate {
    pub(crate) shape: Shape,
    pub(crate) support: Support,
    pub(crate) evidence: Evidence,
    pub(crate) score: f64,
    /// Its points in [`Candidates::hits`].
    pub(crate) hits: Range<usize>,
}

/// The candidates of a picture, and the buffers of their making.
#[derive(Debug, Clone, Default)]
pub(crate) struct Candidates {
    pub(crate) all: Vec<Candidate>,
    /// Numbers of edge points, candidate by candidate.
    pub(crate) hits: Vec<Hit>,
    pub(crate) tried: usize,
    pub(crate) truncated: bool,
    along: Along,
    points: Vec<Point>,
    distances: Vec<f64>,
}

impl Candidates {
    pub(crate) fn clear(&mut self) {
        self.all.clear();
        self.hits.clear();
        (self.tried, self.truncated) = (0, false);
    }

    /// Draws `shape`, which comes from arcs, to the edge points along it.
    pub(crate) fn near(
        &mut self,
        edges: &EdgeMap,
        shape: &Shape,
        options: &Options,
    ) -> Option<Candidate> {
        self.draw(edges, shape, &ROUNDS, options)
    }

    /// Draws `shape`, which comes from a prediction, to the edge points along it.
    pub(crate) fn far(
        &mut self,
        edges: &EdgeMap,
        shape: &Shape,
        options: &Options,
    ) -> Option<Candidate> {
        self.draw(edges, shape, &FAR_ROUNDS, options)
    }

    fn draw(
        &mut self,
        edges: &EdgeMap,
        shape: &Shape,
        rounds: &[Round],
        options: &Options,
    ) -> Option<Candidate> {
        if self.tried >= TRIED_MAX {
            self.truncated = true;
            return None;
        }
        self.tried += 1;
        let mut shape = *shape;
        for &(band_px, cos_min, steps) in rounds {
            if !is_within(&shape, edges, options) {
                return None;
            }
            let support = self.along.gather(edges, &shape, band_px, cos_min, steps);
            if self.along.hits.len() < HITS_MIN || support.share < COARSE_SHARE_MIN {
                return None;
            }
            let is_hopeless = steps == STEPS_MAX
                && Evidence::new(edges, &support).score(shape.ellipse().semi_minor_px)
                    < HOPELESS_SCORE;
            if is_hopeless {
                return None;
            }
            self.points.clear();
            self.points.extend(self.along.hits.iter().map(|&hit| {
                let point = &edges.points[hit as usize];
                (f64::from(point.x), f64::from(point.y))
            }));
            shape = shape.step(&self.points)?;
        }
        // Once more without the points that the noise does not explain.
        let spread_px = self.spread_px(&shape);
        self.points.retain(|&(x, y)| shape.distance(x, y).0.abs() <= spread_px);
        shape = shape.fit_distance(&self.points, 3)?;
        if !is_within(&shape, edges, options) {
            return None;
        }
        let support = self.along.gather(edges, &shape, BAND_PX, COS_MIN, STEPS_MAX);
        if self.along.hits.len() < HITS_MIN {
            return None;
        }
        let start = self.hits.len();
        self.hits.extend_from_slice(&self.along.hits);
        let evidence = Evidence::new(edges, &support);
        let score = evidence.score(shape.ellipse().semi_minor_px);
        Some(Candidate { shape, support, evidence, score, hits: start..self.hits.len() })
    }

    /// Three robust standard deviations of the points at hand from `shape`, in pixels, within bounds.
    fn spread_px(&mut self, shape: &Shape) -> f64 {
        self.distances.clear();
        self.distances.extend(self.points.iter().map(|&(x, y)| shape.distance(x, y).0.abs()));
        let middle = self.distances.len() / 2;
        let (_, median, _) = self.distances.select_nth_unstable_by(middle, f64::total_cmp);
        (3.0 * 1.4826 * *median).clamp(0.35, BAND_PX)
    }
}

fn is_within(shape: &Shape, edges: &EdgeMap, options: &Options) -> bool {
    let ellipse = shape.ellipse();
    let side = edges.map.width().max(edges.map.height()) as f64;
    ellipse.semi_minor_px >= options.semi_axis_min_px
        && ellipse.semi_major_px <= options.semi_axis_max_px.min(SEMI_MAJOR_SHARE_MAX * side)
        && ellipse.semi_minor_px >= options.axis_ratio_min * ellipse.semi_major_px
}
