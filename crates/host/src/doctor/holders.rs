//! Who else has the port open.

use super::device::Device;
use super::machine::Machine;
use super::{Case, Finding};
use crate::LinkAddress;
use crate::lock::LineLock;

pub(super) const NAME: &str = "other-programs";

pub(super) fn check(case: &mut Case<'_>) {
    let mut is_alone = true;
    if let Some(folder) = case.options.lock_folder.clone() {
        for link in case.candidates.clone() {
            let key = (case.connections)(&link, case.options.baud).ok();
            let Some(key) = key.and_then(|connector| connector.lock_key()) else { continue };
            if let Some(holder) = LineLock::holder(&folder, &key) {
                is_alone = false;
                let found = format!("{link} is held by {holder}");
                case.candidates.retain(|candidate| *candidate != link);
                case.tell(Finding::problem(NAME, "held", found).remedy(
                    "wait until that program has ended, or end it; rsapien stop works all the same",
                ));
            }
        }
    }
    for device in case.devices.clone() {
        let is_held = !case
            .candidates
            .iter()
            .any(|link| matches!(link, LinkAddress::Serial(path) if *path == device.path));
        // Who made a pseudo-terminal keeps it open, and a line that is held needs no second word.
        // What is no serial port, such as /dev/null, is told when it is opened.
        let entry = format!("/sys/class/tty/{}", device.name());
        if is_held || device.is_pseudo_terminal() || !case.machine.path(&entry).exists() {
            continue;
        }
        for (pid, name) in programs_at(&device, &case.machine) {
            is_alone = false;
            let found =
                format!("{} is open in another program, too: {name} (pid {pid})", device.path);
            case.tell(
                Finding::problem(NAME, "open-elsewhere", found).remedy(format!(
                    "end {name}: two readers take each other's bytes (kill {pid})"
                )),
            );
        }
    }
    if is_alone {
        let found = "nobody else has the line, as far as this user may look";
        case.tell(Finding::good(NAME, "alone", found));
    }
}

/// The processes, but this one, that have the device open.
fn programs_at(device: &Device, machine: &Machine<'_>) -> Vec<(u32, String)> {
    machine
        .processes()
        .into_iter()
        .filter(|process| process.pid != std::process::id())
        .filter(|process| process.open_files().is_some_and(|files| files.contains(&device.file)))
        .map(|process| (process.pid, process.name))
        .collect()
}
