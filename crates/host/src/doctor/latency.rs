//! How long an FTDI adapter holds bytes back.

use super::{Case, Finding};

pub(super) const NAME: &str = "latency";

/// The longest that does not slow the robot down noticeably, in ms.
const GOOD_MS: u32 = 4;

pub(super) fn check(case: &mut Case<'_>) {
    if case.devices.is_empty() {
        return;
    }
    let mut told = false;
    for device in case.devices.clone() {
        let file = format!("/sys/bus/usb-serial/devices/{}/latency_timer", device.name());
        let Some(ms) = case.machine.text(&file).and_then(|text| text.parse::<u32>().ok()) else {
            continue;
        };
        told = true;
        let path = &device.path;
        if ms <= GOOD_MS {
            let found = format!("{path} hands bytes on after {ms} ms at the latest");
            case.tell(Finding::good(NAME, "latency-short", found));
            continue;
        }
        let found = format!("the FTDI adapter {path} holds bytes back for up to {ms} ms");
        case.tell(
            Finding::advice(NAME, "latency-long", found)
                .remedy(format!("echo 1 | sudo tee {file}, until it is plugged in again"))
                .remedy(
                    "for good: echo 'ACTION==\"add\", SUBSYSTEM==\"usb-serial\", \
                     DRIVER==\"ftdi_sio\", ATTR{latency_timer}=\"1\"' | sudo tee \
                     /etc/udev/rules.d/71-rsapien-latency.rules && sudo udevadm control --reload",
                ),
        );
    }
    if !told {
        let found = "no adapter with a latency timer (only FTDI's have one)";
        case.tell(Finding::good(NAME, "no-latency-timer", found));
    }
}
