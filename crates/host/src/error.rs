//! What can go wrong between a program and the robot, and what to do about it.

use std::io;

use rsapien_protocol::{Address, Kind, Status};

use crate::{Holder, Interruption};

/// Why something was not done. Each text says what happened, where, and what to do next.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A text that names no link.
    #[error(
        "`{text}` names no link: {problem}; write auto, virtual, tcp://HOST:PORT, or a serial port such as /dev/ttyUSB0 or COM3"
    )]
    BadAddress {
        /// The text.
        text: String,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// There is no such device or host.
    #[error("there is no {link}: plug the robot in, or look at the ports with `rsapien ports`")]
    LinkNotFound {
        /// The link, as its address is written.
        link: String,
    },
    /// The device is there, but this user may not open it.
    #[error(
        "no permission to open {link}: on Linux, add the user to the group that owns the device (often dialout) and log in again"
    )]
    PermissionDenied {
        /// The link, as its address is written.
        link: String,
    },
    /// The device or host is there, but cannot be opened.
    #[error("cannot open {link}: {source}")]
    LinkOpen {
        /// The link, as its address is written.
        link: String,
        /// What the system says.
        source: io::Error,
    },
    /// This build has no such links.
    #[error("this build has no {links} links: build it with the feature `{feature}`")]
    LinkNotBuilt {
        /// Which kind of link.
        links: &'static str,
        /// The feature of the crate that brings them.
        feature: &'static str,
    },
    /// No serial port has a robot behind it.
    #[error(
        "no robot found ({tried}): plug one in, name its port, or use the virtual one with `--link virtual`"
    )]
    NoRobot {
        /// What was tried, and what came of it.
        tried: String,
    },
    /// More than one serial port has a robot behind it.
    #[error("{} robots answered ({}): name the one you mean", .links.len(), .links.join(", "))]
    Ambiguous {
        /// Their ports.
        links: Vec<String>,
    },
    /// The link is open, but no controller answers.
    #[error(
        "no answer from the {address} controller on {link} to {tries} tries of {kind}: is the robot switched on, and its line at the same speed?"
    )]
    NoAnswer {
        /// The link.
        link: String,
        /// The controller asked.
        address: Address,
        /// What it was asked.
        kind: Kind,
        /// How often.
        tries: u8,
    },
    /// A controller answered, but did not do it.
    #[error("the {address} controller refused {kind}: {status}")]
    Refused {
        /// The controller.
        address: Address,
        /// What it was asked.
        kind: Kind,
        /// Why it refused.
        status: Status,
    },
    /// Whether the controller did it cannot be known.
    #[error(
        "whether the {address} controller did {kind} is unknown: {why}; look at its state before asking again"
    )]
    OutcomeUnknown {
        /// The controller.
        address: Address,
        /// What it was asked.
        kind: Kind,
        /// What made it unknown.
        why: String,
    },
    /// STOP came first; the request was not sent.
    #[error("{kind} was not sent, since STOP came first")]
    Displaced {
        /// The request given up.
        kind: Kind,
    },
    /// Someone else holds it.
    #[error("{what} is held by {by}: wait until it is released, or end that program")]
    Held {
        /// What is held: a controller or a line.
        what: String,
        /// Who holds it.
        by: Holder,
    },
    /// Another action is being played, or waits, and the policy chosen leaves it alone.
    #[error(
        "{action} was not played: {} in its way{}; play it with the policy queue or replace, or end the other",
        match by.as_slice() {
            [one] => format!("{one} is"),
            several => format!("{} are", crate::stage::list(several)),
        },
        if joints.is_empty() { String::new() } else { format!(" (both need {})", joints.join(", ")) }
    )]
    Claimed {
        /// What was to be played.
        action: String,
        /// What is being played or waits.
        by: Vec<crate::Claim>,
        /// The joints that both need, where that is the reason.
        joints: Vec<&'static str>,
    },
    /// The program that holds the line did not play what it was handed.
    #[cfg(all(feature = "sharing", unix))]
    #[error("{text}")]
    HolderRefused {
        /// What it said.
        text: String,
        /// Whether the robot or the program said no, as against a failure.
        is_refusal: bool,
    },
    /// The program that holds the line went, or does not make itself understood.
    #[cfg(all(feature = "sharing", unix))]
    #[error(
        "the program that held the line is gone ({by}); what it played ends by the robot's dead-man: look at the state, then play again"
    )]
    HolderGone {
        /// Who held it.
        by: Holder,
    },
    /// The lock between programs cannot be taken, for a reason other than another holder.
    #[error(
        "cannot lock {path}: {source}; such files keep two programs off one robot, so make their folder one that you may write to"
    )]
    Lock {
        /// The lock file.
        path: String,
        /// What the system says.
        source: io::Error,
    },
    /// The link broke. It is opened again by itself; motion is not resumed.
    #[error("the link {link} was lost: {why}; it is tried again until it comes back")]
    LinkLost {
        /// The link.
        link: String,
        /// What the system says.
        why: String,
    },
    /// What was under way ended before its time.
    #[error("{kind} was interrupted by {by}")]
    Interrupted {
        /// What was under way.
        kind: Kind,
        /// By what.
        by: Interruption,
    },
    /// It takes longer than it can take.
    #[error("{what} has not ended after {limit_ms} ms: look at the robot")]
    TimeLimit {
        /// What was waited for.
        what: &'static str,
        /// The limit in ms.
        limit_ms: u64,
    },
    /// An action has no label of that name.
    #[error(
        "the action {action} has no label {label:?}{}",
        if names.is_empty() { "; it has none at all".to_owned() } else { format!("; its labels are {}", names.join(", ")) }
    )]
    UnknownLabel {
        /// The action.
        action: String,
        /// The label asked for.
        label: String,
        /// Its labels.
        names: Vec<String>,
    },
    /// An argument is out of its range; nothing was sent.
    #[error("{what} {value} is out of range: {range}")]
    OutOfRange {
        /// The argument.
        what: &'static str,
        /// The value given.
        value: String,
        /// The values allowed.
        range: &'static str,
    },
    /// Two primitives of one step send the same joint to different positions.
    #[error("{first} and {second} send the same joint to two positions in one step")]
    OppositePrimitives {
        /// The first.
        first: String,
        /// The second.
        second: String,
    },
    /// The controller's report is not one that this version understands.
    #[error("the {address} controller answered {kind} with a report of another kind")]
    BadReport {
        /// The controller.
        address: Address,
        /// What it was asked.
        kind: Kind,
    },
    /// The serial ports cannot be listed.
    #[error("cannot list the serial ports: {why}")]
    PortList {
        /// What the system says.
        why: String,
    },
    /// What was asked works on another kind of link only.
    #[error("{what}")]
    NotOnThisLink {
        /// What was asked, and where it works.
        what: &'static str,
    },
    /// The robot's line thread has ended.
    #[error("the line to the robot is closed: open the robot again")]
    Closed,
    /// The virtual robot cannot be made as asked.
    #[cfg(feature = "virtual")]
    #[error("no virtual robot: {0}")]
    VirtualRobot(#[from] rsapien_sim::robot::ConfigError),
    /// `RoboRegistry` refused.
    #[cfg(feature = "registry")]
    #[error(transparent)]
    Registry(#[from] rsapien_registry::RegistryError),
}

impl Error {
    /// Whether the robot, or the holder of what was wanted, said no, as against a failure of the
    /// link, the system or the program.
    pub const fn is_refusal(&self) -> bool {
        #[cfg(all(feature = "sharing", unix))]
        if let Error::HolderRefused { is_refusal, .. } = self {
            return *is_refusal;
        }
        matches!(
            self,
            Error::Refused { .. }
                | Error::Held { .. }
                | Error::Claimed { .. }
                | Error::Interrupted { .. }
                | Error::Displaced { .. }
                | Error::NoRobot { .. }
                | Error::Ambiguous { .. }
        )
    }
}
