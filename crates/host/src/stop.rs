//! Stopping a robot from outside: from a program that does not hold its line.
//!
//! This opens no database, no camera and no configuration, and takes no lock. The link is opened
//! beside whoever has it open, STOP is sent, and what was seen is told. Where another program holds
//! a serial line, STOP is sent several times and nothing is read: the answers are that program's,
//! which would otherwise take the line for dead. On TCP everybody hears every answer.

use std::fmt;
use std::path::PathBuf;

use rsapien_protocol::{Address, Kind, Mode, Report, Session, SessionConfig, SessionEvent};

use crate::link::{Link, RealClock};
use crate::lock::LineLock;
use crate::ports::{drive, list_ports};
use crate::robot::connector;
use crate::{Error, Holder, LinkAddress};

/// How much longer each try waits than the one before. The line's holder sends its packages again
/// at its own even pace; at the same pace, two that met once would meet at every try.
const STAGGER_MS: u64 = 7;

/// How a robot is stopped from outside.
#[derive(Clone, Debug)]
pub struct StopOptions {
    /// Line speed in bit/s.
    pub baud: u32,
    /// Where the locks between programs stand, to tell who holds the line; none to not look.
    pub lock_folder: Option<PathBuf>,
}

impl Default for StopOptions {
    /// 57600 baud, not looking for a holder.
    fn default() -> StopOptions {
        StopOptions { baud: 57_600, lock_folder: None }
    }
}

/// What was seen of one controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopSeen {
    /// It answered; the mode it then was in.
    Answered {
        /// The mode: stopped, unless something came in between.
        mode: Mode,
        /// How often STOP was sent.
        tries: u8,
    },
    /// It did not answer.
    NoAnswer {
        /// How often STOP was sent.
        tries: u8,
    },
    /// Nobody listened: the answers belong to another program, which holds the line.
    NotHeard {
        /// How often STOP was sent.
        tries: u8,
    },
}

#[cfg(all(feature = "serial", unix))]
impl StopSeen {
    /// The same, where nobody listened.
    const fn not_heard(self) -> StopSeen {
        match self {
            StopSeen::NoAnswer { tries } => StopSeen::NotHeard { tries },
            seen => seen,
        }
    }
}

/// What came of stopping the robot behind one link.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StopReport {
    /// The link.
    pub link: String,
    /// What was seen of the motion controller.
    pub motion: StopSeen,
    /// What was seen of the camera controller.
    pub camera: StopSeen,
    /// Who holds the line, if that is known.
    pub holder: Option<Holder>,
}

impl StopReport {
    /// Whether the motion controller itself confirmed it.
    pub const fn is_confirmed(&self) -> bool {
        matches!(self.motion, StopSeen::Answered { .. })
    }
}

impl fmt::Display for StopReport {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let link = &self.link;
        match (self.motion, &self.holder) {
            (StopSeen::Answered { mode, .. }, _) => {
                write!(formatter, "{link}: the robot answered, it is {}", mode.name())
            }
            (StopSeen::NotHeard { tries }, Some(holder)) => write!(
                formatter,
                "{link}: STOP was sent {tries} times; {holder}, holds the line and hears the answer"
            ),
            (StopSeen::NoAnswer { tries } | StopSeen::NotHeard { tries }, _) => {
                write!(formatter, "{link}: STOP was sent {tries} times, no answer came")
            }
        }
    }
}

/// Sends STOP to both controllers of the robot at `address`, whoever holds its line. For
/// [`LinkAddress::Auto`], to every serial port that can be opened, all at the same time: those that
/// answered or are held are told.
///
/// # Errors
/// The link cannot be opened; [`Error::OutcomeUnknown`] when it broke; for `auto`, [`Error::NoRobot`] when no port is held and
/// none answered. [`Error::NotOnThisLink`] for the virtual robot, which lives in its own program.
pub fn emergency_stop(
    address: &LinkAddress,
    options: &StopOptions,
) -> Result<Vec<StopReport>, Error> {
    match address {
        LinkAddress::Auto => stop_all(options),
        LinkAddress::Virtual => Err(Error::NotOnThisLink {
            what: "the virtual robot lives inside the program that runs it: end that program, or stop it there",
        }),
        LinkAddress::Serial(_) | LinkAddress::Tcp(_) => Ok(vec![stop_one(address, options)?]),
    }
}

