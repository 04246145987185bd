//! Where the robot's answers go: to everybody on the line.

use std::io::{ErrorKind, Write};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// An end of the line that listens. Its writes return at once or nearly so.
struct Sink {
    id: u64,
    writer: Box<dyn Write + Send>,
}

/// Everybody who listens.
#[derive(Default)]
pub(super) struct Hub {
    sinks: Mutex<(u64, Vec<Sink>)>,
}

impl Hub {
    /// Adds a listener and returns its number.
    pub(super) fn add(&self, writer: Box<dyn Write + Send>) -> u64 {
        let mut sinks = self.lock();
        sinks.0 += 1;
        let id = sinks.0;
        sinks.1.push(Sink { id, writer });
        id
    }

    /// Removes a listener.
    pub(super) fn remove(&self, id: u64) {
        self.lock().1.retain(|sink| sink.id != id);
    }

    /// Gives bytes to everybody. Who cannot take them now loses them; who is gone is forgotten.
    pub(super) fn broadcast(&self, bytes: &[u8]) {
        self.lock().1.retain_mut(|sink| match sink.writer.write(bytes) {
            Ok(_) => true,
            Err(error) => matches!(
                error.kind(),
                ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
            ),
        });
    }

    /// How many listen.
    pub(super) fn count(&self) -> usize {
        self.lock().1.len()
    }

    fn lock(&self) -> MutexGuard<'_, (u64, Vec<Sink>)> {
        self.sinks.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
