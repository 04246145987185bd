//! Why a simulator did not start.

use std::io;
use std::path::PathBuf;

use crate::pace::FACTOR;
use crate::robot::ConfigError;

/// Why a simulator did not start.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimulatorError {
    /// The robot cannot be made so.
    #[error(transparent)]
    Robot(#[from] ConfigError),
    /// No end was asked for.
    #[error(
        "nobody could reach this robot: name a pseudo-terminal, a TCP address or a control socket"
    )]
    NoEndpoint,
    /// A pace out of range.
    #[error("virtual time at {factor} times the wall clock is not offered, allowed are {} to {}", FACTOR.start(), FACTOR.end())]
    Factor {
        /// What was asked for.
        factor: f64,
    },
    /// The system gave no pseudo-terminal.
    #[error("no pseudo-terminal could be opened: {source}")]
    Terminal {
        /// What the system said.
        source: io::Error,
    },
    /// The path of a link or socket is something else.
    #[error("{} exists and is not {expected}: remove it or choose another path", path.display())]
    Taken {
        /// The path.
        path: PathBuf,
        /// What would have been replaced.
        expected: &'static str,
    },
    /// Another simulator answers there.
    #[error("another simulator is running at {}: stop it or choose another path", path.display())]
    InUse {
        /// Its control socket.
        path: PathBuf,
    },
    /// A link or socket could not be made.
    #[error("{} could not be made: {source}", path.display())]
    Path {
        /// The path.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The text is no address.
    #[error("{address:?} is no address: write HOST:PORT, :PORT or PORT, such as 127.0.0.1:7000")]
    Address {
        /// The text.
        address: String,
    },
    /// Other machines would reach it.
    #[error(
        "{address} can be reached from other machines, where anybody could move the robot: use 127.0.0.1, or allow it explicitly"
    )]
    NotLoopback {
        /// The address.
        address: String,
    },
    /// The address cannot be listened on.
    #[error("nobody can listen on {address}: {source}")]
    Bind {
        /// The address.
        address: String,
        /// What the system said.
        source: io::Error,
    },
}
