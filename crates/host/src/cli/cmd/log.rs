//! `rsapien log`: what a recording says, package by package.

use std::io::{BufWriter, Write};
use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use crate::cli::context::Context;
use crate::cli::diagnostics::Result;
use crate::cli::exit::Status;
use crate::recording::{
    LineDecoder, LineEntry, LineMark, RecordingReader, Topic, What, direction_name, hex,
    package_head,
};

/// Tell what a recording says, package by package
///
/// One line each: time in seconds, direction (-> to the robot, <- to the PC), controller, and what it says. The lines are
/// made of the recorded bytes, so that damage shows: a ! marks packages that came changed (CRC error), broke off, were sent
/// again or went unanswered, and resets of a controller.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien log wave.mcap
  rsapien log wave.mcap --errors          only what went wrong
  rsapien log wave.mcap --motion          with what was played
  rsapien log wave.mcap --json | jq .words")]
pub(crate) struct Cmd {
    /// The recording
    #[arg(value_name = "FILE")]
    file: PathBuf,

    /// Only what went wrong
    #[arg(long)]
    errors: bool,

    /// Leave out the heartbeats: STATE and its answers, where nothing is wrong with them
    #[arg(long)]
    no_state: bool,

    /// Tell what was played, too
    #[arg(long)]
    motion: bool,
}

impl Cmd {
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        // A recording has many lines, and nobody waits for a single one.
        let mut out = BufWriter::new(out);
        let mut reader = RecordingReader::open(&self.file)?;
        let mut decoder = LineDecoder::new();
        let mut last_ms = 0;
        for entry in reader.by_ref() {
            let entry = entry?;
            last_ms = entry.time_ms;
            match entry.topic {
                Topic::Bytes => {
                    for line in decoder.feed(&entry.bytes()?) {
                        self.tell(context, &mut out, &line)?;
                    }
                }
                Topic::Motion if self.motion && !self.errors => {
                    tell_motion(context, &mut out, entry.time_ms, &entry.json()?)?;
                }
                _ => {}
            }
        }
        for line in decoder.finish(last_ms) {
            self.tell(context, &mut out, &line)?;
        }
        out.flush()?;
        if reader.is_cut() {
            tracing::warn!(
                "the end of {} is missing: the program that wrote it was killed, or still writes",
                self.file.display()
            );
        }
        Ok(Status::Done)
    }

    fn tell(&self, context: &Context, out: &mut impl Write, line: &LineEntry) -> Result<()> {
        let is_remarkable = line.is_error() || !line.marks.is_empty();
        let is_left_out = self.errors || (self.no_state && is_heartbeat(line));
        if is_left_out && !is_remarkable {
            return Ok(());
        }
        if context.style.json {
            serde_json::to_writer(&mut *out, &line_json(line))?;
            writeln!(out)?;
        } else {
            writeln!(out, "{line}")?;
        }
        Ok(())
    }
}

fn is_heartbeat(line: &LineEntry) -> bool {
    match &line.what {
        What::Package(content) => package_head(content)["kind"] == "STATE",
        _ => false,
    }
}

fn line_json(line: &LineEntry) -> Value {
    let (what, mut value) = match &line.what {
        What::Package(content) => ("package", package_head(content)),
        What::CrcError => ("crc-error", json!({})),
        What::BrokenOff => ("broken-off", json!({})),
        What::Gap => ("gap", json!({})),
        What::Stray => ("stray", json!({})),
    };
    value["time_ms"] = line.time_ms.into();
    value["direction"] = direction_name(line.direction).into();
    value["controller"] = line.address().map(rsapien_protocol::Address::name).into();
    value["what"] = what.into();
    value["words"] = line.words().into();
    value["marks"] = line.marks.iter().map(LineMark::to_string).collect::<Vec<_>>().into();
    value["hex"] = hex(&line.bytes).into();
    value
}

/// `2.315 == wave: step 1 of 6`.
fn tell_motion(context: &Context, out: &mut impl Write, time_ms: u64, event: &Value) -> Result<()> {
    if context.style.json {
        let mut event = event.clone();
        event["what"] = "motion".into();
        serde_json::to_writer(&mut *out, &event)?;
        return Ok(writeln!(out)?);
    }
    let word = |key: &str| event[key].as_str().unwrap_or_default();
    let (ended, total) = (&event["steps_ended"], &event["steps_total"]);
    let text = match word("event") {
        "begin" => format!("begins, {total} steps"),
        "step" => format!("{ended} of {total} steps"),
        _ => format!("{} {}", word("outcome"), word("detail")),
    };
    let (seconds, thousandths, action) = (time_ms / 1000, time_ms % 1000, word("action"));
    Ok(writeln!(out, "{seconds:4}.{thousandths:03} == {action}: {}", text.trim_end())?)
}
