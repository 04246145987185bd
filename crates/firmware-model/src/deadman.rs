//! The dead-man: silence ends motion.
//!
//! ```text
//!              intact package to this controller: silence = 0
//!            ┌──────────┐
//!            ▼          │
//!        Listening ─────┴── tick: silence + 1; silence = dead-man time, and something moves ──► trip:
//!            ▲                                                          all off, queue emptied, held
//!            └───────────────────────────────────────────────────────────────┘
//! ```
//!
//! The timer routine counts and trips, so a hung main routine cannot keep the motors on. A
//! package accepted in tick `t` keeps them on up to tick `t + time - 1`; in tick `t + time` the
//! dead-man trips, even when the next package is waiting in the ring.

use rsapien_protocol::Parameter;

#[derive(Clone, Debug)]
pub(crate) struct DeadMan {
    /// 0: off.
    timeout_ms: u16,
    silence_ms: u16,
    trips: u16,
}

impl DeadMan {
    pub(crate) const fn new() -> DeadMan {
        DeadMan { timeout_ms: Parameter::DEAD_MAN_MS_DEFAULT, silence_ms: 0, trips: 0 }
    }

    pub(crate) fn configure(&mut self, timeout_ms: u16) {
        self.timeout_ms = timeout_ms;
    }

    pub(crate) fn package_received(&mut self) {
        self.silence_ms = 0;
    }

    pub(crate) fn tick(&mut self) {
        self.silence_ms = self.silence_ms.saturating_add(1);
    }

    /// Whether the dead-man trips, which is counted; `moving` says whether anything moves.
    pub(crate) fn trips_now(&mut self, moving: bool) -> bool {
        let trips = moving && self.timeout_ms != 0 && self.silence_ms >= self.timeout_ms;
        if trips {
            self.trips = self.trips.wrapping_add(1);
        }
        trips
    }

    pub(crate) const fn timeout_ms(&self) -> u16 {
        self.timeout_ms
    }

    pub(crate) const fn trips(&self) -> u16 {
        self.trips
    }
}
