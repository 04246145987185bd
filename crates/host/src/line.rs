//! The line: one thread owns the link and the session, everyone else asks it.
//!
//! With a real link the thread runs by itself: it asks each controller for its state when nothing
//! else was sent to it for a while, which is also what keeps the dead-man from tripping. With a
//! virtual clock it runs only while someone waits for it, so that a program with one thread does
//! the same thing, package for package, every time.

mod runner;

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{self, Receiver, Sender, SyncSender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use rsapien_protocol::{Address, Kind, Request, Status, SynchronizationPackage};

use crate::link::{Connect, RealClock};
use crate::record::{LineSink, PackageLog, PackageRecord, PackageSink};
use crate::{Error, RobotState};

/// How the line is driven.
pub(crate) struct LineOptions {
    pub(crate) baud: u32,
    pub(crate) state_period_ms: u64,
    pub(crate) first_session: u8,
    pub(crate) package_log_length: usize,
    pub(crate) on_package: Option<PackageSink>,
    pub(crate) on_line: Option<LineSink>,
}

/// The answer to a request, whatever its status.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Answer {
    pub(crate) address: Address,
    pub(crate) kind: Kind,
    pub(crate) package: SynchronizationPackage,
}

impl Answer {
    /// The package, if the controller accepted what was asked.
    pub(crate) fn accepted(self) -> Result<SynchronizationPackage, Error> {
        match self.package.status {
            Status::Accepted => Ok(self.package),
            status => Err(Error::Refused { address: self.address, kind: self.kind, status }),
        }
    }
}

pub(crate) type Reply = Sender<Result<Answer, Error>>;

/// What the line's thread is asked.
pub(crate) enum Command {
    /// Opens a session.
    Open { address: Address, reply: Reply },
    /// Sends a request, unless STOP was asked for since `stop_generation`.
    Request { address: Address, request: Request, stop_generation: u64, reply: Reply },
    /// Sends STOP before everything else.
    Stop { address: Address, reply: Reply },
    /// Replies when the time has come, or the state is newer than `newer_than`.
    Wait { until_ms: u64, newer_than: Option<u64>, reply: Sender<()> },
    /// Sends each new state there, until it is closed.
    Subscribe { to: SyncSender<RobotState> },
    /// Ends the thread.
    Close,
}

/// What the thread and its users share.
pub(crate) struct Shared {
    state: Mutex<RobotState>,
    log: Mutex<PackageLog>,
    /// Counts the STOPs asked for. A request that was asked for before a STOP is not sent after it.
    stop_generation: AtomicU64,
    /// The virtual clock, as far as the thread has come.
    virtual_now_ms: AtomicU64,
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, RobotState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn log(&self) -> MutexGuard<'_, PackageLog> {
        self.log.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A line with its thread. Dropping it ends the thread.
pub(crate) struct Line {
    name: String,
    commands: Sender<Command>,
    shared: Arc<Shared>,
    /// None: the clock is virtual.
    clock: Option<RealClock>,
    thread: Option<JoinHandle<()>>,
}

impl Line {
    /// Opens the link and starts the thread.
    pub(crate) fn start(
        mut connector: Box<dyn Connect>,
        options: LineOptions,
    ) -> Result<Line, Error> {
        let name = connector.name();
        let clock = RealClock::start();
        let mut link = connector.connect(clock)?;
        link.flush_input()?;
        let is_paced_by_caller = link.is_paced_by_caller();
        let shared = Arc::new(Shared {
            state: Mutex::default(),
            log: Mutex::new(PackageLog::new(options.package_log_length)),
            stop_generation: AtomicU64::new(0),
            virtual_now_ms: AtomicU64::new(link.now_ms()),
        });
        let (commands, receiver) = mpsc::channel();
        let runner =
            runner::Runner::new(connector, link, clock, options, Arc::clone(&shared), receiver);
        let thread = std::thread::Builder::new()
            .name("rsapien-line".to_owned())
            .spawn(move || runner.run())
            .map_err(|source| Error::LinkOpen { link: name.clone(), source })?;
        let clock = (!is_paced_by_caller).then_some(clock);
        Ok(Line { name, commands, shared, clock, thread: Some(thread) })
    }

    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    pub(crate) fn now_ms(&self) -> u64 {
        match self.clock {
            Some(clock) => clock.now_ms(),
            None => self.shared.virtual_now_ms.load(Ordering::SeqCst),
        }
    }

