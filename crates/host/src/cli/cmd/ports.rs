//! `rsapien ports`: the serial ports, and behind which of them a robot is.

use std::io::Write;

use clap::Args;
use serde_json::{Value, json};

use crate::cli::context::Context;
use crate::cli::diagnostics::Result;
use crate::cli::exit::Status;
use crate::cli::output::{Table, json_line};
use crate::data;
use crate::{PortInformation, ProbeResult, list_ports, probe_ports};

/// List the serial ports, and ask each whether a robot is there
///
/// HELLO is sent to every port that no other rsapien program uses, and changes nothing. The exit status is 1 when no
/// port has a robot.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien ports
  rsapien ports --no-probe --json")]
pub(crate) struct Cmd {
    /// Only list the ports; send nothing
    #[arg(long)]
    no_probe: bool,
}

impl Cmd {
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        let ports = list_ports()?;
        let mut answers = Vec::new();
        if !self.no_probe {
            let lock_folder = data::lock_folder();
            answers = probe_ports(context.baud, lock_folder.as_deref())?;
        }
        let result = |port: &PortInformation| {
            answers.iter().find(|probe| probe.path == port.path).map(|probe| &probe.result)
        };
        let has_robot = answers.iter().any(|probe| matches!(probe.result, ProbeResult::Robot(_)));
        if context.style.json {
            let lines: Vec<Value> =
                ports.iter().map(|port| port_json(port, result(port))).collect();
            json_line(out, &lines)?;
        } else if ports.is_empty() {
            writeln!(out, "this computer has no serial port; --link virtual needs none")?;
        } else {
            let mut table = Table::new(&["port", "bus", "device", "robot"]);
            // A PC lists ports that are not there; they say nothing to a person.
            let is_there = |port: &&PortInformation| {
                port.bus == "usb"
                    || !matches!(
                        result(port),
                        Some(ProbeResult::Failed(
                            crate::Error::LinkNotFound { .. } | crate::Error::LinkOpen { .. }
                        ))
                    )
            };
            let shown: Vec<_> = ports.iter().filter(is_there).collect();
            for port in &shown {
                table.row([
                    port.path.clone(),
                    port.bus.to_owned(),
                    device(port),
                    result(port).map_or("not asked".to_owned(), robot_text),
                ]);
            }
            if !table.is_empty() {
                writeln!(out, "{table}")?;
            }
            match ports.len() - shown.len() {
                0 => {}
                1 => writeln!(out, "1 port that cannot be opened is left out (--json lists all)")?,
                count => writeln!(
                    out,
                    "{count} ports that cannot be opened are left out (--json lists all)"
                )?,
            }
            if !has_robot && !self.no_probe {
                writeln!(out, "no robot answers; --link virtual needs none")?;
            }
        }
        let is_done = if self.no_probe { !ports.is_empty() } else { has_robot };
        Ok(if is_done { Status::Done } else { Status::Refused })
    }
}

fn device(port: &PortInformation) -> String {
    let words = [&port.manufacturer, &port.product, &port.serial_number];
    let named: Vec<&str> = words.into_iter().flatten().map(String::as_str).collect();
    match port.usb_id {
        Some((vendor, product)) if named.is_empty() => format!("{vendor:04x}:{product:04x}"),
        _ => named.join(" "),
    }
}

fn robot_text(result: &ProbeResult) -> String {
    match result {
        ProbeResult::Robot(report) => {
            let [major, minor, patch] = report.firmware;
            format!("yes, firmware {major}.{minor}.{patch} at {} MHz", report.clock_mhz)
        }
        ProbeResult::Silent => "no answer".to_owned(),
        ProbeResult::Held(by) => format!("held by {by}"),
        ProbeResult::Failed(error) => error.to_string(),
    }
}

fn port_json(port: &PortInformation, result: Option<&ProbeResult>) -> Value {
    let (robot, detail) = match result {
        None => (Value::Null, None),
        Some(ProbeResult::Robot(_)) => (json!(true), None),
        Some(ProbeResult::Silent) => (json!(false), Some("no answer".to_owned())),
        Some(ProbeResult::Held(by)) => (Value::Null, Some(format!("held by {by}"))),
        Some(ProbeResult::Failed(error)) => (Value::Null, Some(error.to_string())),
    };
    json!({
        "path": port.path,
        "bus": port.bus,
        "usb_id": port.usb_id.map(|(vendor, product)| format!("{vendor:04x}:{product:04x}")),
        "manufacturer": port.manufacturer,
        "product": port.product,
        "serial_number": port.serial_number,
        "robot": robot,
        "detail": detail,
    })
}
