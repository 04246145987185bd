//! At which speed the robot answers HELLO.

use rsapien_protocol::{Address, HelloReport};

use super::line::ProbeLine;
use super::{Case, Finding};
use crate::{Error, LinkAddress};

pub(super) const NAME: &str = "speed";

/// The speeds that a firmware can be built for, the most likely first, in bit/s.
const BAUDS: [u32; 4] = [57_600, 19_200, 38_400, 115_200];

pub(super) fn check(case: &mut Case<'_>) {
    let mut answered = Vec::new();
    let mut silent = Vec::new();
    for (link, mut line) in case.candidates.clone().into_iter().zip(std::mem::take(&mut case.open))
    {
        match scan(case, &link, &mut line) {
            Ok(Some(report)) => answered.push((line, report)),
            Ok(None) => silent.push(line),
            Err(error) => case.tell(
                Finding::problem(NAME, "link-lost", error.to_string())
                    .remedy("look at the plug and the cable"),
            ),
        }
    }
    let is_one_of_many = answered.len() > 1;
    if is_one_of_many {
        let names: Vec<&str> = answered.iter().map(|(line, _)| line.name()).collect();
        let found = format!("{} robots answered: {}", names.len(), names.join(", "));
        let first = names.first().copied().unwrap_or_default();
        let remedy = format!("name the one you mean: rsapien --link {first} doctor");
        case.tell(Finding::problem(NAME, "ambiguous", found).remedy(remedy));
        return;
    }
    let Some((line, report)) = answered.pop() else {
        if !silent.is_empty() {
            case.tell(nobody(case.address, &silent));
        }
        return;
    };
    let (name, baud) = (line.name(), line.baud());
    case.tell(if !has_speed(case.address) {
        Finding::good(NAME, "answers", format!("the motion controller answers on {name}"))
    } else if baud == case.options.baud {
        let found = format!("the motion controller answers on {name} at {baud} baud");
        Finding::good(NAME, "answers", found)
    } else {
        let found =
            format!("the robot on {name} speaks at {baud} baud, not at {}", case.options.baud);
        Finding::problem(NAME, "other-speed", found)
            .remedy(format!("add --baud {baud} to your commands"))
            .remedy(format!("or flash a firmware built for {} baud", case.options.baud))
    });
    case.motion = Some(report);
    case.line = Some(line);
}

/// A network address has no speed of its own, nor has the virtual robot.
fn has_speed(link: &LinkAddress) -> bool {
    matches!(link, LinkAddress::Auto | LinkAddress::Serial(_))
}

/// HELLO at the speed asked for, then at every other one.
fn scan(
    case: &mut Case<'_>,
    address: &LinkAddress,
    line: &mut ProbeLine,
) -> Result<Option<HelloReport>, Error> {
    if let Some((_, report)) = line.hello(Address::Motion)? {
        return Ok(Some(report));
    }
    if !has_speed(address) {
        return Ok(None);
    }
    for baud in BAUDS.into_iter().filter(|baud| *baud != case.options.baud) {
        line.reopen((case.connections)(address, baud)?, baud)?;
        if let Some((_, report)) = line.hello(Address::Motion)? {
            return Ok(Some(report));
        }
    }
    Ok(None)
}

fn nobody(address: &LinkAddress, silent: &[ProbeLine]) -> Finding {
    if let Some(line) = silent.iter().find(|line| line.is_garbled()) {
        let found = format!("something answers on {}, but no package comes intact", line.name());
        return Finding::problem(NAME, "garbled", found)
            .remedy("look at ground between PC and robot, and at the diodes where the two controllers meet on one line")
            .remedy("or another device is behind this port: rsapien ports lists all of them");
    }
    let names: Vec<&str> = silent.iter().map(ProbeLine::name).collect();
    let links = names.join(", ");
    let at = if has_speed(address) { " at 19200, 38400, 57600 or 115200 baud" } else { "" };
    Finding::problem(NAME, "silent", format!("nobody answers on {links}{at}"))
        .remedy("look at the status LED of the motion controller: dark means no supply, no clock or no firmware")
        .remedy("with a short flash a second, look at the line: TX and RX crossed, RS232 levels, common ground")
        .remedy("docs/firmware.md goes from the supply to the first answer")
}
