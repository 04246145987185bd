//! Ctrl-C and SIGTERM: STOP to the motors first, then the end. A second one ends at once.
//!
//! Only commands that move the robot or run until they are told to end install this; the others keep the system's
//! way, so that one Ctrl-C ends a command that waits for its input.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use super::diagnostics::{Failure, Result};
use super::exit::Status;

/// What stops the motors, and tells whether the robot said so.
type Stop = Box<dyn FnOnce() -> bool + Send>;

/// What the signals' handler and the command share: a process has one of each.
static SHARED: Shared = Shared {
    raised: AtomicBool::new(false),
    stopping: AtomicBool::new(false),
    unanswered: AtomicBool::new(false),
    stop: Mutex::new(None),
};
static INSTALLED: OnceLock<std::result::Result<(), String>> = OnceLock::new();

/// What makes the terminal as it was, before a second Ctrl-C ends the process.
static BEFORE_EXIT: Mutex<Vec<fn()>> = Mutex::new(Vec::new());

/// Has `restore` called before a second Ctrl-C ends the process. It does nothing where there is nothing to restore.
pub(crate) fn before_exit(restore: fn()) {
    BEFORE_EXIT.lock().unwrap_or_else(PoisonError::into_inner).push(restore);
}

/// How often a wait looks whether it is over.
const LOOK_MS: u64 = 20;

struct Shared {
    /// Whether the user wants the command to end.
    raised: AtomicBool,
    /// Whether the motors are being stopped right now.
    stopping: AtomicBool,
    /// Whether the robot did not answer when it was to stop.
    unanswered: AtomicBool,
    stop: Mutex<Option<Stop>>,
}

impl Shared {
    fn stop(&self) -> MutexGuard<'_, Option<Stop>> {
        self.stop.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The right to ask whether the user wants the command to end.
#[derive(Clone, Copy)]
pub(crate) struct Interrupt(&'static Shared);

impl Interrupt {
    /// Takes Ctrl-C and SIGTERM over.
    pub(crate) fn install() -> Result<Self> {
        let installed = INSTALLED
            .get_or_init(|| ctrlc::set_handler(on_signal).map_err(|error| error.to_string()));
        match installed {
            Ok(()) => {
                SHARED.raised.store(false, Ordering::SeqCst);
                Ok(Self(&SHARED))
            }
            Err(reason) => Err(Failure::new(format!("cannot watch for Ctrl-C: {reason}"))),
        }
    }

    /// What is done first when the user wants the command to end; it runs once, on a thread of its own, and tells whether
    /// the robot answered.
    pub(crate) fn stop_first(self, stop: impl FnOnce() -> bool + Send + 'static) {
        *self.0.stop() = Some(Box::new(stop));
    }

    /// Takes back what [`stop_first`](Self::stop_first) was given.
    pub(crate) fn stop_nothing(self) {
        *self.0.stop() = None;
    }

    /// Whether the user wants the command to end.
    pub(crate) fn is_raised(self) -> bool {
        self.0.raised.load(Ordering::SeqCst)
    }

    /// Refuses to go on when the user wants the command to end.
    pub(crate) fn check(self) -> Result<()> {
        if self.is_raised() { Err(Failure::interrupted()) } else { Ok(()) }
    }

    /// Waits; sooner back with an error when the user wants the command to end.
    pub(crate) fn wait(self, duration: Duration) -> Result<()> {
        let end = Instant::now() + duration;
        loop {
            self.check()?;
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Ok(());
            }
            thread::sleep(left.min(Duration::from_millis(LOOK_MS)));
        }
    }
}

/// Runs on a thread of its own, never in a signal's context.
fn on_signal() {
    if SHARED.raised.swap(true, Ordering::SeqCst) {
        for restore in BEFORE_EXIT.lock().unwrap_or_else(PoisonError::into_inner).iter() {
            restore();
        }
        std::process::exit(i32::from(Status::Interrupted.code()));
    }
    if let Some(stop) = SHARED.stop().take() {
        SHARED.stopping.store(true, Ordering::SeqCst);
        // Apart, so that a second Ctrl-C is heard while a dead line keeps this one waiting.
        thread::spawn(|| {
            SHARED.unanswered.store(!stop(), Ordering::SeqCst);
            SHARED.stopping.store(false, Ordering::SeqCst);
        });
    }
}

/// Waits until the motors are stopped, when they are being stopped: the last thing before the process ends. A dead line
/// is given up after its tries; then this tells that the robot did not answer.
pub(crate) fn finish() -> Result<()> {
    while SHARED.stopping.load(Ordering::SeqCst) {
        thread::sleep(Duration::from_millis(LOOK_MS));
    }
    if SHARED.unanswered.swap(false, Ordering::SeqCst) {
        return Err(Failure::new("interrupted; the robot did not answer STOP")
            .status(Status::Interrupted)
            .hint("look at it: its dead-man stops a robot that hears nothing, after half a second unless told otherwise"));
    }
    Ok(())
}
