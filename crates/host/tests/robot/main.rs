//! The library against the virtual robot, on a virtual clock unless a test needs a real one.
#![cfg(feature = "virtual")]

mod common;
mod controllers;
#[cfg(all(unix, feature = "serial"))]
mod doctor;
mod links;
mod perform;
mod player;
#[cfg(all(unix, feature = "serial"))]
mod serial;
mod stage;
