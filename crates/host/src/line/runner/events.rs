//! What the line does with what the session tells.

use rsapien_protocol::{
    Address, Failure, Kind, Mode, Report, SessionEvent, SynchronizationPackage, Ticket,
};

use super::{Asked, Runner, Work, loss, reply_to};
use crate::line::Answer;
use crate::{Error, LinkState, Stamped};

impl Runner {
    pub(super) fn handle_event(&mut self, event: SessionEvent) {
        let now_ms = self.link.now_ms();
        match event {
            SessionEvent::Answered { ticket, address, package, tries, .. } => {
                self.state.counts.answered += 1;
                self.state.counts.resent += u64::from(tries.saturating_sub(1));
                self.note(address, &package, now_ms);
                self.note_dead_man(ticket, address, &package);
                if address == Address::Motion && self.state.link != LinkState::Up {
                    self.state.link = LinkState::Up;
                    self.care_mut(Address::Camera).polled = self.state.camera.is_some();
                }
                self.publish(now_ms);
                self.settle(ticket, |asked| Ok(Answer { address, kind: asked.kind, package }));
            }
            SessionEvent::Failed { ticket, failure, .. } => {
                let tries = match failure {
                    Failure::NoAnswer { tries, .. } | Failure::OutcomeUnknown { tries, .. } => {
                        tries
                    }
                    Failure::Displaced { .. } => 0,
                };
                self.state.counts.resent += u64::from(tries.saturating_sub(1));
                self.state.counts.unanswered += 1;
                self.note_failure(failure, now_ms);
                self.publish(now_ms);
                let link = self.connector.name();
                self.settle(ticket, |asked| Err(loss::error_of(failure, asked.address, &link)));
            }
            SessionEvent::Restarted { .. } => {
                self.state.counts.restarts += 1;
                self.publish(now_ms);
            }
            SessionEvent::Incomprehensible { address, error } => {
                tracing::warn!(%address, %error, "a package was not understood");
            }
        }
    }

    /// Keeps what a package tells.
    fn note(&mut self, address: Address, package: &SynchronizationPackage, now_ms: u64) {
        let care = self.care_mut(address);
        care.polled = true;
        match package.report {
            Report::Hello(report) => {
                if package.status.is_accepted() {
                    care.opened = true;
                    care.dead_man_ms = u64::from(report.dead_man_ms);
                    match address {
                        Address::Motion => self.state.motion_information = Some(report),
                        Address::Camera => self.state.camera_information = Some(report),
                    }
                }
            }
            Report::Motion(report) => {
                self.state.motion = Some(Stamped { time_ms: now_ms, report });
                let may_move = matches!(report.mode, Mode::Initialising | Mode::Executing);
                if std::mem::take(&mut self.is_suspicious) && may_move {
                    // The link came back while the robot was still at it, and whoever asked for
                    // that was told that it ended.
                    self.stops.push_back((Address::Motion, None));
                }
            }
            Report::Camera(report) => {
                self.state.camera = Some(Stamped { time_ms: now_ms, report });
            }
            Report::Counters(_) => {}
        }
    }

    /// Keeps the dead-man time that an accepted CONFIGURE has set.
    fn note_dead_man(
        &mut self,
        ticket: Ticket,
        address: Address,
        package: &SynchronizationPackage,
    ) {
        let asked = self.asked.iter().find(|asked| asked.ticket == ticket);
        let Some(timeout_ms) = asked.and_then(|asked| asked.dead_man_ms) else { return };
        if !package.status.is_accepted() {
            return;
        }
        self.care_mut(address).dead_man_ms = u64::from(timeout_ms);
        let information = match address {
            Address::Motion => &mut self.state.motion_information,
            Address::Camera => &mut self.state.camera_information,
        };
        if let Some(report) = information {
            report.dead_man_ms = timeout_ms;
        }
    }

    fn settle(&mut self, ticket: Ticket, outcome: impl Fn(&Asked) -> Result<Answer, Error>) {
        let mut index = 0;
        while index < self.asked.len() {
            if self.asked.get(index).is_none_or(|asked| asked.ticket != ticket) {
                index += 1;
                continue;
            }
            let asked = self.asked.remove(index);
            let outcome = outcome(&asked);
            if asked.kind == Kind::Hello && asked.reply.is_none() {
                self.end_what_needs_session(asked.address, outcome);
                continue;
            }
            reply_to(asked.reply, outcome);
        }
    }

    /// Ends the request for which HELLO was sent, if no session came of it.
    fn end_what_needs_session(&mut self, address: Address, hello: Result<Answer, Error>) {
        let Err(error) = hello.and_then(Answer::accepted) else { return };
        let waits_for_it = self.pending.front().is_some_and(|pending| {
            pending.address == address && matches!(pending.work, Work::Request { opened: true, .. })
        });
        if waits_for_it && let Some(pending) = self.pending.pop_front() {
            reply_to(pending.reply, Err(error));
        }
    }
}
