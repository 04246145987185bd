//! `rsapien stop`: all motors off, now.

use std::io::Write;

use clap::Args;

use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::exit::Status;
use crate::cli::robot;
use crate::{Error, StopOptions, StopReport, data, emergency_stop};

/// Turn every motor off and empty the queue, whoever is using the robot
///
/// Needs nothing but the line: no database, no camera, no configuration. It takes no lock: STOP is sent beside the program
/// that holds the line, and the answer is left to it. With --link auto STOP goes to every serial port that may have a robot.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien stop
  rsapien stop --link /dev/ttyUSB0")]
pub(crate) struct Cmd {}

impl Cmd {
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        let Self {} = self;
        let address = robot::address(context)?;
        // Only to tell who holds the line; a missing folder is no obstacle.
        let options = StopOptions { baud: context.baud, lock_folder: data::lock_folder() };
        let reports = emergency_stop(&address, &options).map_err(|error| match error {
            Error::NoRobot { tried } => Failure::refused(format!("no robot answered: {tried}"))
                .hint("name its port: rsapien stop --link /dev/ttyUSB0; its switch stops it, too"),
            error => error.into(),
        })?;
        let is_sent_to_robot =
            |report: &StopReport| report.is_confirmed() || report.holder.is_some();
        let lines: Vec<_> = reports.iter().map(ToString::to_string).collect();
        let answer: Vec<_> = reports
            .iter()
            .map(|report| {
                serde_json::json!({
                    "link": report.link,
                    "confirmed": report.is_confirmed(),
                    "detail": report.to_string(),
                })
            })
            .collect();
        context.style.answer(out, &answer, lines.join("\n"))?;
        if !reports.iter().all(is_sent_to_robot) {
            return Err(Failure::new("whether the robot has stopped is not known").hint(
                "check power, cable and --baud; the dead-man stops a robot that hears nothing",
            ));
        }
        Ok(Status::Done)
    }
}
