//! The plain data of a world, and its limits.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use super::WorldError;

/// Red, green and blue as shown on a screen, 0 to 255 each.
pub type Colour = [u8; 3];

/// Objects allowed in one world.
const MOST_OBJECTS: usize = 256;
/// Bytes allowed in a name.
const LONGEST_NAME: usize = 64;
/// Coordinates reach this far from the start, metres.
const FARTHEST_M: f64 = 100.0;
/// Smallest and largest radius of a ball, plate or cup, metres.
const RADIUS_M: (f64, f64) = (0.002, 1.0);

/// What a flat surface is made of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Material {
    /// One colour everywhere.
    Plain {
        /// The colour.
        colour: Colour,
    },
    /// Boards of wood, their grain drawn from the world's seed.
    Wood {
        /// Mean colour of the boards.
        colour: Colour,
        /// Width of a board in metres, 0.02 to 10.
        board_width_m: f64,
    },
}

/// A low solid table: a box on the floor, its sides along the world's axes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Table {
    /// Name, unique in the world.
    pub name: String,
    /// Middle of the top: x, y in metres.
    pub center_m: [f64; 2],
    /// Extent along x in metres, 0.01 to 100.
    pub length_m: f64,
    /// Extent along y in metres, 0.01 to 100.
    pub width_m: f64,
    /// Height of the top above the floor in metres, 0.005 to 3.
    pub height_m: f64,
    /// What it is made of.
    pub material: Material,
}

/// A ball.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ball {
    /// Name, unique in the world.
    pub name: String,
    /// Centre: x, y, z in metres.
    pub center_m: [f64; 3],
    /// Radius in metres, 0.002 to 1.
    pub radius_m: f64,
    /// Colour.
    pub colour: Colour,
}

/// A plate: a flat round disc, its rim ring of another colour.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plate {
    /// Name, unique in the world.
    pub name: String,
    /// Middle of the disc: x, y, z in metres; z is the height of its upper face.
    pub center_m: [f64; 3],
    /// Outer radius of the rim in metres, 0.002 to 1.
    pub radius_m: f64,
    /// Inner radius of the rim in metres, 0.001 up to the outer radius.
    pub inner_radius_m: f64,
    /// Colour inside the rim.
    pub colour: Colour,
    /// Colour of the rim ring.
    pub rim_colour: Colour,
}

/// A cup: an upright open cylinder, its upper edge a flat ring (dark on the cups of the paper's Fig. 9).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cup {
    /// Name, unique in the world.
    pub name: String,
    /// Middle of the base: x, y, z in metres.
    pub base_m: [f64; 3],
    /// Outer radius in metres, 0.002 to 1.
    pub radius_m: f64,
    /// Inner radius in metres, 0.001 up to the outer radius.
    pub inner_radius_m: f64,
    /// Height in metres, 0.005 to 2.
    pub height_m: f64,
    /// Colour of the wall.
    pub colour: Colour,
    /// Colour of the rim ring.
    pub rim_colour: Colour,
}

/// A straight wall: a box on the floor around the segment from one point to another.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wall {
    /// Name, unique in the world.
    pub name: String,
    /// One end of the middle line: x, y in metres.
    pub from_m: [f64; 2],
    /// The other end, at least 0.01 m away.
    pub to_m: [f64; 2],
    /// Thickness in metres, 0.001 to 5, half on either side of the middle line.
    pub thickness_m: f64,
    /// Height in metres, 0.005 to 20.
    pub height_m: f64,
    /// Colour.
    pub colour: Colour,
}

/// One distant lamp, the light of the sky above, and light from everywhere; each 0 to 2, their sum about 1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Light {
    /// Direction towards the lamp: x, y, z of any length above zero; z above zero.
    pub towards_lamp: [f64; 3],
    /// Share of the lamp: falls off with the cosine of the angle of incidence and casts soft shadows.
    pub lamp: f64,
    /// Share of the sky: brightest on upward faces, dimmed where objects touch.
    pub sky: f64,
    /// Share that reaches every face alike, without shading.
    pub ambient: f64,
}

/// Everything a world is made of. Coordinates as told in [the module](crate::world).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WorldDescription {
    /// Seed of the textures; the same seed draws the same grain.
    #[serde(default)]
    pub texture_seed: u64,
    /// The endless floor at z = 0.
    pub floor: Material,
    /// What is seen above the horizon.
    pub backdrop: Colour,
    /// How it is lit.
    pub light: Light,
    /// The table, if there is one.
    #[serde(default)]
    pub table: Option<Table>,
    /// Balls.
    #[serde(default)]
    pub balls: Vec<Ball>,
    /// Plates.
    #[serde(default)]
    pub plates: Vec<Plate>,
    /// Cups.
    #[serde(default)]
    pub cups: Vec<Cup>,
    /// Walls.
    #[serde(default)]
    pub walls: Vec<Wall>,
}

