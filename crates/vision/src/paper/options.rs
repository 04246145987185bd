//! The paper's detector's options and their ranges.

use crate::options::{OptionsError, check};
use crate::paper::noise::NoiseReduction;
use crate::paper::threshold::Threshold;
use crate::paper::vote::{Accumulator, BINS_MAX};

/// Everything that steers a detection, stage by stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Noise reduction of the grey picture.
    pub noise: NoiseReduction,
    /// Binarization of the gradient picture.
    pub threshold: Threshold,
    /// Largest share of pixels that may be edges, in `0..=1`. The paper's detector wants contours that are "well
    /// defined" and noise "greatly reduced"; a picture above this share is noise, and the search is not started.
    pub edge_share_max: f64,
    /// Randomized Hough Transform.
    pub hough: HoughOptions,
    /// Filters of false ellipses.
    pub filter: FilterOptions,
    /// Clustering.
    pub cluster: ClusterOptions,
}

/// Options of [`hough::search`](crate::paper::hough::search).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HoughOptions {
    /// The paper's C: pairs tried for every edge point, `1..=1000`.
    pub pairs_per_edge_point: u32,
    /// Least semi-major axis in pixels, `1..=2000`: with the greatest one the paper's search domain.
    pub semi_major_min_px: f32,
    /// Greatest semi-major axis in pixels, from the least one to 2000.
    pub semi_major_max_px: f32,
    /// Least semi-minor axis in pixels, from 1 to the greatest one.
    pub semi_minor_min_px: f32,
    /// Greatest semi-minor axis in pixels, up to the greatest semi-major axis.
    pub semi_minor_max_px: f32,
    /// Width of an accumulator bin in pixels, `0.25..=50`: the paper's quantisation.
    pub bin_width_px: f32,
}

/// Options of [`filter`](crate::paper::filter::filter()).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilterOptions {
    /// Least number of edge points on the contour: "ellipse quality" of Table 3, `1..`.
    pub quality_min: u32,
    /// Least ratio of the points on the poorer side of the major axis to those on the richer one, `0..=1`.
    pub side_proportion_min: f64,
}

/// Options of [`cluster`](crate::paper::cluster::cluster()).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClusterOptions {
    /// The paper's `D_T`: greatest distance (10) from the centroid at which an ellipse belongs to a cluster, above 0.
    pub distance_max: f64,
    /// How the angle enters the distance (10).
    pub angle: AngleMeasure,
    /// Least number of members of a cluster that is reported, `1..`. 2 drops the single ones, as the authors'
    /// own program does; the paper does not mention it.
    pub members_min: u32,
}

/// How a difference of angles counts beside differences in pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AngleMeasure {
    /// As it is, in radians: next to pixels practically nothing.
    #[default]
    Radians,
    /// As the number of pixels by which it moves the ends of the axes off the contour: `(a - b) Δα`, with the axes of the
    /// centroid. Nothing for a circle, which has no angle.
    ContourShift,
}

impl Options {
    /// The paper's detector.
    ///
    /// | option | value | source |
    /// |---|---|---|
    /// | `pairs_per_edge_point` | 2 | "in our current implementation C = 2" |
    /// | `distance_max` | 20 | "we used `D_T` = 20" |
    /// | `threshold` | maximum variance | "we use the Maximum Variance Threshold" |
    /// | semi-axes | 36 to 75, 15 to 75 px | the paper gives no range; Table 2 lists 44 to 64 and 22 to 43 |
    /// | `bin_width_px`, `quality_min` | 4, 390 | measured; Table 3 lists 200 to 300 for bins of unknown width |
    /// | `side_proportion_min` | 0.5 | measured; the paper says "proportional" |
    /// | `noise` | Gaussian | measured; the paper names no filter |
    /// | `angle` | contour shift | measured; the paper names no unit of α beside pixels |
    /// | `members_min` | 1 | the paper says nothing of dropping single members |
    /// | `edge_share_max` | 0.2 | an addition: refuses noise. The paper's pictures have about 0.05 |
    ///
    /// `docs/detector-paper.md` in the repository tells what was measured.
    pub fn paper() -> Self {
        Self {
            noise: NoiseReduction::Gaussian,
            threshold: Threshold::MaximumVariance,
            edge_share_max: 0.2,
            hough: HoughOptions {
                pairs_per_edge_point: 2,
                semi_major_min_px: 36.0,
                semi_major_max_px: 75.0,
                semi_minor_min_px: 15.0,
                semi_minor_max_px: 75.0,
                bin_width_px: 4.0,
            },
            filter: FilterOptions { quality_min: 390, side_proportion_min: 0.5 },
            cluster: ClusterOptions {
                distance_max: 20.0,
                members_min: 1,
                angle: AngleMeasure::ContourShift,
            },
        }
    }

