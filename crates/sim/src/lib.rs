#![doc = include_str!("../README.md")]
//!
//! Coordinates, units and picture conventions are told once, in [`world`] and [`camera`].

pub mod body;
pub mod camera;
pub mod control;
mod electronics;
pub mod firmware;
pub mod geometry;
pub mod line;
pub mod pace;
pub mod robot;
pub mod server;
mod shared;
pub mod world;

pub use robot::{VirtualRobot, VirtualRobotConfig};
pub use shared::SharedRobot;
