//! `Robot`: the robot from Python.

use crate::errors::{robot_error, value_error};
use crate::outcome::{PyOutcome, admission_told, policy_of};
use crate::recording::{PyRecorder, RecorderSlot};
use crate::registry::{Arguments, NameOrText, PyRegistry, compiled, values};
use crate::state::state_dict;
use crate::waiting::{self, Listeners, ProgressTold};
use numpy::{PyArray1, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rsapien::link::virtual_robot::{Controllers, FirmwareConfig, Pace};
use rsapien::protocol::Status;
use rsapien::recording::About;
use rsapien::sharing::Desk;
use rsapien::sim::world::World;
use rsapien::{
    CameraController, CancelToken, Error, LinkAddress, PauseSwitch, PlayOptions, Policy, Robot,
    RobotOptions, SensorsController, Stage, StopHandle, Terms,
};
use rsapien_registry::{CompileOptions, CompiledAction, Statement};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// What is held of the robot while it is open; the controllers are taken when they are first used.
struct Open {
    // A desk goes before its stage, and that before the line.
    desk: Option<Desk>,
    stage: Option<Stage>,
    robot: Robot,
    camera: Option<CameraController>,
    sensors: Option<SensorsController>,
}

impl Open {
    /// Where actions are played, for other programs too.
    fn stage(&mut self) -> Result<Stage, Error> {
        if let Some(stage) = &self.stage {
            return Ok(stage.clone());
        }
        let stage = Stage::new(self.robot.motion()?)?;
        self.desk = Desk::open(&self.robot, &stage)?;
        self.stage = Some(stage.clone());
        Ok(stage)
    }

    fn camera(&mut self) -> Result<&mut CameraController, Error> {
        if self.camera.is_none() {
            self.camera = Some(self.robot.camera()?);
        }
        self.camera.as_mut().ok_or(Error::Closed)
    }

    fn sensors(&mut self) -> Result<&mut SensorsController, Error> {
        if self.sensors.is_none() {
            self.sensors = Some(self.robot.sensors()?);
        }
        self.sensors.as_mut().ok_or(Error::Closed)
    }
}

/// The robot, real or virtual.
#[pyclass(name = "Robot", module = "rsapien", frozen)]
pub(crate) struct PyRobot {
    open: Mutex<Option<Open>>,
    /// End what is under way in other threads.
    calls: Mutex<Vec<CancelToken>>,
    /// Pauses what is played.
    pause: PauseSwitch,
    /// It keeps the line open, and goes with the rest.
    stop: Mutex<Option<StopHandle>>,
    link: String,
    recorder: RecorderSlot,
    /// What a recording tells of itself.
    about: About,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl PyRobot {
    fn start(
        py: Python<'_>,
        address: &LinkAddress,
        mut options: RobotOptions,
    ) -> PyResult<PyRobot> {
        let recorder = RecorderSlot::default();
        let slot = Arc::clone(&recorder);
        options.on_line = Some(Box::new(move |event| {
            if let Some(recorder) = locked(&slot).as_ref() {
                recorder.line_event(event);
            }
        }));
        // No seed and no world: a recording begins in the middle, where no new virtual robot is.
        let about = About {
            program: options.program.clone(),
            link: address.to_string(),
            baud: options.baud,
            ..About::default()
        };
        let robot = py.detach(|| Robot::open(address, options)).map_err(robot_error)?;
        Ok(PyRobot {
            stop: Mutex::new(Some(robot.stop_handle())),
            link: robot.link_name().to_owned(),
            recorder,
            about,
            calls: Mutex::default(),
            pause: PauseSwitch::new(),
            open: Mutex::new(Some(Open {
                desk: None,
                stage: None,
                robot,
                camera: None,
                sensors: None,
            })),
        })
    }

    /// Runs a request beside Python, with a fresh token.
    fn run<T: Send + 'static>(
        &self,
        py: Python<'_>,
        listeners: &Listeners,
        work: impl FnOnce(&CancelToken, Box<dyn FnMut(ProgressTold) + Send>) -> Result<T, Error> + Send,
    ) -> PyResult<T> {
        let token = CancelToken::new();
        locked(&self.calls).push(token.clone());
        let ran = waiting::run(py, &token, &|| drop(self.stop_motors()), listeners, |told| {
            work(&token, told)
        });
        // It is over; the next look at the calls need not see it.
        token.cancel();
        locked(&self.calls).retain(|call| !call.is_cancelled());
        ran
    }

    fn stop_motors(&self) -> Result<(), Error> {
        let stop = locked(&self.stop).clone();
        stop.ok_or(Error::Closed)?.stop()
    }

    /// Runs a request that needs what is held.
    fn run_held<T: Send + 'static>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&mut Open) -> Result<T, Error> + Send,
    ) -> PyResult<T> {
        self.run(py, &Listeners::default(), |_, _| {
            work(locked(&self.open).as_mut().ok_or(Error::Closed)?)
        })
    }

    fn perform(
        &self,
        py: Python<'_>,
        action: &CompiledAction,
        policy: Policy,
        from_label: Option<String>,
        listeners: &Listeners,
    ) -> PyResult<PyOutcome> {
        let stage = self.run_held(py, Open::stage)?;
        let report = self.run(py, listeners, |token, told| {
            let told = Mutex::new(told);
            let mut options = PlayOptions {
                cancel: token.clone(),
                pause: Some(self.pause.clone()),
                from_label,
                on_progress: Some(Box::new(|progress| {
                    locked(&told)(ProgressTold::Steps(progress.steps_ended, progress.steps_total));
                })),
                ..PlayOptions::default()
            };
            let terms = Terms { policy, guest: None };
            stage.play(action, &terms, &mut options, &mut |admission| {
                locked(&told)(admission_told(admission));
            })
        })?;
        Ok(PyOutcome { report })
    }
}

