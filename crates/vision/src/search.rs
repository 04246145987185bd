//! From arcs to candidates: single arcs that are elliptic by themselves, and pairs of arcs that vote.

use rand::RngExt;
use rand_pcg::Pcg32;

use crate::arc::{Arc, SAMPLES};
use crate::edges::EdgeMap;
use crate::options::Options;
use crate::shape::{Point, Shape};
use crate::support::{Along, Hit, STEPS_MAX, Support};
use crate::vote::{VOTES, vote};

/// An ellipse with what speaks for it.
#[derive(Debug, Clone)]
pub(crate) struct Candidate {
    pub(crate) shape: Shape,
    pub(crate) support: Support,
    pub(crate) log10_false_alarms: f64,
    pub(crate) features: [f64; crate::meaning::FEATURES],
    pub(crate) score: f64,
    /// Its points in [`Search::hits`].
    pub(crate) hits: std::ops::Range<usize>,
    pub(crate) pair: bool,
}

/// Buffers and results of the search.
#[derive(Debug, Clone, Default)]
pub(crate) struct Search {
    pub(crate) candidates: Vec<Candidate>,
    pub(crate) hits: Vec<Hit>,
    pub(crate) pairs: usize,
    pub(crate) tried: usize,
    pub(crate) truncated: bool,
    places: Vec<Place>,
    along: Along,
    points: Vec<Point>,
    distances: Vec<f64>,
    order: Vec<u32>,
    explained: Vec<bool>,
    partners: Vec<(u32, u32)>,
}

/// Pairs of arcs that vote in one picture at the most.
const PAIRS_MAX: usize = 60_000;
/// Candidates looked at along their contour in one picture at the most.
const TRIED_MAX: usize = 6_000;
/// Least votes of a pair: two thirds.
const VOTES_MIN: usize = VOTES * 2 / 3;
/// Steps of the coarse rounds along a contour.
const COARSE_STEPS: usize = 80;
/// Partners of an arc that are tried.
const PARTNERS_MAX: usize = 4;
/// Share of an arc's samples on an accepted contour from which the arc needs no other.
const EXPLAINED_MIN: f32 = 0.75;

impl Search {
    pub(crate) fn run(&mut self, edges: &EdgeMap, arcs: &[Arc], options: &Options) {
        self.candidates.clear();
        self.hits.clear();
        (self.pairs, self.tried, self.truncated) = (0, 0, false);
        self.explained.clear();
        self.explained.resize(arcs.len(), false);
        self.order.clear();
        self.order.extend(0..arcs.len() as u32);
        let weight = |at: &u32| {
            let arc = &arcs[*at as usize];
            arc.length_px * arc.turn_rad.min(6.3)
        };
        self.order.sort_unstable_by(|a, b| weight(b).total_cmp(&weight(a)).then(a.cmp(b)));
        let order = std::mem::take(&mut self.order);
        for &at in &order {
            let arc = &arcs[at as usize];
            if self.explained[at as usize] {
                continue;
            }
            if let Some(shape) = arc.shape
                && let Some(candidate) = self.improve(edges, &shape, options, false)
                && candidate.support.share > 0.2
            {
                self.accept(candidate, arcs);
            }
        }
        self.places.clear();
        self.places.extend(arcs.iter().map(Place::of));
        let mut random = Pcg32::new(options.seed, 0);
        for (rank, &at) in order.iter().enumerate() {
            if self.explained[at as usize] || arcs[at as usize].is_ring {
                continue;
            }
            self.pair(edges, arcs, &order, rank, options, &mut random);
        }
        self.order = order;
    }

