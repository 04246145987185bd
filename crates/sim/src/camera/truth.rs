//! Every ellipse in a picture, computed instead of found.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

use super::scene::{Paint, Scene};
use super::shape::{CUP_FLOOR_SHARE, Shape};
use super::{CameraPose, Intrinsics};
use crate::geometry::Ellipse;
use crate::world::World;

/// Points of a contour that are asked whether they can be seen.
const CONTOUR_SAMPLES: u32 = 180;

/// Which contour of an object an ellipse is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ContourKind {
    /// Outline of a ball.
    BallOutline,
    /// Outer edge of a plate's rim.
    PlateRimOuter,
    /// Inner edge of a plate's rim.
    PlateRimInner,
    /// Outer edge of a cup's rim.
    CupRimOuter,
    /// Inner edge of a cup's rim.
    CupRimInner,
    /// The foot of a cup's wall, of which the far half is always hidden.
    CupBase,
    /// Edge of a cup's inner floor.
    CupInnerFloor,
}

/// An ellipse in the picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct VisibleEllipse {
    /// Name of the object.
    pub object: String,
    /// Which of its contours.
    pub kind: ContourKind,
    /// The whole contour, hidden parts included; its centre may lie outside of the picture.
    #[serde(flatten)]
    pub ellipse: Ellipse,
    /// Share of the contour, in equal steps of the eccentric angle, that is in the picture with nothing before it;
    /// above 0, up to 1.
    pub visible_fraction: f64,
}

/// The outline of a sphere around `center` (camera axes), or `None` unless all of it is in front of the camera.
pub(super) fn project_sphere(
    intrinsics: &Intrinsics,
    center: &Vector3<f64>,
    radius: f64,
) -> Option<Ellipse> {
    if center.z <= radius {
        return None;
    }
    // The dual quadric of the sphere seen through [I | 0] (Hartley and Zisserman, equation 8.5).
    let dual = Matrix3::from_diagonal_element(radius * radius) - center * center.transpose();
    let k = intrinsics.matrix();
    Ellipse::from_dual_conic(&(k * dual * k.transpose()))
}

/// The picture of a circle around `center` with the perpendicular spokes `one` and `other` (camera axes, of the
/// circle's radius), or `None` unless all of it is in front of the camera.
pub(super) fn project_circle(
    intrinsics: &Intrinsics,
    center: &Vector3<f64>,
    one: &Vector3<f64>,
    other: &Vector3<f64>,
) -> Option<Ellipse> {
    if center.z <= one.z.hypot(other.z) {
        return None;
    }
    // The homography from the circle's plane, in which it is the unit circle, to the picture.
    let homography = intrinsics.matrix() * Matrix3::from_columns(&[*one, *other, *center]);
    let unit_circle = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -1.0));
    Ellipse::from_dual_conic(&(homography * unit_circle * homography.transpose()))
}

/// Every ellipse of which at least a part can be seen, in the world's order of balls, plates and cups.
///
/// Contours that reach behind the camera are no ellipses and are left out. Shadows and textures are not told.
pub fn ground_truth(
    world: &World,
    intrinsics: &Intrinsics,
    pose: &CameraPose,
) -> Vec<VisibleEllipse> {
    let scene = Scene::new(world, *intrinsics, *pose);
    let mut truth = Vec::new();
    for surface in &scene.surfaces {
        let name = match surface.paint {
            Paint::Ball(ball) => &ball.name,
            Paint::Plate(plate) => &plate.name,
            Paint::Cup(cup) => &cup.name,
            Paint::Floor | Paint::Table | Paint::Wall(_) => continue,
        };
        for (kind, contour) in contours_of(&surface.shape) {
            let Some(ellipse) = contour.project(&scene) else { continue };
            let seen = (0..CONTOUR_SAMPLES).filter(|&sample| {
                let angle = TAU * f64::from(sample) / f64::from(CONTOUR_SAMPLES);
                contour.is_seen_at(&scene, surface.index, ellipse.point_at(angle))
            });
            let visible_fraction = seen.map(|_| 1.0).sum::<f64>() / f64::from(CONTOUR_SAMPLES);
            if visible_fraction > 0.0 {
                truth.push(VisibleEllipse {
                    object: name.clone(),
                    kind,
                    ellipse,
                    visible_fraction,
                });
            }
        }
    }
    truth
}

/// A curve in the world whose picture is an ellipse.
enum Contour {
    Sphere { center: Vector3<f64>, radius: f64 },
    LevelCircle { center: Vector3<f64>, radius: f64 },
}

fn contours_of(shape: &Shape<'_>) -> Vec<(ContourKind, Contour)> {
    let level = |center: Vector3<f64>, above: f64, radius: f64| Contour::LevelCircle {
        center: center + Vector3::new(0.0, 0.0, above),
        radius,
    };
    match *shape {
        Shape::Floor | Shape::Box(_) => Vec::new(),
        Shape::Ball { center, radius } => {
            vec![(ContourKind::BallOutline, Contour::Sphere { center, radius })]
        }
        Shape::Plate { center, radius, inner_radius } => vec![
            (ContourKind::PlateRimOuter, level(center, 0.0, radius)),
            (ContourKind::PlateRimInner, level(center, 0.0, inner_radius)),
        ],
        Shape::Cup { base, radius, inner_radius, height } => vec![
            (ContourKind::CupRimOuter, level(base, height, radius)),
            (ContourKind::CupRimInner, level(base, height, inner_radius)),
            (ContourKind::CupBase, level(base, 0.0, radius)),
            (ContourKind::CupInnerFloor, level(base, CUP_FLOOR_SHARE * height, inner_radius)),
        ],
    }
}

impl Contour {
    fn project(&self, scene: &Scene<'_>) -> Option<Ellipse> {
        match self {
            Self::Sphere { center, radius } => {
                project_sphere(&scene.intrinsics, &scene.pose.to_camera(center), *radius)
            }
            Self::LevelCircle { center, radius } => {
                let to_camera = scene.pose.rotation.inverse();
                let one = to_camera * Vector3::new(*radius, 0.0, 0.0);
                let other = to_camera * Vector3::new(0.0, *radius, 0.0);
                project_circle(&scene.intrinsics, &scene.pose.to_camera(center), &one, &other)
            }
        }
    }

    /// Whether the contour point at the picture point (`x`, `y`) is in the picture with nothing before it.
    fn is_seen_at(&self, scene: &Scene<'_>, owner: u16, (x, y): (f64, f64)) -> bool {
        /// Hits this close (metres of depth) before the contour are the contour itself.
        const TOLERANCE_M: f64 = 5e-4;
        if !scene.intrinsics.contains(x, y) {
            return false;
        }
        let direction = scene.direction(x, y);
        let position = scene.pose.position;
        let (depth, grazes_owner) = match self {
            // The outline's rays touch the ball where they come nearest to its middle.
            Self::Sphere { center, .. } => {
                ((center - position).dot(&direction) / direction.norm_squared(), true)
            }
            Self::LevelCircle { center, .. } => ((center.z - position.z) / direction.z, false),
        };
        scene.first_hit(x, y, &direction).is_none_or(|hit| {
            hit.depth >= depth - TOLERANCE_M || (grazes_owner && hit.surface.index == owner)
        })
    }
}
