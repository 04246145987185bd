//! `rsapien replay`: a recording again, and whether the answers are the same.

use std::io::Write;
use std::path::PathBuf;
use std::sync::mpsc;
use std::time::Duration;

use clap::{Args, ValueEnum};
use rsapien_registry::language::{Value, parse_value};
use rsapien_sim::robot::Controllers;

use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::exit::Status;
use crate::cli::firmware::FirmwareOptions;
use crate::cli::signal::Interrupt;
use crate::cli::{progress, robot, view};
use crate::recording::replay::{ReplayError, ReplayOptions, ReplayReport, Target, replay};
use crate::recording::{Difference, RecordingReader};
use crate::{CancelToken, Holder, LineLock, LinkAddress, data, ports};

/// Play a recording again, and compare the answers with the recorded ones
///
/// The packages that the PC sent go out again at their recorded times, numbered for a session of their own: to the virtual
/// robot's model, to the firmware as it is flashed, in a simulator, or to the robot on --link. The first answer that
/// differs is told: when, to which package, and in what. docs/recording.md says what is compared, and what a change may
/// be earlier or later by.
///
/// The exit status is 0 when all answers are the same, 1 when they differ, and 2 when that could not be found out.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien replay wave.mcap
  rsapien replay wave.mcap --against firmware
  rsapien replay wave.mcap --against robot --link /dev/ttyUSB0 --from 2s")]
pub(crate) struct Cmd {
    /// The recording
    #[arg(value_name = "FILE")]
    file: PathBuf,

    /// What is to answer
    #[arg(long, value_enum, default_value_t = Against::Virtual)]
    against: Against,

    /// Compare from this time of the recording on, in seconds or with a unit. A virtual robot is given what came before;
    /// a robot is initialised and brought to the recorded pose, and begins where the recorded one was next at rest
    #[arg(long = "from", value_name = "TIME", default_value = "0", value_parser = time)]
    from_ms: u64,

    /// How many ms a change may be earlier or later, 0 to 1000: 0 demands that every answer is the same. Without it
    /// that is demanded of a recording made with --fast on the virtual robot, and 20 of the others
    #[arg(long, value_name = "MS", value_parser = clap::value_parser!(u64).range(0..=1000))]
    tolerance: Option<u64>,

    #[command(flatten)]
    firmware: FirmwareOptions,
}

/// What a recording is played against.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Against {
    /// The model of the controllers, with the recorded seed and world
    Virtual,
    /// The firmware's images in a simulator of the chips, in place of the model
    Firmware,
    /// The robot on --link, which has to stand free
    Robot,
}

impl Cmd {
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        let reader = RecordingReader::open(&self.file)?;
        let interrupt = Interrupt::install()?;
        let options = ReplayOptions {
            from_ms: self.from_ms,
            tolerance_ms: self.tolerance,
            cancel: CancelToken::new(),
        };
        // Held until the end, with the link.
        let mut lock = None;
        let (target, name) = match self.against {
            Against::Virtual if self.firmware.is_asked() => {
                return Err(Failure::new("--firmware: the model is to answer")
                    .hint("add --against firmware, or leave --firmware away"));
            }
            Against::Virtual => {
                let target = Target::virtual_robot(reader.about(), Controllers::Model)?;
                (target, "the virtual robot".to_owned())
            }
            Against::Firmware => {
                let controllers = self.firmware.controllers_or_default(context)?;
                let target = Target::virtual_robot(reader.about(), controllers)?;
                (target, "the firmware".to_owned())
            }
            Against::Robot => {
                let (target, name, held) = robot_target(context)?;
                lock = held;
                (target, name)
            }
        };
        let stop = StopFirst::install(interrupt, &options.cancel);
        let bar = progress::bar(context.style);
        let replayed = replay(reader, target, &options, |number, time_ms| {
            bar.set_message(format!("{}, package {number}", view::seconds(time_ms)));
        });
        bar.finish_and_clear();
        drop(stop);
        drop(lock);
        let report = match replayed {
            Err(ReplayError::Cancelled) => return Err(Failure::interrupted()),
            other => other?,
        };
        let file = self.file.display().to_string();
        context.style.answer(out, &json(&file, &name, &report), text(&file, &name, &report))?;
        Ok(if report.difference.is_some() { Status::Refused } else { Status::Done })
    }
}