fn stop_all(options: &StopOptions) -> Result<Vec<StopReport>, Error> {
    let addresses: Vec<LinkAddress> =
        list_ports()?.into_iter().map(|port| LinkAddress::Serial(port.path)).collect();
    let reports: Vec<Result<StopReport, Error>> = std::thread::scope(|scope| {
        let threads: Vec<_> = addresses
            .iter()
            .map(|address| scope.spawn(move || stop_one(address, options)))
            .collect();
        threads.into_iter().filter_map(|thread| thread.join().ok()).collect()
    });
    let tried = match addresses.len() {
        0 => "this computer has no serial port".to_owned(),
        1 => "STOP was sent to the one serial port".to_owned(),
        count => format!("STOP was sent to {count} serial ports"),
    };
    let reports: Vec<StopReport> = reports
        .into_iter()
        .flatten()
        .filter(|report| report.is_confirmed() || report.holder.is_some())
        .collect();
    if reports.is_empty() { Err(Error::NoRobot { tried }) } else { Ok(reports) }
}

fn stop_one(address: &LinkAddress, options: &StopOptions) -> Result<StopReport, Error> {
    let mut connector = connector(address, options.baud)?;
    let name = connector.name();
    let holder = match (&options.lock_folder, connector.lock_key()) {
        (Some(folder), Some(key)) => LineLock::holder(folder, &key),
        _ => None,
    };
    #[cfg(all(feature = "serial", unix))]
    if let (LinkAddress::Serial(path), Some(_)) = (address, &holder) {
        let mut link = crate::link::beside::BesideLink::open(path, RealClock::start())?;
        let report = stop_on(&mut link, name, options.baud, holder)?;
        return Ok(StopReport {
            motion: report.motion.not_heard(),
            camera: report.camera.not_heard(),
            ..report
        });
    }
    // What waits there belongs to whoever else listens, so it is not thrown away.
    let mut link = connector.connect(RealClock::start())?;
    stop_on(link.as_mut(), name, options.baud, holder)
}

fn stop_on(
    link: &mut dyn Link,
    name: String,
    baud: u32,
    holder: Option<Holder>,
) -> Result<StopReport, Error> {
    // One try at a time: the pauses between them are made here.
    let mut session = Session::new(SessionConfig { baud, tries: 1, ..SessionConfig::default() });
    let motion =
        stop_controller(&mut session, link, Address::Motion).map_err(|error| match error {
            // Nobody opens this link again, and whether STOP arrived before it broke cannot be seen.
            Error::LinkLost { why, .. } => {
                let why = format!("the link {name} broke ({why})");
                Error::OutcomeUnknown { address: Address::Motion, kind: Kind::Stop, why }
            }
            other => other,
        })?;
    // The motors are what matters; a camera on a link that breaks now changes nothing about them.
    let camera = stop_controller(&mut session, link, Address::Camera)
        .unwrap_or(StopSeen::NoAnswer { tries: 0 });
    Ok(StopReport { link: name, motion, camera, holder })
}

fn stop_controller(
    session: &mut Session,
    link: &mut dyn Link,
    address: Address,
) -> Result<StopSeen, Error> {
    let tries_max = SessionConfig::default().tries;
    for tries in 1..=tries_max {
        // Nothing is outstanding, so a STOP is taken.
        if session.stop(address).is_err() {
            break;
        }
        if let Some(SessionEvent::Answered { package, .. }) = drive(session, link)? {
            match package.report {
                Report::Motion(report) => {
                    return Ok(StopSeen::Answered { mode: report.mode, tries });
                }
                Report::Camera(report) => {
                    return Ok(StopSeen::Answered { mode: report.mode, tries });
                }
                Report::Hello(_) | Report::Counters(_) => {}
            }
        }
        link.wait_until(link.now_ms() + u64::from(tries) * STAGGER_MS);
    }
    Ok(StopSeen::NoAnswer { tries: tries_max })
}
