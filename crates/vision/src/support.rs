//! The edge points on a contour.

use crate::edges::EdgeMap;
use crate::shape::Shape;

/// Steps along a contour at the most.
pub(crate) const STEPS_MAX: usize = 240;
/// Distance of two steps on a contour that is not too long for it, in pixels.
const STEP_PX: f64 = 1.25;

/// What lies along a contour.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Support {
    /// Share of the contour inside the picture that has an edge, `0..=1`.
    pub(crate) share: f64,
    /// Share of the contour inside the picture.
    pub(crate) inside: f64,
    /// Mean cosine between gradient and normal.
    pub(crate) agreement: f64,
    /// Root mean square distance in pixels.
    pub(crate) residual: f64,
    /// Steps inside the picture, and those with an edge.
    pub(crate) steps: usize,
    pub(crate) hits: usize,
    /// Hits whose gradient points inwards.
    pub(crate) inward: usize,
    /// Longest stretch without an edge, as a share of the contour.
    pub(crate) gap: f64,
    /// Length of the contour inside the picture, pixels.
    pub(crate) length: f64,
}

/// A hit: the number of the point.
pub(crate) type Hit = u32;

/// No point.
const NONE: Hit = u32::MAX;

/// One step along a contour.
#[derive(Debug, Clone, Copy)]
struct Step {
    /// The point found, or none.
    hit: Hit,
    /// Length of contour that the step stands for, in pixels; 0 outside the picture.
    length: f64,
    distance: f64,
    /// Cosine between gradient and outward normal.
    cosine: f64,
    /// Whether it is near the end of a stretch, where the contour turns to something else and the smoothing has
    /// moved it: it counts, but the ellipse is not drawn to it.
    is_end: bool,
}

/// Buffers of the looking.
#[derive(Debug, Clone, Default)]
pub(crate) struct Along {
    steps: Vec<Step>,
    /// Numbers of the points found, each once in a row.
    pub(crate) hits: Vec<Hit>,
}

/// Stretches of contour shorter than this, in pixels, are dropped: by chance an edge lies along a contour for a few
/// pixels.
const STRETCH_MIN_PX: f64 = 7.0;
/// Length at either end of a longer stretch that is not trusted, in pixels.
const STRETCH_END_PX: f64 = 3.0;
/// On a small contour the least stretch is this share of it.
const STRETCH_MIN_SHARE: f64 = 0.12;

impl Along {
    /// Looks along `shape`, at `steps_max` places at the most, for edge points within `tolerance` pixels whose gradient
    /// is within the angle of `cos_min` to the normal, in either sense.
    pub(crate) fn gather(
        &mut self,
        edges: &EdgeMap,
        shape: &Shape,
        tolerance: f64,
        cos_min: f64,
        steps_max: usize,
    ) -> Support {
        let whole = pulp::Arch::new().dispatch(Walked {
            along: self,
            edges,
            shape,
            tolerance,
            cos_min,
            steps_max,
        });
        self.drop_short_stretches(STRETCH_MIN_PX.min(STRETCH_MIN_SHARE * whole));
        self.sum_up(whole)
    }

    /// Fills the steps; returns the length of the contour in pixels.
    #[inline(always)]
    fn walk(
        &mut self,
        edges: &EdgeMap,
        shape: &Shape,
        tolerance: f64,
        cos_min: f64,
        steps_max: usize,
    ) -> f64 {
        let ellipse = shape.ellipse();
        let perimeter = ellipse.perimeter_px();
        let count = ((perimeter / STEP_PX) as usize).clamp(24, steps_max);
        let (a, b) = (ellipse.semi_major_px, ellipse.semi_minor_px);
        let (sin, cos) = ellipse.theta_rad.sin_cos();
        let turn = std::f64::consts::TAU / count as f64;
        let (turn_sin, turn_cos) = turn.sin_cos();
        let (width, height) = (edges.map.width() as f64, edges.map.height() as f64);
        let reach = tolerance.ceil().min(8.0) as i32;
        let (mut along, mut across) = (1.0_f64, 0.0_f64);
        let points = &edges.points[..];
        self.steps.clear();
        let mut whole = 0.0;
        for _ in 0..count {
            let (u, v) = (a * along, b * across);
            let x = shape.x + u * cos - v * sin;
            let y = shape.y + u * sin + v * cos;
            // The normal is (b cos t, a sin t) in the ellipse's frame; its length is that of a step, too.
            let (normal_u, normal_v) = (b * along, a * across);
            let speed = (normal_u * normal_u + normal_v * normal_v).sqrt();
            let normal_x = (normal_u * cos - normal_v * sin) / speed;
            let normal_y = (normal_u * sin + normal_v * cos) / speed;
            let length = turn * speed;
            (along, across) =
                (along * turn_cos - across * turn_sin, across * turn_cos + along * turn_sin);
            whole += length;
            let mut step =
                Step { hit: NONE, length: 0.0, distance: tolerance, cosine: 0.0, is_end: false };
            if x >= 1.0 && y >= 1.0 && x <= width - 2.0 && y <= height - 2.0 {
                step.length = length;
                let mut look = |number: u32| {
                    let point = &points[number as usize];
                    let (dx, dy) = (f64::from(point.x) - x, f64::from(point.y) - y);
                    let distance = (dx * normal_x + dy * normal_y).abs();
                    let cosine = normal_x * f64::from(point.gradient_x)
                        + normal_y * f64::from(point.gradient_y);
                    if distance < step.distance && cosine.abs() > cos_min {
                        step.hit = number;
                        step.distance = distance;
                        step.cosine = cosine;
                    }
                };
                let (column, row) = ((x + 0.5) as i32, (y + 0.5) as i32);
                // Points are maxima along the axis nearer to their gradient: one a row of an upright contour, one a
                // column of a lying one.
                if normal_x.abs() > normal_y.abs() {
                    edges.map.visit_run(column, row, reach, &mut look);
                } else {
                    for line in row - reach..=row + reach {
                        if let Some(number) = edges.map.number_at(column, line) {
                            look(number);
                        }
                    }
                }
            }
            self.steps.push(step);
        }
        whole
    }

