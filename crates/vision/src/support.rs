//! The edge points on a contour.

use crate::edges::EdgeMap;
use crate::shape::Shape;

/// Steps along a contour at the most.
pub(crate) const STEPS_MAX: usize = 320;

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
    /// Mean contrast of the hits in grey values, and the root mean square of its deviation over the mean.
    pub(crate) contrast: f64,
    pub(crate) unevenness: f64,
    /// Edge points beside the contour, 3 to 5 px off, for each step looked at.
    pub(crate) clutter: f64,
}

/// A hit: the number of the point.
pub(crate) type Hit = u32;

/// Looks along `shape` for edge points within `tolerance` pixels whose gradient is within the angle of `cos_min` to
/// the normal, in either sense. `hits` gets their numbers, each once in a row.
pub(crate) fn gather(
    edges: &EdgeMap,
    shape: &Shape,
    tolerance: f64,
    cos_min: f64,
    steps_max: usize,
    hits: &mut Vec<Hit>,
) -> Support {
    hits.clear();
    let ellipse = shape.ellipse();
    let steps = (ellipse.perimeter_px() as usize).clamp(24, steps_max);
    let (a, b) = (ellipse.semi_major_px, ellipse.semi_minor_px);
    let (sin, cos) = ellipse.theta_rad.sin_cos();
    let (turn_sin, turn_cos) = (std::f64::consts::TAU / steps as f64).sin_cos();
    let (width, height) = (edges.map.width() as f64, edges.map.height() as f64);
    let reach = tolerance.ceil().min(8.0) as i32;
    let (mut along, mut across) = (1.0_f64, 0.0_f64);
    let mut support = Support::default();
    let (mut weight_all, mut weight_inside, mut weight_hit) = (0.0, 0.0, 0.0);
    let (mut cosines, mut squares) = (0.0, 0.0);
    let (mut contrasts, mut contrast_squares) = (0.0, 0.0);
    let (mut gap, mut gap_max, mut gap_first) = (0.0_f64, 0.0_f64, None);
    let points = &edges.points[..];
    for _ in 0..steps {
        let (u, v) = (a * along, b * across);
        let x = shape.x + u * cos - v * sin;
        let y = shape.y + u * sin + v * cos;
        let weight = (a * a * across * across + b * b * along * along).sqrt();
        weight_all += weight;
        if x >= 1.0 && y >= 1.0 && x <= width - 2.0 && y <= height - 2.0 {
            weight_inside += weight;
            support.steps += 1;
            let (_, normal_x, normal_y) = shape.distance(x, y);
            let mut best = (tolerance, u32::MAX, 0.0);
            let mut look = |number: u32| {
                let point = &points[number as usize];
                let (px, py) = (f64::from(point.x), f64::from(point.y));
                let (dx, dy) = (px - x, py - y);
                let distance = (dx * normal_x + dy * normal_y).abs();
                let sideways = (dx * normal_y - dy * normal_x).abs();
                let agreement =
                    normal_x * f64::from(point.gradient_x) + normal_y * f64::from(point.gradient_y);
                if distance < best.0 && sideways < 1.1 && agreement.abs() > cos_min {
                    best = (distance, number, agreement);
                }
            };
            let (column, row) = ((x + 0.5) as i32, (y + 0.5) as i32);
            // Across the contour as far as the tolerance, along it one pixel.
            let (wide, high) =
                if normal_x.abs() > normal_y.abs() { (reach, 1) } else { (1, reach) };
            for line in row - high..=row + high {
                edges.map.visit_run(column, line, wide, &mut look);
            }
            if best.1 == u32::MAX {
                gap += weight;
            } else {
                if gap_first.is_none() {
                    gap_first = Some(gap);
                }
                gap_max = gap_max.max(gap);
                gap = 0.0;
                weight_hit += weight;
                support.hits += 1;
                support.inward += usize::from(best.2 < 0.0);
                cosines += best.2.abs();
                squares += best.0 * best.0;
                let contrast = f64::from(points[best.1 as usize].contrast);
                contrasts += contrast;
                contrast_squares += contrast * contrast;
                if hits.last() != Some(&best.1) {
                    hits.push(best.1);
                }
            }
        }
        (along, across) =
            (along * turn_cos - across * turn_sin, across * turn_cos + along * turn_sin);
    }
    let hit_count = support.hits.max(1) as f64;
    support.agreement = cosines / hit_count;
    support.residual = (squares / hit_count).sqrt();
    support.contrast = contrasts / hit_count;
    support.unevenness = (contrast_squares / hit_count - support.contrast.powi(2)).max(0.0).sqrt()
        / support.contrast.max(1e-9);
    if weight_inside > 0.0 {
        gap_max = gap_max.max(gap + gap_first.unwrap_or(0.0));
        support.share = weight_hit / weight_inside;
        support.gap = gap_max / weight_inside;
    }
    support.inside = weight_inside / weight_all.max(1e-300);
    support.length = ellipse.perimeter_px() * support.inside;
    support
}

/// Edge points beside a contour: for each of a few dozen places on it, those in 3 x 3 pixels on either side, 4 px off.
pub(crate) fn clutter(edges: &EdgeMap, shape: &Shape) -> f64 {
    const PLACES: u32 = 48;
    let (mut count, mut looks) = (0_u32, 0_u32);
    for (x, y) in shape.ellipse().outline(PLACES) {
        let (_, normal_x, normal_y) = shape.distance(x, y);
        for side in [-4.0, 4.0] {
            let (column, row) = ((x + side * normal_x + 0.5) as i32, (y + side * normal_y + 0.5) as i32);
            if column < 2 || row < 2 || column + 2 >= edges.map.width() as i32 || row + 2 >= edges.map.height() as i32 {
                continue;
            }
            looks += 1;
            for line in row - 1..=row + 1 {
                edges.map.visit_run(column, line, 1, |_| count += 1);
            }
        }
    }
    f64::from(count) / f64::from(looks.max(1))
}
