//! A pair of contour points votes: the paper's one-dimensional accumulator, for pairs that need not be vertices.
//!
//! The paper takes two points for the ends of the major axis, which leaves one parameter to vote for. With the tangents at
//! two points known, any two will do: every conic that touches the lines `l1 = 0` and `l2 = 0` at them is a member of
//! the pencil `l1 l2 = k m²`, where `m = 0` is the line through both (the double contact theorem; J. G. Semple and G. T.
//! Kneebone, "Algebraic Projective Geometry", 1952). A third point gives `k = l1 l2 / m²`: one value, one vote, in an
//! accumulator quantised in the logarithm of `k`, whose square root is the ratio of the ellipse's extents along and
//! across the line. The fullest window of bins tells how many of the points agree.

use crate::arc::{Arc, SAMPLES};
use crate::edges::EdgePoint;

/// Bins of the accumulator.
const BINS: usize = 128;
/// Bins for a factor of two in `k`.
const BINS_PER_OCTAVE: f32 = 5.0;
/// Neighbouring bins that count together: 1 + 2 * this.
const WINDOW: usize = 1;

/// The accumulator.
#[derive(Debug, Clone)]
pub(crate) struct Accumulator {
    counts: [u8; BINS],
}

impl Default for Accumulator {
    fn default() -> Self {
        Self { counts: [0; BINS] }
    }
}

impl Accumulator {
    /// Lets the samples of two arcs vote for the conics that touch them at sample `from` of the one and `to` of the other;
    /// returns the votes of the fullest window.
    pub(crate) fn vote(&mut self, one: &Arc, from: usize, other: &Arc, to: usize) -> u32 {
        let (p, q) = (&one.samples[from], &other.samples[to]);
        let (n1x, n1y) = normal(one, from);
        let (n2x, n2y) = normal(other, to);
        let (cx, cy) = (q.x - p.x, q.y - p.y);
        let length = cx.hypot(cy);
        if length < 4.0 {
            return 0;
        }
        let (mx, my) = (-cy / length, cx / length);
        self.counts.fill(0);
        let mut vote = |point: &EdgePoint| {
            let (dx, dy) = (point.x - p.x, point.y - p.y);
            let l1 = dx * n1x + dy * n1y;
            let l2 = (point.x - q.x) * n2x + (point.y - q.y) * n2y;
            let m = dx * mx + dy * my;
            let k = l1 * l2 / (m * m);
            if k > 0.0 && k < f32::MAX {
                let bin = log2(k) * BINS_PER_OCTAVE + BINS as f32 / 2.0;
                let bin = (bin.max(0.0) as usize).min(BINS - 1);
                self.counts[bin] += 1;
            }
        };
        for at in (0..SAMPLES).filter(|&at| at.abs_diff(from) > 1) {
            vote(&one.samples[at]);
        }
        for at in (0..SAMPLES).filter(|&at| at.abs_diff(to) > 1) {
            vote(&other.samples[at]);
        }
        self.counts
            .windows(2 * WINDOW + 1)
            .map(|window| window.iter().map(|&count| u32::from(count)).sum())
            .max()
            .unwrap_or(0)
    }
}

/// Unit normal at a sample towards the inside, from the chord of its neighbours, which is quieter than the gradient.
fn normal(arc: &Arc, at: usize) -> (f32, f32) {
    let (a, b) = (&arc.samples[at - 2], &arc.samples[at + 2]);
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    let length = dx.hypot(dy).max(1e-6);
    let (nx, ny) = (-dy / length, dx / length);
    let (ix, iy) = arc.inside(&arc.samples[at]);
    let sign = (nx * ix + ny * iy).signum();
    (nx * sign, ny * sign)
}

/// Binary logarithm to about 0.1: exponent and mantissa taken as a line.
#[inline(always)]
fn log2(value: f32) -> f32 {
    let bits = value.to_bits();
    (bits as f32) * (1.0 / 8_388_608.0) - 127.0
}

#[cfg(test)]
mod tests;
