//! A serial port that another program holds, for sending only.
//!
//! Who reads a port that another program reads, too, takes its answers away; who opens it as a port
//! of one's own sets its speed anew. This does neither: the device is opened for writing, and stays
//! as its holder has set it.

use std::fs::File;
use std::io::Write;
use std::path::Path;

use rustix::fs::{Mode, OFlags};

use crate::Error;
use crate::link::{Link, RealClock};

/// A port that is written beside its holder. It receives nothing.
pub(crate) struct BesideLink {
    name: String,
    file: File,
    clock: RealClock,
}

impl BesideLink {
    /// Opens the port at `path` for writing.
    ///
    /// # Errors
    /// As [`Connect::connect`](crate::link::Connect::connect).
    pub(crate) fn open(path: &str, clock: RealClock) -> Result<BesideLink, Error> {
        // It never becomes this program's terminal, and a port that takes nothing is no reason to wait.
        let flags = OFlags::WRONLY | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
        match rustix::fs::open(Path::new(path), flags, Mode::empty()) {
            Ok(file) => Ok(BesideLink { name: path.to_owned(), file: file.into(), clock }),
            Err(error) => Err(super::serial::opening(path, error.into())),
        }
    }
}

impl Link for BesideLink {
    fn now_ms(&self) -> u64 {
        self.clock.now_ms()
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Error> {
        let lost = |error: std::io::Error| Error::LinkLost {
            link: self.name.clone(),
            why: error.to_string(),
        };
        self.file.write_all(bytes).map_err(lost)
    }

    fn receive(&mut self, _buffer: &mut [u8], until_ms: u64) -> Result<usize, Error> {
        self.wait_until(until_ms);
        Ok(0)
    }

    fn flush_input(&mut self) -> Result<(), Error> {
        Ok(())
    }
}
