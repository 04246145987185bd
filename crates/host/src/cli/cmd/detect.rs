//! `rsapien detect`: the ellipses in pictures.

pub(super) mod answer;
mod inputs;
mod places;
mod preset;
mod search;
mod stages;
mod tables;
mod tuning;

use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use rsapien_vision::Picture;

pub(super) use self::inputs::read;
use self::places::Places;
pub(super) use self::preset::{DetectorOptions, Preset};
use self::search::Either;
pub(super) use self::search::{Found, Search};
pub(super) use self::stages::{save, save_gray};
use self::tables::Tables;
pub(super) use self::tuning::AxisRange;
use super::snapshot;
use crate::cli::camera::{HeadOptions, Source};
use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result, render};
use crate::cli::exit::Status;
use crate::cli::output::json_line;
use crate::cli::progress::Progress;
use crate::cli::signal::Interrupt;

/// Find the ellipses in pictures
///
/// Reads PNG, JPEG, BMP and PNM files, all of a folder, or the standard input (`-`), or takes a picture with the robot's
/// camera. Two detectors are there. The preset `default` finds ellipses of any size, to parts of a pixel. The preset
/// `paper` is the detector of the paper: noise reduction, gradient, Maximum Variance Threshold, Randomized Hough
/// Transform, filters of false ellipses, clustering; --table and the options of that detector belong to it, and giving one
/// of them asks for it. The same picture, options and seed give the same ellipses.
///
/// With --json each picture is one line: {"image": name, "width": w, "height": h, "ms": time of the detection without
/// reading the file, "ellipses": [[cx, cy, a, b, theta], ...], "scores": [...], "details": [...], "truncated": whether
/// the search was cut short}. Coordinates are pixels, the centre of the top left one at (0, 0), y down; a >= b are
/// semi-axes; theta turns from +x towards +y, in radians. --csv writes a row an ellipse.
///
/// A picture that cannot be read is told on the standard error and the others still run; the exit status is then 2.
/// It is 1 when every picture was read and no ellipse found in any.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien detect cups.png
  rsapien detect cups.png --annotate found.png
  rsapien detect --json photographs/ > ellipses.jsonl
  rsapien detect --csv 'photographs/**/*.jpg' --min-axis 20 --min-score 0.7 > ellipses.csv
  rsapien detect --table fig9a.png fig9b.png fig9c.png fig9d.png
  rsapien detect cups.png --stages stages/
  rsapien detect --camera virtual --pan 40 --tilt -20")]
pub(crate) struct Cmd {
    /// Pictures, folders of them, or patterns such as 'photographs/*.jpg'; `-` is the standard input
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

    /// Write every stage of the detector as a picture to this folder (made where missing)
    #[arg(long, value_name = "DIR")]
    stages: Option<PathBuf>,

    /// Print the paper's Table 2 and Table 3 for these pictures, as its detector fills them; with --json add the counts
    /// to each line
    #[arg(long)]
    table: bool,

    /// Write CSV: a line of the columns' names, then a row an ellipse
    #[arg(long, conflicts_with = "table")]
    csv: bool,

    /// Look N times at each picture and tell the median of the times
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    repeat: u32,

    #[command(flatten)]
    detector: DetectorOptions,
}

