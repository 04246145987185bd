//! The whole detector: the stages in their order, with what each found and cost.

use std::time::{Duration, Instant};

use crate::ellipse::Ellipse;
use crate::image::{GrayImage, GrayView};
use crate::options::OptionsError;
use crate::paper::cluster::cluster;
use crate::paper::edge::{EdgePoint, edge_points};
use crate::paper::filter::filter;
use crate::paper::gradient::sobel_magnitude;
use crate::paper::hough::{Candidate, search};
use crate::paper::noise::reduce_noise;
use crate::paper::options::Options;
use crate::paper::threshold::{binarize, level};

/// Most virtual ellipses that are clustered: those of the highest quality.
pub const VIRTUAL_ELLIPSES_MAX: usize = 4096;

/// A detector with checked options. Cheap to make and to copy; holds no picture and no scratch memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Detector {
    options: Options,
}

/// One ellipse of the result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DetectedEllipse {
    /// The ellipse, in canonical form: the member of its cluster nearest to the centroid.
    pub ellipse: Ellipse,
    /// The paper's "ellipse quality": edge points on its contour.
    pub quality: u32,
    /// Virtual ellipses in its cluster.
    pub members: usize,
}

/// A bound that a detection met, so that it looked at less than the options ask for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Limit {
    /// More of the picture is edge than `edge_share_max` allows: taken for noise, not searched.
    EdgeShare,
    /// Fewer pairs were voted on than `C n`; see the limits in [`hough`](crate::paper::hough).
    Pairs,
    /// Of the virtual ellipses only the best [`VIRTUAL_ELLIPSES_MAX`] were clustered.
    VirtualEllipses,
}

/// The paper's Table 3 for one picture, and what the search did.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Statistics {
    /// "Total edge points".
    pub edge_points: usize,
    /// "Search point pairs": pairs drawn within the search domain and voted on.
    pub search_point_pairs: usize,
    /// Draws of two points, those outside the search domain included.
    pub draws: usize,
    /// Points near the pairs: at most as many votes, since not every point falls in the accumulator.
    pub votes: usize,
    /// "Virtual ellipses": candidates that passed the filters, before clustering.
    pub virtual_ellipses: usize,
    /// "Real ellipses": clusters reported.
    pub real_ellipses: usize,
    /// "Ellipse quality": the threshold in force.
    pub quality_min: u32,
    /// Level of the Maximum Variance Threshold; `None` when the gradient picture is constant.
    pub threshold_level: Option<u8>,
    /// Limits met, empty for any picture of reasonable size and content.
    pub limits: Vec<Limit>,
}

/// Wall time of each stage.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct StageCost {
    /// Noise reduction.
    pub noise: Duration,
    /// Gradient magnitude.
    pub gradient: Duration,
    /// Threshold and binary picture.
    pub threshold: Duration,
    /// List of edge points.
    pub edge: Duration,
    /// Randomized Hough Transform.
    pub hough: Duration,
    /// Filters.
    pub filter: Duration,
    /// Clustering.
    pub cluster: Duration,
}

impl StageCost {
    /// The stages by name in their order.
    pub fn by_stage(&self) -> [(&'static str, Duration); 7] {
        [
            ("noise", self.noise),
            ("gradient", self.gradient),
            ("threshold", self.threshold),
            ("edge", self.edge),
            ("hough", self.hough),
            ("filter", self.filter),
            ("cluster", self.cluster),
        ]
    }

    /// All stages together.
    pub fn total(&self) -> Duration {
        self.by_stage().iter().map(|(_, cost)| *cost).sum()
    }
}

/// What a detection found.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Detection {
    /// The ellipses, in the order of falling quality of the clusters' founders.
    pub ellipses: Vec<DetectedEllipse>,
    /// Counts for the paper's Table 3.
    pub statistics: Statistics,
    /// What each stage cost.
    pub cost: StageCost,
}

impl Detection {
    /// Whether a [`Limit`] was met, so that ellipses may be missing.
    pub fn truncated(&self) -> bool {
        !self.statistics.limits.is_empty()
    }
}