#[pymethods]
impl PyRobot {
    #[staticmethod]
    #[pyo3(signature = (link="auto", *, baud=57_600))]
    fn open(py: Python<'_>, link: &str, baud: u32) -> PyResult<PyRobot> {
        let address: LinkAddress = link.parse().map_err(robot_error)?;
        let options = RobotOptions { baud, ..RobotOptions::for_user("python") };
        PyRobot::start(py, &address, options)
    }

    #[staticmethod]
    #[pyo3(signature = (*, seed=0, world="demo", fast=false, firmware=None, simulator=None))]
    fn r#virtual(
        py: Python<'_>,
        seed: u64,
        world: &str,
        fast: bool,
        firmware: Option<PathBuf>,
        simulator: Option<PathBuf>,
    ) -> PyResult<PyRobot> {
        let mut options = RobotOptions::new("python");
        options.virtual_robot.pace = if fast { Pace::Fast } else { Pace::Real };
        options.virtual_robot.config.seed = seed;
        options.virtual_robot.config.world = World::named(world).map_err(value_error)?;
        if let Some(folder) = firmware {
            let simulator = simulator.unwrap_or_else(|| PathBuf::from("rsapien-gpsim"));
            let found = FirmwareConfig::find(&folder, simulator, options.baud);
            options.virtual_robot.config.controllers =
                Controllers::Firmware(found.map_err(value_error)?);
        }
        PyRobot::start(py, &LinkAddress::Virtual, options)
    }

    #[getter]
    fn link(&self) -> &str {
        &self.link
    }

    fn init(&self, py: Python<'_>) -> PyResult<()> {
        let stage = self.run_held(py, Open::stage)?;
        self.run(py, &Listeners::default(), |token, _| {
            stage.alone("initialisation", |motion| motion.init_unless(token)).map(|_| ())
        })
    }

    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let state = self.run_held(py, |open| {
            let sensed = open.sensors()?.refresh()?;
            match open.camera() {
                Ok(camera) => camera.refresh(),
                // A robot without its camera head still has a state.
                Err(Error::NoAnswer { .. }) => Ok(sensed),
                Err(error) => Err(error),
            }
        })?;
        state_dict(py, &state)
    }

    #[pyo3(signature = (*steps, policy="refuse"))]
    fn r#do(&self, py: Python<'_>, steps: Vec<String>, policy: &str) -> PyResult<PyOutcome> {
        let parsed: Result<Vec<_>, _> =
            steps.iter().map(|text| Statement::parse_short(text)).collect();
        let parsed = parsed.map_err(|finding| value_error(finding.in_words()))?;
        let compiled = PyRegistry::in_memory()?.compile_steps(parsed)?;
        self.perform(py, &compiled, policy_of(policy)?, None, &Listeners::default())
    }

    #[pyo3(signature = (
        action, *, times=1, speed=1.0, mirrored=false, arguments=None, from_label=None, registry=None,
        policy="refuse", on_admission=None, on_progress=None
    ))]
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn play(
        &self,
        py: Python<'_>,
        action: NameOrText,
        times: u16,
        speed: f64,
        mirrored: bool,
        arguments: Option<Arguments>,
        from_label: Option<String>,
        registry: Option<&PyRegistry>,
        policy: &str,
        on_admission: Option<Py<PyAny>>,
        on_progress: Option<Py<PyAny>>,
    ) -> PyResult<PyOutcome> {
        let policy = policy_of(policy)?;
        let arguments = values(py, arguments)?;
        let options = CompileOptions { times, speed, mirrored, arguments };
        let compiled = compiled(registry, &action, &options)?;
        let listeners = Listeners { on_progress, on_admission };
        self.perform(py, &compiled, policy, from_label, &listeners)
    }

    /// The state, again and again.
    #[pyo3(signature = (*, every_ms=100))]
    fn states(slf: Py<Self>, every_ms: u64) -> PyStates {
        PyStates { robot: slf, every_ms, is_first: AtomicBool::new(true) }
    }

    #[pyo3(signature = (pan, tilt, *, speed=0))]
    fn look(&self, py: Python<'_>, pan: f64, tilt: f64, speed: u16) -> PyResult<(f64, f64)> {
        let report = self.run_held(py, |open| {
            let camera = open.camera()?;
            match camera.look(pan, tilt, speed) {
                // The head knows by itself whether it has to be homed first.
                Err(Error::Refused { status: Status::NotInitialised, .. }) => {
                    camera.home()?;
                    camera.look(pan, tilt, speed)
                }
                looked => looked,
            }
        })?;
        Ok((f64::from(report.pan_centideg) / 100.0, f64::from(report.tilt_centideg) / 100.0))
    }

    fn snapshot<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let picture = self.run_held(py, |open| {
            let robot = open.robot.virtual_robot().ok_or(Error::NotOnThisLink {
                what: "only the virtual robot has a camera of its own: read a webcam with a library such as OpenCV",
            })?;
            let view = robot.lock().unwrap_or_else(PoisonError::into_inner).view();
            Ok(view.picture())
        })?;
        let shape = [picture.height as usize, picture.width as usize, 3];
        PyArray1::from_vec(py, picture.rgb).reshape(shape)
    }

    fn stop(&self, py: Python<'_>) -> PyResult<()> {
        py.detach(|| self.stop_motors()).map_err(robot_error)
    }

    fn sleep(&self, py: Python<'_>, ms: u64) -> PyResult<()> {
        let robot = self.run_held(py, |open| Ok(open.robot.clone()))?;
        self.run(py, &Listeners::default(), |_, _| robot.sleep_ms(ms))
    }

    /// Pauses what is played at the end of a step.
    fn pause(&self) {
        self.pause.pause();
    }

    /// Lets what is paused go on.
    fn resume(&self) {
        self.pause.resume();
    }

    #[pyo3(signature = (path, *, force=false))]
    fn record(&self, path: PathBuf, force: bool) -> PyResult<PyRecorder> {
        PyRecorder::begin(path, force, &self.about, &self.recorder)
    }

    fn close(&self, py: Python<'_>) {
        locked(&self.calls).iter().for_each(CancelToken::cancel);
        py.detach(|| {
            if let Some(open) = locked(&self.open).take() {
                // Controllers that are dropped while motors run stop them; this is for the case that
                // another program moves the robot, which leaving a `with` ends as well.
                let is_moving = open.stage.as_ref().is_some_and(|stage| stage.state().is_moving());
                if is_moving {
                    let _ = self.stop_motors();
                }
            }
            *locked(&self.stop) = None;
        });
    }

    fn __enter__(slf: PyRef<'_, Self>) -> PyRef<'_, Self> {
        slf
    }

    #[pyo3(signature = (_kind=None, _error=None, _traceback=None))]
    fn __exit__(
        &self,
        py: Python<'_>,
        _kind: Option<&Bound<'_, PyAny>>,
        _error: Option<&Bound<'_, PyAny>>,
        _traceback: Option<&Bound<'_, PyAny>>,
    ) {
        self.close(py);
    }

    fn __repr__(&self) -> String {
        let open = self.open.try_lock();
        let closed = matches!(open.as_deref(), Ok(None));
        format!("Robot({:?}{})", self.link, if closed { ", closed" } else { "" })
    }
}

/// Goes through the states of a robot.
#[pyclass(name = "States", module = "rsapien", frozen)]
pub(crate) struct PyStates {
    robot: Py<PyRobot>,
    every_ms: u64,
    is_first: AtomicBool,
}

#[pymethods]
impl PyStates {
    fn __iter__(slf: PyRef<'_, Self>) -> PyRef<'_, Self> {
        slf
    }

    fn __next__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let robot = self.robot.get();
        if !self.is_first.swap(false, Ordering::SeqCst) {
            robot.sleep(py, self.every_ms)?;
        }
        robot.state(py)
    }
}