    /// Tries arc `order[rank]` with every later one that can belong to the same ellipse.
    fn pair(
        &mut self,
        edges: &EdgeMap,
        arcs: &[Arc],
        order: &[u32],
        rank: usize,
        options: &Options,
        random: &mut Pcg32,
    ) {
        let one = &arcs[order[rank] as usize];
        self.partners.clear();
        let here = self.places[order[rank] as usize];
        for &at in &order[rank + 1..] {
            if !here.may_face(&self.places[at as usize]) || self.explained[at as usize] {
                continue;
            }
            let other = &arcs[at as usize];
            if !can_belong(one, other) {
                continue;
            }
            if self.pairs >= PAIRS_MAX {
                self.truncated = true;
                break;
            }
            self.pairs += 1;
            let mut votes = 0;
            for _ in 0..2 {
                let from = random.random_range(2..SAMPLES - 2);
                let to = random.random_range(2..SAMPLES - 2);
                votes = votes.max(vote(one, from, other, to));
            }
            if usize::from(votes) >= VOTES_MIN {
                self.partners.push((u32::from(votes) * other.length_px.min(500.0) as u32, at));
            }
        }
        self.partners.sort_unstable_by(|a, b| b.0.cmp(&a.0).then(a.1.cmp(&b.1)));
        self.partners.truncate(PARTNERS_MAX);
        let partners = std::mem::take(&mut self.partners);
        let mut best: Option<Candidate> = None;
        for &(_, at) in &partners {
            let other = &arcs[at as usize];
            self.points.clear();
            self.points.extend(
                [one, other]
                    .iter()
                    .flat_map(|arc| arc.x.iter().zip(&arc.y))
                    .map(|(x, y)| (f64::from(*x), f64::from(*y))),
            );
            let Some(shape) = Shape::fit_conic(&self.points) else { continue };
            let Some(shape) = shape.fit_distance(&self.points, 4) else { continue };
            if shape.deviation(&self.points).0 > 1.2 {
                continue;
            }
            let start = self.hits.len();
            if let Some(candidate) = self.improve(edges, &shape, options, true)
                && candidate.support.share > 0.3
                && best.as_ref().is_none_or(|best| candidate.score > best.score)
            {
                best = Some(candidate);
            } else {
                self.hits.truncate(start);
            }
        }
        self.partners = partners;
        if let Some(best) = best {
            self.accept(best, arcs);
        }
    }

    fn accept(&mut self, candidate: Candidate, arcs: &[Arc]) {
        if candidate.log10_false_alarms < -2.0 {
            let certain = candidate.score > 0.5;
            let reach = candidate.shape.ellipse().semi_major_px + 2.0;
            for (arc, explained) in arcs.iter().zip(&mut self.explained) {
                if *explained
                    || !certain
                    || (f64::from(arc.x[SAMPLES / 2]) - candidate.shape.x).abs() > reach
                    || (f64::from(arc.y[SAMPLES / 2]) - candidate.shape.y).abs() > reach
                {
                    continue;
                }
                let near = (0..SAMPLES)
                    .filter(|&i| {
                        let (x, y) = (f64::from(arc.x[i]), f64::from(arc.y[i]));
                        candidate.shape.distance(x, y).0.abs() < 1.5
                    })
                    .count();
                *explained = near as f32 >= EXPLAINED_MIN * SAMPLES as f32;
            }
            self.candidates.push(candidate);
        }
    }