    /// Forgets the hits of stretches shorter than `least` pixels. A single step without a hit does not end a stretch.
    fn drop_short_stretches(&mut self, least: f64) {
        let count = self.steps.len();
        let is_gap = |steps: &[Step], at: usize| {
            steps[at % count].hit == NONE && steps[(at + 1) % count].hit == NONE
        };
        // Begin behind a gap, so that no stretch is cut in two.
        let Some(seam) = (0..count).find(|&at| is_gap(&self.steps, at)) else { return };
        let (mut first, mut length) = (0, 0.0);
        let mut inside = false;
        for i in 0..=count {
            let at = seam + 2 + i;
            let here = self.steps[at % count];
            let ends = i == count || (here.hit == NONE && self.steps[(at + 1) % count].hit == NONE);
            if ends {
                if inside && length < least {
                    for dropped in first..at {
                        self.steps[dropped % count].hit = NONE;
                    }
                } else if inside && length > 8.0 * STRETCH_END_PX {
                    let end = ((at - first) as f64 * STRETCH_END_PX / length).ceil() as usize;
                    for marked in (first..first + end).chain(at - end..at) {
                        self.steps[marked % count].is_end = true;
                    }
                }
                inside = false;
            } else if here.hit != NONE || inside {
                if !inside {
                    (first, length, inside) = (at, 0.0, true);
                }
                length += here.length;
            }
        }
    }

    fn sum_up(&mut self, whole: f64) -> Support {
        self.hits.clear();
        let mut support = Support::default();
        let (mut inside, mut hit) = (0.0, 0.0);
        let (mut cosines, mut squares) = (0.0, 0.0);
        let (mut gap, mut gap_max, mut gap_first) = (0.0_f64, 0.0_f64, None);
        for step in &self.steps {
            inside += step.length;
            support.steps += usize::from(step.length > 0.0);
            if step.hit == NONE {
                gap += step.length;
                continue;
            }
            gap_first.get_or_insert(gap);
            gap_max = gap_max.max(gap);
            gap = 0.0;
            hit += step.length;
            support.hits += 1;
            support.inward += usize::from(step.cosine < 0.0);
            cosines += step.cosine.abs();
            squares += step.distance * step.distance;
            if !step.is_end && self.hits.last() != Some(&step.hit) {
                self.hits.push(step.hit);
            }
        }
        let count = support.hits.max(1) as f64;
        support.agreement = cosines / count;
        support.residual = (squares / count).sqrt();
        if inside > 0.0 {
            support.gap = gap_max.max(gap + gap_first.unwrap_or(0.0)) / inside;
            support.share = hit / inside;
        }
        support.inside = inside / whole.max(1e-300);
        support.length = inside;
        support
    }
}

/// The walk along a contour, to be compiled for an instruction set.
struct Walked<'a> {
    along: &'a mut Along,
    edges: &'a EdgeMap,
    shape: &'a Shape,
    tolerance: f64,
    cos_min: f64,
    steps_max: usize,
}

impl pulp::WithSimd for Walked<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _instructions: S) -> f64 {
        let Self { along, edges, shape, tolerance, cos_min, steps_max } = self;
        along.walk(edges, shape, tolerance, cos_min, steps_max)
    }
}

#[cfg(test)]
mod tests;
