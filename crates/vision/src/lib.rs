#![doc = include_str!("../README.md")]
//!
//! # The stages
//!
//! | module | step | paper |
//! |---|---|---|
//! | [`image`] | grey picture | "greyscale transform" |
//! | [`noise`] | noise reduction | "noise reduction" |
//! | [`gradient`] | Sobel magnitude | "gradient image" |
//! | [`threshold`] | binary picture | "Maximum Variance Threshold" |
//! | [`edge`] | list of edge points | "edge pixels are white" |
//! | [`hough`] | random pairs, 1-D accumulator | equations (3) to (8) |
//! | [`filter`](mod@filter) | quality, both sides, proportion | section 3.1, Table 3 |
//! | [`cluster`](mod@cluster) | single pass at `D_T` | formulas (9), (10) |
//! | [`detect`] | all of it | Fig. 7 |

// Coordinates, counts and grey values change their type often and deliberately; where a cast can lose something, the
// line beside it says why it does not.
#![allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, clippy::cast_sign_loss)]
// The hot loops must be inlined into the function that is compiled for several instruction sets.
#![allow(clippy::inline_always)]

pub mod cluster;
pub mod detect;
#[cfg(feature = "image")]
pub mod draw;
pub mod edge;
pub mod ellipse;
pub mod filter;
pub mod gradient;
mod grid;
pub mod hough;
pub mod image;
#[cfg(feature = "image")]
pub mod io;
pub mod noise;
pub mod options;
#[cfg(test)]
mod test_pictures;
pub mod threshold;
mod vote;

pub use detect::{DetectedEllipse, Detection, Detector, Limit, StageCost, Stages, Statistics};
pub use edge::EdgePoint;
pub use ellipse::Ellipse;
pub use image::{ColorView, GrayImage, GrayView, ImageError, PixelLayout};
#[cfg(feature = "image")]
pub use io::{Picture, PictureError};
pub use options::{
    AngleMeasure, ClusterOptions, FilterOptions, HoughOptions, Options, OptionsError, Preset,
};
