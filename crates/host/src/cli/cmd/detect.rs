//! `rsapien detect`: the ellipses in pictures.

mod places;
mod tables;
mod tuning;

use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use rsapien_vision::io::{FILE_BYTES_MAX, save_gray_png};
use rsapien_vision::paper::{Detection, Detector, Stages};
use rsapien_vision::{Picture, draw};
use serde::Serialize;

use self::places::Places;
use self::tables::Tables;
pub(super) use self::tuning::AxisRange;
use self::tuning::Tuning;
use super::snapshot;
use crate::cli::camera::{HeadOptions, Source};
use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result, render};
use crate::cli::exit::Status;
use crate::cli::output::{Table, json_line};

/// Colour of the virtual ellipses among the pictures of the stages.
const VIRTUAL_ELLIPSE_COLOR: draw::Color = [64, 96, 255];

/// Find the ellipses in pictures
///
/// Reads PNG, JPEG, BMP and PNM files (`-` is the standard input) or takes a picture with the robot's camera, and runs
/// the detector of the paper: noise reduction, gradient, Maximum Variance Threshold, Randomized Hough Transform,
/// filters of false ellipses, clustering. The same picture, options and seed give the same ellipses.
///
/// With --json each picture is one line: {"image": name, "width": w, "height": h, "ms": time of the detection without
/// reading the file, "ellipses": [[cx, cy, a, b, theta], ...]}. Coordinates are pixels, the centre of the top left
/// one at (0, 0), y down; a >= b are semi-axes; theta turns from +x towards +y, in radians.
///
/// A picture that cannot be read is told on the standard error and the others still run; the exit status is then 2.
/// It is 1 when every picture was read and no ellipse found in any.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien detect cups.png
  rsapien detect cups.png --annotate found.png --stages stages/
  rsapien detect --table fig9a.png fig9b.png fig9c.png fig9d.png
  rsapien detect --json photographs/*.jpg > ellipses.jsonl
  rsapien detect --camera virtual --pan 40 --tilt -20 --semi-major 20..60 --semi-minor 5..60")]
pub(crate) struct Cmd {
    /// Pictures; `-` is the standard input
    #[arg(value_name = "IMAGE", required_unless_present = "camera")]
    images: Vec<PathBuf>,

    /// Take a picture instead of reading files; SOURCE as of rsapien snapshot
    #[arg(long, value_name = "SOURCE", conflicts_with = "images")]
    camera: Option<Source>,

    #[command(flatten)]
    head: HeadOptions,

    /// Write the pictures with the ellipses drawn: a file for one picture; for several a folder (made where missing)
    /// or a name with `{}` for each picture's own
    #[arg(long, value_name = "OUT")]
    annotate: Option<PathBuf>,

    /// Write every stage as a picture to this folder (made where missing)
    #[arg(long, value_name = "DIR")]
    stages: Option<PathBuf>,

    /// Print the paper's Table 2 and Table 3 for these pictures; with --json add the counts to each line
    #[arg(long)]
    table: bool,

    /// Seed of the randomised search
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    /// Threads to use, 1 to 256; as many as the processor has by default
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=256))]
    threads: Option<u16>,

    #[command(flatten)]
    tuning: Tuning,
}

impl Cmd {
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        let detector = self.tuning.detector()?;
        if self.camera.is_none() && (self.head.pan.is_some() || self.head.tilt.is_some()) {
            return Err(Failure::new(
                "--pan and --tilt turn the head of a camera, and these are files",
            )
            .hint("take a picture with --camera SOURCE, as in --camera virtual"));
        }
        let images = match self.camera {
            Some(_) => vec![PathBuf::from("camera")],
            None => self.images.clone(),
        };
        let places = Places::new(&images, self.annotate.as_deref(), self.stages.as_deref())?;
        let threads = rayon::ThreadPoolBuilder::new()
            .num_threads(self.threads.map_or(0, usize::from))
            .build()
            .map_err(|error| Failure::from_error(&error))?;
        let mut seen = Seen::default();
        for (index, path) in images.iter().enumerate() {
            let name = places.name(index);
            let picture = match &self.camera {
                None => read(path),
                Some(source) => Ok(snapshot::take(context, out, source.clone(), self.head)?),
            };
            let looked_at = picture.and_then(|picture| {
                let detection = self.look_at(&detector, &threads, &picture, index, &places)?;
                Ok((picture, detection))
            });
            match looked_at {
                Ok((picture, detection)) => {
                    seen.ellipses += detection.ellipses.len();
                    self.tell(context, out, &mut seen, name, &picture, &detection)?;
                }
                Err(failure) => {
                    seen.failed = true;
                    let text = render(&failure, context.style.error);
                    std::io::stderr().write_all(text.as_bytes())?;
                }
            }
        }
        if self.table && !context.style.json {
            write!(out, "{}", seen.tables)?;
        }
        Ok(match seen {
            Seen { failed: true, .. } => Status::Failed,
            Seen { ellipses: 0, .. } => Status::Refused,
            Seen { .. } => Status::Done,
        })
    }

    /// Detects, and writes the pictures asked for.
    fn look_at(
        &self,
        detector: &Detector,
        threads: &rayon::ThreadPool,
        picture: &Picture,
        index: usize,
        places: &Places,
    ) -> Result<Detection> {
        let gray = picture.to_gray();
        let (detection, stages) =
            threads.install(|| detector.detect_with_stages(&gray.view(), self.seed));
        if let Some(place) = places.annotated(index) {
            save(&annotated(picture, &detection), &place)?;
        }
        if self.stages.is_some() {
            save_gray(&gray, &places.stage(index, "1-grey"))?;
            write_stages(picture, &detection, &stages, |stage| places.stage(index, stage))?;
        }
        Ok(detection)
    }

    fn tell(
        &self,
        context: &Context,
        out: &mut impl Write,
        seen: &mut Seen,
        name: &str,
        picture: &Picture,
        detection: &Detection,
    ) -> Result<()> {
        if context.style.json {
            return json_line(out, &answer(name, picture, detection, self.table));
        }
        if self.table {
            seen.tables.add(name, detection);
            return Ok(());
        }
        writeln!(out, "{}", summary(name, picture, detection))?;
        if !detection.ellipses.is_empty() {
            writeln!(out, "{}", listing(detection))?;
        }
        Ok(out.flush()?)
    }
}

/// What a run over all pictures found.
#[derive(Debug, Default)]
struct Seen {
    ellipses: usize,
    failed: bool,
    tables: Tables,
}

/// Reads a picture; every failure names the file.
fn read(path: &Path) -> Result<Picture> {
    let decoded = if path == Path::new("-") {
        let mut bytes = Vec::new();
        std::io::stdin()
            .take(FILE_BYTES_MAX)
            .read_to_end(&mut bytes)
            .map_err(|error| Failure::file("read", path, &error))?;
        Picture::decode(&bytes)
    } else if path.metadata().is_ok_and(|file| file.is_file() && file.len() == 0) {
        return Err(Failure::new(format!("{} is empty", path.display())));
    } else if path.is_dir() {
        return Err(Failure::new(format!("{} is a folder", path.display()))
            .hint(format!("name the pictures in it: {}/*.png", path.display())));
    } else {
        Picture::open(path)
    };
    decoded.map_err(|error| crate::cli::diagnostics::picture(path, &error))
}

/// The picture with the ellipses drawn.
fn annotated(picture: &Picture, detection: &Detection) -> Picture {
    let mut drawn = picture.clone();
    draw::annotate(&mut drawn, detection.ellipses.iter().map(|found| &found.ellipse));
    drawn
}

/// Writes a picture as PNG.
pub(super) fn save(picture: &Picture, path: &Path) -> Result<()> {
    picture.save_png(path).map_err(|error| crate::cli::diagnostics::picture(path, &error))
}

fn save_gray(gray: &rsapien_vision::GrayImage, path: &Path) -> Result<()> {
    save_gray_png(gray, path).map_err(|error| crate::cli::diagnostics::picture(path, &error))
}

fn write_stages(
    picture: &Picture,
    detection: &Detection,
    stages: &Stages,
    place: impl Fn(&str) -> PathBuf,
) -> Result<()> {
    save_gray(&stages.denoised, &place("2-noise-reduced"))?;
    save_gray(&stages.gradient, &place("3-gradient"))?;
    save_gray(&stages.binary, &place("4-edges"))?;
    let mut candidates = Picture::from_gray(&stages.binary.view());
    for candidate in &stages.virtual_ellipses {
        draw::ellipse(&mut candidates, &candidate.ellipse, VIRTUAL_ELLIPSE_COLOR);
    }
    save(&candidates, &place("5-virtual-ellipses"))?;
    save(&annotated(picture, detection), &place("6-ellipses"))
}

/// One line for people.
fn summary(name: &str, picture: &Picture, detection: &Detection) -> String {
    let count = detection.ellipses.len();
    let found = match count {
        0 => "no ellipse".to_owned(),
        1 => "1 ellipse".to_owned(),
        _ => format!("{count} ellipses"),
    };
    let ms = detection.cost.total().as_secs_f64() * 1e3;
    let limits = if detection.truncated() {
        "; more of it is edge than a search can use: the picture is noise, or the options ask for too much"
    } else {
        ""
    };
    format!("{name} ({} x {}): {found} in {ms:.1} ms{limits}", picture.width(), picture.height())
}

/// The ellipses for people.
fn listing(detection: &Detection) -> Table {
    let mut table = Table::new(&[
        "  ",
        "center x",
        "center y",
        "semi-major",
        "semi-minor",
        "theta (rad)",
        "quality",
    ]);
    for found in &detection.ellipses {
        let ellipse = found.ellipse;
        table.row([
            String::new(),
            format!("{:.1}", ellipse.center_x_px),
            format!("{:.1}", ellipse.center_y_px),
            format!("{:.1}", ellipse.semi_major_px),
            format!("{:.1}", ellipse.semi_minor_px),
            // Adding 0 turns -0 into 0.
            format!("{:.3}", ellipse.theta_rad + 0.0),
            found.quality.to_string(),
        ]);
    }
    table
}

/// One line for programs; the keys stay in this order.
#[derive(Serialize)]
struct Answer<'a> {
    image: &'a str,
    width: usize,
    height: usize,
    ms: f64,
    ellipses: Vec<[f64; 5]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    statistics: Option<serde_json::Value>,
}

fn answer<'a>(name: &'a str, picture: &Picture, detection: &Detection, counts: bool) -> Answer<'a> {
    let ellipses = detection.ellipses.iter().map(|found| found.ellipse);
    Answer {
        image: name,
        width: picture.width(),
        height: picture.height(),
        ms: detection.cost.total().as_secs_f64() * 1e3,
        ellipses: ellipses
            .map(|ellipse| {
                [
                    ellipse.center_x_px,
                    ellipse.center_y_px,
                    ellipse.semi_major_px,
                    ellipse.semi_minor_px,
                    ellipse.theta_rad + 0.0,
                ]
            })
            .collect(),
        statistics: counts.then(|| tables::counts(detection)),
    }
}
