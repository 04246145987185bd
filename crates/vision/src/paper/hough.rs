//! The Randomized Hough Transform for ellipses (paper, section 3.1, equations 3 to 8).
//!
//! Two edge points are taken for the ends of a major axis, which fixes centre, semi-major axis and angle. Every edge
//! point near them then votes, in an accumulator of one dimension, for the semi-minor axis of the ellipse through it.
//! The fullest bin completes a *candidate*. Instead of all n² pairs, `m = C n` random ones are tried.
//!
//! Where the paper is silent, this file holds:
//! - Points are drawn uniformly and with replacement, and stay in the list after a find ("not deleted").
//! - A drawn pair counts towards m when its length lies between twice the least and twice the greatest semi-major axis:
//!   the paper's "search domain condition". Others are drawn again, at most [`DRAWS_PER_PAIR_MAX`] times a pair.
//! - Bin k of the accumulator is centred on `semi_minor_min_px + k bin_width_px`; of equally full bins the least wins.
//!
//! Pairs come in batches of [`BATCH_PAIRS`], each with a generator of its own seeded by (seed, number of the batch), and
//! are put together in order: the result does not depend on the number of threads.

use rand::Rng;
use rand_pcg::Pcg32;
use rayon::prelude::*;

use crate::ellipse::Ellipse;
use crate::paper::edge::EdgePoint;
use crate::paper::grid::{Halves, PointGrid};
use crate::paper::options::HoughOptions;
use crate::paper::vote::{Axis, Peak};

/// Pairs in a batch.
pub const BATCH_PAIRS: usize = 64;
/// Draws spent on a pair, on the mean of its batch, before the batch gives up.
pub const DRAWS_PER_PAIR_MAX: usize = 512;
/// Most pairs of one search, whatever C and the number of edge points are.
pub const PAIRS_MAX: usize = 1 << 18;
/// Points visited by the voting of one search after which no more pairs are tried: about a second on one core.
pub const VOTES_MAX: usize = 1 << 28;
/// Draws of one search after which no more pairs are tried.
pub const DRAWS_MAX: usize = 1 << 26;
/// Batches between two looks at these limits. The last ones may exceed them, by no more than another [`VOTES_MAX`] and one
/// pair a batch.
const WAVE_BATCHES: usize = 64;

/// An ellipse that a pair of edge points and the fullest bin of its accumulator propose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// The proposal, in canonical form.
    pub ellipse: Ellipse,
    /// Points in the fullest bin by quadrant of the ellipse: 0 and 2 lie on one side of the minor axis, 1 and 3 on the
    /// other; 0 and 1 lie on one side of the major axis, 2 and 3 on the other.
    pub votes_by_quadrant: [u32; 4],
}

impl Candidate {
    /// The paper's "ellipse quality": the number of edge points on the contour.
    pub fn quality(&self) -> u32 {
        self.votes_by_quadrant.iter().sum()
    }

    /// Points on either side of the major axis.
    pub fn votes_by_major_side(&self) -> [u32; 2] {
        let [a, b, c, d] = self.votes_by_quadrant;
        [a + b, c + d]
    }

    /// Points on either side of the minor axis.
    pub fn votes_by_minor_side(&self) -> [u32; 2] {
        let [a, b, c, d] = self.votes_by_quadrant;
        [a + c, b + d]
    }
}

/// What a search did and found.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Search {
    /// The candidates in the order of drawing.
    pub candidates: Vec<Candidate>,
    /// Pairs that the options ask for: m = C n.
    pub pairs_wanted: usize,
    /// Pairs that were drawn in the search domain and voted on: "search point pairs" of Table 3.
    pub pairs: usize,
    /// Draws of two points, those outside the search domain included.
    pub draws: usize,
    /// Points near the pairs: at most as many votes, since not every point falls in the accumulator.
    pub votes: usize,
}

impl Search {
    /// Whether a limit ended the search before all wanted pairs were voted on.
    pub fn truncated(&self) -> bool {
        self.pairs < self.pairs_wanted
    }
}

