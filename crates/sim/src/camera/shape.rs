//! Where a ray meets a shape.
//!
//! Directions have depth 1 along the optical axis, so distances along a ray are depths; nothing here needs them to
//! be unit vectors.

use nalgebra::Vector3;

use crate::world::Solid;

/// Nearer than this (metres of depth) nothing is seen.
const NEAREST: f64 = 1e-4;

/// A face of a shape; pixels whose neighbours show another face are sampled more finely.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Face {
    /// Upper side of the floor, a box, or the middle of a plate.
    Top,
    /// A box's end beyond its length, or short of it.
    EndAhead,
    EndBehind,
    /// A box's long side to the left of its length, or to the right.
    SideLeft,
    SideRight,
    /// A ball, or the outside of a cup.
    Outside,
    /// The rim ring of a plate or a cup.
    Rim,
    /// Inside of a cup's wall.
    Inside,
    /// Inner floor of a cup.
    InnerFloor,
    /// A plate seen from below.
    Underside,
}

/// A thing to be seen, in world axes.
#[derive(Debug, Clone, Copy)]
pub(super) enum Shape<'a> {
    Floor,
    Box(&'a Solid),
    Ball { center: Vector3<f64>, radius: f64 },
    Plate { center: Vector3<f64>, radius: f64, inner_radius: f64 },
    Cup { base: Vector3<f64>, radius: f64, inner_radius: f64, height: f64 },
}

/// What a shape cannot reach beyond.
pub(super) enum Bounds {
    /// It reaches everywhere.
    None,
    /// A sphere of this middle and radius.
    Sphere(Vector3<f64>, f64),
    /// A box of these corners, those of one edge differing in one bit of their number.
    Corners([Vector3<f64>; 8]),
}

/// Height of a cup's inner floor above its base, as a share of its height.
pub(super) const CUP_FLOOR_SHARE: f64 = 0.08;

impl Shape<'_> {
    /// The nearest place ahead where the ray from `origin` along `direction` meets the shape.
    pub(super) fn meet(
        &self,
        origin: &Vector3<f64>,
        direction: &Vector3<f64>,
    ) -> Option<(f64, Face)> {
        match *self {
            Self::Floor => level(origin.z, direction.z, 0.0)
                .filter(|_| origin.z > 0.0)
                .map(|depth| (depth, Face::Top)),
            Self::Box(solid) => meet_box(solid, origin, direction),
            Self::Ball { center, radius } => {
                let from_center = origin - center;
                let (enter, _) = roots(
                    direction.norm_squared(),
                    direction.dot(&from_center),
                    from_center.norm_squared() - radius * radius,
                )?;
                (enter > NEAREST).then_some((enter, Face::Outside))
            }
            Self::Plate { center, radius, inner_radius } => {
                let depth = level(origin.z, direction.z, center.z)?;
                let squared = square_from_axis(origin, direction, depth, &center);
                let face = if origin.z < center.z {
                    Face::Underside
                } else if squared < inner_radius * inner_radius {
                    Face::Top
                } else {
                    Face::Rim
                };
                (squared <= radius * radius).then_some((depth, face))
            }
            Self::Cup { base, radius, inner_radius, height } => {
                meet_cup(&base, [radius, inner_radius, height], origin, direction)
            }
        }
    }

    /// Something simple around the shape.
    pub(super) fn bounds(&self) -> Bounds {
        match *self {
            Self::Floor => Bounds::None,
            Self::Box(solid) => {
                let [half_length, half_width] = solid.half_extent_m();
                Bounds::Corners([0, 1, 2, 3, 4, 5, 6, 7].map(|corner| {
                    let along = if corner & 1 == 0 { -half_length } else { half_length };
                    let across = if corner & 2 == 0 { -half_width } else { half_width };
                    let [x, y] = solid.to_world_point([along, across]);
                    Vector3::new(x, y, if corner & 4 == 0 { 0.0 } else { solid.height_m() })
                }))
            }
            Self::Ball { center, radius } | Self::Plate { center, radius, .. } => {
                Bounds::Sphere(center, radius)
            }
            Self::Cup { base, radius, height, .. } => {
                let middle = base + Vector3::new(0.0, 0.0, 0.5 * height);
                Bounds::Sphere(middle, radius.hypot(0.5 * height))
            }
        }
    }
}

