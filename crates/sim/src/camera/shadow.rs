//! Soft shadows, and the darkening where things touch.

use nalgebra::Vector3;

use super::scene::shapes_of;
use super::shape::Shape;
use crate::world::World;

/// Half the angle under which the lamp is seen, as a tangent: the wider, the softer the shadows.
const LAMP_SPREAD: f64 = 0.22;
/// The share of the lamp's light that a full shadow takes; the rest comes back from the room.
const SHADOW_DEPTH: f64 = 0.72;
/// The most of the sky that one thing can take from a place that it touches.
const MOST_SKY_TAKEN: f64 = 0.75;

/// What the light falls on.
pub(super) struct Point {
    pub(super) position: Vector3<f64>,
    pub(super) normal: Vector3<f64>,
    /// The surface's number, which keeps it from shading itself.
    pub(super) owner: u16,
}

/// A ball, or a part of a cup, that takes light from others.
struct Occluder {
    center: Vector3<f64>,
    radius: f64,
    /// The surface it stands for, which does not shade itself.
    owner: u16,
    /// Whether it dims the sky too; one for each thing does.
    dims_sky: bool,
}

/// A plate above what it lies on.
struct Disc {
    center: Vector3<f64>,
    radius: f64,
    owner: u16,
}

/// Everything that casts a shadow.
pub(super) struct Shadows<'a> {
    world: &'a World,
    towards_lamp: Vector3<f64>,
    occluders: Vec<Occluder>,
    discs: Vec<Disc>,
}

impl<'a> Shadows<'a> {
    /// The shadows of a world in which the lamp stands in the direction `towards_lamp`, a unit vector.
    pub(super) fn new(world: &'a World, towards_lamp: Vector3<f64>) -> Self {
        let mut occluders = Vec::new();
        let mut discs = Vec::new();
        // What is out of the picture may still cast its shadow into it.
        for (owner, shape, _) in shapes_of(world) {
            match shape {
                Shape::Ball { center, radius } => {
                    occluders.push(Occluder { center, radius, owner, dims_sky: true });
                }
                Shape::Cup { base, radius, height, .. } => {
                    let heights =
                        [radius.min(0.5 * height), 0.5 * height, height - radius.min(0.5 * height)];
                    occluders.extend(heights.into_iter().enumerate().map(|(place, above)| {
                        Occluder {
                            center: base + Vector3::new(0.0, 0.0, above),
                            radius,
                            owner,
                            dims_sky: place == 0,
                        }
                    }));
                }
                Shape::Plate { center, radius, .. } => discs.push(Disc { center, radius, owner }),
                Shape::Floor | Shape::Box(_) => {}
            }
        }
        Self { world, towards_lamp, occluders, discs }
    }

    /// The shares of the lamp and of the sky that reach a point.
    pub(super) fn light_left(&self, point: &Point) -> (f64, f64) {
        let (mut lamp_left, mut sky_left): (f64, f64) = (1.0, 1.0);
        for occluder in self.occluders.iter().filter(|occluder| occluder.owner != point.owner) {
            let to_center = occluder.center - point.position;
            let squared = to_center.norm_squared();
            let along = to_center.dot(&self.towards_lamp);
            if along > 0.0 {
                let aside = (squared - along * along).max(0.0).sqrt();
                lamp_left = lamp_left
                    .min(ease(0.5 + 0.5 * (aside - occluder.radius) / (LAMP_SPREAD * along)));
            }
            if occluder.dims_sky {
                let facing = point.normal.dot(&to_center).max(0.0) / squared.sqrt();
                sky_left *= 1.0 - (facing * occluder.radius.powi(2) / squared).min(MOST_SKY_TAKEN);
            }
        }
        for disc in self.discs.iter().filter(|disc| disc.owner != point.owner) {
            let below = disc.center.z - point.position.z;
            if below > 0.0 {
                let crossing = point.position + self.towards_lamp * (below / self.towards_lamp.z);
                let aside = (crossing - disc.center).xy().norm();
                lamp_left = lamp_left
                    .min(ease(0.5 + 0.5 * (aside - disc.radius) / (LAMP_SPREAD * below + 0.002)));
                let above = (point.position - disc.center).xy().norm();
                sky_left *= 1.0
                    - 0.6
                        * ease(0.5 - 0.5 * (above - disc.radius) / (below + 0.002))
                        * (1.0 - below).max(0.0);
            }
        }
        (1.0 - SHADOW_DEPTH * (1.0 - lamp_left), sky_left * self.beside_boxes(point))
    }

    /// How much of the sky is left close to the foot of the table and the walls.
    fn beside_boxes(&self, point: &Point) -> f64 {
        const REACH_M: f64 = 0.16;
        /// What lies on top of a box, within rounding, is not beside it.
        const TOP_M: f64 = 1e-6;
        if point.normal.z < 0.5 {
            return 1.0;
        }
        let place = [point.position.x, point.position.y];
        let mut left = 1.0;
        for solid in self.world.solids() {
            if point.position.z < solid.height_m() - TOP_M {
                let near = (1.0 - solid.distance_m(place).max(0.0) / REACH_M).max(0.0);
                left *= 1.0 - 0.5 * near * near * near;
            }
        }
        left
    }
}

/// From 0 to 1 with level ends.
fn ease(share: f64) -> f64 {
    let share = share.clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}