/// Runs the search over `points` on rayon's current threads.
///
/// Candidates with fewer than `side_votes_min` votes on either side of the minor axis are left out, which ends the voting
/// of most pairs half way; [`FilterOptions::side_votes_min`](crate::paper::options::FilterOptions::side_votes_min) is the number that the filters
/// would not let pass anyway. With 0 every pair that got a vote gives a candidate.
///
/// Fewer than two points give no pairs. The same points, options and seed give the same result on any number of
/// threads. Time and memory are bounded by [`PAIRS_MAX`], [`DRAWS_PER_PAIR_MAX`],
/// [`DRAWS_MAX`] and [`VOTES_MAX`]; [`Search::truncated`] tells.
pub fn search(
    points: &[EdgePoint],
    options: &HoughOptions,
    side_votes_min: u32,
    seed: u64,
) -> Search {
    let pairs_wanted = points.len().saturating_mul(options.pairs_per_edge_point as usize);
    if points.len() < 2 || pairs_wanted == 0 {
        return Search { pairs_wanted, ..Search::default() };
    }
    let grid = PointGrid::new(points);
    let pairs = pairs_wanted.min(PAIRS_MAX);
    let batches = pairs.div_ceil(BATCH_PAIRS);
    let mut total = Search { pairs_wanted, ..Search::default() };
    for wave in (0..batches).step_by(WAVE_BATCHES) {
        if total.votes >= VOTES_MAX || total.draws >= DRAWS_MAX {
            break;
        }
        let found: Vec<Search> = (wave..batches.min(wave + WAVE_BATCHES))
            .into_par_iter()
            .map_init(
                || (options.accumulator(), Halves::default()),
                |(accumulator, halves), batch| {
                    let mut random = batch_generator(seed, batch as u64);
                    let mut found = Search::default();
                    let wanted = BATCH_PAIRS.min(pairs - batch * BATCH_PAIRS);
                    let (draws_max, votes_max) =
                        (wanted * DRAWS_PER_PAIR_MAX, VOTES_MAX / WAVE_BATCHES);
                    while found.pairs < wanted && found.draws < draws_max && found.votes < votes_max
                    {
                        found.draws += 1;
                        let (one, other) = (draw(points, &mut random), draw(points, &mut random));
                        let Some(axis) = axis_in_domain(one, other, options) else { continue };
                        found.pairs += 1;
                        grid.halves_around(axis, accumulator.reach_px(axis), halves);
                        let peak = accumulator.vote(&grid, halves, axis, side_votes_min);
                        found.votes += std::mem::take(&mut accumulator.visited);
                        found.candidates.extend(peak.map(|peak| complete(axis, peak)));
                    }
                    found
                },
            )
            .collect();
        for batch in found {
            total.candidates.extend(batch.candidates);
            total.pairs += batch.pairs;
            total.draws += batch.draws;
            total.votes += batch.votes;
        }
    }
    total
}

/// A generator for one batch: neighbouring seeds and batches are spread by the finaliser of `SplitMix64`.
fn batch_generator(seed: u64, batch: u64) -> Pcg32 {
    let spread = |value: u64| {
        let value = value.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let value = (value ^ (value >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let value = (value ^ (value >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        value ^ (value >> 31)
    };
    Pcg32::new(spread(spread(seed) ^ batch), batch)
}

/// One of `points` by the upper bits of a product: bias below 2^-32 times their number, and no division.
fn draw(points: &[EdgePoint], random: &mut Pcg32) -> EdgePoint {
    let index = (u64::from(random.next_u32()) * points.len() as u64) >> 32;
    points[index as usize]
}

/// Equations (3) to (6) for a pair whose length lies in the search domain.
fn axis_in_domain(one: EdgePoint, other: EdgePoint, options: &HoughOptions) -> Option<Axis> {
    let (x1, y1) = (f32::from(one.x), f32::from(one.y));
    let (x2, y2) = (f32::from(other.x), f32::from(other.y));
    let (half_x, half_y) = ((x2 - x1) / 2.0, (y2 - y1) / 2.0);
    let leftward = half_x < 0.0 || (half_x == 0.0 && half_y < 0.0);
    let (half_x, half_y) = if leftward { (-half_x, -half_y) } else { (half_x, half_y) };
    let a2 = half_x * half_x + half_y * half_y;
    let (least, greatest) = (options.semi_major_min_px, options.semi_major_max_px);
    (a2 >= least * least && a2 <= greatest * greatest).then_some(Axis {
        center_x: f32::midpoint(x1, x2),
        center_y: f32::midpoint(y1, y2),
        half_x,
        half_y,
    })
}

/// The candidate of a pair and the fullest bin of its accumulator.
fn complete(axis: Axis, peak: Peak) -> Candidate {
    let (half_x, half_y) = (f64::from(axis.half_x), f64::from(axis.half_y));
    let semi_major_px = half_x.hypot(half_y);
    let ellipse = Ellipse {
        center_x_px: f64::from(axis.center_x),
        center_y_px: f64::from(axis.center_y),
        semi_major_px,
        // The bin's centre may lie above a by up to half a bin.
        semi_minor_px: f64::from(peak.semi_minor_px).min(semi_major_px),
        theta_rad: half_y.atan2(half_x),
    };
    Candidate { ellipse: ellipse.canonical(), votes_by_quadrant: peak.votes_by_quadrant }
}

#[cfg(test)]
mod tests;