    /// Checks every field.
    ///
    /// # Errors
    /// The first field outside its range, by name, with its value and the range.
    pub fn validate(&self) -> Result<(), OptionsError> {
        check("edge_share_max", self.edge_share_max, 0.0, 1.0)?;
        self.hough.validate()?;
        check("filter.quality_min", f64::from(self.filter.quality_min), 1.0, f64::from(u32::MAX))?;
        check("filter.side_proportion_min", self.filter.side_proportion_min, 0.0, 1.0)?;
        check("cluster.distance_max", self.cluster.distance_max, 1e-6, 1e6)?;
        check("cluster.members_min", f64::from(self.cluster.members_min), 1.0, f64::from(u32::MAX))
    }
}

impl Default for Options {
    fn default() -> Self {
        Self::paper()
    }
}

/// Greatest semi-axis that the search domain may reach, in pixels.
pub const SEMI_AXIS_PX_MAX: f32 = 2000.0;

impl HoughOptions {
    /// Checks every field.
    ///
    /// # Errors
    /// The first field outside its range, by name, with its value and the range.
    pub fn validate(&self) -> Result<(), OptionsError> {
        let between = |field, value: f32, least: f32, greatest: f32| {
            check(field, f64::from(value), f64::from(least), f64::from(greatest))
        };
        check("hough.pairs_per_edge_point", f64::from(self.pairs_per_edge_point), 1.0, 1000.0)?;
        between("hough.semi_major_min_px", self.semi_major_min_px, 1.0, SEMI_AXIS_PX_MAX)?;
        between(
            "hough.semi_major_max_px",
            self.semi_major_max_px,
            self.semi_major_min_px,
            SEMI_AXIS_PX_MAX,
        )?;
        between("hough.semi_minor_min_px", self.semi_minor_min_px, 1.0, self.semi_major_max_px)?;
        between(
            "hough.semi_minor_max_px",
            self.semi_minor_max_px,
            self.semi_minor_min_px,
            self.semi_major_max_px,
        )?;
        between("hough.bin_width_px", self.bin_width_px, 0.25, 50.0)?;
        // Validated ranges keep this small; the accumulator has a fixed number of bins.
        if self.bins() > BINS_MAX {
            return Err(OptionsError {
                field: "hough.bin_width_px",
                value: f64::from(self.bin_width_px),
                allowed: format!(
                    "at least {} for this range of the semi-minor axis",
                    (self.semi_minor_max_px - self.semi_minor_min_px) / (BINS_MAX - 1) as f32
                ),
            });
        }
        Ok(())
    }

    /// Bins from the least to the greatest semi-minor axis.
    fn bins(&self) -> usize {
        ((self.semi_minor_max_px - self.semi_minor_min_px) / self.bin_width_px) as usize + 1
    }

    pub(crate) fn accumulator(&self) -> Accumulator {
        Accumulator::new(self.semi_minor_min_px, self.bin_width_px, self.bins())
    }
}

impl FilterOptions {
    /// Votes that either side of an axis must have for a candidate to pass: with the proportion `p` between the sides and
    /// the quality `q` in all, `q p / (1 + p)`, cut down to an integer.
    pub fn side_votes_min(&self) -> u32 {
        let p = self.side_proportion_min;
        // At most half of a u32.
        (f64::from(self.quality_min) * p / (1.0 + p)) as u32
    }
}
