//! A robot that is nothing but rules.

use super::Bounds;
use crate::{
    ActionPackage, BumperMask, HelloReport, Mode, MotionReport, PROTOCOL_VERSION, Pose, Report,
    Request, Status, StopCause, SynchronizationPackage,
};

/// The robot's rules 1 to 3, and nothing else.
#[derive(Clone, Hash)]
pub(super) struct Robot {
    pub(super) session: u8,
    pub(super) last_sequence: u8,
    pub(super) boot: u8,
    pub(super) queue_is_full: bool,
}

impl Robot {
    /// Answers a package; gives the step to run, by its duration, if there is one.
    pub(super) fn take(
        &mut self,
        package: &ActionPackage,
        bounds: Bounds,
    ) -> (SynchronizationPackage, Option<u16>) {
        let mut runs = None;
        let mut status = Status::Accepted;
        match package.request {
            Request::Hello { session, .. } if self.session != session => {
                self.session = session;
                self.last_sequence = 0;
            }
            Request::Step(step) => {
                let next = self.last_sequence.wrapping_add(1);
                let is_duplicate = self.last_sequence != 0
                    && package.sequence == self.last_sequence
                    && bounds.robot_knows_duplicates;
                let is_next = package.sequence == next || !bounds.robot_knows_duplicates;
                if self.session == 0 || package.session != self.session {
                    status = Status::NoSession;
                } else if is_duplicate {
                    // The status given then: only what was accepted used its number up.
                } else if !is_next {
                    status = Status::OutOfSequence;
                } else if self.queue_is_full {
                    status = Status::QueueFull;
                } else {
                    self.last_sequence = package.sequence;
                    runs = Some(step.duration_ms);
                }
            }
            _ => {}
        }
        let kind_byte = package.request.kind().byte();
        let report = match package.request {
            Request::Hello { .. } => Report::Hello(HelloReport {
                version: PROTOCOL_VERSION,
                firmware: [0; 3],
                clock_mhz: 40,
                queue_length: 32,
                dead_man_ms: 500,
                last_sequence: self.last_sequence,
                boot: self.boot,
                reception_errors: 0,
                cause: StopCause::Nothing,
            }),
            _ => Report::Motion(MotionReport {
                mode: Mode::Executing,
                bumpers: BumperMask::NONE,
                middle_switches: [false; 2],
                presses: [0; 6],
                motors: 0,
                supply_low: false,
                pose_reached: Pose::EMPTY,
                queue_free: 0,
                steps_ended: 0,
                boot: self.boot,
                reception_errors: 0,
                cause: StopCause::Nothing,
            }),
        };
        let Request::Hello { session, .. } = package.request else {
            let (session, sequence) = (package.session, package.sequence);
            return (SynchronizationPackage { session, sequence, kind_byte, status, report }, runs);
        };
        let sequence = package.sequence;
        (SynchronizationPackage { session, sequence, kind_byte, status, report }, runs)
    }
}
