//! The 1-D accumulator for the semi-minor axis: equations (7) and (8) over the points near one pair.
//!
//! With `u` and `v` the offsets of a third point from the centre along and across the major axis, `d cos t = u` and
//! `d² sin² t = v²`, so equation (7) reads `b² = a² v² / (a² - u²)`: no angle, no trigonometry. (Equation (8) is the law
//! of cosines in the triangle centre - vertex - point, where `f` is the distance from the vertex to the point.) The loop
//! computes `U = a u` and `V = a v`, which are exact in `f32` for any two pixels, and
//! `b² = V² A / ((A - U) (A + U))` with `A = a²`.
//!
//! A point votes when `b` lies in the range of the semi-minor axis and is not greater than `a`, where `b <= a` is asked for in
//! whole bins: up to the end of the bin that holds `a`. (Asked for exactly it would cut the contour of a circle in half along
//! its length, and circles would be the hardest ellipses to find.) Beyond the vertices the quotient is negative
//! and its root not a number, which is no vote.
//!
//! Bin `k` holds `b` from `b_min + k w` to `b_min + (k + 1) w` (`w` the bin width) and stands for its middle. Against
//! the formulas in exact arithmetic a vote may move to the neighbouring bin only when `b` lies within a relative 1e-5 of
//! a border. Only additions, multiplications, divisions and roots that IEEE 754 rounds exactly are
//! used: the votes are the same on every machine.

use std::ops::Range;

use crate::paper::grid::{Halves, LANES, PointGrid};

/// Most slots a quadrant of the ellipse: its bins, and one slot on either side for what lies outside the range.
const QUADRANT_SLOTS_MAX: usize = 1024;
/// Most bins that an accumulator may have.
pub(crate) const BINS_MAX: usize = QUADRANT_SLOTS_MAX - 2;
/// Slots that are gathered before they are counted.
const GATHERED_MAX: usize = 2048;
/// Counter copies that take turns, so that neighbours in one bin need not wait for each other's count.
const COPIES: usize = 2;
const SLOTS: usize = 4 * QUADRANT_SLOTS_MAX;

/// What voting needs to know of a pair: the centre and the vector from the centre to one vertex, in pixels. Of the two
/// vertices the right one is taken (of an upright pair the lower one), so `half_x >= 0`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Axis {
    pub(crate) center_x: f32,
    pub(crate) center_y: f32,
    pub(crate) half_x: f32,
    pub(crate) half_y: f32,
}

/// The quantised accumulator for the semi-minor axis.
pub(crate) struct Accumulator {
    counts: Vec<[u32; SLOTS]>,
    /// Slots found and not yet counted.
    gathered: Vec<u32>,
    first_px: f32,
    width_px: f32,
    bins: usize,
    /// Slots of a quadrant, as a power of two.
    quadrant_bits: u32,
    /// The instruction set that voting uses.
    instructions: pulp::Arch,
    /// Points visited since the accumulator was made.
    pub(crate) visited: usize,
}

/// The fullest bin of an accumulator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Peak {
    pub(crate) semi_minor_px: f32,
    /// Votes by quadrant; bit 0 of the index is set before the centre along the axis, bit 1 on its left.
    pub(crate) votes_by_quadrant: [u32; 4],
}

impl Accumulator {
    /// `bins` is at most [`BINS_MAX`].
    pub(crate) fn new(first_px: f32, width_px: f32, bins: usize) -> Self {
        let bins = bins.min(BINS_MAX);
        let quadrant_bits = (bins + 2).next_power_of_two().ilog2();
        let (counts, gathered) = (vec![[0; SLOTS]; COPIES], vec![0; GATHERED_MAX]);
        Self {
            counts,
            gathered,
            first_px,
            width_px,
            bins,
            quadrant_bits,
            instructions: pulp::Arch::new(),
            visited: 0,
        }
    }

    /// What `b` has to stay below in order to vote for an ellipse with semi-major axis `a_px`: the end of the bin that holds `a_px`, or of the
    /// last bin.
    fn limit_px(&self, a_px: f32) -> f32 {
        let bins = ((a_px - self.first_px) / self.width_px).floor() + 1.0;
        self.first_px + bins.min(self.bins as f32) * self.width_px
    }