    /// Whether time passes only while somebody waits on the line.
    pub(crate) fn has_virtual_clock(&self) -> bool {
        self.clock.is_none()
    }

    pub(crate) fn state(&self) -> RobotState {
        self.shared.state().clone()
    }

    pub(crate) fn packages(&self) -> Vec<PackageRecord> {
        self.shared.log().records()
    }

    pub(crate) fn stop_generation(&self) -> u64 {
        self.shared.stop_generation.load(Ordering::SeqCst)
    }

    pub(crate) fn open(&self, address: Address) -> Result<Answer, Error> {
        self.ask(|reply| Command::Open { address, reply })
    }

    /// Sends a request and waits for its answer. STOP before it is sent makes it fail.
    pub(crate) fn request(&self, address: Address, request: Request) -> Result<Answer, Error> {
        self.request_before_stop(address, request, self.stop_generation())
    }

    /// As [`request`](Line::request), but for any STOP since `stop_generation`.
    pub(crate) fn request_before_stop(
        &self,
        address: Address,
        request: Request,
        stop_generation: u64,
    ) -> Result<Answer, Error> {
        self.ask(|reply| Command::Request { address, request, stop_generation, reply })
    }

    /// Stops both controllers; the motion controller first, whose error is the one that counts.
    pub(crate) fn stop(&self) -> Result<(), Error> {
        self.shared.stop_generation.fetch_add(1, Ordering::SeqCst);
        let (motion_reply, motion_answer) = mpsc::channel();
        let (camera_reply, camera_answer) = mpsc::channel();
        let knows_camera = {
            let state = self.shared.state();
            state.camera.is_some() || state.camera_information.is_some()
        };
        self.send(Command::Stop { address: Address::Motion, reply: motion_reply })?;
        if knows_camera {
            self.send(Command::Stop { address: Address::Camera, reply: camera_reply })?;
        }
        let stopped = receive(&motion_answer)?.accepted();
        if knows_camera {
            // A camera that does not answer moves no motor of the robot.
            let _ = receive(&camera_answer);
        }
        stopped.map(|_| ())
    }

    /// Waits until `until_ms`, or for a state newer than `newer_than`.
    pub(crate) fn wait(&self, until_ms: u64, newer_than: Option<u64>) -> Result<(), Error> {
        let (reply, answer) = mpsc::channel();
        self.send(Command::Wait { until_ms, newer_than, reply })?;
        answer.recv().map_err(|_| Error::Closed)
    }

    pub(crate) fn sleep_ms(&self, duration_ms: u64) -> Result<(), Error> {
        self.wait(self.now_ms().saturating_add(duration_ms), None)
    }

    /// Waits, at most `limit_ms`, for a state that fulfils `condition`; none when the limit passed.
    pub(crate) fn wait_for(
        &self,
        limit_ms: u64,
        mut condition: impl FnMut(&RobotState) -> bool,
    ) -> Result<Option<RobotState>, Error> {
        let until_ms = self.now_ms().saturating_add(limit_ms);
        loop {
            let state = self.state();
            if condition(&state) {
                return Ok(Some(state));
            }
            if self.now_ms() >= until_ms {
                return Ok(None);
            }
            self.wait(until_ms, Some(state.version))?;
        }
    }

    pub(crate) fn subscribe(&self, places: usize) -> Result<Receiver<RobotState>, Error> {
        let (to, states) = mpsc::sync_channel(places);
        self.send(Command::Subscribe { to })?;
        Ok(states)
    }

    fn ask(&self, command: impl FnOnce(Reply) -> Command) -> Result<Answer, Error> {
        let (reply, answer) = mpsc::channel();
        self.send(command(reply))?;
        receive(&answer)
    }

    fn send(&self, command: Command) -> Result<(), Error> {
        self.commands.send(command).map_err(|_| Error::Closed)
    }
}

fn receive(answer: &Receiver<Result<Answer, Error>>) -> Result<Answer, Error> {
    answer.recv().map_err(|_| Error::Closed)?
}

impl Drop for Line {
    fn drop(&mut self) {
        let _ = self.commands.send(Command::Close);
        // The last handle may be dropped by the thread itself, in a package sink.
        let other =
            self.thread.take_if(|thread| thread.thread().id() != std::thread::current().id());
        if let Some(thread) = other {
            let _ = thread.join();
        }
    }
}
