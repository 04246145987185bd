//! What the line does for each controller by itself: heartbeats, in time for the dead-man.

use rsapien_protocol::Address;

use super::Runner;

/// How often a heartbeat fits into the dead-man time, so that lost packages do not trip it.
const HEARTBEATS_A_DEAD_MAN: u64 = 4;

/// What the line does for one controller by itself.
#[derive(Clone, Copy, Default)]
pub(super) struct Care {
    /// It answered once, so it is asked for its state again and again.
    pub(super) polled: bool,
    /// A session was opened, so one is opened again when the link comes back.
    pub(super) opened: bool,
    pub(super) last_sent_ms: u64,
    pub(super) dead_man_ms: u64,
}

impl Runner {
    pub(super) fn next_heartbeat_ms(&self) -> u64 {
        let due = Address::ALL.into_iter().filter_map(|address| self.heartbeat_ms(address));
        due.min().unwrap_or(u64::MAX)
    }

    /// When the controller at `address` is asked for its state if nothing else is sent to it.
    pub(super) fn heartbeat_ms(&self, address: Address) -> Option<u64> {
        let care = self.care(address);
        let limit_ms = match care.dead_man_ms {
            0 => u64::MAX,
            dead_man_ms => (dead_man_ms / HEARTBEATS_A_DEAD_MAN).max(1),
        };
        let period_ms = self.options.state_period_ms.clamp(1, limit_ms);
        care.polled.then(|| care.last_sent_ms.saturating_add(period_ms))
    }

    pub(super) fn care(&self, address: Address) -> &Care {
        let [motion, camera] = &self.care;
        match address {
            Address::Motion => motion,
            Address::Camera => camera,
        }
    }

    pub(super) fn care_mut(&mut self, address: Address) -> &mut Care {
        let [motion, camera] = &mut self.care;
        match address {
            Address::Motion => motion,
            Address::Camera => camera,
        }
    }
}
