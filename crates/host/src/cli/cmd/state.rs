//! `rsapien state`: what the robot tells of itself.

mod timing;

use std::io::Write;
use std::time::Duration;

use clap::Args;
use rsapien_protocol::Address;

use crate::cli::context::Context;
use crate::cli::diagnostics::Result;
use crate::cli::exit::Status;
use crate::cli::output::json_line;
use crate::cli::robot::{self, PaceOptions};
use crate::cli::view;

/// Tell the state of the robot
///
/// Mode, joints, motors, bumpers, queue, supply and where the head looks. Asking changes nothing.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien state
  rsapien state --watch --json | jq .motion.bumpers
  rsapien state --timing                  where the time goes between request and answer")]
pub(crate) struct Cmd {
    /// Go on until Ctrl-C
    #[arg(short, long)]
    watch: bool,

    /// With --watch: milliseconds between two states, 20 to 60000
    #[arg(long, value_name = "MS", default_value_t = 500, requires = "watch", value_parser = clap::value_parser!(u64).range(20..=60_000))]
    period: u64,

    /// Tell instead where the time goes between a request and its answer: PC, adapter, line, firmware
    #[arg(long, conflicts_with = "watch")]
    timing: bool,

    /// With --timing: how many requests, 1 to 10000
    #[arg(long, value_name = "N", default_value_t = 100, requires = "timing", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    requests: u32,
}

impl Cmd {
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        if self.timing {
            return timing::run(context, out, self.requests);
        }
        let open = robot::open(context, "state", PaceOptions::default())?;
        // Watching moves nothing, so that its end stops nothing.
        open.interrupt.stop_nothing();
        let sensors = open.done(open.robot.sensors())?;
        // A robot without a camera controller has a state, too.
        for address in [Address::Motion, Address::Camera] {
            let _ = open.robot.information(address);
        }
        let link = open.robot.link_name();
        loop {
            let state = match sensors.refresh() {
                Ok(state) => state,
                // A watcher waits until the robot is back.
                Err(_) if self.watch => sensors.state(),
                Err(error) => return Err(error.into()),
            };
            if context.style.json {
                json_line(out, &view::state(link, &state))?;
            } else {
                if self.watch && context.style.output.is_terminal() {
                    // To the upper left corner, and everything below gone.
                    write!(out, "\x1b[H\x1b[2J")?;
                }
                writeln!(out, "{}", view::state_text(link, &state))?;
                if self.watch && !context.style.output.is_terminal() {
                    writeln!(out)?;
                }
                out.flush()?;
            }
            if !self.watch {
                return Ok(Status::Done);
            }
            // Ctrl-C is the only end that watching has, and no failure.
            if open.interrupt.wait(Duration::from_millis(self.period)).is_err() {
                return Ok(Status::Done);
            }
        }
    }
}
