//! Opening the port.

use super::line::ProbeLine;
use super::{Case, Finding};
use crate::Error;

pub(super) const NAME: &str = "opening";

pub(super) fn check(case: &mut Case<'_>) {
    let baud = case.options.baud;
    for link in std::mem::take(&mut case.candidates) {
        let opened = (case.connections)(&link, baud).and_then(|connector| {
            ProbeLine::open(connector, baud, case.options.lock_folder.as_deref())
        });
        match opened {
            Ok(line) => {
                case.tell(Finding::good(NAME, "open", format!("{} is open", line.name())));
                case.open.push(line);
                case.candidates.push(link);
            }
            Err(error) => case.tell(refused(&error)),
        }
    }
}

fn refused(error: &Error) -> Finding {
    let finding = |code| Finding::problem(NAME, code, error.to_string());
    match error {
        Error::LinkNotFound { .. } => {
            finding("no-device").remedy("rsapien ports lists what there is")
        }
        Error::PermissionDenied { .. } => {
            finding("no-permission").remedy("ls -l tells who may open it")
        }
        Error::Held { .. } => {
            finding("held").remedy("wait until that program has ended, or end it")
        }
        Error::LinkOpen { link, .. } if link.starts_with("tcp://") => {
            finding("cannot-open").remedy("start what listens there: a robot, or rsapien sim --tcp")
        }
        _ => finding("cannot-open")
            .remedy("name a serial port: rsapien ports lists what there is")
            .remedy("if it is one, plug the adapter out and in again; dmesg tells more"),
    }
}
