//! Waiting for the robot without keeping Python from anything: the GIL is released, and Ctrl-C stops
//! the motors first.

use crate::errors::{interrupted_by_keyboard, robot_error};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use rsapien::{CancelToken, Error};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// How long a signal may wait until it is looked at.
const SIGNAL_PERIOD: Duration = Duration::from_millis(50);

/// What is told while an action is played.
pub(crate) enum ProgressTold {
    /// Steps ended and steps in all.
    Steps(usize, usize),
    /// What becomes of it, and the words for that.
    Admission(&'static str, String),
}

/// Who is told.
#[derive(Default)]
pub(crate) struct Listeners {
    pub(crate) on_progress: Option<Py<PyAny>>,
    pub(crate) on_admission: Option<Py<PyAny>>,
}

enum Told<T> {
    Progress(ProgressTold),
    End(Result<T, Error>),
}

/// Runs `work` beside this thread. Meanwhile Python's other threads run, listeners are called as
/// progress is told, and an exception (Ctrl-C, or raised by a listener) stops the motors before it
/// is passed on.
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    cancel: &CancelToken,
    stop: &(dyn Fn() + Sync),
    listeners: &Listeners,
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
        let waited = wait(py, &receiver, listeners);
        // What ended by itself has stopped what it began, and nothing of anybody else's.
        if let Err((error, Work::GoesOn)) = waited {
            cancel.cancel();
            py.detach(|| {
                // The exception is what the caller is told; a line that cannot stop any more ends
                // by the robot's dead-man.
                stop();
                let receiver = receiver.lock().unwrap_or_else(PoisonError::into_inner);
                while !matches!(receiver.recv(), Ok(Told::End(_)) | Err(_)) {}
            });
            return Err(error);
        }
        waited.map_err(|(error, _)| error)
    })
}

/// Whether the work is still under way when its wait ends in an exception.
enum Work {
    GoesOn,
    Ended,
}

fn wait<T: Send>(
    py: Python<'_>,
    receiver: &Mutex<Receiver<Told<T>>>,
    listeners: &Listeners,
) -> Result<T, (PyErr, Work)> {
    loop {
        let told = match next(py, receiver) {
            Ok(Told::End(end)) => return end.map_err(|error| (robot_error(error), Work::Ended)),
            Err(RecvTimeoutError::Disconnected) => {
                return Err((robot_error(Error::Closed), Work::Ended));
            }
            Ok(Told::Progress(told)) => tell(py, listeners, told),
            Err(RecvTimeoutError::Timeout) => py.check_signals().map_err(|error| {
                if error.is_instance_of::<PyKeyboardInterrupt>(py) {
                    interrupted_by_keyboard()
                } else {
                    error
                }
            }),
        };
        told.map_err(|error| (error, Work::GoesOn))?;
    }
}

fn tell(py: Python<'_>, listeners: &Listeners, told: ProgressTold) -> PyResult<()> {
    match (told, &listeners.on_progress, &listeners.on_admission) {
        (ProgressTold::Steps(ended, total), Some(on_progress), _) => {
            on_progress.call1(py, (ended, total)).map(drop)
        }
        (ProgressTold::Admission(word, text), _, Some(on_admission)) => {
            on_admission.call1(py, (word, text)).map(drop)
        }
        _ => Ok(()),
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
