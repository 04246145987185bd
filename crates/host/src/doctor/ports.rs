//! Which serial ports there are, and which of them the link means.

use super::device::Device;
use super::{Case, Finding};
use crate::LinkAddress;

pub(super) const NAME: &str = "ports";

pub(super) fn check(case: &mut Case<'_>) {
    match case.address {
        LinkAddress::Auto => look_behind_all(case),
        LinkAddress::Serial(path) => look_behind(case, path),
        LinkAddress::Tcp(_) => {
            case.candidates = vec![case.address.clone()];
            let found = format!(
                "{} is a network address; adapter and speed are the business of its other end",
                case.address
            );
            case.tell(Finding::good(NAME, "network", found));
        }
        LinkAddress::Virtual => {
            case.candidates = vec![case.address.clone()];
            case.tell(Finding::good(NAME, "virtual", "the virtual robot needs no port"));
        }
    }
}

fn look_behind_all(case: &mut Case<'_>) {
    case.devices = Device::all(&case.machine);
    if case.devices.is_empty() {
        case.tell(
            Finding::problem(NAME, "no-port", "this computer has no serial port")
                .remedy("plug the USB adapter in; dmesg tells what the system makes of it")
                .remedy("without a robot: rsapien --link virtual doctor"),
        );
        return;
    }
    case.candidates =
        case.devices.iter().map(|device| LinkAddress::Serial(device.path.clone())).collect();
    for found in case.devices.iter().map(describe).collect::<Vec<_>>() {
        case.tell(Finding::good(NAME, "port", found));
    }
}

fn look_behind(case: &mut Case<'_>, path: &str) {
    let device = Device::at(path, &case.machine);
    case.candidates = vec![case.address.clone()];
    let code = if device.is_pseudo_terminal() { "pseudo-terminal" } else { "port" };
    case.tell(Finding::good(NAME, code, describe(&device)));
    case.devices = vec![device];
}

/// `/dev/ttyUSB0: FT232R USB UART (0403:6001), driver ftdi_sio`.
fn describe(device: &Device) -> String {
    let mut name = device.path.clone();
    if device.file != std::path::Path::new(&device.path) {
        name = format!("{name} is {}", device.file.display());
    }
    if device.is_pseudo_terminal() {
        return format!("{name}, a pseudo-terminal: a program stands behind it");
    }
    let usb = device.usb_id.as_ref().map(|(vendor, product)| format!("{vendor}:{product}"));
    let what = match (&device.product, usb) {
        (Some(product), Some(usb)) => format!("{product} ({usb})"),
        (None, Some(usb)) => format!("USB {usb}"),
        (_, None) => "not a USB adapter, as far as the system tells".to_owned(),
    };
    let driver = device.driver.as_ref().map(|driver| format!(", driver {driver}"));
    format!("{name}: {what}{}", driver.unwrap_or_default())
}
