//! A pair of contour points votes: the paper's one-dimensional accumulator, for pairs that need not be vertices.
//!
//! The paper takes two points for the ends of the major axis, which leaves one parameter to vote for. With the tangents at
//! two points known, any two will do: every conic that touches the lines `l1 = 0` and `l2 = 0` at them is a member of
//! the pencil `l1 l2 = k m²`, where `m = 0` is the line through both (the double contact theorem; J. G. Semple and G. T.
//! Kneebone, "Algebraic Projective Geometry", 1952). A third point gives `k = l1 l2 / m²`: one value, one vote, in an
//! accumulator quantised in the logarithm of `k`, whose square root is the ratio of the ellipse's extents along and
//! across the line. The fullest window of bins tells how many of the points agree.

use crate::arc::{Arc, SAMPLES};

/// Bins of the accumulator.
const BINS: usize = 64;
/// Bins for a factor of two in `k`.
const BINS_PER_OCTAVE: f32 = 5.0;
/// Neighbouring bins that count together.
const WINDOW: usize = 3;
/// Samples on either side of the pair's own that do not vote: so near, the quotient is mostly noise.
const BLIND: usize = 1;
/// Votes that two arcs have, when no sample of the pair is at an end.
pub(crate) const VOTES: usize = 2 * (SAMPLES - 1 - 2 * BLIND);

/// Lets the samples of two arcs vote for the conics that touch them at sample `from` of the one and `to` of the other;
/// returns the votes of the fullest window.
#[inline(always)]
pub(crate) fn vote(one: &Arc, from: usize, other: &Arc, to: usize) -> u8 {
    let (px, py, qx, qy) = (one.x[from], one.y[from], other.x[to], other.y[to]);
    let (chord_x, chord_y) = (qx - px, qy - py);
    let length2 = chord_x * chord_x + chord_y * chord_y;
    if length2 < 16.0 {
        return 0;
    }
    let pair = Pair {
        p: (px, py),
        q: (qx, qy),
        p_normal: (one.inside_x[from], one.inside_y[from]),
        q_normal: (other.inside_x[to], other.inside_y[to]),
        chord: (chord_x, chord_y),
        length2,
    };
    let mut counts = [0_u8; BINS + WINDOW];
    pair.cast(one, from, &mut counts);
    pair.cast(other, to, &mut counts);
    // Bin 0 takes what lies outside the range, and is not looked at.
    let mut fullest = 0;
    for at in 1..BINS {
        fullest = fullest.max(counts[at] + counts[at + 1] + counts[at + 2]);
    }
    fullest
}

/// The pencil of conics that touch two lines at two points.
struct Pair {
    p: (f32, f32),
    q: (f32, f32),
    p_normal: (f32, f32),
    q_normal: (f32, f32),
    chord: (f32, f32),
    length2: f32,
}

impl Pair {
    /// The samples of `arc` vote, but for those next to `own`.
    #[inline(always)]
    fn cast(&self, arc: &Arc, own: usize, counts: &mut [u8; BINS + WINDOW]) {
        let mut bins = [0_u8; SAMPLES];
        for (at, bin) in bins.iter_mut().enumerate() {
            let (dx, dy) = (arc.x[at] - self.p.0, arc.y[at] - self.p.1);
            let l1 = dx * self.p_normal.0 + dy * self.p_normal.1;
            let l2 =
                (arc.x[at] - self.q.0) * self.q_normal.0 + (arc.y[at] - self.q.1) * self.q_normal.1;
            let m = dy * self.chord.0 - dx * self.chord.1;
            let k = l1 * l2 * self.length2 / (m * m);
            let place = log2(k) * BINS_PER_OCTAVE + BINS as f32 / 2.0;
            // Not a number where k is negative or 0 / 0.
            let is_inside = k > 0.0 && place >= 1.0 && place < BINS as f32;
            *bin = if is_inside { place as u8 } else { 0 };
        }
        for (at, &bin) in bins.iter().enumerate() {
            if at.abs_diff(own) > BLIND {
                counts[usize::from(bin) % BINS] += 1;
            }
        }
    }
}

/// Binary logarithm to about 0.1: exponent and mantissa taken as a line.
#[inline(always)]
fn log2(value: f32) -> f32 {
    value.to_bits() as f32 * (1.0 / 8_388_608.0) - 127.0
}
