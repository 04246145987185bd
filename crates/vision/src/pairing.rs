//! Which arcs can lie on one ellipse.

use crate::arc::{Arc, SAMPLES};

/// How many of its radii an arc may be away from another one.
const REACH_RADII: f32 = 8.0;
/// Least length of both arcs together for each pixel of distance. A contour is at least twice as long as the distance of
/// two points on it, so this asks for a fifth of it.
const LENGTH_PER_DISTANCE_MIN: f32 = 0.4;
/// Normals are off by up to this, radians.
const SLACK_RAD: f32 = 0.1;
/// An arc may cross the tangent of another by this, in pixels.
const SLACK_PX: f32 = 1.5;

/// The middle of an arc, for the first look at a pair.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    x: f32,
    y: f32,
    inside_x: f32,
    inside_y: f32,
    reach_px: f32,
    length_px: f32,
}

impl Place {
    pub(crate) fn of(arc: &Arc) -> Self {
        let middle = SAMPLES / 2;
        Self {
            x: arc.x[middle],
            y: arc.y[middle],
            inside_x: arc.inside_x[middle],
            inside_y: arc.inside_y[middle],
            reach_px: REACH_RADII * arc.length_px / arc.turn_rad,
            length_px: arc.length_px,
        }
    }

    /// Whether the middle of each is on the inner side of the other, near enough, and both long enough to be a good part of
    /// a contour through both.
    #[inline(always)]
    pub(crate) fn may_face(&self, other: &Self) -> bool {
        let (dx, dy) = (other.x - self.x, other.y - self.y);
        let reach_px = self.reach_px.max(other.reach_px);
        let length_px = self.length_px + other.length_px;
        is_inside(dx, dy, self.inside_x, self.inside_y)
            & is_inside(-dx, -dy, other.inside_x, other.inside_y)
            & (dx.abs() < reach_px)
            & (dy.abs() < reach_px)
            & (LENGTH_PER_DISTANCE_MIN.powi(2) * (dx * dx + dy * dy) < length_px * length_px)
    }
}

/// Whether two arcs can lie on one ellipse: each on the inner side of the other's tangents.
#[inline(always)]
pub(crate) fn can_belong(one: &Arc, other: &Arc) -> bool {
    const PLACES: [usize; 3] = [1, SAMPLES / 2, SAMPLES - 2];
    let inner = |arc: &Arc, i: usize, point: &Arc, j: usize| {
        let (dx, dy) = (point.x[j] - arc.x[i], point.y[j] - arc.y[i]);
        is_inside(dx, dy, arc.inside_x[i], arc.inside_y[i])
    };
    PLACES
        .iter()
        .all(|&i| PLACES.iter().all(|&j| inner(one, i, other, j) && inner(other, j, one, i)))
}

/// Whether an offset points to the inner side of a tangent, or nearly.
#[inline(always)]
fn is_inside(dx: f32, dy: f32, inside_x: f32, inside_y: f32) -> bool {
    dx * inside_x + dy * inside_y > -SLACK_PX - SLACK_RAD * (dx.abs() + dy.abs())
}
