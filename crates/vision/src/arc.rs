//! Chains cut to elliptic arcs.
//!
//! A polygon that stays within a tolerance of the chain (Ramer 1972; Douglas and Peucker 1973) shows its turns. An arc
//! goes on as long as the turns go the same way, none is a corner, and neighbouring sides are of comparable length;
//! then an ellipse has to pass through it, or it is cut further.

use std::ops::Range;

use crate::chain::Chains;
use crate::edges::EdgePoint;
use crate::shape::{Point, Shape};

/// Greatest distance of a chain from its polygon, in pixels.
const TOLERANCE_PX: f32 = 0.8;
/// Greatest turn between two sides, as a cosine: 75 degrees.
const CORNER_COS: f32 = 0.26;
/// Greatest ratio of the lengths of neighbouring sides.
const SIDE_RATIO_MAX: f32 = 6.0;
/// Least length of an arc in pixels.
const LENGTH_MIN_PX: f32 = 10.0;
/// Least turn of an arc, radians.
const TURN_MIN_RAD: f32 = 0.25;
/// Turn from which an arc must be elliptic by itself, radians.
const TURN_FITTED_RAD: f32 = 1.0;
/// Points of an arc that stand for it.
pub(crate) const SAMPLES: usize = 12;

/// A piece of a contour that turns one way.
#[derive(Debug, Clone)]
pub(crate) struct Arc {
    /// Points at equal steps of the count, first and last included.
    pub(crate) x: [f32; SAMPLES],
    pub(crate) y: [f32; SAMPLES],
    /// Unit normals there towards the inside, from the chords between neighbours, which are quieter than gradients.
    pub(crate) inside_x: [f32; SAMPLES],
    pub(crate) inside_y: [f32; SAMPLES],
    /// Sum of its turns, radians.
    pub(crate) turn_rad: f32,
    /// Length of its polygon, pixels.
    pub(crate) length_px: f32,
    /// Whether it closes to a ring.
    pub(crate) is_ring: bool,
    /// The ellipse through it, for arcs that turn enough to tell.
    pub(crate) shape: Option<Shape>,
}

/// Buffers of the cutting.
#[derive(Debug, Clone, Default)]
pub(crate) struct Arcs {
    pub(crate) all: Vec<Arc>,
    vertices: Vec<usize>,
    stack: Vec<(usize, usize)>,
    turns: Vec<f32>,
    points: Vec<Point>,
}

impl Arcs {
    /// Cuts every chain, in place of the arcs of the picture before.
    pub(crate) fn cut(&mut self, chains: &mut Chains) {
        self.all.clear();
        for at in 0..chains.all.len() {
            let chain = chains.all[at].clone();
            let range = chain.range.clone();
            // A short chain may be a small ellipse, of which a coarse polygon leaves a triangle.
            let small = TOLERANCE_PX.min(0.25 + range.len() as f32 / 120.0);
            if chain.is_ring {
                self.cut_ring(&mut chains.points, range, small);
            } else {
                self.polygon(&chains.points, range, small);
                self.cut_open(&chains.points);
            }
        }
    }

    /// The vertices of the polygon along an open run of points.
    fn polygon(&mut self, points: &[EdgePoint], range: Range<usize>, tolerance_px: f32) {
        self.vertices.clear();
        self.stack.clear();
        let (mut first, mut last) = (range.start, range.end - 1);
        self.vertices.push(first);
        loop {
            let (a, b) = (points[first], points[last]);
            let (dx, dy) = (b.x - a.x, b.y - a.y);
            let length2 = dx * dx + dy * dy;
            let mut farthest = (0.0_f32, first);
            if length2 > 1e-6 {
                for (at, point) in points[first..=last].iter().enumerate() {
                    let offset = ((point.x - a.x) * dy - (point.y - a.y) * dx).abs();
                    if offset > farthest.0 {
                        farthest = (offset, first + at);
                    }
                }
                farthest.0 /= length2.sqrt();
            } else {
                for (at, point) in points[first..=last].iter().enumerate() {
                    let offset = (point.x - a.x).hypot(point.y - a.y);
                    if offset > farthest.0 {
                        farthest = (offset, first + at);
                    }
                }
            }
            if farthest.0 > tolerance_px {
                self.stack.push((farthest.1, last));
                last = farthest.1;
            } else {
                self.vertices.push(last);
                match self.stack.pop() {
                    Some(next) => (first, last) = next,
                    None => break,
                }
            }
        }
    }

