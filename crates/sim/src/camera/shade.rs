//! The light that a point of the scene sends to the camera.
//!
//! Lambert's cosine law for the lamp, a sky that upward faces see more of, soft shadows and the darkening where
//! things touch; round occluders stand in for balls and cups. With `lamp` and `sky` at zero every face shows its
//! own colour alone, which the tests of contours use.

use nalgebra::Vector3;

use super::scene::{Hit, Paint, Scene};
use super::shadow::{Point, Shadows};
use super::shape::{CUP_FLOOR_SHARE, Face, Shape};
use super::texture::wood;
use crate::world::{Colour, Material};

/// Beyond this distance (metres) the floor begins to fade into the backdrop, and has faded at the second.
const FADE_M: (f64, f64) = (4.0, 10.0);
/// How steeply the rim and the bowl of a plate rise, for its shading only.
const PLATE_SLOPE: f64 = 0.30;

type Light = Vector3<f64>;

/// A scene with its light, ready to be asked for colours.
pub(super) struct Shader<'s, 'a> {
    scene: &'s Scene<'a>,
    towards_lamp: Vector3<f64>,
    shadows: Shadows<'a>,
}

impl<'s, 'a> Shader<'s, 'a> {
    pub(super) fn new(scene: &'s Scene<'a>) -> Self {
        let towards_lamp = Vector3::from(scene.description.light.towards_lamp).normalize();
        Self { scene, towards_lamp, shadows: Shadows::new(scene.world, towards_lamp) }
    }

    /// Colour (0 to 255 and a little beyond) of what is seen along `direction`.
    pub(super) fn colour(&self, direction: &Vector3<f64>, hit: Option<Hit<'_, 'a>>) -> [f32; 3] {
        let light = self.light(direction, hit);
        // To the precision of a picture.
        #[allow(clippy::cast_possible_truncation)]
        [light.x as f32, light.y as f32, light.z as f32]
    }

    fn light(&self, direction: &Vector3<f64>, hit: Option<Hit<'_, 'a>>) -> Light {
        let backdrop = self.backdrop(direction);
        let Some(hit) = hit else { return backdrop };
        let position = self.scene.pose.position + hit.depth * direction;
        let (normal, own) = self.surface(&position, direction, &hit);
        let point = Point { position, normal, owner: hit.surface.index };
        let lit = own * self.brightness(&point, &hit) + self.gloss(&point, direction, &hit);
        let distance = hit.depth * direction.norm();
        let faded = ((distance - FADE_M.0) / (FADE_M.1 - FADE_M.0)).clamp(0.0, 1.0);
        lit.lerp(&backdrop, faded)
    }

    /// The backdrop, a little brighter towards the zenith.
    fn backdrop(&self, direction: &Vector3<f64>) -> Light {
        let rise = direction.z / direction.norm();
        light(self.scene.description.backdrop)
            * (1.0 + 0.08 * self.scene.description.light.sky * rise)
    }

    /// Normal and own colour at a point.
    fn surface(
        &self,
        position: &Vector3<f64>,
        direction: &Vector3<f64>,
        hit: &Hit<'_, 'a>,
    ) -> (Vector3<f64>, Light) {
        let up = Vector3::z();
        let outward = |center: [f64; 3]| {
            let [x, y, _] = center;
            Vector3::new(position.x - x, position.y - y, 0.0)
        };
        match (hit.surface.paint, hit.face) {
            (Paint::Floor, _) => (
                up,
                self.material(&self.scene.description.floor, 0, position, up, direction, hit.depth),
            ),
            (Paint::Table, face) => {
                let normal = box_normal(&hit.surface.shape, face);
                let material = self.scene.description.table.as_ref().map(|table| &table.material);
                let own = material.map_or_else(Light::zeros, |material| {
                    self.material(material, 1, position, normal, direction, hit.depth)
                });
                (normal, own)
            }
            (Paint::Wall(wall), face) => (box_normal(&hit.surface.shape, face), light(wall.colour)),
            (Paint::Ball(ball), _) => {
                ((position - Vector3::from(ball.center_m)) / ball.radius_m, light(ball.colour))
            }
            (Paint::Plate(plate), Face::Rim) => {
                (tilted(&outward(plate.center_m), PLATE_SLOPE), light(plate.rim_colour))
            }
            (Paint::Plate(plate), Face::Underside) => (-up, light(plate.colour)),
            (Paint::Plate(plate), _) => {
                // The bowl rises towards the rim.
                let share = outward(plate.center_m).norm() / plate.inner_radius_m;
                let slope = 1.5 * PLATE_SLOPE * ((share - 0.75) / 0.25).clamp(0.0, 1.0);
                (tilted(&outward(plate.center_m), slope), light(plate.colour))
            }
            (Paint::Cup(cup), Face::Rim) => (up, light(cup.rim_colour)),
            (Paint::Cup(cup), Face::Inside) => {
                (-outward(cup.base_m) / cup.inner_radius_m, light(cup.colour))
            }
            (Paint::Cup(cup), Face::InnerFloor) => (up, light(cup.colour)),
            (Paint::Cup(cup), _) => (outward(cup.base_m) / cup.radius_m, light(cup.colour)),
        }
    }

