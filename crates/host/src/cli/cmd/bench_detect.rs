//! `rsapien bench-detect`: what a detection costs, by preset and by the size of the picture.

mod plot;
mod scene;

use std::io::Write;
use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;
use rsapien_vision::image::check_size;
use rsapien_vision::{Detector, paper};
use serde::Serialize;

use super::detect::{Preset, Search};
use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::exit::Status;
use crate::cli::output::{Table, json_line};
use crate::cli::progress::Progress;
use crate::cli::signal::Interrupt;

/// Scenes of each size; each is drawn by a seed of its own.
const SCENES: u64 = 3;

/// Time the detector of every preset, by the size of the picture
///
/// The pictures are drawn anew by every run and are always the same: shaded ground with noise, lines, boxes, and twelve
/// discs and rings, in three arrangements. Everything but the noise and the sharpness of the edges grows with the picture,
/// so that a picture of four times the pixels has about twice the edge points.
///
/// `ms` is the median over the scenes and --repeat runs of each, after one that does not count; edge points and ellipses
/// are means over the scenes.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien bench-detect --threads 1
  rsapien bench-detect --sizes 640x480,1920x1080 --presets default --repeat 20
  rsapien bench-detect --csv --plot cost.svg > cost.csv")]
pub(crate) struct Cmd {
    /// Sizes of the pictures in pixels, width x height
    #[arg(
        long,
        value_name = "WxH",
        value_delimiter = ',',
        default_value = "320x240,640x480,1280x960,1920x1080,3840x2160"
    )]
    sizes: Vec<Size>,

    /// Detectors to time
    #[arg(long, value_enum, value_delimiter = ',', default_value = "default,paper")]
    presets: Vec<Preset>,

    /// Runs of each scene that count
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    repeat: u32,

    /// Threads to use, 1 to 256; as many as the processor has by default
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=256))]
    threads: Option<u16>,

    /// Write CSV: a line of the columns' names, then a row a preset and size
    #[arg(long)]
    csv: bool,

    /// Draw the times over the pixels to this SVG file, both axes logarithmic
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,

    /// Write the scenes as PNG pictures to this folder (made where missing)
    #[arg(long, value_name = "DIR")]
    scenes: Option<PathBuf>,
}

/// Width and height in pixels, written `640x480`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Size {
    width: usize,
    height: usize,
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let wrong = || format!("expected a size in pixels such as 640x480, not {text:?}");
        let (width, height) = text.split_once('x').ok_or_else(wrong)?;
        let number = |text: &str| text.parse::<usize>().map_err(|_| wrong());
        let (width, height) = (number(width)?, number(height)?);
        check_size(width, height).map_err(|error| error.to_string())?;
        Ok(Self { width, height })
    }
}

/// What a preset costs at a size.
#[derive(Debug, Clone, Copy, Serialize)]
struct Cost {
    preset: &'static str,
    width: usize,
    height: usize,
    ms: f64,
    ns_per_pixel: f64,
    edge_points: f64,
    ellipses: f64,
    pictures_per_second: f64,
}

/// The columns of a [`Cost`], for people.
const HEAD: [&str; 7] =
    ["preset", "size", "ms", "ns a pixel", "edge points", "ellipses", "pictures a second"];