/// The robot on `--link`, its name, and what keeps other programs from it.
fn robot_target(context: &Context) -> Result<(Target, String, Option<LineLock>)> {
    let folder = data::lock_folder();
    let address = match robot::address(context)? {
        LinkAddress::Virtual => {
            return Err(Failure::new("--against robot: --link virtual is no robot of its own")
                .hint("use --against virtual, or name the robot's link"));
        }
        LinkAddress::Auto => ports::find_robot(context.baud, folder.as_deref())?,
        other => other,
    };
    let mut connector = crate::robot::connector(&address, context.baud)?;
    let holder = Holder::this_process("rsapien replay");
    let lock = match (folder, connector.lock_key()) {
        (Some(folder), Some(key)) => Some(LineLock::take(&folder, &key, &holder)?),
        _ => None,
    };
    let target = Target::robot(&mut *connector, context.baud)?;
    Ok((target, connector.name(), lock))
}

/// Makes Ctrl-C end the replay, motors off, and waits for that.
struct StopFirst {
    _running: mpsc::Sender<()>,
}

impl StopFirst {
    /// How long the replay may take to end: STOP has six tries at each controller.
    const LIMIT: Duration = Duration::from_secs(3);

    fn install(interrupt: Interrupt, cancel: &CancelToken) -> Self {
        let (running, ended) = mpsc::channel();
        let cancel = cancel.clone();
        interrupt.stop_first(move || {
            cancel.cancel();
            // The other end goes when the replay has ended.
            ended.recv_timeout(Self::LIMIT) == Err(mpsc::RecvTimeoutError::Disconnected)
        });
        Self { _running: running }
    }
}

fn json(file: &str, against: &str, report: &ReplayReport) -> serde_json::Value {
    let difference = |difference: &Difference| {
        let fields: Vec<serde_json::Value> = (difference.fields.iter())
            .map(|field| {
                serde_json::json!({
                    "name": field.name, "recorded": field.recorded, "now": field.now,
                })
            })
            .collect();
        serde_json::json!({
            "time_ms": difference.time_ms,
            "package": difference.package,
            "controller": difference.address.name(),
            "request": difference.request,
            "fields": fields,
        })
    };
    serde_json::json!({
        "file": file,
        "against": against,
        "same": report.difference.is_none(),
        "packages": report.packages,
        "compared": report.compared,
        "unanswered": report.unanswered,
        "touches": report.touches,
        "duration_ms": report.duration_ms,
        "tolerance_ms": report.tolerance_ms.unwrap_or(0),
        "difference": report.difference.as_ref().map(difference),
    })
}

fn text(file: &str, against: &str, report: &ReplayReport) -> String {
    let mut lines = Vec::new();
    match &report.difference {
        None => lines.push(format!(
            "{file} against {against}: all {} answers are the same ({})",
            report.compared,
            view::seconds(report.duration_ms)
        )),
        Some(difference) => {
            let (seconds, thousandths) = (difference.time_ms / 1000, difference.time_ms % 1000);
            lines.push(format!(
                "{file} against {against}: the answers differ first at {seconds}.{thousandths:03} s"
            ));
            let (number, address) = (difference.package, difference.address.name());
            lines.push(format!("  package {number} to {address}: {}", difference.request));
            for field in &difference.fields {
                let (name, recorded, now) = (&field.name, &field.recorded, &field.now);
                lines.push(format!("  {name}: recorded {recorded}; now {now}"));
            }
        }
    }
    if report.tolerance_ms.is_some() && report.difference.is_none() {
        let tolerance_ms = report.tolerance_ms.unwrap_or_default();
        lines.push(format!("  changes may be {tolerance_ms} ms earlier or later"));
    }
    if report.touches > 0 {
        lines.push("  bumpers were pressed and released as recorded".to_owned());
    }
    if report.is_untouched {
        lines.push(
            "  bumpers were pressed in the recording, and nobody presses them here".to_owned(),
        );
    }
    if report.unanswered > 0 {
        lines.push(format!("  {} packages have no answer in the recording", report.unanswered));
    }
    lines.join("\n")
}

/// Seconds, or a time with its unit, in ms.
fn time(text: &str) -> std::result::Result<u64, String> {
    let with_unit =
        if text.parse::<f64>().is_ok() { format!("{text}s") } else { text.trim().to_owned() };
    match (text.trim(), parse_value(&with_unit)) {
        ("0", _) => Ok(0),
        (_, Ok(Value::DurationMs(duration_ms))) => Ok(u64::from(duration_ms)),
        _ => Err("expected a time, as in 2.5, 2.5s or 800ms".to_owned()),
    }
}

impl From<ReplayError> for Failure {
    fn from(error: ReplayError) -> Self {
        match error {
            ReplayError::Recording(error) => error.into(),
            ReplayError::Robot(error) => error.into(),
            error => Self::from_error(&error),
        }
    }
}
