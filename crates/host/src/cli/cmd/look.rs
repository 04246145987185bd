//! `rsapien look`: the pan/tilt head.

use std::io::Write;

use clap::Args;

use crate::cli::camera;
use crate::cli::context::Context;
use crate::cli::diagnostics::Result;
use crate::cli::exit::Status;
use crate::cli::robot::{self, PaceOptions};
use crate::cli::view;

/// Turn the head, and wait until it is there
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien look --pan 30 --tilt -10
  rsapien look --pan 0 --tilt 0 --speed 20")]
pub(crate) struct Cmd {
    /// Degrees to the right of straight ahead, -90 to 90
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = camera::pan)]
    pan: f64,

    /// Degrees above straight ahead, -45 to 45
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = camera::tilt)]
    tilt: f64,

    /// Degrees per second, 1 to 65535; as fast as the head can when not given
    #[arg(long, value_name = "DEG_PER_S", value_parser = clap::value_parser!(u16).range(1..))]
    speed: Option<u16>,

    #[command(flatten)]
    pace: PaceOptions,
}

impl Cmd {
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        let open = robot::open(context, "look", self.pace)?;
        let head = open.ready_camera(context, out)?;
        let report = open.done(head.look(self.pan, self.tilt, self.speed.unwrap_or(0)))?;
        let text = format!(
            "the head looks {} and {}",
            direction(report.pan_centideg, "left", "right"),
            direction(report.tilt_centideg, "down", "up")
        );
        context.style.answer(out, &view::camera(&report), text)?;
        Ok(Status::Done)
    }
}

/// `20.0 degrees down` of hundredths of a degree.
fn direction(centideg: i16, negative: &str, positive: &str) -> String {
    let word = if centideg < 0 { negative } else { positive };
    format!("{:.1} degrees {word}", f64::from(centideg).abs() / 100.0)
}
