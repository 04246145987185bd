//! A serial port as the system describes it.

use std::fs;
use std::path::PathBuf;

use super::machine::Machine;
use crate::list_ports;

/// What is known of a serial port.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Device {
    /// As the link names it.
    pub(super) path: String,
    /// The device file itself, behind symbolic links.
    pub(super) file: PathBuf,
    /// USB vendor and product numbers, four hexadecimal digits each.
    pub(super) usb_id: Option<(String, String)>,
    /// What the device calls itself.
    pub(super) product: Option<String>,
    /// The driver that serves it.
    pub(super) driver: Option<String>,
}

impl Device {
    /// The name of the device below `/dev`, such as `ttyUSB0`.
    pub(super) fn name(&self) -> &str {
        self.file.file_name().and_then(|name| name.to_str()).unwrap_or("")
    }

    /// Whether it is a pseudo-terminal, behind which there is a program.
    pub(super) fn is_pseudo_terminal(&self) -> bool {
        self.file.starts_with("/dev/pts")
    }

    /// What matches the adapter in a udev rule.
    pub(super) fn udev_match(&self) -> String {
        match &self.usb_id {
            Some((vendor, product)) => {
                format!("ATTRS{{idVendor}}==\"{vendor}\", ATTRS{{idProduct}}==\"{product}\"")
            }
            None => format!("KERNEL==\"{}\"", self.name()),
        }
    }

    /// The port at `path`, with what the system tells of it.
    pub(super) fn at(path: &str, machine: &Machine<'_>) -> Device {
        let file = fs::canonicalize(path).unwrap_or_else(|_| PathBuf::from(path));
        let mut device = Device { path: path.to_owned(), file, ..Device::default() };
        let folder = format!("/sys/class/tty/{}/device", device.name());
        let Ok(folder) = fs::canonicalize(machine.path(&folder)) else { return device };
        let driver = fs::read_link(folder.join("driver")).ok();
        device.driver = driver.and_then(|driver| Some(driver.file_name()?.to_str()?.to_owned()));
        let read = |folder: &std::path::Path, name: &str| {
            fs::read_to_string(folder.join(name)).ok().map(|text| text.trim().to_owned())
        };
        // The port is a part of an interface of the USB device that carries the numbers.
        if let Some(usb) = folder.ancestors().find(|folder| folder.join("idVendor").is_file()) {
            device.usb_id = read(usb, "idVendor").zip(read(usb, "idProduct"));
            device.product = read(usb, "product");
        }
        device
    }

    /// Every serial port that is there.
    pub(super) fn all(machine: &Machine<'_>) -> Vec<Device> {
        let Ok(entries) = fs::read_dir(machine.path("/sys/class/tty")) else {
            // A system without these files; the port library knows its ways.
            return list_ports().unwrap_or_default().into_iter().map(Device::from_list).collect();
        };
        let mut names: Vec<String> = entries
            .flatten()
            .filter(|entry| entry.path().join("device").exists())
            .filter_map(|entry| entry.file_name().into_string().ok())
            // A PC names ports that it does not have; their type is 0.
            .filter(|name| {
                machine.text(&format!("/sys/class/tty/{name}/type")).as_deref() != Some("0")
            })
            .collect();
        names.sort();
        names.iter().map(|name| Device::at(&format!("/dev/{name}"), machine)).collect()
    }

    fn from_list(port: crate::PortInformation) -> Device {
        Device {
            file: PathBuf::from(&port.path),
            path: port.path,
            usb_id: port
                .usb_id
                .map(|(vendor, product)| (format!("{vendor:04x}"), format!("{product:04x}"))),
            product: port.product,
            driver: None,
        }
    }
}
