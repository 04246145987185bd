//! The options of the preset `paper`.

use std::str::FromStr;

use clap::{Args, ValueEnum};
use rsapien_vision::paper::noise::NoiseReduction;
use rsapien_vision::paper::{Detector, Options};

use crate::cli::diagnostics::{Failure, Result};

/// What steers the detector of the paper.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Options of the preset paper; each of them asks for it")]
pub(super) struct Tuning {
    #[arg(long, value_name = "MIN..MAX", help = preset("Range of the semi-major axis in pixels: the paper's search domain", |options| range(options.hough.semi_major_min_px, options.hough.semi_major_max_px)))]
    semi_major: Option<AxisRange>,

    #[arg(long, value_name = "MIN..MAX", help = preset("Range of the semi-minor axis in pixels, at most the semi-major one", |options| range(options.hough.semi_minor_min_px, options.hough.semi_minor_max_px)))]
    semi_minor: Option<AxisRange>,

    #[arg(long, value_name = "POINTS", allow_negative_numbers = true, help = preset("Least number of edge points on a contour: the paper's \"ellipse quality\"", |options| options.filter.quality_min.to_string()))]
    quality: Option<u32>,

    #[arg(long, value_name = "C", allow_negative_numbers = true, help = preset("Pairs of points tried for every edge point: the paper's C", |options| options.hough.pairs_per_edge_point.to_string()))]
    pairs: Option<u32>,

    #[arg(long, value_name = "PIXELS", allow_negative_numbers = true, help = preset("Width of an accumulator bin in pixels: the paper's quantisation", |options| options.hough.bin_width_px.to_string()))]
    bin: Option<f32>,

    #[arg(long, value_name = "RATIO", allow_negative_numbers = true, help = preset("Least ratio of the points on the two sides of the major axis, 0 to 1", |options| options.filter.side_proportion_min.to_string()))]
    proportion: Option<f64>,

    #[arg(long, value_name = "D_T", allow_negative_numbers = true, help = preset("Greatest distance within a cluster: the paper's D_T", |options| options.cluster.distance_max.to_string()))]
    distance: Option<f64>,

    #[arg(long, value_name = "N", allow_negative_numbers = true, help = preset("Least number of virtual ellipses in a cluster", |options| options.cluster.members_min.to_string()))]
    members: Option<u32>,

    /// Noise reduction before the gradient
    #[arg(long, value_enum)]
    noise: Option<NoiseName>,
}

/// Help that tells the number of the preset.
fn preset(text: &str, value: impl Fn(&Options) -> String) -> String {
    format!("{text} [as in the paper: {}]", value(&Options::paper()))
}

fn range(least_px: f32, greatest_px: f32) -> String {
    format!("{least_px}..{greatest_px}")
}

/// Noise reductions by name.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum NoiseName {
    None,
    Median,
    Gaussian,
    MedianGaussian,
}

/// A range of semi-axes in pixels, written `30..90`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct AxisRange {
    least_px: f32,
    greatest_px: f32,
}

impl AxisRange {
    /// The least and the greatest, in pixels.
    pub(crate) const fn limits(self) -> (f32, f32) {
        (self.least_px, self.greatest_px)
    }
}

impl FromStr for AxisRange {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let wrong = || format!("expected two numbers of pixels such as 30..90, not {text:?}");
        let (least, greatest) = text.split_once("..").ok_or_else(wrong)?;
        let number = |text: &str| text.trim().parse::<f32>().map_err(|_| wrong());
        Ok(Self { least_px: number(least)?, greatest_px: number(greatest)? })
    }
}

impl Tuning {
    /// The first of these flags that was given.
    pub(super) fn given(&self) -> Option<&'static str> {
        let flags = [
            (self.semi_major.is_some(), "--semi-major"),
            (self.semi_minor.is_some(), "--semi-minor"),
            (self.quality.is_some(), "--quality"),
            (self.pairs.is_some(), "--pairs"),
            (self.bin.is_some(), "--bin"),
            (self.proportion.is_some(), "--proportion"),
            (self.distance.is_some(), "--distance"),
            (self.members.is_some(), "--members"),
            (self.noise.is_some(), "--noise"),
        ];
        flags.into_iter().find_map(|(is_given, flag)| is_given.then_some(flag))
    }

    /// The detector of the paper with the options given.
    pub(super) fn detector(&self) -> Result<Detector> {
        let mut options = Options::paper();
        let hough = &mut options.hough;
        if let Some(range) = self.semi_major {
            (hough.semi_major_min_px, hough.semi_major_max_px) =
                (range.least_px, range.greatest_px);
            // A semi-minor axis is at most the semi-major one; a range given for it is taken as it is.
            hough.semi_minor_max_px = hough.semi_minor_max_px.min(range.greatest_px);
            hough.semi_minor_min_px = hough.semi_minor_min_px.min(hough.semi_minor_max_px);
        }
        if let Some(range) = self.semi_minor {
            (hough.semi_minor_min_px, hough.semi_minor_max_px) =
                (range.least_px, range.greatest_px);
        }
        set(&mut hough.pairs_per_edge_point, self.pairs);
        set(&mut hough.bin_width_px, self.bin);
        set(&mut options.filter.quality_min, self.quality);
        set(&mut options.filter.side_proportion_min, self.proportion);
        set(&mut options.cluster.distance_max, self.distance);
        set(&mut options.cluster.members_min, self.members);
        set(&mut options.noise, self.noise.map(NoiseName::reduction));
        Detector::new(options).map_err(|error| {
            Failure::from_error(&error).hint(format!(
                "{} is set by {}",
                error.field,
                flag(error.field)
            ))
        })
    }
}

impl NoiseName {
    fn reduction(self) -> NoiseReduction {
        match self {
            Self::None => NoiseReduction::None,
            Self::Median => NoiseReduction::Median,
            Self::Gaussian => NoiseReduction::Gaussian,
            Self::MedianGaussian => NoiseReduction::MedianGaussian,
        }
    }
}

fn set<T>(field: &mut T, value: Option<T>) {
    if let Some(value) = value {
        *field = value;
    }
}

/// The flag that sets a field of the detector's options.
fn flag(field: &str) -> &'static str {
    let name = field.rsplit('.').next().unwrap_or(field);
    match name {
        "semi_major_min_px" | "semi_major_max_px" => "--semi-major",
        "semi_minor_min_px" | "semi_minor_max_px" => "--semi-minor",
        "pairs_per_edge_point" => "--pairs",
        "bin_width_px" => "--bin",
        "quality_min" => "--quality",
        "side_proportion_min" => "--proportion",
        "distance_max" => "--distance",
        "members_min" => "--members",
        _ => "the preset",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_read_or_refused_with_an_example() {
        assert_eq!("30..90".parse(), Ok(AxisRange { least_px: 30.0, greatest_px: 90.0 }));
        assert_eq!("7.5..12".parse(), Ok(AxisRange { least_px: 7.5, greatest_px: 12.0 }));
        for text in ["", "30", "30-90", "..", "30..", "a..b"] {
            assert!(text.parse::<AxisRange>().unwrap_err().contains("30..90"), "{text}");
        }
    }
}
