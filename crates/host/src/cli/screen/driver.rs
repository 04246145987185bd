//! Does to the robot what a screen wants, on threads of its own, so that keys are always heard.

use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, PoisonError};

use rsapien_protocol::{Joint, Pose, Position, Step};
use rsapien_registry::CompiledAction;

use super::Told;
use crate::cli::diagnostics::Result;
use crate::cli::performance;
use crate::cli::robot::OpenRobot;
use crate::sharing::Desk;
use crate::{
    CancelToken, Claim, Error, PauseSwitch, PlayOptions, Policy, Stage, StopHandle, Terms,
};

/// How far the robot is moved by a screen.
pub(super) struct Driver {
    // A desk goes before its stage.
    _desk: Option<Desk>,
    stage: Stage,
    stop: StopHandle,
    tell: Sender<Told>,
    /// Of the action played last.
    cancel: Arc<Mutex<CancelToken>>,
    pause: PauseSwitch,
}

impl Driver {
    pub(super) fn new(open: &OpenRobot, tell: Sender<Told>) -> Result<Driver> {
        let stage = Stage::new(open.motion()?)?;
        let desk = Desk::open(&open.robot, &stage)?;
        Ok(Driver {
            _desk: desk,
            stage,
            stop: open.robot.stop_handle(),
            tell,
            cancel: Arc::default(),
            pause: PauseSwitch::new(),
        })
    }

    pub(super) fn claims(&self) -> (Vec<Claim>, Vec<Claim>) {
        self.stage.claims()
    }

    pub(super) fn remark(&self, text: impl Into<String>) {
        // A screen that is gone has no reader.
        let _ = self.tell.send(Told::Remark(text.into()));
    }

    /// STOP, waiting for the robot's word.
    pub(super) fn stop_now(&self) -> Result<()> {
        Ok(self.stop.stop()?)
    }

    /// STOP, at once, whatever else is asked.
    pub(super) fn stop(&self) {
        self.pause.resume();
        let (stop, tell) = (self.stop.clone(), self.tell.clone());
        std::thread::spawn(move || {
            let told = match stop.stop() {
                Ok(()) => "STOP: motors off".to_owned(),
                Err(error) => format!("STOP was not confirmed: {error}"),
            };
            let _ = tell.send(Told::Remark(told));
        });
    }

    /// Plays an action beside what moves other joints.
    pub(super) fn play(&self, action: CompiledAction) {
        let cancel = CancelToken::new();
        *self.cancel.lock().unwrap_or_else(PoisonError::into_inner) = cancel.clone();
        self.pause.resume();
        self.play_with(action, cancel, Some(self.pause.clone()));
    }

    fn play_with(&self, action: CompiledAction, cancel: CancelToken, pause: Option<PauseSwitch>) {
        let (stage, tell) = (self.stage.clone(), self.tell.clone());
        std::thread::spawn(move || {
            let name = action.name.clone();
            let progress = tell.clone();
            let of_progress = name.clone();
            let mut options = PlayOptions {
                cancel,
                pause,
                on_progress: Some(Box::new(move |now| {
                    let action = of_progress.clone();
                    let _ = progress.send(Told::Progress { action, progress: *now });
                })),
                ..PlayOptions::default()
            };
            let terms = Terms { policy: Policy::Merge, guest: None };
            let played = stage.play(&action, &terms, &mut options, &mut |_| {});
            let how = match played {
                Ok(report) => performance::in_words(&report),
                Err(error) => error.to_string(),
            };
            let _ = tell.send(Told::Ended { action: name, how });
        });
    }

    /// Sends one joint somewhere.
    pub(super) fn nudge(&self, joint: Joint, position: Position) {
        let pose = Pose::EMPTY.with(joint, Some(position));
        let step = Step::new(pose, joint.settle_ms());
        let names = joint.position_names();
        let to = names.get(usize::from(position.number() - 1)).copied().unwrap_or_default();
        let action = CompiledAction::from_steps(&format!("{}-{to}", joint.name()), vec![step]);
        self.play_with(action, CancelToken::new(), None);
    }

    pub(super) fn pause(&self, is_paused: bool) {
        if is_paused { self.pause.pause() } else { self.pause.resume() }
    }

    /// Ends the action that was played last.
    pub(super) fn end(&self) {
        self.cancel.lock().unwrap_or_else(PoisonError::into_inner).cancel();
        self.pause.resume();
    }

    /// Initialises the robot.
    pub(super) fn init(&self) {
        let (stage, tell) = (self.stage.clone(), self.tell.clone());
        let cancel = CancelToken::new();
        *self.cancel.lock().unwrap_or_else(PoisonError::into_inner) = cancel.clone();
        std::thread::spawn(move || {
            let done: std::result::Result<_, Error> =
                stage.alone("initialisation", |motion| motion.init_unless(&cancel));
            let how = done.map_or_else(|error| error.to_string(), |_| "done".to_owned());
            let _ = tell.send(Told::Ended { action: "initialisation".to_owned(), how });
        });
    }
}
