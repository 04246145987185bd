//! The line as a pseudo-terminal.
//!
//! The simulator keeps the client's side open itself. So the terminal stays raw and never hangs up when a client
//! closes it, and the next one finds it as the first one did.

use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Read};
use std::os::unix::ffi::OsStringExt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use rustix::fs::{OFlags, fcntl_getfl, fcntl_setfl};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, ioctl_tiocnxcl, tcgetattr, tcsetattr};

use super::hub::Hub;
use super::{SimulatorError, check_folder, put_on_line, wait_readable};
use crate::shared::SharedRobot;

/// An open pseudo-terminal with its link.
pub(super) struct Terminal {
    master: File,
    slave: File,
    path: PathBuf,
    /// Removed with the terminal.
    _link: Link,
}

/// A symbolic link that is removed with its owner.
struct Link {
    link: PathBuf,
    target: PathBuf,
}

impl Terminal {
    /// Opens a pseudo-terminal in raw mode and makes `link` point to it.
    pub(super) fn open(link: PathBuf) -> Result<Self, SimulatorError> {
        let failed = |source: io::Error| SimulatorError::Terminal { source };
        let (master, path) = open_master().map_err(failed)?;
        let slave = OpenOptions::new().read(true).write(true).open(&path).map_err(failed)?;
        make_raw(&slave).map_err(|error| failed(error.into()))?;
        let link = Link::make(link, path.clone())?;
        Ok(Self { master, slave, path, _link: link })
    }

    /// The terminal's own path.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Carries bytes between the terminal and the robot until `stop` is set.
    pub(super) fn serve(
        self,
        robot: SharedRobot,
        hub: &Hub,
        stop: Arc<AtomicBool>,
    ) -> Result<JoinHandle<()>, SimulatorError> {
        let writer =
            self.master.try_clone().map_err(|source| SimulatorError::Terminal { source })?;
        hub.add(Box::new(writer));
        Ok(thread::spawn(move || self.read_until(&robot, &stop)))
    }

    fn read_until(mut self, robot: &SharedRobot, stop: &AtomicBool) {
        let mut bytes = [0; 1024];
        while !stop.load(Ordering::Relaxed) {
            match wait_readable(&self.master) {
                Ok(true) => match self.master.read(&mut bytes) {
                    Ok(count) => put_on_line(robot, bytes.get(..count).unwrap_or_default(), stop),
                    Err(error) if is_passing(&error) => {}
                    // Nobody has the other side open, which our own handle prevents where it can.
                    Err(_) => thread::sleep(Duration::from_millis(50)),
                },
                // A client that was killed leaves its claim to be the only one behind; silence lifts it.
                Ok(false) => drop(ioctl_tiocnxcl(&self.slave)),
                Err(_) => thread::sleep(Duration::from_millis(50)),
            }
        }
    }
}

fn is_passing(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted)
}

fn open_master() -> io::Result<(File, PathBuf)> {
    let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
    grantpt(&master)?;
    unlockpt(&master)?;
    let name = ptsname(&master, Vec::new())?;
    fcntl_setfl(&master, fcntl_getfl(&master)? | OFlags::NONBLOCK)?;
    let path = PathBuf::from(std::ffi::OsString::from_vec(name.into_bytes()));
    Ok((File::from(master), path))
}

fn make_raw(slave: &File) -> rustix::io::Result<()> {
    let mut settings = tcgetattr(slave)?;
    settings.make_raw();
    tcsetattr(slave, OptionalActions::Now, &settings)
}

/// Whether a link may be made at `link`: nothing is there, or a link left behind by a simulator.
pub(super) fn check_place(link: &Path) -> Result<(), SimulatorError> {
    check_folder(link)?;
    let Ok(found) = fs::symlink_metadata(link) else { return Ok(()) };
    let points_to = fs::read_link(link).unwrap_or_default();
    if found.is_symlink() && (points_to.starts_with("/dev/pts") || !link.exists()) {
        return Ok(());
    }
    Err(SimulatorError::Taken { path: link.to_owned(), expected: "a link to a pseudo-terminal" })
}

impl Link {
    /// Makes `link` point to `target`. A link left behind by a simulator (it points to a pseudo-terminal or to
    /// nothing) is replaced; anything else is left alone.
    fn make(link: PathBuf, target: PathBuf) -> Result<Self, SimulatorError> {
        check_place(&link)?;
        // Made aside and moved into place, so that nobody ever finds it missing.
        let mut aside = link.clone().into_os_string();
        aside.push(format!(".{}", std::process::id()));
        let aside = PathBuf::from(aside);
        let made = std::os::unix::fs::symlink(&target, &aside)
            .and_then(|()| fs::rename(&aside, &link))
            .inspect_err(|_| drop(fs::remove_file(&aside)));
        match made {
            Ok(()) => Ok(Self { link, target }),
            Err(source) => Err(SimulatorError::Path { path: link, source }),
        }
    }

    /// Removes the link, if it is still ours.
    fn remove(&self) {
        if fs::read_link(&self.link).is_ok_and(|target| target == self.target) {
            // Gone already is as good.
            let _ = fs::remove_file(&self.link);
        }
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        self.remove();
    }
}
