//! `rsapien record`: everything that happens, in a file.

use std::fs;
use std::io::Write;
use std::path::PathBuf;

use clap::{Args, Subcommand};
use rsapien_registry::language::{Value, parse_value};
use rsapien_vision::Options;

use super::{demo, do_primitives, init, look, play};
use crate::cli::camera::Source;
use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::exit::Status;
use crate::cli::limits::LimitOptions;
use crate::cli::recording::{Pictures, Recording};
use crate::cli::robot::{self, PaceOptions};
use crate::cli::view;
use crate::recording::{Recorder, RecordingSummary, Topic};

/// Record everything that happens while the robot does something, or while you watch it
///
/// FILE keeps every byte both ways, every package, the robot's state, what was played and how it ended, and, where that is
/// asked for, what the camera sees and the ellipses in it. It is an MCAP file: Foxglove opens it, and so do rsapien log,
/// rsapien replay and rsapien.Recording in Python. Behind FILE stands what is to be done, as it would stand behind rsapien;
/// without it, the robot is watched until Ctrl-C, and nothing is moved.
///
/// The exit status is that of what was done.
#[derive(Debug, Args)]
#[command(
    subcommand_value_name = "COMMAND",
    subcommand_help_heading = "What to do",
    after_help = "\
Examples:
  rsapien record wave.mcap play wave --link virtual --fast
  rsapien record --camera --detect look.mcap look --pan 40 --tilt -20 --link virtual
  rsapien record watched.mcap --for 10s   watches the robot for ten seconds
  rsapien log wave.mcap                   what it says, package by package
  rsapien replay wave.mcap                the same again, and whether the answers are the same"
)]
pub(crate) struct Cmd {
    /// The file to write
    #[arg(value_name = "FILE")]
    file: PathBuf,

    /// Replace a file that is there already
    #[arg(long)]
    force: bool,

    /// Without a command: how long to watch, as in 10s, 2min or 500ms
    #[arg(long = "for", value_name = "TIME", value_parser = duration)]
    duration_ms: Option<u32>,

    /// With the virtual robot and without a command: let its time pass as fast as it goes
    #[arg(long, requires = "duration_ms")]
    fast: bool,

    /// Record pictures, too: of the link's own camera, or of SOURCE, which is written as for rsapien snapshot
    #[arg(
        long,
        value_name = "SOURCE",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "auto"
    )]
    camera: Option<Source>,

    /// Pictures a second, 0.1 to 30
    #[arg(long, value_name = "RATE", default_value_t = 5.0, value_parser = rate)]
    fps: f64,

    /// Look for ellipses in the pictures
    #[arg(long, requires = "camera")]
    detect: bool,

    #[command(flatten)]
    limits: LimitOptions,

    #[command(subcommand)]
    what: Option<What>,
}

/// What can be recorded.
#[derive(Debug, Subcommand)]
enum What {
    #[command(after_help = "Example:\n  rsapien record wave.mcap play wave rounds=4")]
    Play(Box<play::Cmd>),
    #[command(after_help = "Example:\n  rsapien record arms.mcap do right-arm-up pause:500")]
    Do(Box<do_primitives::Cmd>),
    #[command(after_help = "Example:\n  rsapien record init.mcap init")]
    Init(Box<init::Cmd>),
    #[command(after_help = "Example:\n  rsapien record look.mcap look --pan 30 --tilt -10")]
    Look(Box<look::Cmd>),
    #[command(after_help = "Example:\n  rsapien record demo.mcap demo --fast")]
    Demo(Box<demo::Cmd>),
}