    /// How far from the centre points may vote for the ellipses on `axis`, in pixels: `a`, or the greatest `b` for a circle.
    pub(crate) fn reach_px(&self, axis: Axis) -> f32 {
        let a_px = (axis.half_x * axis.half_x + axis.half_y * axis.half_y).sqrt();
        a_px.max(self.limit_px(a_px))
    }

    /// Empties the accumulator, lets the points of `halves` vote for the ellipses on `axis`, and returns the fullest bin
    /// (of equals the one with the least semi-minor axis) if it has `side_votes_min` votes or more on both sides of the
    /// minor axis. The voting ends half way when no bin can reach that.
    pub(crate) fn vote(
        &mut self,
        grid: &PointGrid,
        halves: &Halves,
        axis: Axis,
        side_votes_min: u32,
    ) -> Option<Peak> {
        if (halves.first_len() as u64) < u64::from(side_votes_min) {
            return None;
        }
        for copy in &mut self.counts {
            copy[..4 << self.quadrant_bits].fill(0);
        }
        self.vote_runs(grid, halves.first(), axis);
        if self.fullest_side(usize::from(halves.first_is_back())) < side_votes_min {
            return None;
        }
        self.vote_runs(grid, halves.rest(), axis);
        let peak = self.peak();
        let [a, b, c, d] = peak.votes_by_quadrant;
        (a + c >= side_votes_min && b + d >= side_votes_min && a + b + c + d > 0).then_some(peak)
    }

    fn vote_runs(
        &mut self,
        grid: &PointGrid,
        runs: impl Iterator<Item = Range<usize>>,
        axis: Axis,
    ) {
        // Compiled for several instruction sets; the one of this machine is taken. Nothing is rounded otherwise.
        self.instructions.dispatch(VotedRuns { accumulator: self, grid, runs, axis });
    }

    #[inline(always)]
    fn vote_runs_here(
        &mut self,
        grid: &PointGrid,
        runs: impl Iterator<Item = Range<usize>>,
        axis: Axis,
    ) {
        let scale = Scale::new(axis, self);
        // Runs are short; their slots are gathered so that the counting is one long loop.
        let mut gathered = 0;
        for mut run in runs {
            while !run.is_empty() {
                if gathered + LANES > GATHERED_MAX {
                    count(&self.gathered[..gathered], &mut self.counts);
                    gathered = 0;
                }
                let room = (GATHERED_MAX - gathered) / LANES * LANES;
                let len = run.len().min(room);
                // Read on to the end of a lane group; what is too much is overwritten by the next run.
                let read = len.next_multiple_of(LANES);
                let (xs, ys) = (&grid.xs[run.start..][..read], &grid.ys[run.start..][..read]);
                find_slots(xs, ys, scale, &mut self.gathered[gathered..gathered + read]);
                gathered += len;
                run.start += len;
                self.visited += len;
            }
        }
        count(&self.gathered[..gathered], &mut self.counts);
    }

    /// The votes of a bin by quadrant.
    fn votes(&self, bin: usize) -> [u32; 4] {
        [0, 1, 2, 3].map(|quadrant| {
            self.counts.iter().map(|copy| copy[(quadrant << self.quadrant_bits) + bin + 1]).sum()
        })
    }

    /// The bins of a quadrant, as one of the copies counted them.
    fn bins_of(&self, copy: usize, quadrant: usize) -> &[u32] {
        &self.counts[copy][(quadrant << self.quadrant_bits) + 1..][..self.bins]
    }

    /// Most votes that a bin has on one side of the minor axis: in quadrants `side` and `side + 2`.
    fn fullest_side(&self, side: usize) -> u32 {
        let [a, b, c, d] = [(0, side), (1, side), (0, side + 2), (1, side + 2)]
            .map(|(copy, quadrant)| self.bins_of(copy, quadrant));
        a.iter().zip(b).zip(c).zip(d).map(|(((a, b), c), d)| a + b + c + d).max().unwrap_or(0)
    }

