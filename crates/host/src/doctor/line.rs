//! One open line that is asked, not driven.

use rsapien_protocol::{
    Address, Counts, HelloReport, Report, Request, Session, SessionConfig, SessionEvent, Status,
};

use crate::link::{Connect, Link, RealClock};
use crate::lock::LineLock;
use crate::ports::drive;
use crate::robot::random_session;
use crate::{Error, Holder};

/// How often a package is sent to what may be no robot.
const TRIES: u8 = 3;

/// How a request ended.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asked {
    /// Status and report; none when no answer came.
    pub(super) answer: Option<(Status, Report)>,
    /// How often it was sent.
    pub(super) tries: u8,
    /// From the first try to the answer, in ms.
    pub(super) round_trip_ms: u64,
}

/// A line that is open.
pub(super) struct ProbeLine {
    name: String,
    baud: u32,
    connector: Box<dyn Connect>,
    link: Box<dyn Link>,
    session: Session,
    /// Packages came, but none that was intact.
    is_garbled: bool,
    // Released when the line is closed.
    _lock: Option<LineLock>,
}

impl ProbeLine {
    pub(super) fn open(
        mut connector: Box<dyn Connect>,
        baud: u32,
        lock_folder: Option<&std::path::Path>,
    ) -> Result<ProbeLine, Error> {
        let lock = match (lock_folder, connector.lock_key()) {
            (Some(folder), Some(key)) => {
                Some(LineLock::take(folder, &key, &Holder::this_process("rsapien doctor"))?)
            }
            _ => None,
        };
        let mut link = connector.connect(RealClock::start())?;
        link.flush_input()?;
        let name = connector.name();
        let session = new_session(baud);
        Ok(ProbeLine { name, baud, connector, link, session, is_garbled: false, _lock: lock })
    }

    pub(super) fn name(&self) -> &str {
        &self.name
    }

    pub(super) fn baud(&self) -> u32 {
        self.baud
    }

    /// Opens the link anew at another speed, by what `connector` opens.
    pub(super) fn reopen(&mut self, connector: Box<dyn Connect>, baud: u32) -> Result<(), Error> {
        self.connector = connector;
        self.link = self.connector.connect(RealClock::start())?;
        self.link.flush_input()?;
        self.baud = baud;
        self.session = new_session(baud);
        Ok(())
    }

    /// Whether damaged packages came, at whichever speed.
    pub(super) fn is_garbled(&self) -> bool {
        self.is_garbled
    }

    pub(super) fn now_ms(&self) -> u64 {
        self.link.now_ms()
    }

    /// What reception at this end counted.
    pub(super) fn counts(&self) -> Counts {
        self.session.counts()
    }

    /// HELLO; none when nobody answers.
    pub(super) fn hello(
        &mut self,
        address: Address,
    ) -> Result<Option<(Status, HelloReport)>, Error> {
        // Nothing is outstanding, so that it is taken.
        if self.session.open(address).is_err() {
            return Ok(None);
        }
        Ok(match self.settle()?.answer {
            Some((status, Report::Hello(report))) => Some((status, report)),
            _ => None,
        })
    }

    /// STATE or COUNTERS.
    pub(super) fn ask(&mut self, address: Address, request: Request) -> Result<Asked, Error> {
        if self.session.request(address, request).is_err() {
            return Ok(Asked { answer: None, tries: 0, round_trip_ms: 0 });
        }
        self.settle()
    }

    fn settle(&mut self) -> Result<Asked, Error> {
        let event = drive(&mut self.session, self.link.as_mut())?;
        self.is_garbled |= self.session.counts().errors > 0;
        Ok(match event {
            Some(SessionEvent::Answered { package, tries, round_trip_ms, .. }) => {
                Asked { answer: Some((package.status, package.report)), tries, round_trip_ms }
            }
            _ => Asked { answer: None, tries: TRIES, round_trip_ms: 0 },
        })
    }
}

fn new_session(baud: u32) -> Session {
    let first_session = random_session();
    Session::new(SessionConfig { baud, first_session, tries: TRIES, ..SessionConfig::default() })
}
