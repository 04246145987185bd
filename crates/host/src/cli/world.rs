//! The virtual robot's world: `--world`.

use std::fs;
use std::path::Path;

use rsapien_sim::world::{World, WorldError};

use super::diagnostics::{Failure, Result};

/// What `--world` says in `--help`.
pub(crate) const HELP: &str = "World of the virtual robot: demo (a table with a ball, a plate and a cup), wall, empty, \
     random (things on a table by the seed), or a JSON file";

/// A built-in world by its name, `random`, or a JSON file.
pub(crate) fn named(name: &str, seed: u64) -> Result<World> {
    if name == "random" {
        return Ok(World::random(seed));
    }
    if World::names().contains(&name) {
        return World::named(name).map_err(|error| Failure::from_error(&error));
    }
    let path = Path::new(name);
    let known = format!("the worlds are {}, random, and JSON files", World::names().join(", "));
    let text = fs::read_to_string(path)
        .map_err(|error| Failure::file("read", path, &error).hint(known))?;
    World::from_json(&text).map_err(|error: WorldError| Failure::from_error(&error).within(name))
}
