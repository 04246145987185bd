//! Waiting for the robot without keeping Python from anything: the GIL is released, and Ctrl-C stops
//! the motors first.

use crate::errors::{interrupted_by_keyboard, robot_error};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use rsapien::{CancelToken, Error, StopHandle};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// How long a signal may wait until it is looked at.
const SIGNAL_PERIOD: Duration = Duration::from_millis(50);

/// Steps ended and steps in all.
pub(crate) type ProgressTold = (usize, usize);

enum Told<T> {
    Progress(ProgressTold),
    End(Result<T, Error>),
}

/// Runs `work` beside this thread. Meanwhile Python's other threads run, `on_progress` is called as
/// progress is told, and an exception (Ctrl-C, or raised by `on_progress`) stops the motors before it
/// is passed on.
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    cancel: &CancelToken,
    stop: &StopHandle,
    on_progress: Option<Py<PyAny>>,
    work: impl FnOnce(Box<dyn FnMut(ProgressTold) + Send>) -> Result<T, Error> + Send,
) -> PyResult<T> {
    let (sender, receiver) = channel();
    // Shared with the closures that run without the GIL; nobody else waits for it.
    let receiver = Mutex::new(receiver);
    std::thread::scope(|scope| {
        let progress: Sender<Told<T>> = sender.clone();
        scope.spawn(move || {
            let told = Box::new(move |told| {
                // Nobody listens any more once an exception ended the wait.
                let _ = progress.send(Told::Progress(told));
            });
            let end = work(told);
            let _ = sender.send(Told::End(end));
        });
        let waited = wait(py, &receiver, on_progress.as_ref());
        if waited.is_err() {
            cancel.cancel();
            py.detach(|| {
                // The exception is what the caller is told; a line that cannot stop any more ends
                // by the robot's dead-man.
                let _ = stop.stop();
                let receiver = receiver.lock().unwrap_or_else(PoisonError::into_inner);
                while !matches!(receiver.recv(), Ok(Told::End(_)) | Err(_)) {}
            });
        }
        waited
    })
}

fn wait<T: Send>(
    py: Python<'_>,
    receiver: &Mutex<Receiver<Told<T>>>,
    on_progress: Option<&Py<PyAny>>,
) -> PyResult<T> {
    loop {
        match next(py, receiver) {
            Ok(Told::Progress((ended, total))) => {
                if let Some(on_progress) = on_progress {
                    on_progress.call1(py, (ended, total))?;
                }
            }
            Ok(Told::End(end)) => return end.map_err(robot_error),
            Err(RecvTimeoutError::Timeout) => py.check_signals().map_err(|error| {
                if error.is_instance_of::<PyKeyboardInterrupt>(py) {
                    interrupted_by_keyboard()
                } else {
                    error
                }
            })?,
            Err(RecvTimeoutError::Disconnected) => return Err(robot_error(Error::Closed)),
        }
    }
}

fn next<T: Send>(
    py: Python<'_>,
    receiver: &Mutex<Receiver<Told<T>>>,
) -> Result<Told<T>, RecvTimeoutError> {
    py.detach(|| {
        receiver.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(SIGNAL_PERIOD)
    })
}
