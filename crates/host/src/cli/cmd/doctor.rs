//! `rsapien doctor`: what is wrong between this computer and the robot, and what to do about it.

use std::io::Write;

use clap::Args;
use rsapien_protocol::HelloReport;
use serde_json::{Value, json};

use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::exit::Status;
use crate::cli::output::{Screen, json_line};
use crate::cli::registry::RegistryOptions;
use crate::cli::robot;
use crate::cli::view;
use crate::doctor::{self, Diagnosis, DoctorOptions, Finding, LineQuality, Severity};
use crate::{LinkAddress, data};

/// Find out what is wrong between this computer and the robot
///
/// Looks at ports, permission, adapter, other programs, line speed, firmware, resets, supply, switches, the errors of a
/// second of packages, webcams and the file of the actions, and ends with one verdict and the next step. Nothing is
/// moved: HELLO, STATE and COUNTERS are all that is sent. A line that another rsapien holds is left alone. The exit
/// status is 0 for a healthy robot and 1 when something is to be mended, also when there is no robot.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien doctor                          every serial port
  rsapien doctor --link /dev/ttyUSB0
  rsapien doctor --json > report.json     for a question to others")]
pub(crate) struct Cmd {
    #[command(flatten)]
    registry: RegistryOptions,
}

impl Cmd {
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        let address = robot::address(context)?;
        let options = DoctorOptions {
            baud: context.baud,
            lock_folder: data::lock_folder(),
            firmware_expected: firmware_expected(),
            registry_file: self.registry.file(context),
            ..DoctorOptions::default()
        };
        context
            .style
            .remark(out, "nothing is moved: HELLO, STATE and COUNTERS are all that is sent\n")?;
        let mut written = Ok(());
        let is_color = context.style.output == Screen::Color;
        let diagnosis = doctor::examine(&address, &options, &mut |finding| {
            // A step takes up to a second, so each finding is shown when it is there.
            if !context.style.json && finding.severity != Severity::NotReached && written.is_ok() {
                written = writeln!(out, "{}", text(finding, is_color)).and_then(|()| out.flush());
            }
        });
        written.map_err(Failure::from)?;
        let verdict = diagnosis.verdict();
        if context.style.json {
            json_line(out, &answer(&address, &diagnosis))?;
        } else {
            writeln!(out, "\nverdict  {}\nnext     {}", verdict.text, verdict.next)?;
        }
        Ok(if diagnosis.is_healthy() { Status::Done } else { Status::Refused })
    }
}

/// This program was written for the firmware that its own virtual robot runs.
fn firmware_expected() -> Option<[u8; 3]> {
    let options = DoctorOptions { measure_ms: 0, ..DoctorOptions::default() };
    let diagnosis = doctor::examine(&LinkAddress::Virtual, &options, &mut |_| {});
    diagnosis.motion.map(|report| report.firmware)
}

/// `ok      ports  /dev/ttyUSB0: ...`, with what to do below it.
fn text(finding: &Finding, is_color: bool) -> String {
    let (word, color) = match finding.severity {
        Severity::NotReached => ("-", "2"),
        Severity::Good => ("ok", "32"),
        Severity::Advice => ("advice", "33"),
        Severity::Problem => ("mend", "31"),
    };
    let word = format!("{word:<6}");
    let word = if is_color { format!("\x1b[{color}m{word}\x1b[0m") } else { word };
    let mut text = format!("{word}  {:<14}  {}", finding.check, finding.found);
    for remedy in &finding.remedies {
        text = format!("{text}\n{:24}do: {remedy}", "");
    }
    text
}

fn answer(address: &LinkAddress, diagnosis: &Diagnosis) -> Value {
    let findings: Vec<Value> = diagnosis
        .findings
        .iter()
        .map(|finding| {
            json!({
                "check": finding.check,
                "code": finding.code,
                "severity": finding.severity.name(),
                "found": finding.found,
                "remedies": finding.remedies,
            })
        })
        .collect();
    let verdict = diagnosis.verdict();
    json!({
        "link": diagnosis.link.clone().unwrap_or_else(|| address.to_string()),
        "healthy": diagnosis.is_healthy(),
        "verdict": verdict.text,
        "next": verdict.next,
        "findings": findings,
        "motion_information": diagnosis.motion.as_ref().map(controller),
        "camera_information": diagnosis.camera.as_ref().map(controller),
        "line": diagnosis.line.as_ref().map(line),
    })
}

fn controller(report: &HelloReport) -> Value {
    view::information(report, report.boot, report.cause)
}

fn line(quality: &LineQuality) -> Value {
    json!({
        "measured_ms": quality.measured_ms,
        "requests": quality.requests,
        "lost": quality.lost,
        "resent": quality.resent,
        "errors_here": quality.errors_here,
        "errors_there": quality.errors_there,
        "framing_errors": quality.framing_errors,
        "overruns": quality.overruns,
        "round_trip_median_ms": quality.round_trip_median_ms,
        "round_trip_worst_ms": quality.round_trip_worst_ms,
    })
}
