//! Recordings: everything that went over the line, the robot's state, what was played, pictures and
//! ellipses, in one MCAP file.
//!
//! A [`Recorder`] writes one, a [`RecordingReader`] reads it from its begin to its end without holding it in
//! memory, a [`LineDecoder`] makes packages and damage of the recorded bytes, and [`replay::replay`] sends
//! the recorded requests again and compares the answers. `docs/recording.md` has the table of channels.
//!
//! Times are those of the line's clock in ms; in the file they stand behind the moment at which the
//! recording began, so that tools show the time of day.

mod compare;
mod decode;
mod error;
mod exchange;
mod json;
mod read;
pub mod replay;
mod schema;
#[cfg(test)]
mod tests;
mod write;

pub use compare::{Difference, Field};
pub use decode::{LineDecoder, LineEntry, LineMark, What};
pub use error::RecordingError;
#[cfg(feature = "cli")]
pub(crate) use json::{direction_name, hex, package_head};
pub use read::{BytesMessage, Entry, Frame, RecordingReader};
pub use schema::Topic;
pub use write::{About, Recorder, RecordingSummary};
