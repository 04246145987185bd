//! The options of the [`Detector`], their ranges and their builder.

use thiserror::Error;

use crate::detector::Detector;
use crate::image::SIDE_PX_MAX;

/// An option outside its range.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("option {field} is {value}, allowed is {allowed}")]
pub struct OptionsError {
    /// Name of the field, as in `hough.bin_width_px`.
    pub field: &'static str,
    /// The value given.
    pub value: f64,
    /// The range allowed, in words.
    pub allowed: String,
}

/// Refuses a value outside `least..=greatest`, and one that is not a number.
pub(crate) fn check(
    field: &'static str,
    value: f64,
    least: f64,
    greatest: f64,
) -> Result<(), OptionsError> {
    if value >= least && value <= greatest {
        Ok(())
    } else {
        Err(OptionsError { field, value, allowed: format!("{least} to {greatest}") })
    }
}

/// What is reported of a drawn ring, a stroke with two edges of opposite sense.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Strokes {
    /// One ellipse: the line half way between the two edges. A ring so wide that its inner edge encloses less than
    /// a third of the outer edge's area is taken for two contours.
    #[default]
    MiddleLine,
    /// Both edges, an ellipse each.
    BothEdges,
}

/// A part of the picture, in pixels: the pixels whose columns lie in `left..left + width` and whose rows lie in
/// `top..top + height`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Region {
    /// First column.
    pub left: usize,
    /// First row.
    pub top: usize,
    /// Columns, at least 1.
    pub width: usize,
    /// Rows, at least 1.
    pub height: usize,
}

/// Everything that steers a detection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Least semi-minor axis in pixels, `1.5..=16384`. Below that a contour has too few pixels to tell it from noise.
    pub semi_axis_min_px: f64,
    /// Greatest semi-major axis in pixels, from the least semi-axis to 16384.
    pub semi_axis_max_px: f64,
    /// Least ratio of the semi-minor to the semi-major axis, `0.05..=1`.
    pub axis_ratio_min: f64,
    /// Least [score](crate::DetectedEllipse::score), `0..=1`.
    pub score_min: f64,
    /// The part of the picture that is looked at; all of it when `None`, and what of it lies inside the picture
    /// otherwise. Coordinates of the result are those of the whole picture.
    pub region: Option<Region>,
    /// What is reported of a drawn ring.
    pub strokes: Strokes,
    /// Whether the edge points on each contour are kept in [`Detection::support`](crate::Detection::support).
    pub support_points: bool,
    /// Whether each ellipse gets the [covariance](crate::DetectedEllipse::covariance) of its parameters.
    pub covariance: bool,
    /// Seed of the random draws. The same seed gives the same ellipses on any machine and any number of threads.
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            semi_axis_min_px: 2.0,
            semi_axis_max_px: SIDE_PX_MAX as f64,
            axis_ratio_min: 0.2,
            score_min: 0.6,
            region: None,
            strokes: Strokes::MiddleLine,
            support_points: false,
            covariance: false,
            seed: 1,
        }
    }
}

impl Options {
    /// Checks every field.
    ///
    /// # Errors
    /// The first field outside its range, by name, with its value and the range.
    pub fn validate(&self) -> Result<(), OptionsError> {
        let side_px = SIDE_PX_MAX as f64;
        check("semi_axis_min_px", self.semi_axis_min_px, 1.5, side_px)?;
        check("semi_axis_max_px", self.semi_axis_max_px, self.semi_axis_min_px, side_px)?;
        check("axis_ratio_min", self.axis_ratio_min, 0.05, 1.0)?;
        check("score_min", self.score_min, 0.0, 1.0)?;
        if let Some(region) = self.region {
            check("region.left", region.left as f64, 0.0, side_px)?;
            check("region.top", region.top as f64, 0.0, side_px)?;
            check("region.width", region.width as f64, 1.0, side_px)?;
            check("region.height", region.height as f64, 1.0, side_px)?;
        }
        Ok(())
    }
}

/// Makes a [`Detector`]; every method sets one of the [`Options`].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[must_use]
pub struct DetectorBuilder {
    options: Options,
}

impl DetectorBuilder {
    /// All options at once.
    pub fn options(mut self, options: Options) -> Self {
        self.options = options;
        self
    }

    /// Least semi-minor and greatest semi-major axis, in pixels; see [`Options::semi_axis_min_px`].
    pub fn semi_axes_px(mut self, least: f64, greatest: f64) -> Self {
        (self.options.semi_axis_min_px, self.options.semi_axis_max_px) = (least, greatest);
        self
    }

    /// Least ratio of the semi-axes; see [`Options::axis_ratio_min`].
    pub fn axis_ratio_min(mut self, ratio: f64) -> Self {
        self.options.axis_ratio_min = ratio;
        self
    }

    /// Least score; see [`Options::score_min`].
    pub fn score_min(mut self, score: f64) -> Self {
        self.options.score_min = score;
        self
    }

    /// The part of the picture to look at; see [`Options::region`].
    pub fn region(mut self, region: Option<Region>) -> Self {
        self.options.region = region;
        self
    }

    /// What is reported of a drawn ring; see [`Options::strokes`].
    pub fn strokes(mut self, strokes: Strokes) -> Self {
        self.options.strokes = strokes;
        self
    }

    /// Whether support points are kept; see [`Options::support_points`].
    pub fn support_points(mut self, keep: bool) -> Self {
        self.options.support_points = keep;
        self
    }

    /// Whether covariances are computed; see [`Options::covariance`].
    pub fn covariance(mut self, compute: bool) -> Self {
        self.options.covariance = compute;
        self
    }

    /// Seed of the random draws; see [`Options::seed`].
    pub fn seed(mut self, seed: u64) -> Self {
        self.options.seed = seed;
        self
    }

    /// Checks the options and makes the detector.
    ///
    /// # Errors
    /// The first option outside its range, by name, with its value and the range.
    pub fn build(self) -> Result<Detector, OptionsError> {
        Detector::with_options(self.options)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_field_is_checked_by_name() {
        let refused = |change: fn(&mut Options)| {
            let mut options = Options::default();
            change(&mut options);
            options.validate().unwrap_err().field
        };
        assert_eq!(refused(|o| o.semi_axis_min_px = 1.4), "semi_axis_min_px");
        assert_eq!(refused(|o| o.semi_axis_max_px = 1.9), "semi_axis_max_px");
        assert_eq!(refused(|o| o.axis_ratio_min = f64::NAN), "axis_ratio_min");
        assert_eq!(refused(|o| o.score_min = 1.1), "score_min");
        assert_eq!(
            refused(|o| o.region = Some(Region { left: 0, top: 0, width: 0, height: 9 })),
            "region.width"
        );
        assert!(Options::default().validate().is_ok());
    }

    #[test]
    fn an_error_names_field_value_and_range() {
        let error = Detector::builder().score_min(-1.0).build().unwrap_err();
        assert_eq!(error.to_string(), "option score_min is -1, allowed is 0 to 1");
    }
}
