//! The virtual robot: controllers, body, world and camera.
//!
//! Coordinates, units and picture conventions are told once, in [`world`] and [`camera`].

pub mod camera;
pub mod geometry;
pub mod world;
