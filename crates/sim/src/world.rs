//! What stands around the robot: floor, table, balls, plates, cups and walls.
//!
//! # Coordinates
//! Lengths are metres, angles radians. World axes are fixed where the robot starts: x points forward, y to the left,
//! z up; the floor is z = 0. Headings turn counter-clockwise seen from above, 0 along +x. (The camera's head speaks
//! the link's language instead, hundredths of a degree with pan to the right and tilt up positive: see
//! [`crate::camera::HeadAngles`]. Picture coordinates are told in [`crate::camera`].)
//!
//! A [`WorldDescription`] is plain data, in code or in JSON; a [`World`] is one that has been checked. Walls and the
//! table are solid: bumpers meet them and they stop the robot. Balls, plates and cups are light and are only seen.

mod builtin;
mod description;
mod error;
mod obstacles;
#[cfg(test)]
mod tests;

pub use description::{Ball, Colour, Cup, Light, Material, Plate, Table, Wall, WorldDescription};
pub use error::WorldError;
pub use obstacles::{Contact, Motion, RayHit, Solid};

use serde::{Deserialize, Serialize};

/// A checked world. It does not change; a changed one is made with [`World::new`] from a changed description.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "WorldDescription", into = "WorldDescription")]
pub struct World {
    description: WorldDescription,
    solids: Vec<Solid>,
}

impl World {
    /// Checks a description and prepares it for rendering and contact queries.
    ///
    /// # Errors
    /// [`WorldError`] names the first object whose size or place is outside the documented limits, a name used
    /// twice, or too many objects.
    pub fn new(description: WorldDescription) -> Result<Self, WorldError> {
        description.check()?;
        let table = description.table.iter().map(Solid::from_table);
        let solids = table.chain(description.walls.iter().map(Solid::from_wall)).collect();
        Ok(Self { description, solids })
    }

    /// Reads a world from the JSON form of [`WorldDescription`].
    ///
    /// # Errors
    /// [`WorldError::Json`] with line and column where the text is no description, otherwise as [`World::new`].
    pub fn from_json(text: &str) -> Result<Self, WorldError> {
        let description: WorldDescription =
            serde_json::from_str(text).map_err(|source| WorldError::Json { source })?;
        Self::new(description)
    }

    /// The world as JSON that [`World::from_json`] reads back to an equal world.
    ///
    /// # Errors
    /// [`WorldError::Json`] where the serialiser fails, which no checked world is known to bring about.
    pub fn to_json(&self) -> Result<String, WorldError> {
        serde_json::to_string_pretty(&self.description)
            .map_err(|source| WorldError::Json { source })
    }

    /// The data this world was made from.
    pub fn description(&self) -> &WorldDescription {
        &self.description
    }

    /// What blocks the robot: the table, if any, then the walls, as boxes standing on the floor.
    pub fn solids(&self) -> &[Solid] {
        &self.solids
    }
}

impl TryFrom<WorldDescription> for World {
    type Error = WorldError;

    fn try_from(description: WorldDescription) -> Result<Self, WorldError> {
        Self::new(description)
    }
}

impl From<World> for WorldDescription {
    fn from(world: World) -> Self {
        world.description
    }
}
