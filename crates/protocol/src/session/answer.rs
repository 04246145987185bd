//! What an answer, or its absence, does to the session: it settles the request outstanding, asks back
//! what a refusal is worth, or leaves the outcome unknown.

use super::outstanding::{Outstanding, Phase, Question};
use super::{
    EVENTS_MAX, Failure, Peer, RESTARTED_MAX, Session, SessionEvent, UnknownReason, hello,
};
use crate::{ActionPackage, Address, HelloReport, Report, Status, SynchronizationPackage};

impl Session {
    pub(super) fn handle_package(
        &mut self,
        address: Address,
        package: SynchronizationPackage,
        now_ms: u64,
    ) {
        self.note_boot(address, &package.report);
        let Some(outstanding) = self.outstanding else { return };
        if address != outstanding.address {
            return;
        }
        if outstanding.tries > 0 && answers(&package, &outstanding.package) {
            self.handle_answer(outstanding, package, now_ms);
        } else if let Some(question) = outstanding.question
            && question.tries > 0
            && answers(&package, &question.package)
        {
            self.handle_last_number(outstanding, question, &package);
        }
    }

    fn handle_answer(
        &mut self,
        mut outstanding: Outstanding,
        package: SynchronizationPackage,
        now_ms: u64,
    ) {
        if !outstanding.package.request.kind().is_numbered() {
            return self.end_answered(outstanding, package, now_ms);
        }
        if matches!(package.status, Status::NoSession | Status::OutOfSequence) {
            self.peer_mut(outstanding.address).session = None;
            // It may have run in the session that was lost, its answer with it.
            if outstanding.tries > 1 || outstanding.was_reset || outstanding.question.is_some() {
                return self.end_failed(outstanding, UnknownReason::SessionLost);
            }
            return self.end_answered(outstanding, package, now_ms);
        }
        if let Some(question) = &mut outstanding.question {
            if !question.answer.status.is_accepted() {
                (question.answer, question.answered_ms) = (package, now_ms);
            }
        } else if may_pass(package.status) {
            let session = outstanding.package.session;
            let hello = ActionPackage { session, sequence: self.tag(), request: hello(session) };
            outstanding.phase = Phase::Sending;
            outstanding.question =
                Some(Question { package: hello, tries: 0, answer: package, answered_ms: now_ms });
        } else {
            return self.end_answered(outstanding, package, now_ms);
        }
        self.outstanding = Some(outstanding);
    }

    /// The answer to the question: everything sent before it has arrived or never will.
    fn handle_last_number(
        &mut self,
        outstanding: Outstanding,
        question: Question,
        package: &SynchronizationPackage,
    ) {
        let number = outstanding.package.sequence;
        let mut answer = question.answer;
        let last = match package.report {
            Report::Hello(HelloReport { last_sequence, .. })
                if package.status.is_accepted() && !outstanding.was_reset =>
            {
                last_sequence
            }
            _ => return self.end_failed(outstanding, UnknownReason::SessionLost),
        };
        if last == number {
            answer.status = Status::Accepted;
        } else if last.wrapping_add(1) != number || answer.status.is_accepted() {
            return self.end_failed(outstanding, UnknownReason::SessionLost);
        }
        self.end_answered(outstanding, answer, question.answered_ms);
    }

    fn end_answered(
        &mut self,
        outstanding: Outstanding,
        package: SynchronizationPackage,
        answered_ms: u64,
    ) {
        let Outstanding { ticket, address, tries, .. } = outstanding;
        if package.status.is_accepted() {
            if let Report::Hello(report) = package.report {
                *self.peer_mut(address) = Peer {
                    session: Some(package.session),
                    last_sequence: report.last_sequence,
                    boot: Some(report.boot),
                };
            } else if outstanding.package.request.kind().is_numbered() {
                self.peer_mut(address).last_sequence = package.sequence;
            }
        }
        self.outstanding = None;
        let round_trip_ms = answered_ms.saturating_sub(outstanding.first_sent_ms);
        let event = SessionEvent::Answered { ticket, address, package, tries, round_trip_ms };
        self.push(event, EVENTS_MAX);
    }

    /// Ends a request that was sent and has no answer that settles it.
    pub(super) fn end_failed(&mut self, outstanding: Outstanding, reason: UnknownReason) {
        let Outstanding { ticket, address, tries, .. } = outstanding;
        let kind = outstanding.package.request.kind();
        let failure = match (kind.is_numbered(), reason) {
            (true, reason) => Failure::OutcomeUnknown { address, kind, tries, reason },
            (false, UnknownReason::Displaced) => Failure::Displaced { kind },
            (false, _) => Failure::NoAnswer { address, kind, tries },
        };
        if kind.is_numbered() {
            // Whether the number was used up cannot be known, so the session ends with it.
            self.peer_mut(address).session = None;
            if let Some(Question { answer, answered_ms, .. }) = outstanding.question
                && answer.status.is_accepted()
            {
                return self.end_answered(outstanding, answer, answered_ms);
            }
        }
        self.outstanding = None;
        self.push(SessionEvent::Failed { ticket, address, failure }, EVENTS_MAX);
    }

    fn note_boot(&mut self, address: Address, report: &Report) {
        let Some(boot) = report.boot() else { return };
        let known = self.peer_mut(address).boot.replace(boot);
        if known.is_some_and(|known| known != boot) {
            self.peer_mut(address).session = None;
            if let Some(outstanding) = &mut self.outstanding {
                outstanding.was_reset |= outstanding.address == address && outstanding.tries > 0;
            }
            self.push(SessionEvent::Restarted { address, boot }, RESTARTED_MAX);
        }
    }
}

fn answers(answer: &SynchronizationPackage, asked: &ActionPackage) -> bool {
    answer.session == asked.session
        && answer.sequence == asked.sequence
        && answer.kind_byte == asked.request.kind().byte()
}

/// Whether a robot that answered so may answer the same bytes otherwise a moment later, in the
/// same session.
const fn may_pass(status: Status) -> bool {
    matches!(status, Status::QueueFull | Status::Held | Status::NotInitialised)
}
