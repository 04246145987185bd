//! The watchdog: a controller whose main routine no longer runs is reset.
//!
//! ```text
//!              main routine: count = 0
//!            ┌──────────┐
//!            ▼          │
//!         Watching ─────┴── tick: count + 1; count = watchdog time ──► reset: all motors off,
//!            ▲                                     boot number + 1, cause 5, no session, fresh
//!            └──────────────────────────────────────────────┘
//! ```
//!
//! On the chips an RC oscillator of its own counts, so its time is true to some tens of percent
//! only; the model counts ticks of the nominal time.

#[derive(Clone, Debug)]
pub(crate) struct Watchdog {
    timeout_ms: u8,
    count_ms: u8,
}

impl Watchdog {
    pub(crate) const fn new(timeout_ms: u8) -> Watchdog {
        Watchdog { timeout_ms, count_ms: 0 }
    }

    pub(crate) fn clear(&mut self) {
        self.count_ms = 0;
    }

    /// Whether the watchdog resets the controller in this tick.
    pub(crate) fn tick(&mut self) -> bool {
        self.count_ms = self.count_ms.saturating_add(1);
        self.count_ms >= self.timeout_ms
    }
}