    /// Own colour of a flat surface; `layer` keeps the grain of floor and table apart.
    fn material(
        &self,
        material: &Material,
        layer: u64,
        position: &Vector3<f64>,
        normal: Vector3<f64>,
        direction: &Vector3<f64>,
        depth: f64,
    ) -> Light {
        match *material {
            Material::Plain { colour } => light(colour),
            Material::Wood { colour, board_width_m } => {
                let slant = (normal.dot(direction).abs() / direction.norm()).max(0.05);
                let footprint_m = depth / (self.scene.intrinsics.fx * slant);
                // On upright faces the grain runs around the edge.
                let (along, across) = if normal.z > 0.5 {
                    (position.y, position.x)
                } else {
                    (position.x + position.y, position.z)
                };
                let seed = self.scene.description.texture_seed.wrapping_add(layer);
                light(colour) * wood(seed, along, across, board_width_m, footprint_m)
            }
        }
    }

    /// Share of a surface's own colour that reaches the camera.
    fn brightness(&self, point: &Point, hit: &Hit<'_, 'a>) -> f64 {
        let settings = &self.scene.description.light;
        let incidence = point.normal.dot(&self.towards_lamp).max(0.0);
        let (lamp_left, sky_left) = self.shadows.light_left(point);
        let depth_in_cup = match (hit.surface.paint, hit.face) {
            (Paint::Cup(cup), Face::Inside | Face::InnerFloor) => {
                1.0 - (point.position.z - cup.base_m[2]) / cup.height_m
            }
            _ => 0.0,
        };
        // Light falls into a cup from above only: the deeper, the less.
        let in_cup = 1.0 - 0.75 * depth_in_cup / (1.0 - CUP_FLOOR_SHARE);
        let sky = sky_left * (0.62 + 0.38 * point.normal.z);
        settings.ambient + in_cup * (settings.sky * sky + settings.lamp * incidence * lamp_left)
    }

    /// The lamp's soft reflection on glazed things.
    fn gloss(&self, point: &Point, direction: &Vector3<f64>, hit: &Hit<'_, 'a>) -> Light {
        let (strength, exponent) = match (hit.surface.paint, hit.face) {
            (Paint::Ball(_), _) => (0.42, 26),
            (Paint::Cup(_), Face::Outside) => (0.16, 18),
            (Paint::Plate(_), _) => (0.10, 24),
            _ => return Light::zeros(),
        };
        // Blinn's half-way vector.
        let half = (self.towards_lamp - direction.normalize()).normalize();
        let shine = point.normal.dot(&half).max(0.0).powi(exponent);
        Light::repeat(255.0 * self.scene.description.light.lamp * strength * shine)
    }
}

fn light(colour: Colour) -> Light {
    Light::from(colour.map(f64::from))
}

/// The upward normal of a surface that rises along `outward`.
fn tilted(outward: &Vector3<f64>, slope: f64) -> Vector3<f64> {
    let length = outward.norm().max(1e-9);
    (Vector3::z() - outward * (slope / length)).normalize()
}

fn box_normal(shape: &Shape<'_>, face: Face) -> Vector3<f64> {
    let Shape::Box(solid) = shape else { return Vector3::z() };
    let level = match face {
        Face::EndAhead => [1.0, 0.0],
        Face::EndBehind => [-1.0, 0.0],
        Face::SideLeft => [0.0, 1.0],
        Face::SideRight => [0.0, -1.0],
        _ => return Vector3::z(),
    };
    let [x, y] = solid.to_world_vector(level);
    Vector3::new(x, y, 0.0)
}
