//! What both controllers have in common: reception, analysis, transmission, dead-man, watchdog
//! and the numbers every report carries.
//!
//! One pass of the main routine, which both controllers make of these parts:
//!
//! ```text
//!   watchdog cleared
//!         ▼
//!   package complete? ── yes ─► analysed ── in its turn ─► executed ─► an answer is owed
//!         │ no                     └── refused, duplicate ──────────►     │
//!         ▼                                                               │
//!   answer owed, transmitter idle? ◄──────────────────────────────────────┘
//!         │ no       └── yes ─► response initiated, with the report of this moment
//!         ▼                        │
//!   bumpers tested (motion) ◄──────┘
//! ```

use rsapien_protocol::{
    ActionView, Address, Content, CountersReport, HelloReport, Kind, PROTOCOL_VERSION, Report,
    Request, Status, StopCause, SynchronizationPackage,
};

use crate::command::{Command, Verdict};
use crate::deadman::DeadMan;
use crate::reception::Reception;
use crate::transmission::{Answer, Transmission};
use crate::watchdog::Watchdog;
use crate::{CLOCK_MHZ_DEFAULT, FIRMWARE_VERSION, ResetCause};

#[derive(Clone, Debug)]
pub(crate) struct Communication {
    pub(crate) address: Address,
    pub(crate) now_ms: u64,
    pub(crate) reception: Reception,
    pub(crate) command: Command,
    pub(crate) transmission: Transmission,
    pub(crate) dead_man: DeadMan,
    pub(crate) watchdog: Watchdog,
    pub(crate) boot: u8,
    pub(crate) cause: StopCause,
    pub(crate) clock_mhz: u8,
    /// A fault: the main routine no longer runs.
    pub(crate) hung: bool,
}

impl Communication {
    pub(crate) const fn new(
        address: Address,
        reset_cause: ResetCause,
        eeprom_boot: u8,
        watchdog_ms: u8,
    ) -> Communication {
        Communication {
            address,
            now_ms: 0,
            reception: Reception::new(address),
            command: Command::new(address),
            transmission: Transmission::new(),
            dead_man: DeadMan::new(),
            watchdog: Watchdog::new(watchdog_ms),
            boot: eeprom_boot.wrapping_add(1),
            cause: reset_cause.stop_cause(),
            clock_mhz: CLOCK_MHZ_DEFAULT,
            hung: false,
        }
    }

    /// The part of the timer routine that both controllers have; whether the watchdog resets.
    pub(crate) fn tick(&mut self) -> bool {
        self.now_ms += 1;
        self.dead_man.tick();
        self.watchdog.tick()
    }

    /// Main routine: the next intact package, which feeds the dead-man whatever it asks for.
    pub(crate) fn next_package(&mut self) -> Option<Content> {
        let content = self.reception.next_package(self.now_ms)?;
        self.dead_man.package_received();
        Some(content)
    }

    pub(crate) fn analyse(&mut self, content: &Content) -> Verdict {
        self.command.analyse(ActionView::new(content.action()))
    }

    /// Notes what became of a request that was left to the controller.
    pub(crate) fn executed(&mut self, content: &Content, request: Request, status: Status) {
        if status.is_accepted() && request.kind().is_numbered() {
            self.command.note_executed(ActionView::new(content.action()).sequence());
        }
    }

    pub(crate) fn owe_answer(&mut self, content: &Content, status: Status) {
        self.transmission.owe(Answer::to(ActionView::new(content.action()), status));
    }

    /// The report that answers HELLO and COUNTERS; every other kind is answered with the
    /// controller's own.
    pub(crate) fn common_report(&self, answer: Answer, queue_length: u8) -> Option<Report> {
        match Kind::from_byte(answer.kind_byte) {
            Some(Kind::Hello) => {
                Some(Report::Hello(self.hello_report(queue_length, answer.status)))
            }
            Some(Kind::Counters) => Some(Report::Counters(self.counters_report())),
            _ => None,
        }
    }

    /// Main routine: initiates a response.
    pub(crate) fn initiate_response(&mut self, answer: Answer, report: Report) {
        let package = SynchronizationPackage {
            session: answer.session,
            sequence: answer.sequence,
            kind_byte: answer.kind_byte,
            status: answer.status,
            report,
        };
        self.transmission.begin(package.encode(self.address));
    }

    /// Reception errors since reset, modulo 256.
    pub(crate) const fn reception_errors(&self) -> u8 {
        self.reception.counts().errors.to_le_bytes()[0]
    }

    fn hello_report(&self, queue_length: u8, status: Status) -> HelloReport {
        HelloReport {
            version: if status.is_accepted() { PROTOCOL_VERSION } else { 0 },
            firmware: FIRMWARE_VERSION,
            clock_mhz: self.clock_mhz,
            queue_length,
            dead_man_ms: self.dead_man.timeout_ms(),
            last_sequence: self.command.last_sequence(),
            boot: self.boot,
            reception_errors: self.reception_errors(),
            cause: self.cause,
        }
    }

    pub(crate) const fn counters_report(&self) -> CountersReport {
        let counts = self.reception.counts();
        CountersReport {
            accepted: counts.accepted,
            resets: counts.resets,
            crc_errors: counts.crc_errors,
            framing_errors: counts.framing_errors,
            overruns: counts.overruns,
            duplicates: self.command.duplicates(),
            dead_man_trips: self.dead_man.trips(),
        }
    }
}
