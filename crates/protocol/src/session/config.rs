//! How a session behaves.

use crate::frame::{self, ACTION_PACKAGE_LENGTH, SYNCHRONIZATION_PACKAGE_LENGTH};

/// How the PC's end of a line behaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SessionConfig {
    /// Line speed in bit/s; not 0.
    pub baud: u32,
    /// What is granted to an answer beyond the time both packages take on the line, in ms.
    pub margin_ms: u16,
    /// How often a package is sent before it is given up; not 0.
    pub tries: u8,
    /// The number proposed for the first session; 0 is taken as 1. Draw it at random, so that a
    /// restarted program does not meet its predecessor's session.
    pub first_session: u8,
}

impl Default for SessionConfig {
    /// 57600 baud, 40 ms, six tries, session 1.
    fn default() -> SessionConfig {
        SessionConfig { baud: 57_600, margin_ms: 40, tries: 6, first_session: 1 }
    }
}

impl SessionConfig {
    /// How long an answer may take before the package is sent again, in ms.
    pub fn answer_time_ms(&self) -> u64 {
        let line_bytes = ACTION_PACKAGE_LENGTH + SYNCHRONIZATION_PACKAGE_LENGTH;
        frame::line_time_ms(line_bytes, self.baud.max(1)) + u64::from(self.margin_ms)
    }
}
