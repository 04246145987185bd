//! A robot: the line to it, and who holds its controllers.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rsapien_protocol::{Address, HelloReport, Kind, Report, Request};

use crate::control::{CameraController, Controller, MotionController, SensorsController};
use crate::line::{Answer, Line, LineOptions};
use crate::link::Connect;
use crate::lock::LineLock;
use crate::record::{LineSink, PackageRecord, PackageSink};
use crate::{Error, Holder, LinkAddress, data, link, ports};

/// How a robot is opened.
pub struct RobotOptions {
    /// What the program calls itself; others who find the robot held are told.
    pub program: String,
    /// Line speed in bit/s: 57600, or what the firmware was built for (19200, 38400, 115200).
    pub baud: u32,
    /// Where the locks between programs stand; none for no lock.
    pub lock_folder: Option<PathBuf>,
    /// How long a controller may go without a package before it is asked for its state, in ms. This
    /// is the heartbeat; it comes more often where a short dead-man time asks for it. At least 1.
    pub state_period_ms: u64,
    /// How many packages the log keeps.
    pub package_log_length: usize,
    /// Takes each package as it goes over the line.
    pub on_package: Option<PackageSink>,
    /// Takes everything that happens on the line, down to the bytes; a recording does.
    pub on_line: Option<LineSink>,
    /// How the virtual robot is made that the link `virtual` leads to.
    #[cfg(feature = "virtual")]
    pub virtual_robot: link::virtual_robot::VirtualOptions,
}

impl RobotOptions {
    /// 57600 baud, a heartbeat every 100 ms, a log of 4096 packages, and no lock between programs.
    pub fn new(program: impl Into<String>) -> RobotOptions {
        RobotOptions {
            program: program.into(),
            baud: 57_600,
            lock_folder: None,
            state_period_ms: 100,
            package_log_length: 4096,
            on_package: None,
            on_line: None,
            #[cfg(feature = "virtual")]
            virtual_robot: link::virtual_robot::VirtualOptions::default(),
        }
    }

    /// As [`new`](RobotOptions::new), with the locks of this user's programs
    /// ([`data::lock_folder`]).
    pub fn for_user(program: impl Into<String>) -> RobotOptions {
        RobotOptions { lock_folder: data::lock_folder(), ..RobotOptions::new(program) }
    }
}

/// A robot behind a link. Clones share it; the last one closes the line.
///
/// As in the paper's control interface architecture (section 3, Fig. 6), requests are issued and
/// feedback is read through controllers: [`motion`](Robot::motion), [`camera`](Robot::camera) and
/// [`sensors`](Robot::sensors). Each has one holder at a time. [`stop`](Robot::stop) alone needs
/// none.
#[derive(Clone)]
pub struct Robot {
    inner: Arc<Inner>,
}

pub(crate) struct Inner {
    // The line comes before its lock, so that it is closed when the lock goes.
    pub(crate) line: Line,
    program: String,
    holders: Mutex<[Option<Holder>; Controller::COUNT]>,
    #[cfg(feature = "virtual")]
    virtual_robot: Option<link::virtual_robot::SharedVirtualRobot>,
    _lock: Option<LineLock>,
    /// The folder of the lock, and what stands for the line there.
    #[cfg(all(feature = "sharing", unix))]
    lock_place: Option<(PathBuf, String)>,
}

impl Inner {
    fn holders(&self) -> MutexGuard<'_, [Option<Holder>; Controller::COUNT]> {
        self.holders.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Makes this program the holder of `controller`.
    pub(crate) fn take(&self, controller: Controller) -> Result<(), Error> {
        let mut holders = self.holders();
        let Some(place) = holders.get_mut(controller as usize) else { return Ok(()) };
        if let Some(by) = place {
            let what = format!("the {} controller of {}", controller.name(), self.line.name());
            return Err(Error::Held { what, by: by.clone() });
        }
        *place = Some(Holder::this_process(&self.program));
        Ok(())
    }

    pub(crate) fn program(&self) -> &str {
        &self.program
    }

    pub(crate) fn release(&self, controller: Controller) {
        if let Some(place) = self.holders().get_mut(controller as usize) {
            *place = None;
        }
    }
}