    /// Cuts a ring: it is turned so that it begins at a corner, if it has one.
    fn cut_ring(&mut self, points: &mut [EdgePoint], range: Range<usize>, tolerance_px: f32) {
        if let Some(shape) = self.fit(points, range.clone()) {
            let turn_rad = turn_sign(&points[range.clone()]) * std::f32::consts::TAU;
            self.push(points, range, turn_rad, true, Some(shape));
            return;
        }
        self.polygon(points, range.clone(), tolerance_px);
        // The sharpest turn becomes the seam.
        let mut seam = (2.0, 0);
        for window in self.vertices.windows(3) {
            let (_, cos) = turn(points[window[0]], points[window[1]], points[window[2]]);
            if cos < seam.0 {
                seam = (cos, window[1]);
            }
        }
        if seam.1 > range.start {
            points[range.clone()].rotate_left(seam.1 - range.start);
            self.polygon(points, range, tolerance_px);
        }
        self.cut_open(points);
    }

    /// Cuts the polygon at hand.
    fn cut_open(&mut self, points: &[EdgePoint]) {
        let vertices = std::mem::take(&mut self.vertices);
        let side = |at: usize| {
            let (a, b) = (points[vertices[at]], points[vertices[at + 1]]);
            ((b.x - a.x).powi(2) + (b.y - a.y).powi(2)).sqrt()
        };
        self.turns.clear();
        self.turns.push(0.0);
        for window in vertices.windows(3) {
            let (sin, cos) = turn(points[window[0]], points[window[1]], points[window[2]]);
            self.turns.push(if cos < CORNER_COS { f32::NAN } else { sin.atan2(cos) });
        }
        // An arc covers the sides from `first` to `last` (vertex numbers).
        let sides = vertices.len() - 1;
        let mut first = 0;
        while first < sides {
            let mut last = first + 1;
            let mut sign = 0.0;
            let mut total = 0.0;
            while last < sides {
                let here = self.turns[last];
                let ratio = side(last) / side(last - 1).max(0.1);
                if here.is_nan()
                    || here * sign < 0.0
                    || !(1.0 / SIDE_RATIO_MAX..=SIDE_RATIO_MAX).contains(&ratio)
                {
                    break;
                }
                sign = here;
                total += here;
                last += 1;
            }
            self.keep(points, &vertices[first..=last], total);
            first = last;
        }
        self.vertices = vertices;
    }

    /// Keeps a run of vertices as one arc, or as several where no ellipse passes through all of it.
    fn keep(&mut self, points: &[EdgePoint], vertices: &[usize], turn_rad: f32) {
        let (Some(&start), Some(&end)) = (vertices.first(), vertices.last()) else { return };
        if vertices.len() < 3 || turn_rad.abs() < TURN_MIN_RAD || end - start < 8 {
            return;
        }
        if turn_rad.abs() < TURN_FITTED_RAD {
            self.push(points, start..end + 1, turn_rad, false, None);
            return;
        }
        if let Some(shape) = self.fit(points, start..end + 1) {
            self.push(points, start..end + 1, turn_rad, false, Some(shape));
            return;
        }
        // The longest run from the front that is elliptic, then the rest.
        let mut from = 0;
        while from + 2 < vertices.len() {
            let mut to = vertices.len() - 1;
            let mut found = None;
            while to > from + 1 {
                let turn: f32 = turn_between(points, &vertices[from..=to]);
                if turn.abs() < TURN_FITTED_RAD {
                    found = Some((turn, None));
                    break;
                }
                if let Some(shape) = self.fit(points, vertices[from]..vertices[to] + 1) {
                    found = Some((turn, Some(shape)));
                    break;
                }
                to -= 1;
            }
            if let Some((turn, shape)) = found
                && turn.abs() >= TURN_MIN_RAD
            {
                self.push(points, vertices[from]..vertices[to] + 1, turn, false, shape);
            }
            from = to.max(from + 1);
        }
    }

