//! Why a recording cannot be written or read.

use std::path::PathBuf;

/// Why a recording cannot be written or read.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// A file is there already.
    #[error("{} is there already", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// The system refused to open, read or write the file.
    #[error("cannot {action} {}", path.display())]
    File {
        /// What was tried: `read`, `write`.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is something else.
    #[error("{} is no MCAP file", path.display())]
    NotMcap {
        /// The file.
        path: PathBuf,
    },
    /// The file is broken before its end.
    #[error("{} is damaged: {why}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
    /// An MCAP file of another program, or one that ended before anything was recorded.
    #[error("{} has no channel of a recording of rsapien", path.display())]
    NoChannels {
        /// The file.
        path: PathBuf,
    },
    /// A message that is not as its channel's schema says.
    #[error("a message of {topic} is not as it has to be: {why}")]
    Message {
        /// The channel's topic.
        topic: &'static str,
        /// What is wrong.
        why: String,
    },
}