impl Robot {
    /// Opens the line at `address` and makes sure that a motion controller answers. This reads
    /// states only, so the robot does not notice.
    ///
    /// # Errors
    /// The link cannot be opened, someone else holds the line ([`Error::Held`]), or nobody answers
    /// ([`Error::NoAnswer`]); for [`LinkAddress::Auto`] also [`Error::NoRobot`] and
    /// [`Error::Ambiguous`].
    pub fn open(address: &LinkAddress, options: RobotOptions) -> Result<Robot, Error> {
        match address {
            LinkAddress::Auto => {
                let found = ports::find_robot(options.baud, options.lock_folder.as_deref())?;
                Robot::open(&found, options)
            }
            LinkAddress::Virtual => Robot::open_virtual(options),
            LinkAddress::Serial(_) | LinkAddress::Tcp(_) => {
                let connector = connector(address, options.baud)?;
                Robot::open_with(connector, options)
            }
        }
    }

    /// Opens a robot behind any link.
    ///
    /// # Errors
    /// As [`open`](Robot::open).
    pub fn open_with(connector: Box<dyn Connect>, options: RobotOptions) -> Result<Robot, Error> {
        Robot::assemble(connector, options, random_session(), |inner| inner)
    }

    /// Opens a virtual robot that others use as well: for its picture, its faults, its world.
    ///
    /// # Errors
    /// As [`open`](Robot::open).
    #[cfg(feature = "virtual")]
    pub fn virtual_with(
        robot: link::virtual_robot::SharedVirtualRobot,
        pace: link::virtual_robot::Pace,
        options: RobotOptions,
    ) -> Result<Robot, Error> {
        let connector = link::virtual_robot::VirtualConnector::new(Arc::clone(&robot), pace);
        // The same session each time: the run is to be the same, too.
        Robot::assemble(Box::new(connector), options, 1, |mut inner| {
            inner.virtual_robot = Some(robot);
            inner
        })
    }

    #[cfg(feature = "virtual")]
    fn open_virtual(options: RobotOptions) -> Result<Robot, Error> {
        let robot = options.virtual_robot.build()?;
        let pace = options.virtual_robot.pace;
        Robot::virtual_with(robot, pace, options)
    }

    #[cfg(not(feature = "virtual"))]
    fn open_virtual(_options: RobotOptions) -> Result<Robot, Error> {
        Err(Error::LinkNotBuilt { links: "virtual", feature: "virtual" })
    }

    fn assemble(
        connector: Box<dyn Connect>,
        options: RobotOptions,
        first_session: u8,
        finish: impl FnOnce(Inner) -> Inner,
    ) -> Result<Robot, Error> {
        let holder = Holder::this_process(&options.program);
        let lock_place = options.lock_folder.clone().zip(connector.lock_key());
        let lock = match &lock_place {
            Some((folder, key)) => Some(LineLock::take(folder, key, &holder)?),
            None => None,
        };
        let line_options = LineOptions {
            baud: options.baud,
            state_period_ms: options.state_period_ms,
            first_session,
            package_log_length: options.package_log_length,
            on_package: options.on_package,
            on_line: options.on_line,
        };
        let name = connector.name();
        let line =
            Line::start(connector, line_options).map_err(|error| not_opened(&name, error))?;
        line.request(Address::Motion, Request::State)
            .and_then(Answer::accepted)
            .map_err(|error| not_opened(&name, error))?;
        // A camera controller may be missing; whoever takes it is told then.
        let _ = line.request(Address::Camera, Request::State);
        let inner = finish(Inner {
            line,
            program: options.program,
            holders: Mutex::default(),
            #[cfg(feature = "virtual")]
            virtual_robot: None,
            _lock: lock,
            #[cfg(all(feature = "sharing", unix))]
            lock_place,
        });
        Ok(Robot { inner: Arc::new(inner) })
    }

    /// The link's name, as its address is written.
    pub fn link_name(&self) -> &str {
        self.inner.line.name()
    }

    /// The folder of the lock between programs, and what stands for the line there.
    #[cfg(all(feature = "sharing", unix))]
    pub(crate) fn lock_place(&self) -> Option<(&std::path::Path, &str)> {
        let (folder, key) = self.inner.lock_place.as_ref()?;
        Some((folder, key))
    }

    /// The line's clock in ms. Virtual robot: the robot's clock.
    pub fn now_ms(&self) -> u64 {
        self.inner.line.now_ms()
    }

    /// Lets `duration_ms` pass on the line's clock, with heartbeats going on.
    ///
    /// # Errors
    /// [`Error::Closed`].
    pub fn sleep_ms(&self, duration_ms: u64) -> Result<(), Error> {
        self.inner.line.sleep_ms(duration_ms)
    }

