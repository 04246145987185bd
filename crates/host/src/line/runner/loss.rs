//! What the line does when the robot falls silent or the link breaks. The link is opened again and
//! again until it is back; then sessions are opened anew, but no motion is resumed.

use rsapien_protocol::{Address, Direction, Failure, Session};

use super::{Pending, Runner, Work, reply_to, session_config};
use crate::{Error, LinkState};

/// How often a lost link is tried.
const RETRY_MS: u64 = 500;

impl Runner {
    /// One turn without a link: lets time pass and tries the link when it is time to.
    pub(super) fn turn_lost(&mut self) -> Result<(), Error> {
        self.end_requests();
        self.end_waits();
        let retry_ms = self.retry_ms.unwrap_or_default();
        if self.link.now_ms() < retry_ms {
            self.rest(retry_ms.min(self.next_wait_ms()));
            return Ok(());
        }
        match self.connector.connect(self.clock) {
            Ok(link) => {
                self.link = link;
                self.recover()
            }
            Err(error) => {
                tracing::debug!(%error, "the link is still lost");
                self.retry_ms = Some(self.link.now_ms().saturating_add(RETRY_MS));
                Ok(())
            }
        }
    }

    /// Takes note that the link broke. What was on the line ends here.
    pub(super) fn lose(&mut self, error: &Error) {
        let why = match error {
            Error::LinkLost { why, .. } => why.clone(),
            other => other.to_string(),
        };
        let now_ms = self.link.now_ms();
        let link = self.connector.name();
        tracing::warn!(link, why, "link lost");
        self.retry_ms = Some(now_ms.saturating_add(RETRY_MS));
        self.state.link = LinkState::Lost { since_ms: now_ms, why: why.clone() };
        // Session numbers go on, so that packages of the old session mean nothing in the new one.
        self.next_session = self.next_session.wrapping_add(64).max(1);
        self.session = Session::new(session_config(&self.options, self.next_session));
        self.publish(now_ms);
        for asked in std::mem::take(&mut self.asked) {
            let error = if asked.kind.is_numbered() {
                let why = format!("the link {link} was lost before the answer came: {why}");
                Error::OutcomeUnknown { address: asked.address, kind: asked.kind, why }
            } else {
                Error::LinkLost { link: link.clone(), why: why.clone() }
            };
            reply_to(asked.reply, Err(error));
        }
        self.end_requests();
    }

    /// Ends what cannot be sent.
    fn end_requests(&mut self) {
        let link = self.connector.name();
        let why = match &self.state.link {
            LinkState::Lost { why, .. } => why.clone(),
            LinkState::Up | LinkState::Silent { .. } => String::new(),
        };
        let replies = self.pending.drain(..).map(|pending| pending.reply);
        let replies = replies.chain(self.stops.drain(..).map(|(_, reply)| reply));
        for reply in replies {
            reply_to(reply, Err(Error::LinkLost { link: link.clone(), why: why.clone() }));
        }
    }

    /// Takes up a link that was opened again.
    fn recover(&mut self) -> Result<(), Error> {
        self.link.flush_input()?;
        let now_ms = self.link.now_ms();
        self.retry_ms = None;
        self.is_suspicious = true;
        self.listener = rsapien_protocol::Receiver::listening(Direction::ToPc);
        self.state.counts.reconnects += 1;
        self.state.link = LinkState::Silent { since_ms: now_ms };
        for address in Address::ALL.into_iter().rev() {
            let care = self.care_mut(address);
            // Its state is asked for at once.
            care.last_sent_ms = 0;
            if care.opened {
                self.pending.push_front(Pending { address, work: Work::Open, reply: None });
            }
        }
        tracing::info!(link = self.connector.name(), "link opened again");
        self.publish(now_ms);
        Ok(())
    }

    /// Keeps what a request that failed tells of the link.
    pub(super) fn note_failure(&mut self, failure: Failure, now_ms: u64) {
        let (address, tries) = match failure {
            Failure::NoAnswer { address, tries, .. }
            | Failure::OutcomeUnknown { address, tries, .. } => (address, tries),
            Failure::Displaced { .. } => return,
        };
        if address == Address::Camera {
            // Its tries would keep the line from the motion controller, whose dead-man waits.
            self.care_mut(address).polled = false;
        }
        // A camera controller may be missing; the link is what leads to the motion controller. A
        // single try tells nothing: STOP took the place of the next ones.
        if address == Address::Motion && tries > 1 && self.state.link == LinkState::Up {
            self.state.link = LinkState::Silent { since_ms: now_ms };
        }
    }
}

/// The error of a request that the session gave up.
pub(super) fn error_of(failure: Failure, address: Address, link: &str) -> Error {
    match failure {
        Failure::NoAnswer { kind, tries, .. } => {
            Error::NoAnswer { link: link.to_owned(), address, kind, tries }
        }
        Failure::OutcomeUnknown { kind, tries, reason, .. } => {
            let why = format!("it was sent {tries} times, and {reason}");
            Error::OutcomeUnknown { address, kind, why }
        }
        Failure::Displaced { kind } => Error::Displaced { kind },
    }
}
