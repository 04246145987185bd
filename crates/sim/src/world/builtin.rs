//! The worlds that come with the robot.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::{
    Ball, Colour, Cup, Light, Material, Plate, Table, Wall, World, WorldDescription, WorldError,
};

const OAK: Colour = [201, 158, 108];
const DARK_FLOOR: Colour = [139, 105, 76];
const PLASTER: Colour = [226, 219, 205];
const BACKDROP: Colour = [214, 219, 222];
const PORCELAIN: Colour = [244, 242, 236];

/// Low enough for the robot, 0.34 m high, to look down on.
const TABLE_HEIGHT_M: f64 = 0.06;

/// Names that [`World::named`] knows.
const NAMES: [&str; 3] = ["demo", "empty", "wall"];

/// A lamp high behind the robot's left shoulder.
fn room_light() -> Light {
    Light { towards_lamp: [-0.8, 0.5, 1.0], lamp: 0.64, sky: 0.34, ambient: 0.18 }
}

fn bare_floor(texture_seed: u64) -> WorldDescription {
    WorldDescription {
        texture_seed,
        floor: Material::Wood { colour: DARK_FLOOR, board_width_m: 0.14 },
        backdrop: BACKDROP,
        light: room_light(),
        table: None,
        balls: Vec::new(),
        plates: Vec::new(),
        cups: Vec::new(),
        walls: Vec::new(),
    }
}

fn low_table(center_m: [f64; 2], length_m: f64, width_m: f64) -> Table {
    let material = Material::Wood { colour: OAK, board_width_m: 0.16 };
    Table {
        name: "table".to_owned(),
        center_m,
        length_m,
        width_m,
        height_m: TABLE_HEIGHT_M,
        material,
    }
}

fn wall(name: &str, from_m: [f64; 2], to_m: [f64; 2]) -> Wall {
    Wall { name: name.to_owned(), from_m, to_m, thickness_m: 0.06, height_m: 2.4, colour: PLASTER }
}

fn skirting(name: &str, from_m: [f64; 2], to_m: [f64; 2]) -> Wall {
    Wall { thickness_m: 0.02, height_m: 0.07, colour: PORCELAIN, ..wall(name, from_m, to_m) }
}

fn plate(center_m: [f64; 3], name: String, radius_m: f64, rim_colour: Colour) -> Plate {
    Plate {
        name,
        center_m,
        radius_m,
        inner_radius_m: 0.68 * radius_m,
        colour: PORCELAIN,
        rim_colour,
    }
}

fn cup(base_m: [f64; 3], name: String, radius_m: f64, colour: Colour) -> Cup {
    Cup {
        name,
        base_m,
        radius_m,
        inner_radius_m: 0.84 * radius_m,
        height_m: 1.6 * radius_m,
        colour,
        rim_colour: [62, 44, 36],
    }
}

impl World {
    /// The built-in world of this name: `demo`, `empty` or `wall`.
    ///
    /// # Errors
    /// [`WorldError::UnknownWorld`] lists the names there are.
    pub fn named(name: &str) -> Result<Self, WorldError> {
        match name {
            "demo" => Ok(Self::demo()),
            "empty" => Ok(Self::empty()),
            "wall" => Ok(Self::wall()),
            _ => Err(WorldError::UnknownWorld { name: name.to_owned(), known: NAMES.join(", ") }),
        }
    }

