//! One robot for several programs: who holds its line plays for others, too.
//!
//! A line has one reader, the program that holds it ([`LineLock`](crate::LineLock)). Beside the lock that
//! program keeps a [`Desk`]: a Unix socket, for this user only, at which other programs hand in their actions as
//! [`Guest`]s. Each is played on the holder's [`Stage`](crate::Stage) on the guest's own terms, and the guest is
//! told what becomes of it, how far it is and how it ended. A guest that goes, however that happens, takes its
//! action with it. A holder that goes leaves its robot to the dead-man.
//!
//! What goes over the socket is one JSON value a line. On systems without Unix sockets there is no desk, and a
//! line that is held is held.

#[cfg(unix)]
mod desk;
#[cfg(unix)]
mod guest;
#[cfg(not(unix))]
mod nowhere;
#[cfg(unix)]
mod wire;

#[cfg(unix)]
use std::path::{Path, PathBuf};

#[cfg(unix)]
pub use desk::Desk;
#[cfg(unix)]
pub use guest::Guest;
#[cfg(not(unix))]
pub use nowhere::{Desk, Guest};

#[cfg(unix)]
/// The longest path of a socket that every system takes: macOS has 104 bytes for it and its end.
const PATH_LENGTH_MAX: usize = 103;

#[cfg(unix)]
/// Where the desk of the line stands that `key` stands for; none where the folder's name is too long for a socket.
fn socket_path(lock_folder: &Path, key: &str) -> Option<PathBuf> {
    // The key itself is often too long: FNV-1a, 64 bits.
    let hash = key.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    let path = lock_folder.join(format!("{:08x}.desk", hash & 0xffff_ffff));
    (path.as_os_str().len() <= PATH_LENGTH_MAX).then_some(path)
}
