//! Who holds what: controllers within a program, lines between programs.
//!
//! A line has one reader, and whoever reads it keeps the robot's dead-man from tripping; so what
//! is locked between programs is the whole line, and with it every controller behind it. The lock
//! is the system's, on a file, so it goes when its holder dies, however that happens. Beside it
//! stands a file that tells who the holder is.

use std::fmt;
use std::fs::{self, File, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use crate::Error;

/// Who holds a controller or a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Holder {
    /// The process; 0 when unknown.
    pub pid: u32,
    /// What the program calls itself.
    pub program: String,
    /// Since when, in ms since 1970; 0 when unknown.
    pub since_unix_ms: u64,
}

impl Holder {
    /// This process, under the name `program`, from now on.
    pub fn this_process(program: &str) -> Holder {
        Holder {
            pid: std::process::id(),
            program: program.replace(['\n', '\r'], " "),
            since_unix_ms: unix_ms(),
        }
    }

    fn to_text(&self) -> String {
        format!("{}\n{}\n{}\n", self.pid, self.since_unix_ms, self.program)
    }

    fn from_text(text: &str) -> Option<Holder> {
        let mut lines = text.lines();
        let pid = lines.next()?.parse().ok()?;
        let since_unix_ms = lines.next()?.parse().ok()?;
        Some(Holder { pid, since_unix_ms, program: lines.next()?.to_owned() })
    }
}

/// `pid 4711 (rsapien play), since 12 s`.
impl fmt::Display for Holder {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.pid == 0 {
            return formatter.write_str("another program");
        }
        write!(formatter, "pid {} ({})", self.pid, self.program)?;
        let seconds = unix_ms().saturating_sub(self.since_unix_ms) / 1000;
        write!(formatter, ", since {seconds} s")
    }
}

fn unix_ms() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_millis()).unwrap_or(u64::MAX)
}

/// A line held against other programs, until it is dropped.
#[derive(Debug)]
pub struct LineLock {
    holder_path: PathBuf,
    // Closing it releases the lock.
    _file: File,
}

impl LineLock {
    /// Takes the line that `key` stands for, with lock files in `folder`, which is made if needed.
    ///
    /// # Errors
    /// [`Error::Held`] when another program, or this one, holds it; [`Error::Lock`] when the files
    /// cannot be written.
    pub fn take(folder: &Path, key: &str, holder: &Holder) -> Result<LineLock, Error> {
        let path = folder.join(format!("{}.lock", file_stem(key)));
        let failed = |source: io::Error| Error::Lock { path: path.display().to_string(), source };
        fs::create_dir_all(folder).map_err(failed)?;
        let file =
            File::options().create(true).truncate(false).write(true).open(&path).map_err(failed)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let by = wait_for_holder(folder, key);
                return Err(Error::Held { what: format!("the line {key}"), by });
            }
            Err(TryLockError::Error(source)) => return Err(failed(source)),
        }
        let holder_path = holder_path(folder, key);
        write_whole(&holder_path, &holder.to_text()).map_err(failed)?;
        Ok(LineLock { holder_path, _file: file })
    }

    /// Who holds the line that `key` stands for, if someone does. Takes nothing.
    pub fn holder(folder: &Path, key: &str) -> Option<Holder> {
        let file = File::options()
            .write(true)
            .open(folder.join(format!("{}.lock", file_stem(key))))
            .ok()?;
        match file.try_lock_shared() {
            Err(TryLockError::WouldBlock) => Some(wait_for_holder(folder, key)),
            Ok(()) | Err(TryLockError::Error(_)) => None,
        }
    }
}

impl Drop for LineLock {
    fn drop(&mut self) {
        // The file beside it goes first; the lock itself goes with the file handle.
        let _ = fs::remove_file(&self.holder_path);
    }
}

/// Reads who the holder is. It may have the lock, but not have written its name yet.
fn wait_for_holder(folder: &Path, key: &str) -> Holder {
    let path = holder_path(folder, key);
    for _ in 0..10 {
        let text = fs::read_to_string(&path).unwrap_or_default();
        if let Some(holder) = Holder::from_text(&text) {
            return holder;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    Holder { pid: 0, program: String::new(), since_unix_ms: 0 }
}

/// Writes a file so that a reader sees all of it or nothing.
fn write_whole(path: &Path, text: &str) -> io::Result<()> {
    let draft = path.with_extension("draft");
    File::create(&draft)?.write_all(text.as_bytes())?;
    fs::rename(&draft, path)
}

fn holder_path(folder: &Path, key: &str) -> PathBuf {
    folder.join(format!("{}.holder", file_stem(key)))
}

/// A file name for `key`: letters and digits as they are, others as their code, so that different
/// keys never share a file.
fn file_stem(key: &str) -> String {
    use fmt::Write as _;
    let mut stem = String::with_capacity(key.len());
    for byte in key.bytes() {
        if byte.is_ascii_alphanumeric() {
            stem.push(char::from(byte));
        } else {
            let _ = write!(stem, "_{byte:02x}");
        }
    }
    stem
}

#[cfg(test)]
mod tests;