    /// The names [`World::named`] knows.
    pub fn names() -> &'static [&'static str] {
        &NAMES
    }

    /// Nothing but the floor.
    pub fn empty() -> Self {
        built_in(bare_floor(1))
    }

    /// The floor and one wall, 0.22 m high, across the robot's way, its near face half a metre ahead of the start.
    pub fn wall() -> Self {
        let low = wall("wall", [0.53, -1.0], [0.53, 1.0]);
        let walls = vec![Wall { height_m: 0.22, ..low }];
        built_in(WorldDescription { walls, ..bare_floor(2) })
    }

    /// A low table along the right of the way with a ball, a plate and a cup on it, and walls around.
    ///
    /// The way ahead is free for 1.3 m. The ball is out of sight while the head looks straight ahead from the start,
    /// and can be looked at from the start as well as anywhere on the first half metre of the way.
    pub fn demo() -> Self {
        let table = low_table([0.50, -0.84], 1.70, 1.20);
        let top = table.height_m;
        built_in(WorldDescription {
            balls: vec![Ball {
                name: "ball".to_owned(),
                center_m: [0.56, -0.46, top + 0.08],
                radius_m: 0.08,
                colour: [196, 34, 38],
            }],
            plates: vec![plate(
                [0.73, -0.352, top + 0.012],
                "plate".to_owned(),
                0.09,
                [58, 98, 150],
            )],
            cups: vec![cup([0.48, -0.80, top], "cup".to_owned(), 0.055, [236, 226, 204])],
            walls: vec![
                wall("wall ahead", [1.45, -1.6], [1.45, 1.6]),
                skirting("skirting ahead", [1.41, -1.6], [1.41, 1.6]),
                wall("wall on the right", [1.45, -1.6], [-1.5, -1.6]),
            ],
            table: Some(table),
            ..bare_floor(7)
        })
    }

    /// A table, one to three balls, up to two plates and two cups, none overlapping, and a wall behind.
    ///
    /// The same seed gives the same world. Everything lies 0.55 m to 1.25 m ahead of the start and up to 0.6 m to
    /// either side.
    pub fn random(seed: u64) -> Self {
        let mut random = Pcg64::seed_from_u64(seed);
        let table = low_table([0.95, 0.0], 0.90, 1.60);
        let top = table.height_m;
        let mut taken: Vec<[f64; 3]> = Vec::new();
        let mut description = WorldDescription { texture_seed: seed, ..bare_floor(seed) };
        description.walls.push(wall(
            "wall ahead",
            [random.random_range(1.8..3.0), -3.0],
            [2.2, 3.0],
        ));
        for index in 1..=random.random_range(1..=3) {
            let radius_m = random.random_range(0.03..0.055);
            if let Some([x, y]) = free_place(&mut random, &mut taken, radius_m) {
                let colour = [[196, 34, 38], [30, 74, 160], [28, 110, 62], [92, 40, 112]]
                    [random.random_range(0..4)];
                let center_m = [x, y, top + radius_m];
                description.balls.push(Ball {
                    name: format!("ball {index}"),
                    center_m,
                    radius_m,
                    colour,
                });
            }
        }
        for index in 1..=random.random_range(0..=2) {
            let radius_m = random.random_range(0.08..0.125);
            if let Some([x, y]) = free_place(&mut random, &mut taken, radius_m) {
                let rim_colour =
                    [[58, 98, 150], [150, 60, 52], [70, 120, 92]][random.random_range(0..3)];
                description.plates.push(plate(
                    [x, y, top + 0.012],
                    format!("plate {index}"),
                    radius_m,
                    rim_colour,
                ));
            }
        }
        for index in 1..=random.random_range(0..=2) {
            let radius_m = random.random_range(0.034..0.048);
            if let Some([x, y]) = free_place(&mut random, &mut taken, radius_m) {
                let colour =
                    [[236, 226, 204], [120, 160, 176], [224, 180, 96]][random.random_range(0..3)];
                description.cups.push(cup([x, y, top], format!("cup {index}"), radius_m, colour));
            }
        }
        description.table = Some(table);
        built_in(description)
    }
}

/// A place (x, y) on the table where a circle of this radius overlaps none taken so far, and takes it.
fn free_place(random: &mut Pcg64, taken: &mut Vec<[f64; 3]>, radius_m: f64) -> Option<[f64; 2]> {
    const ATTEMPTS: usize = 64;
    (0..ATTEMPTS).find_map(|_| {
        let (x, y) = (random.random_range(0.55 + radius_m..1.25), random.random_range(-0.6..0.6));
        let free = taken.iter().all(|[other_x, other_y, other_radius]| {
            (x - other_x).hypot(y - other_y) > radius_m + other_radius + 0.01
        });
        free.then(|| {
            taken.push([x, y, radius_m]);
            [x, y]
        })
    })
}

/// A description written in this file, which a test has checked.
fn built_in(description: WorldDescription) -> World {
    World::new(description)
        .unwrap_or_else(|error| unreachable!("a built-in world is valid: {error}"))
}
