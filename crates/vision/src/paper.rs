//! The paper's detector, preset `paper`: exact, tested and left as it is.
//!
//! C. Başca, M. Taloş and R. Brad, "Humanoid robot with vision recognition control system", section 3.1.
//!
//! | module | step | paper |
//! |---|---|---|
//! | [`image`](crate::image) | grey picture | "greyscale transform" |
//! | [`noise`] | noise reduction | "noise reduction" |
//! | [`gradient`] | Sobel magnitude | "gradient image" |
//! | [`threshold`] | binary picture | "Maximum Variance Threshold" |
//! | [`edge`] | list of edge points | "edge pixels are white" |
//! | [`hough`] | random pairs, 1-D accumulator | equations (3) to (8) |
//! | [`filter`](mod@filter) | quality, both sides, proportion | section 3.1, Table 3 |
//! | [`cluster`](mod@cluster) | single pass at `D_T` | formulas (9), (10) |
//! | [`detect`] | all of it | Fig. 7 |

pub mod cluster;
pub mod detect;
pub mod edge;
pub mod filter;
pub mod gradient;
mod grid;
pub mod hough;
pub mod noise;
pub mod options;
pub mod threshold;
mod vote;

pub use detect::{DetectedEllipse, Detection, Detector, Limit, StageCost, Stages, Statistics};
pub use edge::EdgePoint;
pub use options::{AngleMeasure, ClusterOptions, FilterOptions, HoughOptions, Options};
