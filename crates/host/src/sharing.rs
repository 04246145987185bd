//! One robot for several programs: who holds its line plays for others, too.
//!
//! A line has one reader, the program that holds it ([`LineLock`](crate::LineLock)). Beside the lock that
//! program keeps a [`Desk`]: a Unix socket, for this user only, at which other programs hand in their actions as
//! [`Guest`]s. Each is played on the holder's [`Stage`](crate::Stage) on the guest's own terms, and the guest is
//! told what becomes of it, how far it is and how it ended. A guest that goes, however that happens, takes its
//! action with it. A holder that goes leaves its robot to the dead-man.
//!
//! What goes over the socket is one JSON value a line ([`wire`]).

mod desk;
mod guest;
mod wire;

use std::path::{Path, PathBuf};

pub use desk::Desk;
pub use guest::Guest;

/// The longest path of a socket that every system takes.
const PATH_LENGTH_MAX: usize = 100;

/// Where the desk of the line stands that `key` stands for; none where the folder's name is too long for a socket.
fn socket_path(lock_folder: &Path, key: &str) -> Option<PathBuf> {
    // The key itself is often too long: FNV-1a, 64 bits.
    let hash = key.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    let path = lock_folder.join(format!("{hash:016x}.desk"));
    (path.as_os_str().len() <= PATH_LENGTH_MAX).then_some(path)
}
