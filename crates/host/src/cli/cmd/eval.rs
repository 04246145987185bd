//! `rsapien eval`: how good detections are.

mod failures;
mod peers;
mod row;
mod sets;

use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use rsapien_vision::Ellipse;
use rsapien_vision::evaluate::{PictureScore, Truth, score_picture};

use self::failures::Failures;
use self::peers::Peer;
use self::row::{Row, Scores};
use self::sets::Set;
use super::detect::{DetectorOptions, Search, read};
use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result, render};
use crate::cli::exit::Status;
use crate::cli::output::{Table, json_line};
use crate::cli::progress::Progress;
use crate::cli::signal::Interrupt;

/// Score the detector on pictures whose ellipses are known
///
/// DIR holds `images/` and, for each of them, a JSON file in `gt/`: {"image": name, "width": w, "height": h, "ellipses":
/// [[cx, cy, a, b, theta], ...], "ignore": [...]}, the last of them ellipses that may be found or not. Or it holds several
/// such folders, each of them a set with a row of its own.
///
/// Found and true ellipses are matched one to one, as many as can be, among the pairs whose overlap (area of the
/// intersection over area of the union) reaches --overlap. `P` is the share of the detections that are true, `R` the share of
/// the truth that is found, `F` their harmonic mean, over all pictures of the set; `ms` is the mean time of a picture; `IoU` the
/// mean overlap of the pairs; `centre` and `axes` are medians of the errors of centres and semi-axes, in pixels.
///
/// --compare sets the answers of another detector beside them: JSON lines as of rsapien detect --json. Its `ratio` is our
/// mean time over its own.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien eval --data pictures/
  rsapien eval --data pictures/ --threads 1 --compare opencv/ --failures failures/
  rsapien eval --data pictures/arcs --preset paper --quality 250")]
pub(crate) struct Cmd {
    /// A folder with images/ and gt/, or one of such folders; may be given several times
    #[arg(long, value_name = "DIR", required = true)]
    data: Vec<PathBuf>,

    /// Least overlap of a found and a true ellipse that are the same, above 0 and up to 1
    #[arg(long, value_name = "SHARE", default_value_t = 0.8, value_parser = overlap)]
    overlap: f64,

    /// Look N times at each picture and take the median of the times
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000))]
    repeat: u32,

    /// Another detector's answers: a file of JSON lines, or a folder of a file SET.jsonl for each set
    #[arg(long, value_name = "FILE.jsonl")]
    compare: Vec<PathBuf>,

    /// Write each picture with what was found (green), missed (red) and false (orange) to DIR/SET/
    #[arg(long, value_name = "DIR")]
    failures: Option<PathBuf>,

    #[command(flatten)]
    detector: DetectorOptions,
}

/// An overlap that tells something.
fn overlap(text: &str) -> std::result::Result<f64, String> {
    match text.parse() {
        Ok(share) if share > 0.0 && share <= 1.0 => Ok(share),
        _ => Err("expected a share above 0 and up to 1, such as 0.8".to_owned()),
    }
}

impl Cmd {
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        let preset = self.detector.preset(None)?;
        if let Some(flag) = self.detector.detail() {
            return Err(Failure::new(format!("{flag} is told by rsapien detect alone"))
                .hint(format!("leave {flag} out")));
        }
        let sets = sets::find(&self.data)?;
        let peers: Vec<Peer> =
            self.compare.iter().map(|path| Peer::read(path)).collect::<Result<_>>()?;
        let mut run = Run {
            search: self.detector.search(preset)?,
            threads: self.detector.threads()?,
            failures: self.failures.as_deref().map(Failures::new),
            overlap_min: self.overlap,
            repeat: self.repeat,
            failed: false,
        };
        let mut ours = Scores::new(preset.name());
        let mut theirs: Vec<(&Peer, Scores)> =
            peers.iter().map(|peer| (peer, Scores::new(&peer.name))).collect();
        let pictures = sets.iter().map(|set| set.truths.len()).sum();
        let interrupt = Interrupt::install()?;
        let mut progress = Progress::new(context.style, pictures);
        let mut table = Table::new(&row::HEAD);
        let mut done = 0;
        for set in &sets {
            ours.begin(&set.name);
            for (_, scores) in &mut theirs {
                scores.begin(&set.name);
            }
            for truth in &set.truths {
                if interrupt.is_raised() {
                    return Err(Failure::interrupted_after(done, pictures));
                }
                progress.next(&truth.image);
                run.picture(context, &progress, set, truth, &mut ours)?;
                for (peer, scores) in &mut theirs {
                    match peer.answer(&set.name, &truth.image) {
                        Some(answer) => {
                            let score = score(&answer.ellipses, truth, self.overlap);
                            scores.add(&score, answer.ms);
                        }
                        None => scores.add_missing(truth),
                    }
                }
                done += 1;
            }
            let ours_ms = ours.row().mean_ms();
            let mut tell = |row: &Row| {
                table.row(row.cells());
                if context.style.json { progress.aside(|| json_line(out, row)) } else { Ok(()) }
            };
            tell(ours.row())?;
            for (_, scores) in &mut theirs {
                scores.compare_with(ours_ms);
                tell(scores.row())?;
            }
        }
        drop(progress);
        if sets.len() > 1 {
            let totals = std::iter::once(ours).chain(theirs.into_iter().map(|(_, scores)| scores));
            for row in totals.map(Scores::total) {
                table.row(row.cells());
                if context.style.json {
                    json_line(out, &row)?;
                }
            }
        }
        if !context.style.json {
            writeln!(out, "{table}")?;
        }
        Ok(if run.failed { Status::Failed } else { Status::Done })
    }
}

/// What is the same for every picture.
struct Run {
    search: Search,
    threads: rayon::ThreadPool,
    failures: Option<Failures>,
    overlap_min: f64,
    repeat: u32,
    failed: bool,
}

impl Run {
    /// Looks at a picture and adds its score; one that cannot be read is told and counts as missed.
    fn picture(
        &mut self,
        context: &Context,
        progress: &Progress,
        set: &Set,
        truth: &Truth,
        scores: &mut Scores,
    ) -> Result<()> {
        let picture = match read(&set.image(truth)) {
            Ok(picture) => picture,
            Err(failure) => {
                self.failed = true;
                scores.add_missing(truth);
                let text = render(&failure, context.style.error);
                return progress.aside(|| Ok(std::io::stderr().write_all(text.as_bytes())?));
            }
        };
        let gray = picture.to_gray();
        let (search, repeat) = (&mut self.search, self.repeat);
        let found = self.threads.install(|| search.look_at(&gray.view(), repeat));
        let ellipses = found.ellipses();
        let score = score(&ellipses, truth, self.overlap_min);
        if let Some(failures) = &self.failures {
            failures.write(&set.name, picture, &ellipses, truth, &score, self.overlap_min)?;
        }
        scores.add(&score, Some(found.duration_ms()));
        Ok(())
    }
}

/// The score of a picture at one overlap.
fn score(found: &[Ellipse], truth: &Truth, overlap_min: f64) -> PictureScore {
    score_picture(found, truth, &[overlap_min]).pop().unwrap_or_default()
}
