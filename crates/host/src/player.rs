//! The player: keeps the robot's queue filled with the steps of an action, and tells how it ended.
//!
//! ```text
//!   Before ── the robot is busy: waits until its queue has run out
//!     ▼
//!   Filling ── a place is free: STEP; none is: waits, asks for the state
//!     ▼ every step is queued
//!   Draining ── waits until the robot has counted every step as ended, and is idle
//!     ▼
//!   Resting ── waits until joints under way have arrived (unless told otherwise)
//!     ▼
//!   Done                 from any of them: Refused, Interrupted, Unknown
//! ```
//!
//! A compiled action is performed in sections between its waits for bumpers, each played as above:
//!
//! ```text
//!   section ── done ──► wait ── pressed ──► section ── ... ── the last section is done ──► Done
//!      │                 └─ in vain ──► goes on, ends, or plays another action instead
//!      └─ a bumper is met ──► ends, or plays another action instead
//! ```
//!
//! An action is done when the robot itself says so: its count of ended steps has grown by the
//! steps sent, it is idle, and it was neither stopped, held nor reset in between.

mod floor;
mod outcome;
mod perform;
mod run;
mod source;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use rsapien_protocol::Step;

pub use outcome::{Outcome, PlayReport, Progress, StepReached};

pub(crate) use floor::Floor;
pub(crate) use outcome::{ending_bumpers, interruption};
pub(crate) use perform::perform;
pub(crate) use run::{RunEnd, play, run};
pub(crate) use source::{POLL_AHEAD_MS, POLL_MS, Seen, Source, duration_ms, is_paused};

use crate::Error;

/// Ends an action from another thread: its player stops the motors first, then returns.
#[derive(Clone, Debug, Default)]
pub struct CancelToken {
    cancelled: Arc<AtomicBool>,
}

impl CancelToken {
    /// A token that is not cancelled.
    pub fn new() -> CancelToken {
        CancelToken::default()
    }

    /// Cancels what was started with this token or a clone of it. Safe in a signal handler.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::SeqCst);
    }

    /// Whether it was cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::SeqCst)
    }
}

/// Pauses an action from another thread: no further step is sent, so that the robot stands at the end
/// of a step, motors off; and lets it go on. With a switch in its options, a player queues one step
/// ahead only, so that a pause takes effect at the end of the step after the one under way at latest.
#[derive(Clone, Debug, Default)]
pub struct PauseSwitch {
    paused: Arc<AtomicBool>,
}

impl PauseSwitch {
    /// A switch that is not set.
    pub fn new() -> PauseSwitch {
        PauseSwitch::default()
    }

    /// Pauses what is played with this switch or a clone of it.
    pub fn pause(&self) {
        self.paused.store(true, Ordering::SeqCst);
    }

    /// Lets it go on.
    pub fn resume(&self) {
        self.paused.store(false, Ordering::SeqCst);
    }

    /// Whether it is set.
    pub fn is_paused(&self) -> bool {
        self.paused.load(Ordering::SeqCst)
    }
}

/// Is told how far an action is.
pub type ProgressSink<'a> = Box<dyn FnMut(&Progress) + Send + 'a>;

/// How an action is played.
pub struct PlayOptions<'a> {
    /// Ends it.
    pub cancel: CancelToken,
    /// Pauses it; none for a player that queues as much as the robot takes.
    pub pause: Option<PauseSwitch>,
    /// The label from which a compiled action is played; from its beginning where none is given.
    pub from_label: Option<String>,
    /// Is called when the action begins, and whenever the robot has ended a step.
    pub on_progress: Option<ProgressSink<'a>>,
    /// Whether to wait, when the last step has ended, until joints still under way have arrived.
    pub wait_for_rest: bool,
}

impl Default for PlayOptions<'_> {
    /// Not cancelled, silent, waiting for rest.
    fn default() -> Self {
        PlayOptions {
            cancel: CancelToken::new(),
            pause: None,
            from_label: None,
            on_progress: None,
            wait_for_rest: true,
        }
    }
}

/// Refuses what a player cannot play; nothing was sent then.
pub(crate) fn check(steps: &[Step]) -> Result<(), Error> {
    let out_of_range = |what, value: String, range| Err(Error::OutOfRange { what, value, range });
    if steps.is_empty() {
        return out_of_range("number of steps", "0".to_owned(), "an action has at least one");
    }
    if steps.iter().any(|step| step.duration_ms == 0) {
        return out_of_range("duration of a step", "0 ms".to_owned(), "1 to 65535 ms");
    }
    if steps.iter().skip(1).any(|step| step.replace) {
        return out_of_range(
            "replace flag",
            "set behind the first step".to_owned(),
            "only the first step may replace the queue, the others would cut the action short",
        );
    }
    Ok(())
}
