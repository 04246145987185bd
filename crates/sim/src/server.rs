//! A virtual robot for other programs: a pseudo-terminal, TCP, and the control channel.
//!
//! ```no_run
//! use rsapien_sim::server::{Simulator, SimulatorConfig};
//!
//! let config = SimulatorConfig { pty: Some("/tmp/robot".into()), ..SimulatorConfig::default() };
//! let simulator = Simulator::start(config)?;
//! assert!(simulator.control_path().is_some_and(|path| path.ends_with("robot.control")));
//! simulator.stop();
//! # Ok::<(), rsapien_sim::server::SimulatorError>(())
//! ```
//!
//! Every endpoint is an end of the one line: what any client sends is merged, and what the robot answers is heard by
//! all. A client that does not read loses bytes, as on any line without flow control.

mod address;
mod error;
mod hub;
mod pty;
mod readiness;
mod tcp;
#[cfg(test)]
mod tests;

pub use address::socket_address;
pub use error::SimulatorError;

use std::io;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use crate::control;
use crate::pace::{self, Clock, FACTOR};
use crate::robot::{VirtualRobot, VirtualRobotConfig};
use crate::shared::SharedRobot;
use hub::Hub;
use pty::Terminal;
pub(crate) use readiness::wait_readable;

/// Which ends a simulator offers, and how its time passes.
#[derive(Debug, Clone, Default)]
pub struct SimulatorConfig {
    /// The robot.
    pub robot: VirtualRobotConfig,
    /// Becomes a symbolic link to a pseudo-terminal that speaks as the robot's serial port does.
    pub pty: Option<PathBuf>,
    /// Where TCP clients find the line: `HOST:PORT`, `:PORT` or `PORT` (both on 127.0.0.1); port 0 takes a free one.
    pub tcp: Option<String>,
    /// Where the control channel's Unix socket stands. Without it, `pty` with `.control` behind it.
    pub control: Option<PathBuf>,
    /// Where the control channel is found by TCP, written as for `tcp`.
    pub control_tcp: Option<String>,
    /// Whether addresses that other machines reach are allowed. Nobody is asked for a password there.
    pub allow_remote: bool,
    /// What moves the virtual clock.
    pub clock: Clock,
}

/// A running simulator. Dropping it stops it.
#[derive(Debug)]
pub struct Simulator {
    robot: SharedRobot,
    stop: Arc<AtomicBool>,
    lost_ms: Arc<AtomicU64>,
    threads: Vec<JoinHandle<()>>,
    link: Option<PathBuf>,
    terminal: Option<PathBuf>,
    tcp: Option<SocketAddr>,
    control: Option<PathBuf>,
    control_tcp: Option<SocketAddr>,
}

