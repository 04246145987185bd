//! Which serial ports there are, and behind which of them a robot answers.

use std::path::Path;

use rsapien_protocol::{Address, HelloReport, Report, Session, SessionConfig, SessionEvent};

use crate::link::{Connect, Link, RealClock};
use crate::lock::LineLock;
use crate::robot::{connector, random_session};
use crate::{Error, Holder, LinkAddress};

/// How often HELLO is sent to a port that may have anything behind it.
const PROBE_TRIES: u8 = 3;

/// A serial port.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PortInformation {
    /// Its path or name, as a link address takes it.
    pub path: String,
    /// The bus it is on: `usb`, `pci`, `bluetooth`, or `unknown`.
    pub bus: &'static str,
    /// USB vendor and product numbers.
    pub usb_id: Option<(u16, u16)>,
    /// What the device calls its maker.
    pub manufacturer: Option<String>,
    /// What the device calls itself.
    pub product: Option<String>,
    /// The device's serial number.
    pub serial_number: Option<String>,
}

/// What came of asking one port.
#[derive(Debug)]
pub enum ProbeResult {
    /// A motion controller answered HELLO.
    Robot(HelloReport),
    /// Nobody answered.
    Silent,
    /// Another program holds the line; it was left alone.
    Held(Holder),
    /// The port cannot be used.
    Failed(Error),
}

/// One port that was asked.
#[derive(Debug)]
pub struct Probe {
    /// The port.
    pub path: String,
    /// What came of it.
    pub result: ProbeResult,
}

/// The serial ports of this computer, by name.
///
/// # Errors
/// [`Error::PortList`] when the system does not tell; [`Error::LinkNotBuilt`] without the feature
/// `serial`.
#[cfg(feature = "serial")]
pub fn list_ports() -> Result<Vec<PortInformation>, Error> {
    use serialport::SerialPortType;

    // There is no such folder in some containers; the library takes it for granted.
    if cfg!(target_os = "linux") && !Path::new("/sys/class/tty").is_dir() {
        return Ok(Vec::new());
    }
    let ports = serialport::available_ports()
        .map_err(|error| Error::PortList { why: error.description })?;
    let mut ports: Vec<PortInformation> = ports
        .into_iter()
        .map(|port| {
            let path = port.port_name;
            match port.port_type {
                SerialPortType::UsbPort(usb) => PortInformation {
                    path,
                    bus: "usb",
                    usb_id: Some((usb.vid, usb.pid)),
                    manufacturer: usb.manufacturer,
                    product: usb.product,
                    serial_number: usb.serial_number,
                },
                SerialPortType::PciPort => {
                    PortInformation { path, bus: "pci", ..PortInformation::default() }
                }
                SerialPortType::BluetoothPort => {
                    PortInformation { path, bus: "bluetooth", ..PortInformation::default() }
                }
                SerialPortType::Unknown => {
                    PortInformation { path, bus: "unknown", ..PortInformation::default() }
                }
            }
        })
        .collect();
    ports.sort_by(|one, other| one.path.cmp(&other.path));
    Ok(ports)
}

/// The serial ports of this computer, by name.
///
/// # Errors
/// [`Error::LinkNotBuilt`]: this build has no serial links.
#[cfg(not(feature = "serial"))]
pub fn list_ports() -> Result<Vec<PortInformation>, Error> {
    Err(Error::LinkNotBuilt { links: "serial", feature: "serial" })
}

/// Asks every serial port for a robot by HELLO, all at the same time. HELLO ends the session of
/// another program, so lines that `lock_folder` tells are held are left alone.
///
/// # Errors
/// As [`list_ports`].
pub fn probe_ports(baud: u32, lock_folder: Option<&Path>) -> Result<Vec<Probe>, Error> {
    let ports = list_ports()?;
    Ok(std::thread::scope(|scope| {
        let probes: Vec<_> = ports
            .into_iter()
            .map(|port| {
                let path = port.path.clone();
                (port.path, scope.spawn(move || probe(&path, baud, lock_folder)))
            })
            .collect();
        probes
            .into_iter()
            .map(|(path, thread)| {
                let result = thread.join().unwrap_or(ProbeResult::Silent);
                Probe { path, result }
            })
            .collect()
    }))
}

/// The one robot found by HELLO.
///
/// # Errors
/// [`Error::NoRobot`], [`Error::Ambiguous`], [`Error::Held`] when none answered but another program
/// holds a line, and as [`list_ports`].
pub fn find_robot(baud: u32, lock_folder: Option<&Path>) -> Result<LinkAddress, Error> {
    choose(probe_ports(baud, lock_folder)?)
}

fn choose(probes: Vec<Probe>) -> Result<LinkAddress, Error> {
    let robots: Vec<String> = probes
        .iter()
        .filter(|probe| matches!(probe.result, ProbeResult::Robot(_)))
        .map(|probe| probe.path.clone())
        .collect();
    match <[String; 1]>::try_from(robots) {
        Ok([path]) => return Ok(LinkAddress::Serial(path)),
        Err(links) if !links.is_empty() => return Err(Error::Ambiguous { links }),
        Err(_) => {}
    }
    let tried = describe(&probes);
    for probe in probes {
        if let ProbeResult::Held(by) = probe.result {
            return Err(Error::Held { what: format!("the line {}", probe.path), by });
        }
    }
    Err(Error::NoRobot { tried })
}

