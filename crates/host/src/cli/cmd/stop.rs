//! `rsapien stop`: all motors off, now.

use std::io::Write;

use clap::Args;

use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::exit::Status;
use crate::cli::robot;
use crate::{StopOptions, emergency_stop};

/// Turn every motor off and empty the queue, whoever is using the robot
///
/// Needs nothing but the line: no database, no camera, no configuration, and it does not wait for another program's
/// lock. With --link auto STOP goes to every serial port that may have a robot.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien stop
  rsapien stop --link /dev/ttyUSB0")]
pub(crate) struct Cmd {}

impl Cmd {
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        let address = robot::address(context)?;
        let options = StopOptions { baud: context.baud, ..StopOptions::default() };
        let reports = emergency_stop(&address, &options)?;
        if reports.is_empty() {
            return Err(Failure::refused("nothing to stop: there is no serial port")
                .hint("name the robot's port with --link; switching it off stops it, too"));
        }
        let all: Vec<_> = reports.iter().map(ToString::to_string).collect();
        context.style.answer(out, &serde_json::json!({"stopped": all}), all.join("\n"))?;
        Ok(Status::Done)
    }
}