impl Simulator {
    /// Makes the robot, opens every endpoint asked for, and lets time run.
    ///
    /// # Errors
    /// [`SimulatorError`] says which endpoint could not be opened and why; nothing is left running then.
    pub fn start(config: SimulatorConfig) -> Result<Self, SimulatorError> {
        if let Clock::Paced { factor } = config.clock
            && !FACTOR.contains(&factor)
        {
            return Err(SimulatorError::Factor { factor });
        }
        if config.pty.is_none()
            && config.tcp.is_none()
            && config.control.is_none()
            && config.control_tcp.is_none()
        {
            return Err(SimulatorError::NoEndpoint);
        }
        let control_path = config.control.clone().or_else(|| {
            config.pty.as_deref().map(|link| {
                let mut path = link.as_os_str().to_owned();
                path.push(".control");
                PathBuf::from(path)
            })
        });
        let mut simulator = Self {
            robot: SharedRobot::new(VirtualRobot::new(config.robot)?),
            stop: Arc::default(),
            lost_ms: Arc::default(),
            threads: Vec::new(),
            link: config.pty.clone(),
            terminal: None,
            tcp: None,
            control: control_path.clone(),
            control_tcp: None,
        };
        let hub = Arc::new(Hub::default());
        if let Some(link) = &config.pty {
            pty::check_place(link)?;
        }
        // The control socket comes first: where it answers, another simulator has the link.
        if let Some(path) = control_path {
            let thread =
                control::serve_unix(path, simulator.robot.clone(), Arc::clone(&simulator.stop))?;
            simulator.threads.push(thread);
        }
        if let Some(link) = config.pty {
            let terminal = Terminal::open(link)?;
            simulator.terminal = Some(terminal.path().to_owned());
            simulator.threads.push(terminal.serve(
                simulator.robot.clone(),
                &hub,
                Arc::clone(&simulator.stop),
            )?);
        }
        if let Some(address) = config.tcp {
            let listener = tcp::bind(&address, config.allow_remote)?;
            simulator.tcp = Some(listener.address);
            simulator.threads.push(listener.serve(
                simulator.robot.clone(),
                Arc::clone(&hub),
                Arc::clone(&simulator.stop),
            ));
        }
        if let Some(address) = config.control_tcp {
            let listener = tcp::bind(&address, config.allow_remote)?;
            simulator.control_tcp = Some(listener.address);
            simulator.threads.push(control::serve_tcp(
                listener.listener,
                simulator.robot.clone(),
                Arc::clone(&simulator.stop),
            ));
        }
        simulator.threads.push(pace::run(
            simulator.robot.clone(),
            config.clock,
            Arc::clone(&simulator.stop),
            Arc::clone(&simulator.lost_ms),
            move |bytes| hub.broadcast(bytes),
        ));
        Ok(simulator)
    }

    /// The robot itself.
    pub fn robot(&self) -> &SharedRobot {
        &self.robot
    }

    /// Virtual ms that a paced clock had to let go so far, because the simulation is slower than it: the robot lives
    /// more slowly then, and works.
    pub fn lost_ms(&self) -> u64 {
        self.lost_ms.load(Ordering::Relaxed)
    }

    /// The symbolic link to the pseudo-terminal.
    pub fn link(&self) -> Option<&Path> {
        self.link.as_deref()
    }

    /// The pseudo-terminal that the link points to.
    pub fn terminal(&self) -> Option<&Path> {
        self.terminal.as_deref()
    }

    /// Where TCP clients find the line.
    pub fn tcp_address(&self) -> Option<SocketAddr> {
        self.tcp
    }

    /// Where the control channel's Unix socket stands.
    pub fn control_path(&self) -> Option<&Path> {
        self.control.as_deref()
    }

    /// Where TCP clients find the control channel.
    pub fn control_tcp_address(&self) -> Option<SocketAddr> {
        self.control_tcp
    }

    /// The flag that stops the simulator when it is set, for a signal handler. [`stop`](Simulator::stop) then waits
    /// for its end.
    pub fn stop_flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.stop)
    }

    /// Stops time, closes every endpoint and removes link and socket; takes a fifth of a second at most, unless a
    /// client of the control channel waits for a picture.
    pub fn stop(mut self) {
        self.end();
    }

    fn end(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            // A thread that panicked has nothing left to clean up.
            let _ = thread.join();
        }
    }
}

/// Whether the folder is there in which a link or a socket is to be made at `path`.
pub(crate) fn check_folder(path: &Path) -> Result<(), SimulatorError> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    if folder.is_none_or(Path::is_dir) {
        return Ok(());
    }
    let source = io::Error::new(io::ErrorKind::NotFound, "there is no such folder");
    Err(SimulatorError::Path { path: path.to_owned(), source })
}

/// Bytes of clients that may wait for their turn on the line; readers hold back until there is room.
const WAITING_MAX: usize = 4096;

/// Puts a client's bytes on the line, as soon as there is room for them. Bytes are lost when `stop` is set meanwhile.
fn put_on_line(robot: &SharedRobot, bytes: &[u8], stop: &AtomicBool) {
    while !stop.load(Ordering::Relaxed) {
        let mut robot = robot.lock();
        if robot.unsent() < WAITING_MAX {
            robot.send(bytes);
            return;
        }
        drop(robot);
        thread::sleep(Duration::from_millis(1));
    }
}

impl Drop for Simulator {
    fn drop(&mut self) {
        self.end();
    }
}
