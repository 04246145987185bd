//! How an action ended, as the holder tells it.

use rsapien_protocol::{
    Address, BumperMask, Content, Direction, Fed, MotionReport, Receiver, Report, Status,
    StopCause, SynchronizationPackage,
};
use serde::{Deserialize, Serialize};

use super::{Source, source, source_told};
use crate::player::StepReached;
use crate::{Interruption, Outcome, PlayReport};

#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct ReportTold {
    outcome: OutcomeTold,
    reached: Option<(usize, Source)>,
    instead: Option<Box<ReportTold>>,
    action: String,
    steps_ended: usize,
    steps_accepted: usize,
    steps_total: usize,
    elapsed_ms: u64,
    pauses: usize,
    before: Option<Vec<u8>>,
    evidence: Option<Vec<u8>>,
}

/// An outcome; what interrupted is a name with its detail in numbers.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum OutcomeTold {
    Done,
    Refused(u8),
    Interrupted(String, u8),
    Unknown(String),
}

/// A report as the bytes of the package that told it.
fn report_bytes(report: MotionReport) -> Vec<u8> {
    let package = SynchronizationPackage {
        session: 0,
        sequence: 0,
        kind_byte: rsapien_protocol::Kind::State.byte(),
        status: Status::Accepted,
        report: Report::Motion(report),
    };
    package.encode(Address::Motion).to_vec()
}

fn motion_report(bytes: &[u8]) -> Option<MotionReport> {
    let mut receiver = Receiver::listening(Direction::ToPc);
    let content: Content = bytes.iter().find_map(|byte| match receiver.feed(*byte, 0) {
        Fed::Package(content) => Some(content),
        _ => None,
    })?;
    match SynchronizationPackage::parse(&content).ok()?.report {
        Report::Motion(report) => Some(report),
        _ => None,
    }
}

impl OutcomeTold {
    pub(super) fn of(outcome: &Outcome) -> OutcomeTold {
        let interrupted = |name: &str, detail| OutcomeTold::Interrupted(name.to_owned(), detail);
        match outcome {
            Outcome::Done => OutcomeTold::Done,
            Outcome::Refused { status } => OutcomeTold::Refused(status.byte()),
            Outcome::Unknown { why } => OutcomeTold::Unknown(why.clone()),
            Outcome::Interrupted { by } => match by {
                Interruption::Bumper(mask) => interrupted("bumper", mask.bits()),
                Interruption::Stop => interrupted("stop", 0),
                Interruption::DeadMan => interrupted("dead-man", 0),
                Interruption::Reset(cause) => interrupted("reset", cause.byte()),
                Interruption::LinkLost => interrupted("link-lost", 0),
                Interruption::Cancelled => interrupted("cancelled", 0),
                Interruption::Replaced => interrupted("replaced", 0),
                Interruption::WaitInVain(mask) => interrupted("wait-in-vain", mask.bits()),
            },
        }
    }

    pub(super) fn outcome(self) -> Outcome {
        let unknown = |what: String| Outcome::Unknown {
            why: format!("the program that holds the line told it in words not known here: {what}"),
        };
        match self {
            OutcomeTold::Done => Outcome::Done,
            OutcomeTold::Refused(byte) => match Status::from_byte(byte) {
                Some(status) => Outcome::Refused { status },
                None => unknown(format!("refused, status {byte}")),
            },
            OutcomeTold::Unknown(why) => Outcome::Unknown { why },
            OutcomeTold::Interrupted(name, detail) => {
                let by = match name.as_str() {
                    "bumper" => Some(Interruption::Bumper(BumperMask::from_low_bits(detail))),
                    "stop" => Some(Interruption::Stop),
                    "dead-man" => Some(Interruption::DeadMan),
                    "reset" => StopCause::from_byte(detail).map(Interruption::Reset),
                    "link-lost" => Some(Interruption::LinkLost),
                    "cancelled" => Some(Interruption::Cancelled),
                    "replaced" => Some(Interruption::Replaced),
                    "wait-in-vain" => {
                        Some(Interruption::WaitInVain(BumperMask::from_low_bits(detail)))
                    }
                    _ => None,
                };
                by.map_or_else(|| unknown(name), |by| Outcome::Interrupted { by })
            }
        }
    }
}

impl ReportTold {
    pub(crate) fn of(report: &PlayReport) -> ReportTold {
        ReportTold {
            outcome: OutcomeTold::of(&report.outcome),
            reached: report.reached.as_ref().map(|it| (it.number, source_told(&it.source))),
            instead: report.instead.as_ref().map(|it| Box::new(ReportTold::of(it))),
            action: report.action.clone(),
            steps_ended: report.steps_ended,
            steps_accepted: report.steps_accepted,
            steps_total: report.steps_total,
            elapsed_ms: report.elapsed_ms,
            pauses: report.pauses,
            before: report.before.map(report_bytes),
            evidence: report.evidence.map(report_bytes),
        }
    }

    pub(crate) fn report(self) -> PlayReport {
        PlayReport {
            outcome: self.outcome.outcome(),
            reached: self.reached.map(|(number, of)| StepReached { number, source: source(of) }),
            instead: self.instead.map(|it| Box::new(it.report())),
            action: self.action,
            steps_ended: self.steps_ended,
            steps_accepted: self.steps_accepted,
            steps_total: self.steps_total,
            elapsed_ms: self.elapsed_ms,
            pauses: self.pauses,
            before: self.before.as_deref().and_then(motion_report),
            evidence: self.evidence.as_deref().and_then(motion_report),
        }
    }
}
