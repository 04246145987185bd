//! Keys pressed while an action is played, without Enter.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::stdio::stdin;
use rustix::termios::{
    LocalModes, OptionalActions, SpecialCodeIndex, Termios, tcgetattr, tcsetattr,
};

use super::signal;

/// How the terminal was before its keys were listened to.
static BEFORE: Mutex<Option<Termios>> = Mutex::new(None);
/// How often the listener looks whether it is to end, in ns.
const LOOK_NS: i64 = 50_000_000;

/// Listens to the keys of the terminal on the standard input until it is dropped; the terminal is as before then.
pub(crate) struct Keys {
    is_over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Keys {
    /// Hands each key to `on_key`, on a thread of its own. None where the standard input is no terminal, or is not
    /// this command's: in the background, a look at it would stop the command.
    pub(crate) fn listen(mut on_key: impl FnMut(u8) + Send + 'static) -> Option<Keys> {
        let terminal = stdin();
        let before = tcgetattr(terminal).ok()?;
        // A terminal that controls no session has no background.
        let in_front = rustix::termios::tcgetpgrp(terminal);
        if in_front.is_ok_and(|group| group != rustix::process::getpgrp()) {
            return None;
        }
        let mut raw = before.clone();
        // Ctrl-C stays a signal.
        raw.local_modes -= LocalModes::ICANON | LocalModes::ECHO;
        raw.special_codes[SpecialCodeIndex::VMIN] = 0;
        raw.special_codes[SpecialCodeIndex::VTIME] = 0;
        *BEFORE.lock().unwrap_or_else(PoisonError::into_inner) = Some(before);
        signal::before_exit(restore);
        if tcsetattr(terminal, OptionalActions::Now, &raw).is_err() {
            restore();
            return None;
        }
        let is_over = Arc::new(AtomicBool::new(false));
        let ends = Arc::clone(&is_over);
        let thread = std::thread::spawn(move || {
            while !ends.load(Ordering::SeqCst) {
                if let Some(key) = next_key() {
                    on_key(key);
                }
            }
        });
        Some(Keys { is_over, thread: Some(thread) })
    }
}

impl Drop for Keys {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::SeqCst);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
        restore();
    }
}

/// Makes the terminal as it was.
fn restore() {
    if let Some(before) = BEFORE.lock().unwrap_or_else(PoisonError::into_inner).take() {
        // A terminal that is gone needs no restoring.
        let _ = tcsetattr(stdin(), OptionalActions::Now, &before);
    }
}

/// The key that is pressed within a look's time.
fn next_key() -> Option<u8> {
    let terminal = stdin();
    let mut polled = [PollFd::new(&terminal, PollFlags::IN)];
    let time = Timespec { tv_sec: 0, tv_nsec: LOOK_NS };
    let mut key = [0];
    if !matches!(poll(&mut polled, Some(&time)), Ok(1..)) {
        return None;
    }
    if rustix::io::read(terminal, &mut key) == Ok(1) {
        return Some(key[0]);
    }
    // The terminal is gone, which a poll would tell at once again and again.
    std::thread::sleep(Duration::from_nanos(LOOK_NS.unsigned_abs()));
    None
}
