//! From arcs to candidates: arcs that are elliptic by themselves first, then pairs of what remains.
//!
//! This is the paper's search with arcs for points. Pairs are drawn within two arcs that can belong together, each pair
//! [votes](crate::vote) in a one-dimensional accumulator, and pairs whose votes agree become candidates. As in the paper
//! nothing is taken away when an ellipse is found; but an arc that an ellipse explains leads no search of its own.

use rand::RngExt;
use rand_pcg::Pcg32;

use crate::arc::{Arc, SAMPLES};
use crate::candidate::{BAND_PX, Candidate, Candidates};
use crate::edges::EdgeMap;
use crate::options::Options;
use crate::pairing::{Place, can_belong};
use crate::shape::{Point, Shape};
use crate::vote::{VOTES, vote};

/// Pairs of arcs that vote in one picture at the most.
const PAIRS_MAX: usize = 60_000;
/// Arcs that are searched at the most: those that are longest and turn most.
const ARCS_MAX: usize = 4_000;
/// Pairs of points drawn for a pair of arcs at the most.
const DRAWS: usize = 4;
/// Least votes of a pair: two thirds.
const VOTES_MIN: usize = VOTES * 2 / 3;
/// Partners of an arc that are tried: those with most votes for their length.
const PARTNERS_MAX: usize = 4;
/// Greatest root mean square distance of two arcs from the ellipse through both, in pixels.
const DEVIATION_MAX_PX: f64 = 1.2;
/// Least support of a candidate from a single arc and from a pair, as a share of the contour.
const SINGLE_SHARE_MIN: f64 = 0.2;
const PAIR_SHARE_MIN: f64 = 0.3;
/// Candidates that chance explains nearly as well are dropped.
const LOG10_FALSE_ALARMS_MAX: f64 = -2.0;
/// Score from which an ellipse explains the arcs on it.
const EXPLAINING_SCORE: f64 = 0.5;
/// Samples of an arc that have to lie on such an ellipse.
const EXPLAINED_SAMPLES: usize = SAMPLES * 3 / 4;

/// Buffers of the search.
#[derive(Debug, Clone, Default)]
pub(crate) struct Search {
    pub(crate) pairs: usize,
    pub(crate) truncated: bool,
    /// Arcs by falling weight.
    order: Vec<u32>,
    /// In that order.
    places: Vec<Place>,
    explained: Vec<bool>,
    /// Votes times length, and rank.
    partners: Vec<(u32, usize)>,
    points: Vec<Point>,
}

impl Search {
    /// Forgets the picture before.
    pub(crate) fn clear(&mut self) {
        (self.pairs, self.truncated) = (0, false);
    }

    /// Searches all arcs; what is found goes to `candidates`.
    pub(crate) fn run(
        &mut self,
        edges: &EdgeMap,
        arcs: &[Arc],
        options: &Options,
        candidates: &mut Candidates,
    ) {
        self.truncated = arcs.len() > ARCS_MAX;
        let mut order = std::mem::take(&mut self.order);
        order.clear();
        order.extend(0..arcs.len() as u32);
        let weight = |at: &u32| {
            let arc = &arcs[*at as usize];
            arc.length_px * arc.turn_rad
        };
        order.sort_unstable_by(|a, b| weight(b).total_cmp(&weight(a)).then(a.cmp(b)));
        order.truncate(ARCS_MAX);
        let ranked = Ranked { arcs, order: &order };
        self.explained.clear();
        self.explained.resize(order.len(), false);
        self.places.clear();
        self.places.extend((0..order.len()).map(|rank| Place::of(ranked.arc(rank))));

        for rank in 0..order.len() {
            if !self.explained[rank]
                && let Some(shape) = &ranked.arc(rank).shape
                && let Some(found) = candidates.near(edges, shape, options)
                && found.support.share > SINGLE_SHARE_MIN
            {
                self.keep(found, ranked, candidates);
            }
        }
        let mut random = Pcg32::new(options.seed, 0);
        for rank in 0..order.len() {
            if !self.explained[rank] && !ranked.arc(rank).is_ring {
                pulp::Arch::new().dispatch(Partnered {
                    search: self,
                    ranked,
                    rank,
                    random: &mut random,
                });
                self.try_partners(edges, ranked, rank, options, candidates);
            }
        }
        self.truncated |= candidates.truncated;
        self.order = order;
    }

