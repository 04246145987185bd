//! The 1-D accumulator for the semi-minor axis: equations (7) and (8) over the points near one pair.
//!
//! With `u` and `v` the offsets of a third point from the centre along and across the major axis, `d cos t = u` and
//! `d² sin² t = v²`, so equation (7) reads `b² = a² v² / (a² - u²)`: no angle, no trigonometry. (Equation (8) is the law
//! of cosines in the triangle centre - vertex - point, where `f` is the distance from the vertex to the point.) The loop
//! computes `U = a u` and `V = a v`, which are exact in `f32` for any two pixels, and
//! `b² = V² A / ((A - U) (A + U))` with `A = a²`.
//!
//! A point votes when `b` lies in the range of the semi-minor axis and is at most `a`. `b <= a` is the same as `d <= a`,
//! the condition that the third point is no farther from the centre than the vertices; for `d > a` beyond the vertices
//! the quotient is negative, its root not a number, and no vote.
//!
//! Bin `k` is centred on `b_min + k w` (`w` the bin width), so `b` falls in the nearest bin, at exactly half way in the even
//! one. Against the formulas in exact arithmetic a vote may move to the neighbouring bin only when `b` lies within a
//! relative 1e-5 of a border. Only additions, multiplications, divisions and roots that IEEE 754 rounds exactly are
//! used: the votes are the same on every machine.

use crate::grid::{LANES, PointGrid, Run};

/// Accumulator slots a side of the major axis; two of them catch what lies outside the range.
const SIDE_SLOTS: usize = 2048;
/// Most bins that an accumulator may have.
pub(crate) const BINS_MAX: usize = SIDE_SLOTS - 2;
/// Counter copies that take turns, so that neighbours in one bin need not wait for each other's count.
const COPIES: usize = 2;
const SLOTS: usize = 2 * SIDE_SLOTS;

/// What voting needs to know of a pair: the centre and the vector from the centre to one vertex, in pixels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Axis {
    pub(crate) center_x: f32,
    pub(crate) center_y: f32,
    pub(crate) half_x: f32,
    pub(crate) half_y: f32,
}

/// The quantised accumulator for the semi-minor axis.
pub(crate) struct Accumulator {
    slots: Box<[[u32; SLOTS]; COPIES]>,
    first_px: f32,
    width_px: f32,
    bins: usize,
}

/// The fullest bin of an accumulator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Peak {
    pub(crate) semi_minor_px: f32,
    /// Votes from either side of the major axis.
    pub(crate) votes_by_side: [u32; 2],
}

impl Accumulator {
    /// `bins` is at most [`BINS_MAX`].
    pub(crate) fn new(first_px: f32, width_px: f32, bins: usize) -> Self {
        let slots = Box::new([[0; SLOTS]; COPIES]);
        Self { slots, first_px, width_px, bins: bins.min(BINS_MAX) }
    }

    /// Empties the accumulator and lets the points of `runs` vote for the ellipses on `axis`.
    pub(crate) fn vote(&mut self, grid: &PointGrid, runs: &[Run], axis: Axis) {
        for copy in self.slots.iter_mut() {
            copy[..self.bins + 2].fill(0);
            copy[SIDE_SLOTS..SIDE_SLOTS + self.bins + 2].fill(0);
        }
        for run in runs {
            let end = run.start + (run.end - run.start).next_multiple_of(LANES);
            let (xs, ys) = (&grid.xs[run.start..end], &grid.ys[run.start..end]);
            vote_run(xs, ys, axis, self.first_px, self.width_px, self.bins, &mut self.slots);
        }
    }

    /// The votes of bin `k` by side.
    fn votes(&self, bin: usize) -> [u32; 2] {
        [0, SIDE_SLOTS].map(|side| self.slots.iter().map(|copy| copy[side + bin + 1]).sum())
    }

    /// The fullest bin, of equals the one with the least semi-minor axis.
    pub(crate) fn peak(&self) -> Peak {
        let mut best = (0, 0);
        for bin in 0..self.bins {
            let [one, other] = self.votes(bin);
            if one + other > best.0 {
                best = (one + other, bin);
            }
        }
        Peak {
            semi_minor_px: self.first_px + best.1 as f32 * self.width_px,
            votes_by_side: self.votes(best.1),
        }
    }
}

/// The hot loop, whole lane groups of points at a time. Slot 0 of a side takes what is below the first bin, slot
/// `bins + 1` what is above the last or not a number.
fn vote_run(
    xs: &[f32],
    ys: &[f32],
    axis: Axis,
    first_px: f32,
    width_px: f32,
    bins: usize,
    slots: &mut [[u32; SLOTS]; COPIES],
) {
    /// Adding 2^23 to a number in `0..2^23` rounds it to an integer and leaves that in the low bits.
    const TO_INTEGER: f32 = 8_388_608.0;
    let Axis { center_x, center_y, half_x, half_y } = axis;
    let a2 = half_x * half_x + half_y * half_y;
    let per_px = 1.0 / width_px;
    let shift = 1.0 - first_px * per_px;
    let above = (bins + 1) as f32;
    for (xs, ys) in xs.chunks_exact(LANES).zip(ys.chunks_exact(LANES)) {
        let mut index = [0_u32; LANES];
        for ((index, x), y) in index.iter_mut().zip(xs).zip(ys) {
            let (dx, dy) = (x - center_x, y - center_y);
            let along = dx * half_x + dy * half_y;
            let across = dy * half_x - dx * half_y;
            let b = (across * across * a2 / ((a2 - along) * (a2 + along))).sqrt();
            let place = b * per_px + shift;
            // In this order a value that is not a number ends above.
            let place = if place < above { place } else { above };
            let place = if place > 0.0 { place } else { 0.0 };
            let side = (across.to_bits() >> 31) * SIDE_SLOTS as u32;
            *index = ((place + TO_INTEGER).to_bits() & (SIDE_SLOTS as u32 - 1)) + side;
        }
        for pair in index.chunks_exact(COPIES) {
            for (copy, &index) in slots.iter_mut().zip(pair) {
                copy[index as usize % SLOTS] += 1;
            }
        }
    }
}
