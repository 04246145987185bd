//! Edge points linked to chains, one pixel wide, with the bright side on one hand all along.
//!
//! Every point looks for its successor: the nearest point ahead, at right angles to the gradient, whose gradient points
//! nearly the same way. A point that two would follow keeps the nearer one. What remains are open chains and rings
//! (Grompone von Gioi and Randall 2017, as in [`edges`](crate::edges)).

use std::ops::Range;

use crate::edges::{EdgeMap, EdgePoint};

/// No point.
const NONE: u32 = u32::MAX;
/// Least cosine between the gradients of neighbours.
const AGREEMENT_MIN: f32 = 0.5;
/// The same across a gap of a pixel.
const GAP_AGREEMENT_MIN: f32 = 0.8;
/// Sine from which a direction goes down so steeply that no successor lies in a row above.
const STEEP: f32 = 0.85;
/// Chains with fewer points are left out.
const POINTS_MIN: usize = 8;

/// A run of [`Chains::points`].
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Chain {
    pub(crate) range: Range<usize>,
    /// Whether the last point is followed by the first.
    pub(crate) is_ring: bool,
}

/// The chains of a picture.
#[derive(Debug, Clone, Default)]
pub(crate) struct Chains {
    /// Points chain by chain, in the order of travel, the gradient on the same hand.
    pub(crate) points: Vec<EdgePoint>,
    pub(crate) all: Vec<Chain>,
    next: Vec<u32>,
    previous: Vec<u32>,
}

impl Chains {
    /// Forgets the picture before.
    pub(crate) fn clear(&mut self) {
        self.points.clear();
        self.all.clear();
    }

    /// Links the points of `edges`, in place of those of the picture before.
    pub(crate) fn link(&mut self, edges: &EdgeMap) {
        let count = edges.points.len();
        for links in [&mut self.next, &mut self.previous] {
            links.clear();
            links.resize(count, NONE);
        }
        pulp::Arch::new().dispatch(Linked { chains: self, edges });
        self.collect(edges);
    }

    #[inline(always)]
    fn link_all(&mut self, edges: &EdgeMap) {
        let mut number = 0_u32;
        for y in 0..edges.map.height() {
            for (word_at, &word) in edges.map.row(y).iter().enumerate() {
                let mut bits = word;
                while bits != 0 {
                    let x = word_at as i32 * 64 + bits.trailing_zeros() as i32;
                    bits &= bits - 1;
                    self.link_point(edges, number, x, y as i32);
                    number += 1;
                }
            }
        }
    }

    #[inline(always)]
    fn link_point(&mut self, edges: &EdgeMap, number: u32, x: i32, y: i32) {
        let points = &edges.points[..];
        let here = points[number as usize];
        // Downward part of the direction of travel: rows behind need no look.
        let down = here.gradient_x;
        let mut best = (f32::INFINITY, NONE);
        let mut look = |other: u32| {
            let there = points[other as usize];
            let step = Step::between(&here, &there);
            if step.ahead > 0.0 && step.agreement > AGREEMENT_MIN && step.distance2 < best.0 {
                best = (step.distance2, other);
            }
        };
        let rows = (y - i32::from(down < STEEP))..=(y + i32::from(down > -STEEP));
        for row in rows {
            edges.map.visit_run(x, row, 1, &mut look);
        }
        if best.1 == NONE {
            let mut look = |other: u32| {
                let there = points[other as usize];
                let step = Step::between(&here, &there);
                // Across a gap a point has to lie well ahead, within 45 degrees.
                let is_ahead = step.ahead > 0.0 && step.ahead * step.ahead > 0.5 * step.distance2;
                if is_ahead && step.agreement > GAP_AGREEMENT_MIN && step.distance2 < best.0 {
                    best = (step.distance2, other);
                }
            };
            let rows = (y - 2 * i32::from(down < STEEP))..=(y + 2 * i32::from(down > -STEEP));
            for row in rows {
                edges.map.visit_run(x, row, 2, &mut look);
            }
        }
        let (distance2, successor) = best;
        if successor == NONE {
            return;
        }
        let rival = self.previous[successor as usize];
        if rival != NONE {
            let rival_point = points[rival as usize];
            let there = points[successor as usize];
            let rival2 = (there.x - rival_point.x).powi(2) + (there.y - rival_point.y).powi(2);
            if rival2 <= distance2 {
                return;
            }
            self.next[rival as usize] = NONE;
        }
        self.next[number as usize] = successor;
        self.previous[successor as usize] = number;
    }

    /// Follows the links: open chains from their first points, then rings.
    fn collect(&mut self, edges: &EdgeMap) {
        self.clear();
        for start in 0..edges.points.len() {
            if self.previous[start] == NONE {
                self.follow(edges, start, false);
            }
        }
        for start in 0..edges.points.len() {
            if self.next[start] != NONE {
                self.follow(edges, start, true);
            }
        }
    }

    /// Takes the chain from `start` and its links.
    fn follow(&mut self, edges: &EdgeMap, start: usize, is_ring: bool) {
        let first = self.points.len();
        let mut at = start;
        loop {
            self.points.push(edges.points[at]);
            let next = std::mem::replace(&mut self.next[at], NONE);
            if next == NONE || next as usize == start {
                break;
            }
            at = next as usize;
        }
        if self.points.len() - first < POINTS_MIN {
            self.points.truncate(first);
        } else {
            self.all.push(Chain { range: first..self.points.len(), is_ring });
        }
    }
}

/// From a point to one that may follow.
struct Step {
    /// How far ahead it lies, in pixels.
    ahead: f32,
    /// Cosine between the gradients.
    agreement: f32,
    distance2: f32,
}

impl Step {
    #[inline(always)]
    fn between(here: &EdgePoint, there: &EdgePoint) -> Self {
        let (dx, dy) = (there.x - here.x, there.y - here.y);
        Self {
            ahead: dy * here.gradient_x - dx * here.gradient_y,
            agreement: here.gradient_x * there.gradient_x + here.gradient_y * there.gradient_y,
            distance2: dx * dx + dy * dy,
        }
    }
}

/// The linking, to be compiled for an instruction set.
struct Linked<'a> {
    chains: &'a mut Chains,
    edges: &'a EdgeMap,
}

impl pulp::WithSimd for Linked<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _instructions: S) {
        self.chains.link_all(self.edges);
    }
}