impl Cmd {
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        if self.csv && context.style.json {
            return Err(Failure::new("--csv and --json are two forms of one answer")
                .hint("leave one of them out"));
        }
        if let Some(folder) = &self.scenes {
            std::fs::create_dir_all(folder)
                .map_err(|error| Failure::file("make", folder, &error))?;
        }
        let threads = rayon::ThreadPoolBuilder::new()
            .num_threads(self.threads.map_or(0, usize::from))
            .build()
            .map_err(|error| Failure::from_error(&error))?;
        let interrupt = Interrupt::install()?;
        let total = self.sizes.len() * self.presets.len();
        let mut progress = Progress::new(context.style, total);
        let mut costs = Vec::new();
        let mut table = Table::new(&HEAD);
        if self.csv {
            writeln!(
                out,
                "preset,width,height,ms,ns_per_pixel,edge_points,ellipses,pictures_per_second"
            )?;
        }
        for &size in &self.sizes {
            let draw = |seed| scene::draw(size.width, size.height, seed);
            let scenes: Vec<_> = (0..SCENES)
                .map(draw)
                .collect::<std::result::Result<_, _>>()
                .map_err(|error| Failure::from_error(&error))?;
            if let Some(folder) = &self.scenes {
                for (scene, seed) in scenes.iter().zip(0..) {
                    let name = format!("scene-{}x{}-{seed}.png", size.width, size.height);
                    super::detect::save_gray(scene, &folder.join(name))?;
                }
            }
            for &preset in &self.presets {
                if interrupt.is_raised() {
                    return Err(Failure::interrupted_after(costs.len(), total));
                }
                let Size { width, height } = size;
                progress.next(&format!("{}, {width} x {height}", preset.name()));
                let cost = threads.install(|| self.time(preset, &scenes))?;
                progress.aside(|| self.tell(context, out, &cost))?;
                table.row(cells(&cost));
                costs.push(cost);
            }
        }
        drop(progress);
        if !self.csv && !context.style.json {
            writeln!(out, "{table}")?;
        }
        if let Some(file) = &self.plot {
            std::fs::write(file, plot::draw(&costs))
                .map_err(|error| Failure::file("write", file, &error))?;
        }
        Ok(Status::Done)
    }

    /// Times a preset over scenes of one size.
    fn time(&self, preset: Preset, scenes: &[rsapien_vision::GrayImage]) -> Result<Cost> {
        let mut search = match preset {
            Preset::Default => Search::from(Detector::default()),
            Preset::Paper => Search::paper(paper::Detector::paper(), 1),
        };
        let (mut durations_ms, mut edge_points, mut ellipses) = (Vec::new(), 0, 0);
        for scene in scenes {
            let view = scene.view();
            // Buffers grow, caches fill.
            let found = search.look_at(&view, 1);
            edge_points += found.edge_points();
            ellipses += found.ellipses().len();
            for _ in 0..self.repeat {
                durations_ms.push(search.look_at(&view, 1).duration_ms());
            }
        }
        let (Some(scene), Some(ms)) = (scenes.first(), median(&mut durations_ms)) else {
            return Err(Failure::new("there is no picture to look at"));
        };
        let (width, height) = (scene.width(), scene.height());
        // Counts of points and pixels are exact in f64.
        #[expect(clippy::cast_precision_loss)]
        let (pixels, mean) =
            ((width * height) as f64, |sum: usize| sum as f64 / scenes.len() as f64);
        Ok(Cost {
            preset: preset.name(),
            width,
            height,
            ms,
            ns_per_pixel: ms * 1e6 / pixels,
            edge_points: mean(edge_points),
            ellipses: mean(ellipses),
            pictures_per_second: 1e3 / ms,
        })
    }

    /// Tells a cost to programs, as soon as it is known.
    fn tell(&self, context: &Context, out: &mut impl Write, cost: &Cost) -> Result<()> {
        if context.style.json {
            return json_line(out, cost);
        }
        if self.csv {
            let Cost { preset, width, height, ms, ns_per_pixel, .. } = cost;
            let Cost { edge_points, ellipses, pictures_per_second, .. } = cost;
            writeln!(
                out,
                "{preset},{width},{height},{ms:.4},{ns_per_pixel:.3},{edge_points:.1},{ellipses:.1},{pictures_per_second:.2}"
            )?;
            out.flush()?;
        }
        Ok(())
    }
}

fn cells(cost: &Cost) -> [String; 7] {
    [
        cost.preset.to_owned(),
        format!("{} x {}", cost.width, cost.height),
        format!("{:.2}", cost.ms),
        format!("{:.1}", cost.ns_per_pixel),
        format!("{:.0}", cost.edge_points),
        format!("{:.1}", cost.ellipses),
        format!("{:.1}", cost.pictures_per_second),
    ]
}

/// The middle one of these; the upper of two. `None` of none.
fn median(values: &mut [f64]) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_or_refused_with_an_example() {
        assert_eq!("640x480".parse(), Ok(Size { width: 640, height: 480 }));
        for text in ["", "640", "640x", "x480", "-1x5", "640*480"] {
            assert!(text.parse::<Size>().unwrap_err().contains("640x480"), "{text}");
        }
        assert!("0x5".parse::<Size>().unwrap_err().contains("empty"));
        assert!("99999x5".parse::<Size>().unwrap_err().contains("too large"));
    }
}
