//! Links: where the line's bytes go and come from.
//!
//! A link moves bytes and tells the time; packages, resends and sessions are the line's. Links of
//! this crate: serial ports, TCP, and the virtual robot in process. A program may bring its own by
//! implementing [`Link`] and [`Connect`].

#[cfg(all(feature = "serial", unix))]
pub(crate) mod beside;
#[cfg(feature = "serial")]
pub mod serial;
pub mod tcp;
#[cfg(feature = "virtual")]
pub mod virtual_robot;

use std::time::{Duration, Instant};

use crate::Error;

/// One open connection to a line.
pub trait Link: Send {
    /// The time in ms, from an origin of the link's own. It never runs backwards.
    fn now_ms(&self) -> u64;

    /// Puts bytes on the line, all of them.
    ///
    /// # Errors
    /// [`Error::LinkLost`] when the line is gone; the link is dropped and made anew then.
    fn send(&mut self, bytes: &[u8]) -> Result<(), Error>;

    /// Waits for bytes until `until_ms` and puts what has come, at most a bufferful, into `buffer`.
    /// Returns how many; 0 when the time has come first.
    ///
    /// # Errors
    /// [`Error::LinkLost`] as [`send`](Link::send).
    fn receive(&mut self, buffer: &mut [u8], until_ms: u64) -> Result<usize, Error>;

    /// Lets time pass until `until_ms` without looking at the line.
    fn wait_until(&mut self, until_ms: u64) {
        let left_ms = until_ms.saturating_sub(self.now_ms());
        std::thread::sleep(Duration::from_millis(left_ms));
    }

    /// Throws away what has come but was not received.
    ///
    /// # Errors
    /// [`Error::LinkLost`] as [`send`](Link::send).
    fn flush_input(&mut self) -> Result<(), Error>;

    /// Whether time is virtual and passes only inside [`receive`](Link::receive) and
    /// [`wait_until`](Link::wait_until), as fast as they are called.
    fn is_paced_by_caller(&self) -> bool {
        false
    }
}

/// Opens a link, and opens it again when it was lost.
pub trait Connect: Send {
    /// The link's name, as its address is written.
    fn name(&self) -> String;

    /// What stands for the line in the locks between programs; none when no other program can
    /// reach it.
    fn lock_key(&self) -> Option<String> {
        None
    }

    /// Opens the link. Its clock goes on from the one before: it tells ms since `origin`, unless
    /// it is virtual.
    ///
    /// # Errors
    /// [`Error::LinkNotFound`], [`Error::PermissionDenied`] or [`Error::LinkOpen`].
    fn connect(&mut self, clock: RealClock) -> Result<Box<dyn Link>, Error>;
}

/// The time in ms since a program opened its line.
#[derive(Clone, Copy, Debug)]
pub struct RealClock {
    origin: Instant,
}

impl RealClock {
    /// A clock that stands at 0 now.
    pub fn start() -> RealClock {
        RealClock { origin: Instant::now() }
    }

    /// Milliseconds since the start.
    pub fn now_ms(self) -> u64 {
        u64::try_from(self.origin.elapsed().as_millis()).unwrap_or(u64::MAX)
    }

    /// What is left until `until_ms`, at least 1 ms: a time-out of zero means "for ever" to some
    /// systems.
    pub(crate) fn left(self, until_ms: u64) -> Duration {
        Duration::from_millis(until_ms.saturating_sub(self.now_ms()).max(1))
    }
}