    fn peak(&self) -> Peak {
        let mut best = (0_u32, 0_usize);
        for bin in 0..self.bins {
            let votes = self.votes(bin).iter().sum();
            if votes > best.0 {
                best = (votes, bin);
            }
        }
        Peak {
            semi_minor_px: self.first_px + (best.1 as f32 + 0.5) * self.width_px,
            votes_by_quadrant: self.votes(best.1),
        }
    }
}

/// The voting, to be compiled for an instruction set.
struct VotedRuns<'a, I> {
    accumulator: &'a mut Accumulator,
    grid: &'a PointGrid,
    runs: I,
    axis: Axis,
}

impl<I: Iterator<Item = Range<usize>>> pulp::WithSimd for VotedRuns<'_, I> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _instructions: S) {
        self.accumulator.vote_runs_here(self.grid, self.runs, self.axis);
    }
}

/// What the hot loop holds in registers.
#[derive(Debug, Clone, Copy)]
struct Scale {
    axis: Axis,
    /// a².
    a2: f32,
    /// a² in squares of bin widths.
    a2_bins: f32,
    /// From `b` in bin widths to slots.
    shift: f32,
    /// Greatest `b` that votes, in bin widths.
    limit_bins: f32,
    quadrant_bits: u32,
}

impl Scale {
    fn new(axis: Axis, accumulator: &Accumulator) -> Self {
        let per_px = 1.0 / accumulator.width_px;
        let a2 = axis.half_x * axis.half_x + axis.half_y * axis.half_y;
        Self {
            axis,
            a2,
            a2_bins: a2 * per_px * per_px,
            // Slots are rounded to, so half a slot below the lower border of bin 0, which is slot 1.
            shift: 0.5 - accumulator.first_px * per_px,
            limit_bins: accumulator.limit_px(a2.sqrt()) * per_px,
            quadrant_bits: accumulator.quadrant_bits,
        }
    }

    /// The slot of a point: 0 of its quadrant when it does not vote, else the number of its bin and 1.
    #[inline(always)]
    fn slot(&self, x: f32, y: f32) -> u32 {
        /// Adding 2^23 to a number in `0..2^23` rounds it to an integer and leaves that in the low bits.
        const TO_INTEGER: f32 = 8_388_608.0;
        let Axis { center_x, center_y, half_x, half_y } = self.axis;
        let (dx, dy) = (x - center_x, y - center_y);
        let along = dx * half_x + dy * half_y;
        let across = dy * half_x - dx * half_y;
        let b_bins =
            (across * across * self.a2_bins / ((self.a2 - along) * (self.a2 + along))).sqrt();
        let place = b_bins + self.shift;
        // The limit is the end of a bin and belongs to the next one. A value that is not a number is below nothing.
        let place = if b_bins < self.limit_bins { place } else { 0.0 };
        let place = if place > 0.0 { place } else { 0.0 };
        let quadrant = ((across.to_bits() >> 31) << 1) | (along.to_bits() >> 31);
        ((place + TO_INTEGER).to_bits() & (QUADRANT_SLOTS_MAX as u32 - 1))
            | (quadrant << self.quadrant_bits)
    }
}

/// The hot loop: the slots of a run of points. Its body has no branch, so the compiler takes several points at a time.
#[inline(always)]
fn find_slots(xs: &[f32], ys: &[f32], scale: Scale, slots: &mut [u32]) {
    for ((slot, &x), &y) in slots.iter_mut().zip(xs).zip(ys) {
        *slot = scale.slot(x, y);
    }
}

/// Counts one vote for each of `slots`. The copies take turns.
#[inline(always)]
fn count(slots: &[u32], counts: &mut [[u32; SLOTS]]) {
    let [first, second] = counts else { return };
    let (pairs, last) = slots.as_chunks::<COPIES>();
    for [one, other] in pairs {
        first[*one as usize % SLOTS] += 1;
        second[*other as usize % SLOTS] += 1;
    }
    for &slot in last {
        first[slot as usize % SLOTS] += 1;
    }
}

#[cfg(test)]
mod tests;