/// The pictures and lists between the stages.
#[derive(Debug, Clone, PartialEq)]
pub struct Stages {
    /// After noise reduction.
    pub denoised: GrayImage,
    /// Gradient magnitude, clipped to 8 bits.
    pub gradient: GrayImage,
    /// Edges white, the rest black.
    pub binary: GrayImage,
    /// The edge points row by row.
    pub edge_points: Vec<EdgePoint>,
    /// Candidates that passed the filters.
    pub virtual_ellipses: Vec<Candidate>,
}

impl Detector {
    /// A detector with these options.
    ///
    /// # Errors
    /// The first option outside its range.
    pub fn new(options: Options) -> Result<Self, OptionsError> {
        options.validate()?;
        Ok(Self { options })
    }

    /// The paper's detector.
    pub fn paper() -> Self {
        Self { options: Options::paper() }
    }

    /// The options in force.
    pub fn options(&self) -> &Options {
        &self.options
    }

    /// Finds the ellipses of a picture. The same picture, options and seed give the same ellipses on any number of threads; it
    /// runs on rayon's current pool (`rayon::ThreadPool::install` chooses another).
    pub fn detect(&self, picture: &GrayView<'_>, seed: u64) -> Detection {
        self.detect_with_stages(picture, seed).0
    }

    /// Like [`detect`](Self::detect), with everything between the stages beside the result.
    pub fn detect_with_stages(&self, picture: &GrayView<'_>, seed: u64) -> (Detection, Stages) {
        let options = &self.options;
        let mut cost = StageCost::default();
        let denoised = timed(&mut cost.noise, || reduce_noise(picture, options.noise));
        let gradient = timed(&mut cost.gradient, || sobel_magnitude(&denoised.view()));
        let (threshold_level, binary) = timed(&mut cost.threshold, || {
            let level = level(&gradient.view(), options.threshold);
            (level, binarize(&gradient.view(), level))
        });
        let points = timed(&mut cost.edge, || edge_points(&binary.view()));

        let mut limits = Vec::new();
        let area_px = (picture.width() * picture.height()) as f64;
        let searched = if points.len() as f64 > options.edge_share_max * area_px {
            limits.push(Limit::EdgeShare);
            &[]
        } else {
            points.as_slice()
        };
        let found = timed(&mut cost.hough, || {
            search(searched, &options.hough, options.filter.side_votes_min(), seed)
        });
        if found.truncated() {
            limits.push(Limit::Pairs);
        }
        let mut virtual_ellipses =
            timed(&mut cost.filter, || filter(&found.candidates, &options.filter));
        if virtual_ellipses.len() > VIRTUAL_ELLIPSES_MAX {
            limits.push(Limit::VirtualEllipses);
            virtual_ellipses.sort_by_key(|candidate| std::cmp::Reverse(candidate.quality()));
            virtual_ellipses.truncate(VIRTUAL_ELLIPSES_MAX);
        }
        let clusters = timed(&mut cost.cluster, || cluster(&virtual_ellipses, &options.cluster));

        let ellipses: Vec<_> = clusters
            .iter()
            .map(|cluster| DetectedEllipse {
                ellipse: cluster.representative.ellipse,
                quality: cluster.representative.quality(),
                members: cluster.members,
            })
            .collect();
        let statistics = Statistics {
            edge_points: points.len(),
            search_point_pairs: found.pairs,
            draws: found.draws,
            votes: found.votes,
            virtual_ellipses: virtual_ellipses.len(),
            real_ellipses: ellipses.len(),
            quality_min: options.filter.quality_min,
            threshold_level,
            limits,
        };
        let stages = Stages { denoised, gradient, binary, edge_points: points, virtual_ellipses };
        (Detection { ellipses, statistics, cost }, stages)
    }
}

/// Runs a stage and notes its wall time.
fn timed<T>(cost: &mut Duration, stage: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = stage();
    *cost = start.elapsed();
    result
}

#[cfg(test)]
mod tests;
