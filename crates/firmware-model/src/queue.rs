//! The queue of steps: a ring that the main routine fills and the timer routine empties.
//!
//! ```text
//!              append                     ┌─────┐ append, take
//!   Empty ─────────────────────► Waiting ─┘ ◄───┘
//!     ▲                           │   │ ▲
//!     └── take the last, clear ───┘   │ └── take ─── Full ── append: refused, nothing changes
//!     ▲                               └── 32nd ───► │
//!     └── clear ────────────────────────────────────┘
//! ```
//!
//! The running step has left the queue, so 32 steps may wait behind it. In C the main routine
//! masks the timer interrupt while it appends or clears.

use rsapien_protocol::{BumperMask, Pose, Step};

/// Steps that may wait behind the running one.
pub const QUEUE_LENGTH: u8 = 32;

/// What the queue keeps of a step: `replace` has done its work when the step is queued.
#[derive(Clone, Copy, Debug)]
pub(crate) struct QueuedStep {
    pub(crate) pose: Pose,
    pub(crate) duration_ms: u16,
    pub(crate) ending_bumpers: BumperMask,
}

#[derive(Clone, Debug)]
pub(crate) struct Queue {
    steps: [QueuedStep; QUEUE_LENGTH as usize],
    first: u8,
    count: u8,
}

impl Queue {
    pub(crate) const fn new() -> Queue {
        let empty =
            QueuedStep { pose: Pose::EMPTY, duration_ms: 0, ending_bumpers: BumperMask::NONE };
        Queue { steps: [empty; QUEUE_LENGTH as usize], first: 0, count: 0 }
    }

    pub(crate) const fn free(&self) -> u8 {
        QUEUE_LENGTH - self.count
    }

    pub(crate) fn clear(&mut self) {
        self.count = 0;
    }

    /// Appends a step; false when there is no place.
    pub(crate) fn append(&mut self, step: Step) -> bool {
        if self.free() == 0 {
            return false;
        }
        let place = usize::from((self.first + self.count) % QUEUE_LENGTH);
        self.steps[place] = QueuedStep {
            pose: step.pose,
            duration_ms: step.duration_ms,
            ending_bumpers: step.ending_bumpers,
        };
        self.count += 1;
        true
    }

    pub(crate) fn take(&mut self) -> Option<QueuedStep> {
        if self.count == 0 {
            return None;
        }
        let step = self.steps[usize::from(self.first % QUEUE_LENGTH)];
        self.first = (self.first + 1) % QUEUE_LENGTH;
        self.count -= 1;
        Some(step)
    }
}