/// What was tried: each port of its own word, but those that cannot be opened only counted, since
/// a PC lists many that are not there.
fn describe(probes: &[Probe]) -> String {
    if probes.is_empty() {
        return "this computer has no serial port".to_owned();
    }
    let mut words = Vec::new();
    let mut failed = 0;
    for probe in probes {
        match &probe.result {
            ProbeResult::Robot(_) => words.push(format!("{} answered", probe.path)),
            ProbeResult::Silent => words.push(format!("{} is silent", probe.path)),
            ProbeResult::Held(by) => words.push(format!("{} is held by {by}", probe.path)),
            ProbeResult::Failed(Error::PermissionDenied { .. }) => {
                words.push(format!("no permission to open {}", probe.path));
            }
            ProbeResult::Failed(_) => failed += 1,
        }
    }
    if failed > 0 {
        words.push(format!("{failed} more cannot be opened"));
    }
    words.join(", ")
}

fn probe(path: &str, baud: u32, lock_folder: Option<&Path>) -> ProbeResult {
    let result = connector(&LinkAddress::Serial(path.to_owned()), baud).and_then(|connector| {
        let lock = match (lock_folder, connector.lock_key()) {
            (Some(folder), Some(key)) => {
                Some(LineLock::take(folder, &key, &Holder::this_process("search for a robot"))?)
            }
            _ => None,
        };
        let found = hello(connector, baud);
        drop(lock);
        found
    });
    match result {
        Ok(Some(report)) => ProbeResult::Robot(report),
        Ok(None) => ProbeResult::Silent,
        Err(Error::Held { by, .. }) => ProbeResult::Held(by),
        Err(error) => ProbeResult::Failed(error),
    }
}

fn hello(mut connector: Box<dyn Connect>, baud: u32) -> Result<Option<HelloReport>, Error> {
    let mut link = connector.connect(RealClock::start())?;
    link.flush_input()?;
    let first_session = random_session();
    let config =
        SessionConfig { baud, first_session, tries: PROBE_TRIES, ..SessionConfig::default() };
    let mut session = Session::new(config);
    let Ok(_ticket) = session.open(Address::Motion) else { return Ok(None) };
    let event = drive(&mut session, link.as_mut())?;
    Ok(match event {
        Some(SessionEvent::Answered { package, .. }) => match package.report {
            Report::Hello(report) => Some(report),
            _ => None,
        },
        _ => None,
    })
}

/// Drives a session until what it was asked has ended.
pub(crate) fn drive(
    session: &mut Session,
    link: &mut dyn Link,
) -> Result<Option<SessionEvent>, Error> {
    let mut buffer = [0; 256];
    loop {
        while let Some(event) = session.poll_event() {
            if matches!(event, SessionEvent::Answered { .. } | SessionEvent::Failed { .. }) {
                return Ok(Some(event));
            }
        }
        let now_ms = link.now_ms();
        while let Some(bytes) = session.poll_transmit(now_ms) {
            link.send(&bytes)?;
        }
        let Some(until_ms) = session.poll_timeout() else { return Ok(None) };
        let count = link.receive(&mut buffer, until_ms)?;
        let now_ms = link.now_ms();
        session.handle_bytes(buffer.get(..count).unwrap_or(&buffer), now_ms);
        session.handle_timeout(now_ms);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn probes(results: Vec<ProbeResult>) -> Vec<Probe> {
        let number = |(index, result)| Probe { path: format!("/dev/tty{index}"), result };
        results.into_iter().enumerate().map(number).collect()
    }

    fn robot() -> ProbeResult {
        ProbeResult::Robot(HelloReport {
            version: 1,
            firmware: [0, 1, 0],
            clock_mhz: 40,
            queue_length: 32,
            dead_man_ms: 500,
            last_sequence: 0,
            boot: 1,
            reception_errors: 0,
            cause: rsapien_protocol::StopCause::PowerOn,
        })
    }

    fn held() -> ProbeResult {
        let program = "play".to_owned();
        ProbeResult::Held(Holder { pid: 77, program, since_unix_ms: 0 })
    }

    #[test]
    fn one_robot_is_chosen_and_two_are_listed() {
        let one = choose(probes(vec![ProbeResult::Silent, robot(), held()]));
        assert_eq!(one.unwrap(), LinkAddress::Serial("/dev/tty1".into()));
        let two = choose(probes(vec![robot(), robot()])).unwrap_err().to_string();
        assert!(two.contains("2 robots answered (/dev/tty0, /dev/tty1)"), "{two}");
    }

    #[test]
    fn no_robot_tells_what_was_tried_and_names_the_virtual_one() {
        let message = choose(Vec::new()).unwrap_err().to_string();
        assert!(message.contains("no serial port") && message.contains("--link virtual"));
        let gone = || ProbeResult::Failed(Error::LinkNotFound { link: String::new() });
        let denied = ProbeResult::Failed(Error::PermissionDenied { link: String::new() });
        let results = vec![ProbeResult::Silent, gone(), gone(), denied];
        let message = choose(probes(results)).unwrap_err().to_string();
        for part in ["/dev/tty0 is silent", "no permission to open /dev/tty3", "2 more cannot"] {
            assert!(message.contains(part), "{message}");
        }
    }

    #[test]
    fn a_line_that_is_held_is_told_when_no_other_answers() {
        let message = choose(probes(vec![ProbeResult::Silent, held()])).unwrap_err().to_string();
        assert!(message.contains("/dev/tty1 is held by pid 77 (play)"), "{message}");
    }
}
