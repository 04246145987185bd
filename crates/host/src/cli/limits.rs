//! Which ellipses are wanted: options shared by every command that looks with the default detector.

use clap::Args;
use rsapien_vision::image::SIDE_PX_MAX;
use rsapien_vision::{Detector, Options};

use crate::cli::diagnostics::{Failure, Result};

/// Bounds of what the default detector finds.
#[derive(Debug, Clone, Args)]
pub(crate) struct LimitOptions {
    #[arg(long, value_name = "PX", allow_negative_numbers = true, help = usual(&format!("Least semi-minor axis in pixels, 1.5 to {SIDE_PX_MAX}"), |options| options.semi_axis_min_px))]
    min_axis: Option<f64>,

    #[arg(long, value_name = "PX", allow_negative_numbers = true, help = usual(&format!("Greatest semi-major axis in pixels, from the least axis to {SIDE_PX_MAX}"), |options| options.semi_axis_max_px))]
    max_axis: Option<f64>,

    #[arg(long, value_name = "RATIO", allow_negative_numbers = true, help = usual("Least ratio of the semi-minor to the semi-major axis, 0.05 to 1", |options| options.axis_ratio_min))]
    min_ratio: Option<f64>,

    #[arg(long, value_name = "S", allow_negative_numbers = true, help = usual("Least score, 0 to 1: how much speaks for an ellipse", |options| options.score_min))]
    min_score: Option<f64>,
}

/// Help that tells the default.
fn usual(text: &str, value: impl Fn(&Options) -> f64) -> String {
    format!("{text} [default: {}]", value(&Options::default()))
}

impl LimitOptions {
    /// The first of these flags that was given.
    pub(crate) fn given(&self) -> Option<&'static str> {
        let flags = [
            (self.min_axis.is_some(), "--min-axis"),
            (self.max_axis.is_some(), "--max-axis"),
            (self.min_ratio.is_some(), "--min-ratio"),
            (self.min_score.is_some(), "--min-score"),
        ];
        flags.into_iter().find_map(|(is_given, flag)| is_given.then_some(flag))
    }

    /// The detector of `options` within these bounds.
    pub(crate) fn detector(&self, options: Options) -> Result<Detector> {
        let options = Options {
            semi_axis_min_px: self.min_axis.unwrap_or(options.semi_axis_min_px),
            semi_axis_max_px: self.max_axis.unwrap_or(options.semi_axis_max_px),
            axis_ratio_min: self.min_ratio.unwrap_or(options.axis_ratio_min),
            score_min: self.min_score.unwrap_or(options.score_min),
            ..options
        };
        Detector::with_options(options).map_err(|error| {
            let flag = flag(error.field);
            Failure::from_error(&error).hint(format!("{} is set by {flag}", error.field))
        })
    }
}

/// The flag that sets a field of the detector's options; the region's is of `rsapien detect` alone.
fn flag(field: &str) -> &'static str {
    match field {
        "semi_axis_min_px" => "--min-axis",
        "semi_axis_max_px" => "--max-axis",
        "axis_ratio_min" => "--min-ratio",
        "score_min" => "--min-score",
        _ => "--region",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Axes and ratios down to these are promised by the help.
    #[test]
    fn the_ranges_told_are_the_detectors() {
        let limits = |min_axis, min_ratio| LimitOptions {
            min_axis: Some(min_axis),
            max_axis: Some(16_384.0),
            min_ratio: Some(min_ratio),
            min_score: Some(0.0),
        };
        assert!(limits(1.5, 0.05).detector(Options::default()).is_ok());
        for (least, ratio, named) in [(1.49, 0.05, "--min-axis"), (1.5, 0.049, "--min-ratio")] {
            let refused = limits(least, ratio).detector(Options::default()).unwrap_err();
            assert!(format!("{refused:?}").contains(named), "{refused:?}");
        }
    }
}
