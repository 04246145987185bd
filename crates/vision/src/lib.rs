#![doc = include_str!("../README.md")]
// Coordinates, counts and grey values change their type often and deliberately; where a cast can lose something, the
// line beside it says why it does not.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    clippy::cast_possible_wrap
)]
// Formulas keep the letters of their sources.
#![allow(clippy::many_single_char_names)]
// The hot loops must be inlined into the function that is compiled for several instruction sets.
#![allow(clippy::inline_always)]

mod arc;
mod candidate;
mod chain;
mod covariance;
pub mod detection;
pub mod detector;
#[cfg(feature = "image")]
pub mod draw;
mod edges;
pub mod ellipse;
pub mod evaluate;
pub mod image;
#[cfg(feature = "image")]
pub mod io;
mod meaning;
pub mod options;
mod pairing;
pub mod paper;
pub mod pose;
mod search;
mod select;
mod shape;
mod stages;
mod support;
#[cfg(test)]
mod test_pictures;
pub mod tracker;
mod vote;

pub use detection::{DetectedEllipse, Detection, StageCost, Statistics, SupportPoint};
pub use detector::Detector;
pub use ellipse::Ellipse;
pub use image::{ColorView, GrayImage, GrayView, ImageError, PixelLayout};
#[cfg(feature = "image")]
pub use io::{Picture, PictureError};
pub use options::{DetectorBuilder, Options, OptionsError, Region, Strokes};
pub use stages::{ArcStage, Stages};
pub use tracker::{Track, TrackState, Tracker, TrackerOptions};
