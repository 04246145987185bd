//! Which detector, and the options of the default one.

use std::str::FromStr;

use clap::{Args, ValueEnum};
use rsapien_vision::{Detector, Options, Region, Strokes};

use super::search::Search;
use super::tuning::Tuning;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::limits::LimitOptions;

/// Presets by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::cli::cmd) enum Preset {
    /// Arcs, votes and least squares: any size, between pixels, strokes by their middle line
    Default,
    /// The Randomized Hough Transform as the paper has it
    Paper,
}

impl Preset {
    /// Its name on the command line.
    pub(in crate::cli::cmd) fn name(self) -> &'static str {
        match self {
            Self::Default => "default",
            Self::Paper => "paper",
        }
    }
}

/// Everything that chooses and steers a detector.
#[derive(Debug, Clone, Args)]
pub(in crate::cli::cmd) struct DetectorOptions {
    /// Which detector; `default` where no option of the paper's is given, `paper` where one is
    #[arg(long, value_enum)]
    preset: Option<Preset>,

    /// Seed of the randomised search
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    /// Threads to use, 1 to 256; as many as the processor has by default
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=256))]
    threads: Option<u16>,

    #[command(flatten)]
    tuning: DefaultTuning,

    #[command(flatten)]
    paper: Tuning,
}

/// What steers the default detector.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Options of the preset default")]
struct DefaultTuning {
    #[command(flatten)]
    limits: LimitOptions,

    /// Look only at this part of the picture, in pixels: left, top, width, height; results stay those of the whole
    #[arg(long, value_name = "X,Y,W,H")]
    region: Option<RegionText>,

    /// What is told of a drawn ring: its middle line, or both its edges [default: middle]
    #[arg(long, value_enum)]
    strokes: Option<StrokesName>,

    /// Tell with --json the edge points on each contour: x, y, and the direction of the gradient in radians
    #[arg(long)]
    points: bool,

    /// Tell with --json the covariance of each ellipse's five numbers
    #[arg(long)]
    covariance: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum StrokesName {
    Middle,
    Edges,
}

/// A region as it is written on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct RegionText(Region);

impl FromStr for RegionText {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let wrong = || {
            format!(
                "expected left, top, width and height in pixels, such as 100,50,320,240, not {text:?}"
            )
        };
        let numbers: std::result::Result<Vec<usize>, _> =
            text.split(',').map(|number| number.trim().parse()).collect();
        let [left, top, width, height] = *numbers.map_err(|_| wrong())?.as_slice() else {
            return Err(wrong());
        };
        Ok(Self(Region { left, top, width, height }))
    }
}

impl DetectorOptions {
    /// The preset meant; `also` is a flag outside this group that only the paper's detector knows, when it was given.
    pub(in crate::cli::cmd) fn preset(&self, also: Option<&'static str>) -> Result<Preset> {
        let of_paper = self.paper.given().or(also);
        let of_default = self.tuning.given();
        match (self.preset, of_paper, of_default) {
            (Some(Preset::Default), Some(flag), _) => Err(Failure::new(format!(
                "{flag} belongs to the preset paper, and --preset default is asked for"
            ))
            .hint(format!("give --preset paper, or leave {flag} out"))),
            (None, Some(paper), Some(default)) => Err(Failure::new(format!(
                "{paper} belongs to the preset paper and {default} to the preset default"
            ))
            .hint("leave one of them out; see rsapien detect --help")),
            (Some(Preset::Paper), _, Some(flag)) => Err(Failure::new(format!(
                "{flag} belongs to the preset default, and --preset paper is asked for"
            ))
            .hint(format!(
                "leave {flag} or --preset out; the paper's axes are set by --semi-major and --semi-minor"
            ))),
            (Some(preset), _, _) => Ok(preset),
            (None, Some(_), None) => Ok(Preset::Paper),
            (None, None, _) => Ok(Preset::Default),
        }
    }

    /// The detector of this preset with the options given.
    pub(in crate::cli::cmd) fn search(&self, preset: Preset) -> Result<Search> {
        Ok(match preset {
            Preset::Default => Search::from(self.tuning.detector(self.seed)?),
            Preset::Paper => Search::paper(self.paper.detector()?, self.seed),
        })
    }

    /// The first flag given that asks for something about each ellipse which only JSON can tell.
    pub(in crate::cli::cmd) fn detail(&self) -> Option<&'static str> {
        let flags = [(self.tuning.points, "--points"), (self.tuning.covariance, "--covariance")];
        flags.into_iter().find_map(|(is_given, flag)| is_given.then_some(flag))
    }

    /// The threads that detections run on.
    pub(in crate::cli::cmd) fn threads(&self) -> Result<rayon::ThreadPool> {
        rayon::ThreadPoolBuilder::new()
            .num_threads(self.threads.map_or(0, usize::from))
            .build()
            .map_err(|error| Failure::from_error(&error))
    }
}

impl DefaultTuning {
    /// The first of these flags that was given.
    fn given(&self) -> Option<&'static str> {
        let flags = [
            (self.region.is_some(), "--region"),
            (self.strokes.is_some(), "--strokes"),
            (self.points, "--points"),
            (self.covariance, "--covariance"),
        ];
        let own = flags.into_iter().find_map(|(is_given, flag)| is_given.then_some(flag));
        self.limits.given().or(own)
    }

    fn detector(&self, seed: u64) -> Result<Detector> {
        let usual = Options::default();
        let options = Options {
            region: self.region.map(|region| region.0),
            strokes: match self.strokes {
                Some(StrokesName::Edges) => Strokes::BothEdges,
                Some(StrokesName::Middle) => Strokes::MiddleLine,
                None => usual.strokes,
            },
            support_points: self.points,
            covariance: self.covariance,
            seed,
            ..usual
        };
        self.limits.detector(options)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        options: DetectorOptions,
    }

    fn preset(line: &str, also: Option<&'static str>) -> Result<Preset> {
        let words = std::iter::once("rsapien").chain(line.split_whitespace());
        Line::try_parse_from(words).expect("a line").options.preset(also)
    }

    #[test]
    fn an_option_of_the_paper_asks_for_its_preset_and_never_against_what_is_said() {
        for (line, also, expected) in [
            ("", None, Preset::Default),
            ("--min-axis 5 --seed 3", None, Preset::Default),
            ("--quality 250", None, Preset::Paper),
            ("", Some("--table"), Preset::Paper),
            ("--preset paper --semi-major 20..60", Some("--table"), Preset::Paper),
        ] {
            assert_eq!(preset(line, also).unwrap(), expected, "{line}");
        }
        for (line, named) in [
            ("--preset default --noise median", "--noise"),
            ("--preset paper --region 1,2,3,4", "--region"),
            ("--quality 250 --min-score 0.5", "--min-score"),
        ] {
            let refused = preset(line, None).unwrap_err().to_string();
            assert!(refused.contains(named), "{line}: {refused}");
        }
    }

    #[test]
    fn regions_are_read_or_refused_with_an_example() {
        let region = Region { left: 1, top: 20, width: 300, height: 4 };
        assert_eq!("1, 20,300,4".parse(), Ok(RegionText(region)));
        for text in ["", "1,2,3", "1,2,3,4,5", "1,2,3,x", "-1,2,3,4"] {
            assert!(text.parse::<RegionText>().unwrap_err().contains("100,50,320,240"), "{text}");
        }
    }
}
