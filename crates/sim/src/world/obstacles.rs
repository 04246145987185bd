//! What bumpers meet and what stops the robot.

use serde::Serialize;

use super::{Table, Wall, World};

/// A solid box standing on the floor: a wall or the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    name: String,
    center: [f64; 2],
    /// Unit vector along the box's length; its width lies a quarter turn to the left.
    axis: [f64; 2],
    half_length: f64,
    half_width: f64,
    height: f64,
}

/// A place where a bumper touches something solid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Contact<'a> {
    /// Name of the wall or table.
    pub object: &'a str,
    /// How deep the bumper's sphere reaches into it, metres, zero or more.
    pub depth_m: f64,
}

/// Where a ray meets something solid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RayHit<'a> {
    /// Name of the wall or table.
    pub object: &'a str,
    /// Distance from the ray's start in metres; zero where it starts inside.
    pub distance_m: f64,
}

/// How far a round footprint came on a straight way.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Motion<'a> {
    /// Where it ended: x, y in metres.
    pub position_m: [f64; 2],
    /// What stopped it, or `None` where it went all the way.
    pub blocked_by: Option<&'a str>,
}

impl Solid {
    pub(super) fn from_table(table: &Table) -> Self {
        Self {
            name: table.name.clone(),
            center: table.center_m,
            axis: [1.0, 0.0],
            half_length: 0.5 * table.length_m,
            half_width: 0.5 * table.width_m,
            height: table.height_m,
        }
    }

    pub(super) fn from_wall(wall: &Wall) -> Self {
        let ([from_x, from_y], [to_x, to_y]) = (wall.from_m, wall.to_m);
        let length = (to_x - from_x).hypot(to_y - from_y);
        Self {
            name: wall.name.clone(),
            center: [0.5 * (from_x + to_x), 0.5 * (from_y + to_y)],
            axis: [(to_x - from_x) / length, (to_y - from_y) / length],
            half_length: 0.5 * length,
            half_width: 0.5 * wall.thickness_m,
            height: wall.height_m,
        }
    }

    /// Name of the wall or table.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Height of its top above the floor, metres.
    pub fn height_m(&self) -> f64 {
        self.height
    }

    /// Half the extent along its own length and width, metres.
    pub fn half_extent_m(&self) -> [f64; 2] {
        [self.half_length, self.half_width]
    }

    /// A world vector (x, y) in the box's own axes.
    pub(crate) fn to_local_vector(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [axis_x, axis_y] = self.axis;
        [x * axis_x + y * axis_y, y * axis_x - x * axis_y]
    }

    /// A vector in the box's own axes as a world vector (x, y).
    pub(crate) fn to_world_vector(&self, [along, across]: [f64; 2]) -> [f64; 2] {
        let [axis_x, axis_y] = self.axis;
        [along * axis_x - across * axis_y, along * axis_y + across * axis_x]
    }

    /// A world point (x, y) in the box's own axes, seen from its middle.
    pub(crate) fn to_local_point(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        self.to_local_vector([x - self.center[0], y - self.center[1]])
    }

    /// A point in the box's own axes, seen from its middle, as a world point (x, y).
    pub(crate) fn to_world_point(&self, point: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.to_world_vector(point);
        [self.center[0] + x, self.center[1] + y]
    }

    /// Distance in metres of a point (x, y) from the footprint; zero or less inside it.
    pub fn distance_m(&self, point_m: [f64; 2]) -> f64 {
        let [along, across] = self.to_local_point(point_m);
        let (over_length, over_width) =
            (along.abs() - self.half_length, across.abs() - self.half_width);
        let (aside_length, aside_width) = (over_length.max(0.0), over_width.max(0.0));
        let outside = (aside_length * aside_length + aside_width * aside_width).sqrt();
        outside + over_length.max(over_width).min(0.0)
    }

    /// Distance along `direction` (unit, own axes) at which a circle of `radius` from `start` (own axes) first
    /// touches the footprint. Zero where it overlaps already.
    fn sweep(&self, start: [f64; 2], direction: [f64; 2], radius: f64) -> Option<f64> {
        // The places that the middle must not enter are the rectangle grown by the radius with rounded corners:
        // two grown boxes and four circles.
        let boxes = [(radius, 0.0), (0.0, radius)].into_iter().filter_map(|(length, width)| {
            enter_box(start, direction, [self.half_length + length, self.half_width + width])
        });
        let corners = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].into_iter().filter_map(
            |(along, across)| {
                let corner =
                    [start[0] - along * self.half_length, start[1] - across * self.half_width];
                enter_circle(corner, direction, radius)
            },
        );
        boxes.chain(corners).min_by(f64::total_cmp)
    }
}