impl Cmd {
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        let mut search = self.search(context)?;
        let (images, failures) = match self.camera {
            Some(_) => (vec![PathBuf::from("camera")], Vec::new()),
            None => inputs::pictures(&self.images),
        };
        let mut seen = Seen::default();
        for failure in failures {
            seen.failure(context, &failure)?;
        }
        let places = Places::new(&images, self.annotate.as_deref(), self.stages.as_deref())?;
        let threads = self.detector.threads()?;
        // Between pictures there is something to end well; where one is waited for, Ctrl-C ends the process as usual.
        let waits = images.len() < 2 || images.iter().any(|path| inputs::is_standard_input(path));
        let interrupt = if waits { None } else { Some(Interrupt::install()?) };
        let mut progress = Progress::new(context.style, images.len());
        if self.csv {
            answer::csv_head(out)?;
        }
        for (index, path) in images.iter().enumerate() {
            if interrupt.is_some_and(Interrupt::is_raised) {
                out.flush()?;
                return Err(Failure::interrupted_after(index, images.len()));
            }
            let name = places.name(index);
            progress.next(name);
            let picture = match &self.camera {
                None => inputs::read(path),
                Some(source) => Ok(snapshot::take(context, out, source.clone(), self.head)?),
            };
            let looked_at = picture.and_then(|picture| {
                let found = self.look_at(&mut search, &threads, &picture, index, &places)?;
                Ok((picture, found))
            });
            progress.aside(|| match looked_at {
                Ok((picture, found)) => {
                    seen.ellipses += found.ellipses().len();
                    self.tell(context, out, &mut seen, name, &picture, &found)
                }
                Err(failure) => seen.failure(context, &failure),
            })?;
        }
        drop(progress);
        if self.table && !context.style.json {
            write!(out, "{}", seen.tables)?;
        }
        Ok(match seen {
            Seen { failed: true, .. } => Status::Failed,
            Seen { ellipses: 0, .. } => Status::Refused,
            Seen { .. } => Status::Done,
        })
    }

    /// The detector asked for, once nothing that was given contradicts it.
    fn search(&self, context: &Context) -> Result<Search> {
        let preset = self.detector.preset(self.table.then_some("--table"))?;
        if let (Some(flag), false) = (self.detector.detail(), context.style.json) {
            return Err(Failure::new(format!("{flag} is told in JSON alone"))
                .hint(format!("add --json, or leave {flag} out")));
        }
        if self.csv && context.style.json {
            return Err(Failure::new("--csv and --json are two forms of one answer")
                .hint("leave one of them out"));
        }
        if self.camera.is_none() && (self.head.pan.is_some() || self.head.tilt.is_some()) {
            return Err(Failure::new(
                "--pan and --tilt turn the head of a camera, and these are files",
            )
            .hint("take a picture with --camera SOURCE, as in --camera virtual"));
        }
        self.detector.search(preset)
    }

    /// Detects, and writes the pictures asked for.
    fn look_at(
        &self,
        search: &mut Search,
        threads: &rayon::ThreadPool,
        picture: &Picture,
        index: usize,
        places: &Places,
    ) -> Result<Found> {
        let gray = picture.to_gray();
        let found = threads.install(|| search.look_at(&gray.view(), self.repeat));
        if let Some(place) = places.annotated(index) {
            save(&stages::annotated(picture, &found.ellipses()), &place)?;
        }
        if self.stages.is_some() {
            let place = |stage: &str| places.stage(index, stage);
            threads.install(|| stages::write(search, picture, &gray, &found.ellipses(), place))?;
        }
        Ok(found)
    }

    fn tell(
        &self,
        context: &Context,
        out: &mut impl Write,
        seen: &mut Seen,
        name: &str,
        picture: &Picture,
        found: &Found,
    ) -> Result<()> {
        if context.style.json {
            return json_line(out, &answer::line(name, picture, found, self.table));
        }
        if self.csv {
            return answer::csv_rows(out, name, found);
        }
        if self.table
            && let Either::Paper(detection) = &found.detection
        {
            seen.tables.add(name, detection);
            return Ok(());
        }
        writeln!(out, "{}", answer::summary(name, picture, found))?;
        if let Some(listing) = answer::listing(found) {
            writeln!(out, "{listing}")?;
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

impl Seen {
    /// Tells a failure; the others still run.
    fn failure(&mut self, context: &Context, failure: &Failure) -> Result<()> {
        self.failed = true;
        let text = render(failure, context.style.error);
        Ok(std::io::stderr().write_all(text.as_bytes())?)
    }
}
