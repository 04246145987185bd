//! Waiting for a file descriptor, in turns short enough to notice a stop.

use std::os::fd::AsFd;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;

/// How long a thread waits before it looks at the stop flag again, in ms.
const TURN_MS: i64 = 100;

/// Whether something can be read or accepted now; waits a turn for it.
///
/// # Errors
/// What the system says, but for interruptions.
pub(crate) fn wait_readable(descriptor: &impl AsFd) -> std::io::Result<bool> {
    let mut polled = [PollFd::new(descriptor, PollFlags::IN)];
    let turn = Timespec { tv_sec: 0, tv_nsec: TURN_MS * 1_000_000 };
    match poll(&mut polled, Some(&turn)) {
        Ok(ready) => Ok(ready > 0),
        Err(Errno::INTR) => Ok(false),
        Err(error) => Err(error.into()),
    }
}