impl WorldDescription {
    /// Height in metres of what lies under the point (`x_m`, `y_m`): the table's top or the floor.
    pub fn surface_height_m(&self, x_m: f64, y_m: f64) -> f64 {
        self.table
            .as_ref()
            .filter(|table| {
                let [center_x, center_y] = table.center_m;
                (x_m - center_x).abs() <= 0.5 * table.length_m
                    && (y_m - center_y).abs() <= 0.5 * table.width_m
            })
            .map_or(0.0, |table| table.height_m)
    }

    pub(super) fn check(&self) -> Result<(), WorldError> {
        let names = || {
            (self.table.iter().map(|table| &table.name))
                .chain(self.balls.iter().map(|ball| &ball.name))
                .chain(self.plates.iter().map(|plate| &plate.name))
                .chain(self.cups.iter().map(|cup| &cup.name))
                .chain(self.walls.iter().map(|wall| &wall.name))
        };
        let count = names().count();
        if count > MOST_OBJECTS {
            return Err(WorldError::TooManyObjects { count, most: MOST_OBJECTS });
        }
        let mut seen = BTreeSet::new();
        for name in names() {
            if name.is_empty() || name.len() > LONGEST_NAME {
                return Err(WorldError::NameLength { length: name.len(), most: LONGEST_NAME });
            }
            if !seen.insert(name) {
                return Err(WorldError::DuplicateName { name: name.clone() });
            }
        }
        self.light.check()?;
        self.floor.check("floor")?;
        self.table.iter().try_for_each(Table::check)?;
        self.balls.iter().try_for_each(Ball::check)?;
        self.plates.iter().try_for_each(Plate::check)?;
        self.cups.iter().try_for_each(Cup::check)?;
        self.walls.iter().try_for_each(Wall::check)
    }
}

fn within(
    object: &str,
    quantity: &'static str,
    value: f64,
    (least, most): (f64, f64),
) -> Result<(), WorldError> {
    // Written so that a value that is no number is refused too.
    if value >= least && value <= most {
        Ok(())
    } else {
        Err(WorldError::OutOfRange { object: object.to_owned(), quantity, value, least, most })
    }
}

fn near_enough(object: &str, place_m: &[f64]) -> Result<(), WorldError> {
    place_m
        .iter()
        .try_for_each(|&value| within(object, "a coordinate (m)", value, (-FARTHEST_M, FARTHEST_M)))
}

impl Material {
    fn check(&self, object: &str) -> Result<(), WorldError> {
        match self {
            Self::Plain { .. } => Ok(()),
            Self::Wood { board_width_m, .. } => {
                within(object, "the width of a board (m)", *board_width_m, (0.02, 10.0))
            }
        }
    }
}

impl Light {
    fn check(&self) -> Result<(), WorldError> {
        let [x, y, z] = self.towards_lamp;
        within("light", "x towards the lamp", x, (-1000.0, 1000.0))?;
        within("light", "y towards the lamp", y, (-1000.0, 1000.0))?;
        within("light", "z towards the lamp", z, (0.001, 1000.0))?;
        within("light", "the lamp's share", self.lamp, (0.0, 2.0))?;
        within("light", "the sky's share", self.sky, (0.0, 2.0))?;
        within("light", "the ambient share", self.ambient, (0.0, 2.0))
    }
}

impl Table {
    fn check(&self) -> Result<(), WorldError> {
        near_enough(&self.name, &self.center_m)?;
        within(&self.name, "the length (m)", self.length_m, (0.01, FARTHEST_M))?;
        within(&self.name, "the width (m)", self.width_m, (0.01, FARTHEST_M))?;
        within(&self.name, "the height (m)", self.height_m, (0.005, 3.0))?;
        self.material.check(&self.name)
    }
}

impl Ball {
    fn check(&self) -> Result<(), WorldError> {
        near_enough(&self.name, &self.center_m)?;
        within(&self.name, "the radius (m)", self.radius_m, RADIUS_M)
    }
}

impl Plate {
    fn check(&self) -> Result<(), WorldError> {
        near_enough(&self.name, &self.center_m)?;
        within(&self.name, "the radius (m)", self.radius_m, RADIUS_M)?;
        within(&self.name, "the inner radius (m)", self.inner_radius_m, (0.001, self.radius_m))
    }
}

impl Cup {
    fn check(&self) -> Result<(), WorldError> {
        near_enough(&self.name, &self.base_m)?;
        within(&self.name, "the radius (m)", self.radius_m, RADIUS_M)?;
        within(&self.name, "the inner radius (m)", self.inner_radius_m, (0.001, self.radius_m))?;
        within(&self.name, "the height (m)", self.height_m, (0.005, 2.0))
    }
}

impl Wall {
    fn check(&self) -> Result<(), WorldError> {
        near_enough(&self.name, &self.from_m)?;
        near_enough(&self.name, &self.to_m)?;
        let length_m = (self.to_m[0] - self.from_m[0]).hypot(self.to_m[1] - self.from_m[1]);
        within(&self.name, "the length (m)", length_m, (0.01, 4.0 * FARTHEST_M))?;
        within(&self.name, "the thickness (m)", self.thickness_m, (0.001, 5.0))?;
        within(&self.name, "the height (m)", self.height_m, (0.005, 20.0))
    }
}
