//! A world prepared for one camera pose: which shapes a pixel's ray can meet at all, and which it meets first.

use nalgebra::Vector3;

use super::pose::CameraPose;
use super::shape::{Bounds, Face, Shape};
use super::{Intrinsics, truth};
use crate::geometry::Ellipse;
use crate::world::{World, WorldDescription};

/// What a surface is painted with.
#[derive(Debug, Clone, Copy)]
pub(super) enum Paint<'a> {
    Floor,
    Table,
    Wall(&'a crate::world::Wall),
    Ball(&'a crate::world::Ball),
    Plate(&'a crate::world::Plate),
    Cup(&'a crate::world::Cup),
}

/// A shape that may be in the picture.
#[derive(Debug)]
pub(super) struct Surface<'a> {
    pub(super) shape: Shape<'a>,
    pub(super) paint: Paint<'a>,
    /// Place in the world's order of objects; the same whatever is in the picture.
    pub(super) index: u16,
    bounds: PixelBox,
}

/// The part of the picture outside of which a shape cannot be.
#[derive(Debug, Clone, Copy)]
struct PixelBox {
    x: (f64, f64),
    y: (f64, f64),
}

const WHOLE_PICTURE: PixelBox =
    PixelBox { x: (f64::NEG_INFINITY, f64::INFINITY), y: (f64::NEG_INFINITY, f64::INFINITY) };

/// What a ray meets first.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hit<'s, 'a> {
    pub(super) depth: f64,
    pub(super) face: Face,
    pub(super) surface: &'s Surface<'a>,
}

/// A world seen from one place.
pub(super) struct Scene<'a> {
    pub(super) description: &'a WorldDescription,
    pub(super) world: &'a World,
    pub(super) intrinsics: Intrinsics,
    pub(super) pose: CameraPose,
    pub(super) surfaces: Vec<Surface<'a>>,
}

impl<'a> Scene<'a> {
    pub(super) fn new(world: &'a World, intrinsics: Intrinsics, pose: CameraPose) -> Self {
        let surfaces = shapes_of(world)
            .filter_map(|(index, shape, paint)| {
                let bounds = bounds_of(&shape, &intrinsics, &pose)?;
                Some(Surface { shape, paint, index, bounds })
            })
            .collect();
        Self { description: world.description(), world, intrinsics, pose, surfaces }
    }

    /// The world direction, of depth 1, that is seen at the picture point (`x`, `y`).
    pub(super) fn direction(&self, x: f64, y: f64) -> Vector3<f64> {
        self.pose.rotation * self.intrinsics.direction(x, y)
    }

    /// What is seen first along `direction`, which is the direction of the picture point (`x`, `y`).
    pub(super) fn first_hit(
        &self,
        x: f64,
        y: f64,
        direction: &Vector3<f64>,
    ) -> Option<Hit<'_, 'a>> {
        let mut first: Option<Hit<'_, 'a>> = None;
        for surface in &self.surfaces {
            let PixelBox { x: (left, right), y: (top, bottom) } = surface.bounds;
            if x < left || x > right || y < top || y > bottom {
                continue;
            }
            if let Some((depth, face)) = surface.shape.meet(&self.pose.position, direction)
                && first.is_none_or(|hit| depth < hit.depth)
            {
                first = Some(Hit { depth, face, surface });
            }
        }
        first
    }
}