    /// Lets an arc vote with every later one that can belong to the same ellipse, and notes the best.
    #[inline(always)]
    fn find_partners(&mut self, ranked: Ranked<'_>, rank: usize, random: &mut Pcg32) {
        self.partners.clear();
        let (one, here) = (ranked.arc(rank), self.places[rank]);
        for (other_rank, there) in self.places.iter().enumerate().skip(rank + 1) {
            if !here.may_face(there) || self.explained[other_rank] {
                continue;
            }
            let other = ranked.arc(other_rank);
            if !can_belong(one, other) {
                continue;
            }
            if self.pairs >= PAIRS_MAX {
                self.truncated = true;
                break;
            }
            self.pairs += 1;
            // The ends of an arc are its least certain places.
            let mut draw = || random.random_range(2..SAMPLES - 2);
            let mut votes = 0;
            for drawn in 1..=DRAWS {
                votes = votes.max(usize::from(vote(one, draw(), other, draw())));
                // Arcs of one ellipse seldom vote so badly, whatever pair is drawn.
                if votes >= VOTES_MIN || drawn == DRAWS / 2 && votes < VOTES_MIN / 2 {
                    break;
                }
            }
            if votes >= VOTES_MIN {
                let length_px = other.length_px.min(500.0) as u32;
                self.partners.push((votes as u32 * length_px, other_rank));
            }
        }
        self.partners.sort_unstable_by(|a, b| b.0.cmp(&a.0).then(a.1.cmp(&b.1)));
        self.partners.truncate(PARTNERS_MAX);
    }

    /// Makes candidates of an arc and its partners, and keeps the best.
    fn try_partners(
        &mut self,
        edges: &EdgeMap,
        ranked: Ranked<'_>,
        rank: usize,
        options: &Options,
        candidates: &mut Candidates,
    ) {
        let mut best: Option<Candidate> = None;
        for at in 0..self.partners.len() {
            let arcs = [ranked.arc(rank), ranked.arc(self.partners[at].1)];
            let samples = arcs.iter().flat_map(|arc| arc.x.iter().zip(&arc.y));
            self.points.clear();
            self.points.extend(samples.map(|(x, y)| (f64::from(*x), f64::from(*y))));
            let Some(shape) = Shape::fit_conic(&self.points) else { continue };
            let Some(shape) = shape.fit_distance(&self.points, 4) else { continue };
            if shape.deviation(&self.points).0 > DEVIATION_MAX_PX {
                continue;
            }
            if let Some(found) = candidates.near(edges, &shape, options)
                && found.support.share > PAIR_SHARE_MIN
                && best.as_ref().is_none_or(|best| found.score > best.score)
            {
                best = Some(found);
            }
        }
        if let Some(best) = best {
            self.keep(best, ranked, candidates);
        }
    }

    /// Keeps a candidate, and marks the arcs that it explains.
    fn keep(&mut self, found: Candidate, ranked: Ranked<'_>, candidates: &mut Candidates) {
        if found.evidence.log10_false_alarms >= LOG10_FALSE_ALARMS_MAX {
            return;
        }
        if found.score > EXPLAINING_SCORE {
            let reach_px = found.shape.ellipse().semi_major_px + 2.0;
            let is_on = |arc: &Arc, i: usize| {
                let (x, y) = (f64::from(arc.x[i]), f64::from(arc.y[i]));
                found.shape.distance(x, y).0.abs() < BAND_PX
            };
            for (rank, explained) in self.explained.iter_mut().enumerate() {
                let arc = ranked.arc(rank);
                let (dx, dy) = (
                    f64::from(arc.x[SAMPLES / 2]) - found.shape.x,
                    f64::from(arc.y[SAMPLES / 2]) - found.shape.y,
                );
                if !*explained && dx.abs() < reach_px && dy.abs() < reach_px {
                    let samples = (0..SAMPLES).filter(|&i| is_on(arc, i)).count();
                    *explained = samples >= EXPLAINED_SAMPLES;
                }
            }
        }
        candidates.all.push(found);
    }
}

/// The search for partners, to be compiled for an instruction set.
struct Partnered<'a> {
    search: &'a mut Search,
    ranked: Ranked<'a>,
    rank: usize,
    random: &'a mut Pcg32,
}

impl pulp::WithSimd for Partnered<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _instructions: S) {
        self.search.find_partners(self.ranked, self.rank, self.random);
    }
}

/// The arcs by rank.
#[derive(Clone, Copy)]
struct Ranked<'a> {
    arcs: &'a [Arc],
    order: &'a [u32],
}

impl<'a> Ranked<'a> {
    #[inline(always)]
    fn arc(self, rank: usize) -> &'a Arc {
        &self.arcs[self.order[rank] as usize]
    }
}
