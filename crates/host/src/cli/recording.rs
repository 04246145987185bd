//! A recording that the command under way writes: the line, what is played, and what a camera sees.

mod eye;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rsapien_registry::CompiledAction;
use rsapien_vision::Detector;
use serde_json::{Value, json};

use self::eye::{Eye, Look};
use super::camera::{Camera, Source};
use super::diagnostics::{Failure, Result};
use crate::link::virtual_robot::{Controllers, Pace};
use crate::recording::{About, Recorder, RecordingError, RecordingSummary};
use crate::{LineEvent, LinkAddress, Progress, Robot, RobotOptions};

/// What is recorded of a camera.
#[derive(Clone)]
pub(crate) struct Pictures {
    pub(crate) source: Source,
    /// Between two pictures, in ms of the line's clock.
    pub(crate) period_ms: u64,
    /// What looks for ellipses in them.
    pub(crate) detector: Option<Detector>,
}

/// A recording in progress. Clones are the same one.
#[derive(Clone)]
pub(crate) struct Recording {
    recorder: Recorder,
    pictures: Option<Pictures>,
    eye: Arc<Mutex<Option<Eye>>>,
}

impl std::fmt::Debug for Recording {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.recorder.fmt(formatter)
    }
}

impl Recording {
    pub(crate) fn new(recorder: Recorder, pictures: Option<Pictures>) -> Self {
        Self { recorder, pictures, eye: Arc::default() }
    }

    /// Lets the line of a robot that is about to be opened be recorded.
    pub(crate) fn attach(&self, address: &LinkAddress, options: &mut RobotOptions) {
        self.recorder.describe(&about(address, options));
        let mut sink = self.recorder.line_sink();
        let eye = Arc::clone(&self.eye);
        let period_ms = self.pictures.as_ref().map(|pictures| pictures.period_ms);
        let mut next_ms = 0;
        options.on_line = Some(Box::new(move |event| {
            sink(event);
            let LineEvent::State(state) = event else { return };
            let Some(period_ms) = period_ms.filter(|_| state.time_ms >= next_ms) else { return };
            if let Some(eye) = locked(&eye).as_ref()
                && eye.look(state.time_ms)
            {
                next_ms = state.time_ms + period_ms;
            }
        }));
    }

    /// Begins with the pictures, once the robot is open.
    pub(crate) fn opened(&self, address: &LinkAddress, robot: &Robot, pace: Pace) -> Result<()> {
        let Some(pictures) = &self.pictures else { return Ok(()) };
        let source = pictures.source.clone().resolve(address)?;
        let look = Look {
            camera: Camera::open(source, Some(robot))?,
            detector: pictures.detector.clone(),
            recorder: self.recorder.clone(),
        };
        // Where time stands still meanwhile, no picture is left out and each run has the same ones.
        let is_waited_for = *address == LinkAddress::Virtual && pace == Pace::Fast;
        *locked(&self.eye) = Some(Eye::open(look, is_waited_for)?);
        Ok(())
    }

    /// Tells of an action that begins.
    pub(crate) fn begin(&self, time_ms: u64, action: &CompiledAction) -> Performance<'_> {
        let name = &*action.name;
        let event = json!({
            "event": "begin", "action": name, "steps_total": action.steps.len(),
        });
        self.recorder.motion(time_ms, event);
        Performance { recorder: &self.recorder, name: name.to_owned(), told: None }
    }

    /// Ends the file.
    pub(crate) fn finish(&self) -> Result<RecordingSummary> {
        let eye = locked(&self.eye).take();
        if let Some(eye) = eye {
            eye.close();
        }
        Ok(self.recorder.finish()?)
    }
}

/// What is recorded of an action while it is played.
pub(crate) struct Performance<'recording> {
    recorder: &'recording Recorder,
    name: String,
    /// What is played instead, steps ended and index of the label, as told last.
    told: Option<(Option<usize>, usize, Option<usize>)>,
}

impl Performance<'_> {
    /// Tells how far it is, when that has changed.
    pub(crate) fn step(&mut self, time_ms: u64, action: &CompiledAction, progress: &Progress) {
        let now = (progress.handler, progress.steps_ended, progress.label);
        if self.told.replace(now) == Some(now) {
            return;
        }
        // What is played instead of the rest tells of itself.
        let instead = progress.handler.and_then(|index| action.handlers.get(index));
        let action = instead.unwrap_or(action);
        let label = progress.label.and_then(|index| action.labels.get(index));
        self.recorder.motion(
            time_ms,
            json!({
                "event": "step",
                "action": self.name,
                "steps_ended": progress.steps_ended,
                "steps_total": progress.steps_total,
                "label": label.map(|label| &*label.name),
                "instead": instead.map(|it| it.name.as_str()),
            }),
        );
    }

    /// Tells how it ended.
    pub(crate) fn end(self, time_ms: u64, report: &Value) {
        let mut event = json!({"event": "end", "action": self.name});
        for key in ["steps_ended", "steps_total", "outcome", "detail", "reached", "instead"] {
            if let Some(value) = report.get(key) {
                event[key] = value.clone();
            }
        }
        self.recorder.motion(time_ms, event);
    }
}

/// What a recording is of.
fn about(address: &LinkAddress, options: &RobotOptions) -> About {
    let about = About {
        program: options.program.clone(),
        link: address.to_string(),
        baud: options.baud,
        ..About::default()
    };
    if *address != LinkAddress::Virtual {
        return about;
    }
    let made = &options.virtual_robot;
    let controllers = match made.config.controllers {
        Controllers::Model => "model",
        Controllers::Firmware(_) => "firmware",
    };
    About {
        seed: Some(made.config.seed),
        world: made.config.world.to_json().ok(),
        controllers: Some(controllers.to_owned()),
        is_fast: made.pace == Pace::Fast,
        ..about
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl From<RecordingError> for Failure {
    fn from(error: RecordingError) -> Self {
        let failure = Self::from_error(&error);
        match error {
            RecordingError::Exists { .. } => {
                failure.hint("choose another name, or let it be replaced: --force")
            }
            RecordingError::NotMcap { .. } | RecordingError::NoChannels { .. } => {
                failure.hint("rsapien record writes such files: rsapien record FILE.mcap play wave")
            }
            _ => failure,
        }
    }
}