/// The world's shapes, numbered in a fixed order: floor, table, walls, balls, plates, cups.
pub(super) fn shapes_of(world: &World) -> impl Iterator<Item = (u16, Shape<'_>, Paint<'_>)> {
    let description = world.description();
    let table = description.table.iter().map(|_| Paint::Table);
    let boxes = table.chain(description.walls.iter().map(Paint::Wall));
    let boxes = world.solids().iter().zip(boxes).map(|(solid, paint)| (Shape::Box(solid), paint));
    let balls = description.balls.iter().map(|ball| {
        (
            Shape::Ball { center: Vector3::from(ball.center_m), radius: ball.radius_m },
            Paint::Ball(ball),
        )
    });
    let plates = description.plates.iter().map(|plate| {
        let center = Vector3::from(plate.center_m);
        (
            Shape::Plate { center, radius: plate.radius_m, inner_radius: plate.inner_radius_m },
            Paint::Plate(plate),
        )
    });
    let cups = description.cups.iter().map(|cup| {
        let (base, radius) = (Vector3::from(cup.base_m), cup.radius_m);
        (
            Shape::Cup { base, radius, inner_radius: cup.inner_radius_m, height: cup.height_m },
            Paint::Cup(cup),
        )
    });
    let all = std::iter::once((Shape::Floor, Paint::Floor))
        .chain(boxes)
        .chain(balls)
        .chain(plates)
        .chain(cups);
    (0..).zip(all).map(|(index, (shape, paint))| (index, shape, paint))
}

/// Where in the picture a shape can be; `None` where it is behind the camera or beside the picture.
fn bounds_of(shape: &Shape<'_>, intrinsics: &Intrinsics, pose: &CameraPose) -> Option<PixelBox> {
    /// Room for the samples of a pixel around its centre, and for rounding.
    const MARGIN_PX: f64 = 1.0;
    let bounds = match shape.bounds() {
        Bounds::None => return Some(WHOLE_PICTURE),
        Bounds::Sphere(center, radius) => {
            let center = pose.to_camera(&center);
            if center.z + radius <= 0.0 {
                return None;
            }
            let Some(ellipse) = truth::project_sphere(intrinsics, &center, radius) else {
                return Some(WHOLE_PICTURE);
            };
            box_of_ellipse(&ellipse)
        }
        Bounds::Corners(corners) => {
            box_of_corners(&corners.map(|corner| pose.to_camera(&corner)), intrinsics)?
        }
    };
    let PixelBox { x: (left, right), y: (top, bottom) } = bounds;
    let beside = right < -MARGIN_PX
        || bottom < -MARGIN_PX
        || left > f64::from(intrinsics.width) + MARGIN_PX
        || top > f64::from(intrinsics.height) + MARGIN_PX;
    (!beside).then_some(PixelBox {
        x: (left - MARGIN_PX, right + MARGIN_PX),
        y: (top - MARGIN_PX, bottom + MARGIN_PX),
    })
}

fn box_of_ellipse(ellipse: &Ellipse) -> PixelBox {
    let Ellipse { center_x, center_y, semi_major, semi_minor, theta } = *ellipse;
    let (sin, cos) = theta.sin_cos();
    let half_x = (semi_major * cos).hypot(semi_minor * sin);
    let half_y = (semi_major * sin).hypot(semi_minor * cos);
    PixelBox {
        x: (center_x - half_x, center_x + half_x),
        y: (center_y - half_y, center_y + half_y),
    }
}

/// The picture of the part of a box that is in front of the camera; `None` where there is none.
fn box_of_corners(corners: &[Vector3<f64>; 8], intrinsics: &Intrinsics) -> Option<PixelBox> {
    /// What is nearer than this (metres of depth) is cut off; nothing that near is rendered.
    const CUT_M: f64 = 5e-5;
    let edges = (0..8_usize)
        .flat_map(|corner| [1, 2, 4].map(|bit| (corner, corner | bit)))
        .filter(|(corner, other)| corner != other)
        .filter_map(|(corner, other)| Some((corners.get(corner)?, corners.get(other)?)));
    let ends = edges.flat_map(|(one, other)| {
        let crossing = (one.z < CUT_M) != (other.z < CUT_M);
        let cut = crossing.then(|| one.lerp(other, (CUT_M - one.z) / (other.z - one.z)));
        [Some(*one), Some(*other), cut].into_iter().flatten().filter(|end| end.z >= 0.99 * CUT_M)
    });
    ends.filter_map(|end| intrinsics.project(&end)).fold(None, |bounds, (x, y)| {
        let PixelBox { x: (left, right), y: (top, bottom) } =
            bounds.unwrap_or(PixelBox { x: (x, x), y: (y, y) });
        Some(PixelBox { x: (left.min(x), right.max(x)), y: (top.min(y), bottom.max(y)) })
    })
}