    /// Draws a candidate to the edge points along it, and tells what speaks for it.
    pub(crate) fn improve(
        &mut self,
        edges: &EdgeMap,
        shape: &Shape,
        options: &Options,
        pair: bool,
    ) -> Option<Candidate> {
        if self.tried >= TRIED_MAX {
            self.truncated = true;
            return None;
        }
        self.tried += 1;
        let mut shape = *shape;
        // Coarse rounds with few points, the first in a wide band, then a fine one with all.
        for (tolerance, cos_min, steps) in
            [(2.0, 0.8, COARSE_STEPS), (1.5, 0.87, COARSE_STEPS), (1.5, 0.9, STEPS_MAX)]
        {
            if !within(&shape, edges, options) {
                return None;
            }
            let support = self.along.gather(edges, &shape, tolerance, cos_min, steps);
            if self.along.hits.len() < 8 || support.share < 0.15 {
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
        let spread = self.spread(&shape);
        self.points.retain(|&(x, y)| shape.distance(x, y).0.abs() <= spread);
        shape = shape.fit_distance(&self.points, 3)?;
        if !within(&shape, edges, options) {
            return None;
        }
        let mut support = self.along.gather(edges, &shape, 1.5, 0.9, STEPS_MAX);
        support.clutter = crate::support::clutter(edges, &shape);
        if self.along.hits.len() < 10 {
            return None;
        }
        let start = self.hits.len();
        self.hits.extend_from_slice(&self.along.hits);
        let log10_false_alarms = crate::meaning::log10_false_alarms(edges, &support);
        let features = crate::meaning::features(&shape.ellipse(), &support, log10_false_alarms);
        let score = crate::meaning::score(&features);
        let hits = start..self.hits.len();
        Some(Candidate { shape, support, log10_false_alarms, features, score, hits, pair })
    }
}

impl Search {
    /// Three robust standard deviations of the points at hand from `shape`, in pixels, within bounds.
    fn spread(&mut self, shape: &Shape) -> f64 {
        self.distances.clear();
        self.distances.extend(self.points.iter().map(|&(x, y)| shape.distance(x, y).0.abs()));
        let middle = self.distances.len() / 2;
        let (_, median, _) = self.distances.select_nth_unstable_by(middle, f64::total_cmp);
        (3.0 * 1.4826 * *median).clamp(0.35, 1.5)
    }
}

/// Greatest semi-major axis, as a share of the picture's longer side: of a larger ellipse too little is seen.
const SEMI_MAJOR_SHARE_MAX: f64 = 0.75;

fn within(shape: &Shape, edges: &EdgeMap, options: &Options) -> bool {
    let ellipse = shape.ellipse();
    let side = edges.map.width().max(edges.map.height()) as f64;
    ellipse.semi_minor_px >= options.semi_axis_min_px
        && ellipse.semi_major_px <= options.semi_axis_max_px.min(SEMI_MAJOR_SHARE_MAX * side)
        && ellipse.semi_minor_px >= options.axis_ratio_min * ellipse.semi_major_px
}

/// The middle of an arc, for the first look at a pair.
#[derive(Debug, Clone, Copy)]
struct Place {
    x: f32,
    y: f32,
    inside_x: f32,
    inside_y: f32,
    reach: f32,
}

impl Place {
    fn of(arc: &Arc) -> Self {
        let middle = SAMPLES / 2;
        Self {
            x: arc.x[middle],
            y: arc.y[middle],
            inside_x: arc.inside_x[middle],
            inside_y: arc.inside_y[middle],
            reach: REACH_RADII * arc.length_px / arc.turn_rad,
        }
    }

    /// Whether the middle of each is on the inner side of the other, and near enough.
    #[inline(always)]
    fn may_face(&self, other: &Self) -> bool {
        let (dx, dy) = (other.x - self.x, other.y - self.y);
        let slack = -1.5 - SLACK * (dx.abs() + dy.abs());
        let reach = self.reach.max(other.reach);
        (dx * self.inside_x + dy * self.inside_y > slack)
            & (-dx * other.inside_x - dy * other.inside_y > slack)
            & (dx.abs() < reach)
            & (dy.abs() < reach)
    }
}

/// How many of its radii an arc may be away from another one.
const REACH_RADII: f32 = 8.0;
/// Normals are off by up to this, radians.
const SLACK: f32 = 0.1;

/// Whether two arcs can lie on one ellipse: each on the inner side of the other's tangents.
fn can_belong(one: &Arc, other: &Arc) -> bool {
    const PLACES: [usize; 3] = [1, SAMPLES / 2, SAMPLES - 2];
    let inner = |arc: &Arc, i: usize, point: &Arc, j: usize| {
        let (dx, dy) = (point.x[j] - arc.x[i], point.y[j] - arc.y[i]);
        dx * arc.inside_x[i] + dy * arc.inside_y[i] > -1.5 - SLACK * (dx.abs() + dy.abs())
    };
    PLACES
        .iter()
        .all(|&i| PLACES.iter().all(|&j| inner(one, i, other, j) && inner(other, j, one, i)))
}