    /// The ellipse through a run of points, if there is one that stays near to all of them.
    fn fit(&mut self, points: &[EdgePoint], range: Range<usize>) -> Option<Shape> {
        self.points.clear();
        let count = range.len().min(32);
        self.points.extend((0..count).map(|i| {
            let point = points[range.start + i * (range.len() - 1) / (count - 1)];
            (f64::from(point.x), f64::from(point.y))
        }));
        let shape = Shape::fit_conic(&self.points)?.fit_distance(&self.points, 4)?;
        let (rms, greatest) = shape.deviation(&self.points);
        (rms < 0.6 && greatest < 1.8).then_some(shape)
    }

    fn push(
        &mut self,
        points: &[EdgePoint],
        range: Range<usize>,
        turn_rad: f32,
        is_ring: bool,
        shape: Option<Shape>,
    ) {
        let last = range.len() - 1;
        let sample = |i: usize| points[range.start + i * last / (SAMPLES - 1)];
        let x: [f32; SAMPLES] = std::array::from_fn(|i| sample(i).x);
        let y: [f32; SAMPLES] = std::array::from_fn(|i| sample(i).y);
        let side = |i: usize| ((x[i + 1] - x[i]).powi(2) + (y[i + 1] - y[i]).powi(2)).sqrt();
        let length_px = (0..SAMPLES - 1).map(side).sum();
        if length_px < LENGTH_MIN_PX {
            return;
        }
        // The inside is where the arc turns to.
        let sense = turn_rad.signum();
        let normal = |i: usize| {
            let (from, to) = (i.saturating_sub(2), (i + 2).min(SAMPLES - 1));
            let (dx, dy) = (x[to] - x[from], y[to] - y[from]);
            let scale = sense / (dx * dx + dy * dy).sqrt().max(1e-6);
            (-dy * scale, dx * scale)
        };
        let normals: [(f32, f32); SAMPLES] = std::array::from_fn(normal);
        self.all.push(Arc {
            x,
            y,
            inside_x: normals.map(|normal| normal.0),
            inside_y: normals.map(|normal| normal.1),
            turn_rad: turn_rad.abs(),
            length_px,
            is_ring,
            shape,
        });
    }
}

/// Sine and cosine of the turn at `b`, positive from +x towards +y.
fn turn(a: EdgePoint, b: EdgePoint, c: EdgePoint) -> (f32, f32) {
    let (ux, uy) = (b.x - a.x, b.y - a.y);
    let (vx, vy) = (c.x - b.x, c.y - b.y);
    let norm = ((ux * ux + uy * uy) * (vx * vx + vy * vy)).sqrt().max(1e-9);
    ((ux * vy - uy * vx) / norm, (ux * vx + uy * vy) / norm)
}

/// Sum of the turns along a run of vertices, radians.
fn turn_between(points: &[EdgePoint], vertices: &[usize]) -> f32 {
    vertices
        .windows(3)
        .map(|window| {
            let (sin, cos) = turn(points[window[0]], points[window[1]], points[window[2]]);
            sin.atan2(cos)
        })
        .sum()
}

/// The sense in which a closed run of points turns: the sign of its area.
fn turn_sign(points: &[EdgePoint]) -> f32 {
    let last = points.len() - 1;
    let area: f32 = (0..points.len())
        .map(|i| {
            let (a, b) = (points[i], points[if i == last { 0 } else { i + 1 }]);
            (a.x - points[0].x) * (b.y - points[0].y) - (b.x - points[0].x) * (a.y - points[0].y)
        })
        .sum();
    area.signum()
}
