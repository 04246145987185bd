//! Takes the pictures of a recording, on a thread of its own: the line must not wait for a camera.

use std::sync::mpsc::{self, Receiver, SyncSender};
use std::thread::JoinHandle;

use rsapien_vision::Detector;

use crate::cli::camera::Camera;
use crate::cli::diagnostics::{Failure, Result};
use crate::recording::Recorder;

/// What takes a picture, looks at it, and keeps both.
pub(super) struct Look {
    pub(super) camera: Camera,
    pub(super) detector: Option<Detector>,
    pub(super) recorder: Recorder,
}

impl Look {
    /// At `time_ms` of the line's clock.
    fn once(&mut self, time_ms: u64) -> Result<()> {
        let picture = self.camera.take()?;
        self.recorder.frame(time_ms, &picture);
        if let Some(detector) = &mut self.detector {
            let found = detector.detect(&picture.to_gray().view());
            let found: Vec<_> =
                found.ellipses.iter().map(|found| (found.ellipse, found.score)).collect();
            self.recorder.detections(time_ms, &found);
        }
        Ok(())
    }
}

/// The thread, and how it is asked.
pub(super) struct Eye {
    asked: SyncSender<u64>,
    done: Receiver<()>,
    is_waited_for: bool,
    thread: JoinHandle<()>,
}

impl Eye {
    /// Starts the thread. With `is_waited_for`, [`look`](Self::look) comes back when the picture is taken.
    pub(super) fn open(mut look: Look, is_waited_for: bool) -> Result<Self> {
        // No place to wait in: a picture that comes late would belong to another moment.
        let (asked, orders) = mpsc::sync_channel::<u64>(0);
        let (told, done) = mpsc::sync_channel(1);
        let run = move || {
            let mut is_told = false;
            for time_ms in orders {
                if let Err(failure) = look.once(time_ms)
                    && !std::mem::replace(&mut is_told, true)
                {
                    tracing::warn!("a picture was not recorded: {failure}");
                }
                if is_waited_for && told.send(()).is_err() {
                    return;
                }
            }
        };
        let thread = std::thread::Builder::new()
            .name("rsapien-eye".to_owned())
            .spawn(run)
            .map_err(|error| Failure::new(format!("cannot start a thread: {error}")))?;
        Ok(Self { asked, done, is_waited_for, thread })
    }

    /// Asks for a picture at `time_ms`; false when the one before is not ready yet.
    pub(super) fn look(&self, time_ms: u64) -> bool {
        if self.is_waited_for {
            return self.asked.send(time_ms).is_ok() && self.done.recv().is_ok();
        }
        self.asked.try_send(time_ms).is_ok()
    }

    /// Waits for the last picture.
    pub(super) fn close(self) {
        drop(self.asked);
        drop(self.done);
        // A thread that panicked has told so.
        let _ = self.thread.join();
    }
}