impl Cmd {
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        if self.what.is_some() && self.duration_ms.is_some() {
            return Err(Failure::new("--for: what is done ends by itself")
                .hint("leave --for away; or leave the command away, to watch the robot"));
        }
        if let (Some(flag), false) = (self.limits.given(), self.detect) {
            return Err(Failure::new(format!("{flag} is for --detect"))
                .hint("add --camera --detect, or leave it away"));
        }
        let detector = self.limits.detector(Options::default())?;
        let pictures = self.camera.map(|source| Pictures {
            source,
            period_ms: period_ms(self.fps),
            detector: self.detect.then_some(detector),
        });
        let recording = Recording::new(Recorder::create(&self.file, self.force)?, pictures);
        let context = Context { recording: Some(recording.clone()), ..context.clone() };
        let done = match self.what {
            Some(What::Play(cmd)) => cmd.run(&context, out),
            Some(What::Do(cmd)) => cmd.run(&context, out),
            Some(What::Init(cmd)) => cmd.run(&context, out),
            Some(What::Look(cmd)) => cmd.run(&context, out),
            Some(What::Demo(cmd)) => cmd.run(&context, out),
            None => watch(&context, out, self.duration_ms, self.fast),
        };
        let summary = recording.finish()?;
        match done {
            Ok(status) => {
                context.style.answer(out, &json(&summary), text(&summary))?;
                Ok(status)
            }
            Err(failure) => {
                if summary.messages.is_empty() {
                    // Nothing happened, so nothing is left behind.
                    let _ = fs::remove_file(&self.file);
                } else {
                    context.style.remark(out, text(&summary))?;
                }
                Err(failure)
            }
        }
    }
}

/// Watches the robot, which moves nothing, so that its end stops nothing.
fn watch(
    context: &Context,
    out: &mut impl Write,
    duration_ms: Option<u32>,
    fast: bool,
) -> Result<Status> {
    /// How often Ctrl-C is looked for.
    const LOOK_MS: u64 = 20;
    let open = robot::open(context, "record", PaceOptions { fast })?;
    open.interrupt.stop_nothing();
    if duration_ms.is_none() {
        context.style.remark(out, "recording until Ctrl-C")?;
    }
    let until_ms = duration_ms.map(|duration_ms| open.robot.now_ms() + u64::from(duration_ms));
    loop {
        let now_ms = open.robot.now_ms();
        let left_ms = until_ms.map_or(LOOK_MS, |until_ms| until_ms.saturating_sub(now_ms));
        // Ctrl-C is the end of it, and no failure.
        if left_ms == 0 || open.interrupt.is_raised() {
            return Ok(Status::Done);
        }
        open.robot.sleep_ms(left_ms.min(LOOK_MS))?;
    }
}

fn count(summary: &RecordingSummary, topic: Topic) -> u32 {
    summary.messages.iter().find(|(it, _)| *it == topic).map_or(0, |(_, count)| *count)
}

fn json(summary: &RecordingSummary) -> serde_json::Value {
    let messages: serde_json::Map<String, serde_json::Value> = (summary.messages.iter())
        .map(|(topic, count)| (topic.name().to_owned(), (*count).into()))
        .collect();
    serde_json::json!({
        "file": summary.path,
        "duration_ms": summary.duration_ms,
        "messages": messages,
    })
}

/// `recorded wave.mcap: 10.2 s, 214 packages, 107 states`.
fn text(summary: &RecordingSummary) -> String {
    let mut text = format!(
        "recorded {}: {}, {} packages, {} states",
        summary.path.display(),
        view::seconds(summary.duration_ms),
        count(summary, Topic::Packages),
        count(summary, Topic::State),
    );
    for (topic, what) in [(Topic::Camera, "pictures"), (Topic::Detections, "detections")] {
        let count = count(summary, topic);
        if count > 0 {
            text = format!("{text}, {count} {what}");
        }
    }
    text
}

fn duration(text: &str) -> std::result::Result<u32, String> {
    match parse_value(text.trim()) {
        Ok(Value::DurationMs(duration_ms)) if duration_ms > 0 => Ok(duration_ms),
        _ => Err("expected a time with its unit, as in 10s, 2min or 500ms".to_owned()),
    }
}

fn rate(text: &str) -> std::result::Result<f64, String> {
    match text.parse() {
        Ok(rate) if (0.1..=30.0).contains(&rate) => Ok(rate),
        _ => Err("expected 0.1 to 30 pictures a second".to_owned()),
    }
}

/// Of a rate within its range.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn period_ms(rate: f64) -> u64 {
    (1000.0 / rate).round() as u64
}