    /// Stops every motor, whoever holds the controllers. Requests that were asked for before and
    /// are not on the line yet are not sent any more.
    ///
    /// # Errors
    /// [`Error::NoAnswer`] or [`Error::LinkLost`]: the robot's dead-man is left to stop it.
    pub fn stop(&self) -> Result<(), Error> {
        self.inner.line.stop()
    }

    /// Something to stop the robot with from another thread, such as the one that handles Ctrl-C.
    pub fn stop_handle(&self) -> StopHandle {
        StopHandle { inner: Arc::clone(&self.inner) }
    }

    /// What the controller at `address` told of itself when its session was opened: firmware,
    /// clock, queue length, dead-man time, boot number and the cause of the last reset.
    ///
    /// # Errors
    /// [`Error::NoAnswer`] and others, when no session is open yet and none can be opened.
    pub fn information(&self, address: Address) -> Result<HelloReport, Error> {
        let line = &self.inner.line;
        if let Some(report) = line.state().information(address) {
            return Ok(report);
        }
        let package = line.open(address)?.accepted()?;
        match package.report {
            Report::Hello(report) => Ok(report),
            _ => Err(Error::BadReport { address, kind: Kind::Hello }),
        }
    }

    /// The packages that the log keeps, oldest first.
    pub fn packages(&self) -> Vec<PackageRecord> {
        self.inner.line.packages()
    }

    /// Takes the motion controller and opens a session with it.
    ///
    /// # Errors
    /// [`Error::Held`] while someone holds it; [`Error::NoAnswer`] and others of the line.
    pub fn motion(&self) -> Result<MotionController, Error> {
        MotionController::take(&self.inner)
    }

    /// Takes the camera controller and opens a session with it.
    ///
    /// # Errors
    /// [`Error::Held`] while someone holds it; [`Error::NoAnswer`] when the robot has none.
    pub fn camera(&self) -> Result<CameraController, Error> {
        CameraController::take(&self.inner)
    }

    /// Takes the sensors: bumpers, switches, supply, and every state as it comes.
    ///
    /// # Errors
    /// [`Error::Held`] while someone holds them.
    pub fn sensors(&self) -> Result<SensorsController, Error> {
        SensorsController::take(&self.inner)
    }

    /// The virtual robot behind the link, if it is one.
    #[cfg(feature = "virtual")]
    pub fn virtual_robot(&self) -> Option<link::virtual_robot::SharedVirtualRobot> {
        self.inner.virtual_robot.clone()
    }
}

impl std::fmt::Debug for Robot {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Robot").field("link", &self.link_name()).finish_non_exhaustive()
    }
}

/// Stops the robot from any thread. It keeps the line open.
#[derive(Clone)]
pub struct StopHandle {
    inner: Arc<Inner>,
}

impl StopHandle {
    /// As [`Robot::stop`].
    ///
    /// # Errors
    /// As [`Robot::stop`].
    pub fn stop(&self) -> Result<(), Error> {
        self.inner.line.stop()
    }
}

/// A link that broke while it was opened is not tried again by itself.
fn not_opened(link: &str, error: Error) -> Error {
    match error {
        Error::LinkLost { why, .. } => {
            Error::LinkOpen { link: link.to_owned(), source: std::io::Error::other(why) }
        }
        other => other,
    }
}

/// What opens the link at `address`.
pub(crate) fn connector(address: &LinkAddress, baud: u32) -> Result<Box<dyn Connect>, Error> {
    match address {
        #[cfg(feature = "serial")]
        LinkAddress::Serial(path) => {
            Ok(Box::new(link::serial::SerialConnector::new(path.as_str(), baud)))
        }
        #[cfg(not(feature = "serial"))]
        LinkAddress::Serial(_) => {
            let _ = baud;
            Err(Error::LinkNotBuilt { links: "serial", feature: "serial" })
        }
        LinkAddress::Tcp(target) => Ok(Box::new(link::tcp::TcpConnector::new(target.as_str()))),
        LinkAddress::Auto | LinkAddress::Virtual => Err(Error::NotOnThisLink {
            what: "a connection is made to one serial port or TCP server",
        }),
    }
}

/// A session number that a restarted program will hardly propose again.
pub(crate) fn random_session() -> u8 {
    use std::hash::{BuildHasher, Hasher, RandomState};
    let [first, ..] = RandomState::new().build_hasher().finish().to_le_bytes();
    first.max(1)
}
