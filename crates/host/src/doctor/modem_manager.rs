//! Whether `ModemManager` runs, which takes each new adapter for a modem and talks to it.

use super::{Case, Finding};

pub(super) const NAME: &str = "modem-manager";

pub(super) fn check(case: &mut Case<'_>) {
    if case.devices.is_empty() {
        return;
    }
    let Some(device) = case.devices.iter().find(|device| device.usb_id.is_some()).cloned() else {
        case.tell(Finding::good(NAME, "no-adapter", "no USB adapter that it could take"));
        return;
    };
    let is_running = case.machine.processes().iter().any(|process| process.name == "ModemManager");
    if !is_running {
        case.tell(Finding::good(NAME, "not-running", "ModemManager does not run"));
        return;
    }
    let found =
        "ModemManager runs: it talks to an adapter for half a minute after it is plugged in";
    case.tell(
        Finding::advice(NAME, "running", found)
            .remedy(format!(
                "tell it to leave the adapter alone: echo 'SUBSYSTEM==\"tty\", {}, \
                 ENV{{ID_MM_DEVICE_IGNORE}}=\"1\"' | sudo tee /etc/udev/rules.d/72-rsapien-no-modem.rules && \
                 sudo udevadm control --reload, then plug it in again",
                device.udev_match()
            ))
            .remedy("or, without a modem: sudo systemctl mask --now ModemManager"),
    );
}