/// Depth at which a ray crosses a level plane.
fn level(origin_z: f64, direction_z: f64, plane_z: f64) -> Option<f64> {
    let depth = (plane_z - origin_z) / direction_z;
    (depth > NEAREST && depth.is_finite()).then_some(depth)
}

/// Both roots, in order, of `squared` x² + 2 `half_linear` x + `constant`.
fn roots(squared: f64, half_linear: f64, constant: f64) -> Option<(f64, f64)> {
    let discriminant = half_linear * half_linear - squared * constant;
    if discriminant < 0.0 || squared <= 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    Some(((-half_linear - root) / squared, (-half_linear + root) / squared))
}

/// Squared distance of a point of the ray from the upright axis through `foot`.
fn square_from_axis(
    origin: &Vector3<f64>,
    direction: &Vector3<f64>,
    depth: f64,
    foot: &Vector3<f64>,
) -> f64 {
    let x = origin.x + depth * direction.x - foot.x;
    let y = origin.y + depth * direction.y - foot.y;
    x * x + y * y
}

fn meet_cup(
    base: &Vector3<f64>,
    [radius, inner_radius, height]: [f64; 3],
    origin: &Vector3<f64>,
    direction: &Vector3<f64>,
) -> Option<(f64, Face)> {
    let (floor, top) = (base.z + CUP_FLOOR_SHARE * height, base.z + height);
    let (x, y) = (origin.x - base.x, origin.y - base.y);
    let squared = direction.x * direction.x + direction.y * direction.y;
    let half_linear = direction.x * x + direction.y * y;
    let wall = |radius: f64| roots(squared, half_linear, x * x + y * y - radius * radius);
    let between = |depth: f64, low: f64| {
        let z = origin.z + depth * direction.z;
        depth > NEAREST && z >= low && z <= top
    };
    let outside = wall(radius).map(|(enter, _)| enter).filter(|&depth| between(depth, base.z));
    let inside = wall(inner_radius).map(|(_, leave)| leave).filter(|&depth| between(depth, floor));
    let rim = level(origin.z, direction.z, top).filter(|&depth| {
        let square = square_from_axis(origin, direction, depth, base);
        square <= radius * radius && square >= inner_radius * inner_radius
    });
    let inner_floor = level(origin.z, direction.z, floor).filter(|&depth| {
        square_from_axis(origin, direction, depth, base) <= inner_radius * inner_radius
    });
    [
        (outside, Face::Outside),
        (rim, Face::Rim),
        (inside, Face::Inside),
        (inner_floor, Face::InnerFloor),
    ]
    .into_iter()
    .filter_map(|(depth, face)| Some((depth?, face)))
    .min_by(|one, other| one.0.total_cmp(&other.0))
}

fn meet_box(solid: &Solid, origin: &Vector3<f64>, direction: &Vector3<f64>) -> Option<(f64, Face)> {
    let [start_along, start_across] = solid.to_local_point([origin.x, origin.y]);
    let [along, across] = solid.to_local_vector([direction.x, direction.y]);
    let [half_length, half_width] = solid.half_extent_m();
    let half_height = 0.5 * solid.height_m();
    let slabs = [
        (start_along, along, half_length, Face::EndAhead, Face::EndBehind),
        (start_across, across, half_width, Face::SideLeft, Face::SideRight),
        // The lower side stands on the floor and is never seen.
        (origin.z - half_height, direction.z, half_height, Face::Top, Face::Top),
    ];
    let (mut enter, mut leave, mut face) = (f64::NEG_INFINITY, f64::INFINITY, Face::Top);
    for (start, step, half, positive, negative) in slabs {
        if step == 0.0 {
            if start.abs() > half {
                return None;
            }
            continue;
        }
        let (near, far) =
            ((-half.copysign(step) - start) / step, (half.copysign(step) - start) / step);
        if near > enter {
            (enter, face) = (near, if step > 0.0 { negative } else { positive });
        }
        leave = leave.min(far);
    }
    (enter <= leave && enter > NEAREST).then_some((enter, face))
}
