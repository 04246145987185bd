//! The log of packages: what went over the line, as bytes and in words.

use std::collections::VecDeque;
use std::fmt;

use rsapien_protocol::{
    ActionPackage, Address, Content, Direction, Fed, HeaderByte, Kind, Receiver, Report, Request,
    SynchronizationPackage, frame,
};

use crate::RobotState;

/// One package that went over the line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PackageRecord {
    /// When, in ms of the line's clock: when it was sent, or when its last byte came.
    pub time_ms: u64,
    /// Which way it went.
    pub direction: Direction,
    /// Whose package it is.
    pub address: Address,
    /// The line bytes.
    pub bytes: Vec<u8>,
}

/// Takes each package as it goes over the line. It is called by the line's thread, so it must be
/// quick and must not wait for the robot.
pub type PackageSink = Box<dyn FnMut(&PackageRecord) + Send>;

/// What happens on the line, in the order in which it does. Times are ms of the line's clock.
#[derive(Clone, Copy, Debug)]
pub enum LineEvent<'event> {
    /// Bytes were put on the line.
    Sent {
        /// When.
        time_ms: u64,
        /// All of them.
        bytes: &'event [u8],
    },
    /// Bytes came, intact or not.
    Received {
        /// When they were taken from the link.
        time_ms: u64,
        /// All that were there.
        bytes: &'event [u8],
    },
    /// A package is complete, sent or received.
    Package(&'event PackageRecord),
    /// What the program knows of the robot was renewed.
    State(&'event RobotState),
}

/// Takes everything that happens on the line. It is called by the line's thread, so it must be quick
/// and must not wait for the robot.
pub type LineSink = Box<dyn FnMut(&LineEvent<'_>) + Send>;

impl PackageRecord {
    pub(crate) fn received(time_ms: u64, content: &Content) -> PackageRecord {
        let address = content.address();
        let header = HeaderByte { direction: Direction::ToPc, address };
        let bytes: rsapien_protocol::SynchronizationBytes =
            frame::encode(header, content.synchronization());
        PackageRecord { time_ms, direction: Direction::ToPc, address, bytes: bytes.to_vec() }
    }

    /// The package in words: its kind, number and arguments, or its status and report.
    pub fn meaning(&self) -> String {
        match self.content() {
            None => "not a package".to_owned(),
            Some(content) => match self.direction {
                Direction::ToRobot => action_meaning(&content),
                Direction::ToPc => synchronization_meaning(&content),
            },
        }
    }

    fn content(&self) -> Option<Content> {
        let mut receiver = Receiver::listening(self.direction);
        self.bytes.iter().find_map(|byte| match receiver.feed(*byte, 0) {
            Fed::Package(content) => Some(content),
            _ => None,
        })
    }
}

/// One line of a log: time in s, direction, controller, meaning.
impl fmt::Display for PackageRecord {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let arrow = match self.direction {
            Direction::ToRobot => "->",
            Direction::ToPc => "<-",
        };
        let (seconds, thousandths) = (self.time_ms / 1000, self.time_ms % 1000);
        let address = self.address.name();
        write!(formatter, "{seconds:4}.{thousandths:03} {arrow} {address} {}", self.meaning())
    }
}

fn action_meaning(content: &Content) -> String {
    let package = match ActionPackage::parse(content.action()) {
        Ok(package) => package,
        Err(status) => return format!("action package refused by itself: {status}"),
    };
    let ActionPackage { session, sequence, request } = package;
    let arguments = match request {
        Request::Hello { session, .. } => format!(" proposing session {session}"),
        Request::Step(step) => {
            let mut names: Vec<String> =
                step.pose.primitives().map(|primitive| primitive.to_string()).collect();
            if names.is_empty() {
                names.push("pause".to_owned());
            }
            let replace = if step.replace { ", replacing the queue" } else { "" };
            format!(" {} {} ms{replace}", names.join("+"), step.duration_ms)
        }
        Request::Configure(parameter) => format!(" {parameter:?}"),
        Request::Aim(target) => format!(
            " pan {} tilt {} at {} deg/s",
            degrees(target.pan_centideg),
            degrees(target.tilt_centideg),
            target.speed_deg_per_s
        ),
        Request::State | Request::Stop | Request::Counters | Request::Init | Request::Home => {
            String::new()
        }
    };
    format!("{}{arguments} ({})", request.kind(), number(session, sequence, request.kind()))
}

fn number(session: u8, sequence: u8, kind: Kind) -> String {
    if kind.is_numbered() { format!("s{session} #{sequence}") } else { format!("tag {sequence}") }
}

fn synchronization_meaning(content: &Content) -> String {
    let package = match SynchronizationPackage::parse(content) {
        Ok(package) => package,
        Err(error) => return error.to_string(),
    };
    let kind = Kind::from_byte(package.kind_byte);
    let name = kind.map_or("?", Kind::name);
    let number = kind.map_or_else(String::new, |kind| {
        format!(" ({})", number(package.session, package.sequence, kind))
    });
    let report = match package.report {
        Report::Motion(report) => format!(
            "{}, motors {:07b}, free {}, ended {}",
            report.mode.name(),
            report.motors,
            report.queue_free,
            report.steps_ended
        ),
        Report::Camera(report) => format!(
            "{}, pan {} tilt {}",
            report.mode.name(),
            degrees(report.pan_centideg),
            degrees(report.tilt_centideg)
        ),
        Report::Hello(report) => {
            let [major, minor, patch] = report.firmware;
            format!(
                "firmware {major}.{minor}.{patch} at {} MHz, boot {}",
                report.clock_mhz, report.boot
            )
        }
        Report::Counters(report) => format!("{} packages accepted", report.accepted),
    };
    let status = package.status;
    format!("{name}{number} {status}: {report}")
}

fn degrees(centideg: i16) -> String {
    format!("{:.2}", f64::from(centideg) / 100.0)
}

/// The last packages, and whoever wants to see each.
pub(crate) struct PackageLog {
    records: VecDeque<PackageRecord>,
    length_max: usize,
}

impl PackageLog {
    pub(crate) fn new(length_max: usize) -> PackageLog {
        PackageLog { records: VecDeque::new(), length_max }
    }

    pub(crate) fn push(&mut self, record: PackageRecord) {
        if self.length_max == 0 {
            return;
        }
        if self.records.len() >= self.length_max {
            self.records.pop_front();
        }
        self.records.push_back(record);
    }

    pub(crate) fn records(&self) -> Vec<PackageRecord> {
        self.records.iter().cloned().collect()
    }
}
