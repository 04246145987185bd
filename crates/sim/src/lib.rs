//! The virtual robot: controllers, body, world and camera.
//!
//! Coordinates, units and picture conventions are told once, in [`world`] and [`camera`].

pub mod body;
pub mod camera;
pub mod geometry;
pub mod line;
pub mod robot;
pub mod world;

pub use robot::{VirtualRobot, VirtualRobotConfig};