/// Where a ray first enters the box of these half extents around the origin.
fn enter_box(start: [f64; 2], direction: [f64; 2], half: [f64; 2]) -> Option<f64> {
    let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
    for ((start, direction), half) in start.into_iter().zip(direction).zip(half) {
        if direction.abs() < 1e-12 {
            if start.abs() > half {
                return None;
            }
            continue;
        }
        let (one, other) = ((-half - start) / direction, (half - start) / direction);
        enter = enter.max(one.min(other));
        leave = leave.min(one.max(other));
    }
    (enter <= leave).then_some(enter)
}

/// Where a ray first enters the circle of this radius around the origin.
fn enter_circle(start: [f64; 2], direction: [f64; 2], radius: f64) -> Option<f64> {
    let middle = -(start[0] * direction[0] + start[1] * direction[1]);
    let outside = start[0] * start[0] + start[1] * start[1] - radius * radius;
    if outside <= 0.0 {
        return Some(0.0);
    }
    let discriminant = middle * middle - outside;
    (discriminant >= 0.0 && middle > 0.0).then(|| middle - discriminant.sqrt())
}

/// A blocked footprint is left this far in front of what stopped it, so that rounding never puts it inside.
const CLEARANCE_M: f64 = 1e-6;

impl World {
    /// The deepest contact of a bumper, a sphere of `radius_m` around `center_m` (x, y, z), with anything solid.
    ///
    /// `None` where it touches nothing. Touching exactly counts as contact of depth zero.
    pub fn first_contact(&self, center_m: [f64; 3], radius_m: f64) -> Option<Contact<'_>> {
        let [x, y, z] = center_m;
        let contacts = self.solids.iter().filter_map(|solid| {
            let aside = solid.distance_m([x, y]);
            let above = z - solid.height;
            let distance = if above > 0.0 { aside.max(0.0).hypot(above) } else { aside };
            (distance <= radius_m)
                .then_some(Contact { object: &solid.name, depth_m: radius_m - distance })
        });
        contacts.reduce(|deepest, next| if next.depth_m > deepest.depth_m { next } else { deepest })
    }

    /// The nearest solid thing along a level ray at `height_m` above the floor.
    ///
    /// The ray starts at `from_m` (x, y) and runs in the direction `heading_rad`. `None` where there is nothing
    /// within `range_m`.
    pub fn distance_along_ray(
        &self,
        from_m: [f64; 2],
        heading_rad: f64,
        height_m: f64,
        range_m: f64,
    ) -> Option<RayHit<'_>> {
        let (sin, cos) = heading_rad.sin_cos();
        self.nearest(from_m, [cos, sin], 0.0, height_m).filter(|hit| hit.distance_m <= range_m)
    }

    /// Moves a circle of `radius_m` straight from `from_m` to `to_m` (x, y) until something solid stops it.
    ///
    /// A footprint that overlaps something already may move away from it, but not deeper into it.
    pub fn blocked_motion(&self, from_m: [f64; 2], to_m: [f64; 2], radius_m: f64) -> Motion<'_> {
        let way = [to_m[0] - from_m[0], to_m[1] - from_m[1]];
        let length = way[0].hypot(way[1]);
        if length == 0.0 {
            return Motion { position_m: from_m, blocked_by: None };
        }
        let direction = [way[0] / length, way[1] / length];
        let deeper = self.solids.iter().find(|solid| {
            let (before, after) = (solid.distance_m(from_m), solid.distance_m(to_m));
            before < radius_m && after < before
        });
        if let Some(solid) = deeper {
            return Motion { position_m: from_m, blocked_by: Some(&solid.name) };
        }
        let touched = self.solids.iter().filter(|solid| solid.distance_m(from_m) >= radius_m);
        let first = nearest_of(touched, from_m, direction, radius_m)
            .filter(|hit| hit.distance_m <= length + CLEARANCE_M);
        match first {
            None => Motion { position_m: to_m, blocked_by: None },
            Some(hit) => {
                let travelled = (hit.distance_m - CLEARANCE_M).clamp(0.0, length);
                let position_m =
                    [from_m[0] + travelled * direction[0], from_m[1] + travelled * direction[1]];
                Motion { position_m, blocked_by: Some(hit.object) }
            }
        }
    }

    fn nearest(
        &self,
        from: [f64; 2],
        direction: [f64; 2],
        radius: f64,
        height: f64,
    ) -> Option<RayHit<'_>> {
        nearest_of(
            self.solids.iter().filter(|solid| height <= solid.height),
            from,
            direction,
            radius,
        )
    }
}

fn nearest_of<'a>(
    solids: impl Iterator<Item = &'a Solid>,
    from: [f64; 2],
    direction: [f64; 2],
    radius: f64,
) -> Option<RayHit<'a>> {
    solids
        .filter_map(|solid| {
            let distance_m = solid.sweep(
                solid.to_local_point(from),
                solid.to_local_vector(direction),
                radius,
            )?;
            Some(RayHit { object: solid.name(), distance_m })
        })
        .min_by(|one, other| one.distance_m.total_cmp(&other.distance_m))
}
