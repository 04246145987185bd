//! The stage: several actions on one robot that never fight over a motor.
//!
//! Whoever plays on a stage claims the joints of its action until it has ended. What happens when another
//! action is there already is the caller's choice ([`Policy`]), and told before anything moves
//! ([`Admission`]). Actions that move different joints can go on side by side: the robot has one queue of
//! steps, so a thread of the stage makes one row of slices of them ([`merge`]).
//!
//! STOP, the dead-man, a reset, a lost link and a bumper that ends one of them act on the whole robot, and so
//! end every action on the stage. An action that is cancelled or replaced ends alone: the motors are stopped
//! at once, and what others had under way goes on.

mod claims;
mod conductor;
mod floor;
mod merge;

use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use rsapien_registry::CompiledAction;

pub(crate) use claims::list;
pub use claims::{Admission, Claim, Policy};

use self::claims::{Verdict, decide};
use self::conductor::Stream;
use self::floor::StageFloor;
use self::merge::Merge;
use crate::player::{PlayOptions, PlayReport, perform};
use crate::robot;
use crate::{CancelToken, Error, Interruption, MotionController, RobotState};

/// How often one that waits looks whether it is cancelled.
const LOOK: Duration = Duration::from_millis(20);
/// Every joint.
const ALL_JOINTS: u8 = 0x7F;

/// On what terms an action is played.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Terms {
    /// What is done when another is being played.
    pub policy: Policy,
    /// For whom, where that is not the stage's own program: its name and process.
    pub guest: Option<(String, u32)>,
}

/// Plays actions for several holders. Clones share it; when the last one goes, the motion controller is let go.
#[derive(Clone)]
pub struct Stage {
    handle: Arc<Handle>,
}

struct Handle {
    inner: Arc<Inner>,
    conductor: Option<JoinHandle<()>>,
}

struct Inner {
    robot: Arc<robot::Inner>,
    motion: Mutex<MotionController>,
    state: Mutex<State>,
    changed: Condvar,
    /// STOPs of the stage's own, which end one action only.
    own_stops: Mutex<u64>,
}

#[derive(Default)]
struct State {
    playing: Vec<Performer>,
    waiting: VecDeque<Performer>,
    merge: Merge,
    streams: Vec<Stream>,
    /// The count of STOPs before the streams at hand began.
    run_generation: u64,
    /// STOPs from outside that ended a run.
    halts: u64,
    next_id: u64,
    is_closing: bool,
}

struct Performer {
    id: u64,
    claim: Claim,
    /// Whether it ends what is played.
    replaces: bool,
    ended_by: Option<Interruption>,
}

/// Takes a performer off the stage.
struct Leave<'a> {
    inner: &'a Inner,
    id: u64,
}

impl Drop for Leave<'_> {
    fn drop(&mut self) {
        let mut state = self.inner.state();
        state.playing.retain(|performer| performer.id != self.id);
        state.waiting.retain(|performer| performer.id != self.id);
        self.inner.changed.notify_all();
    }
}

impl Inner {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn own_stops(&self) -> MutexGuard<'_, u64> {
        self.own_stops.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Counts the STOPs that are not the stage's own.
    fn stop_generation(&self) -> u64 {
        let own_stops = self.own_stops();
        self.robot.line.stop_generation().saturating_sub(*own_stops)
    }

    fn wait<'a>(&self, state: MutexGuard<'a, State>) -> MutexGuard<'a, State> {
        let waited = self.changed.wait_timeout(state, LOOK);
        waited.unwrap_or_else(PoisonError::into_inner).0
    }
}

impl State {
    fn claims(performers: impl IntoIterator<Item = Claim>) -> Vec<Claim> {
        performers.into_iter().collect()
    }

    fn playing(&self) -> Vec<Claim> {
        State::claims(self.playing.iter().map(|performer| performer.claim.clone()))
    }

    fn ended_by(&self, id: u64) -> Option<Interruption> {
        let all = self.playing.iter().chain(&self.waiting);
        all.filter(|performer| performer.id == id).find_map(|performer| performer.ended_by)
    }
}

impl Stage {
    /// A stage on which `motion` moves the robot, which is to be initialised.
    ///
    /// # Errors
    /// [`Error::Closed`] when the system has no thread for it.
    pub fn new(motion: MotionController) -> Result<Stage, Error> {
        let inner = Arc::new(Inner {
            robot: Arc::clone(motion.inner()),
            motion: Mutex::new(motion),
            state: Mutex::default(),
            changed: Condvar::new(),
            own_stops: Mutex::new(0),
        });
        let of_thread = Arc::clone(&inner);
        let conductor = std::thread::Builder::new()
            .name("rsapien-stage".to_owned())
            .spawn(move || conductor::conduct(&of_thread))
            .map_err(|_| Error::Closed)?;
        Ok(Stage { handle: Arc::new(Handle { inner, conductor: Some(conductor) }) })
    }

    /// The newest state of the whole robot, as it was reported last.
    pub fn state(&self) -> RobotState {
        self.handle.inner.robot.line.state()
    }

    /// Has actions that join begin within 0.4 s, whatever is played: steps are cut into slices of at most 200 ms, which the
    /// robot counts as steps. Otherwise one that joins begins when the steps have ended that are in the robot's queue.
    pub fn share(&self) {
        self.handle.inner.state().merge.is_shared = true;
    }

    /// What is being played, and what waits behind it.
    pub fn claims(&self) -> (Vec<Claim>, Vec<Claim>) {
        let state = self.handle.inner.state();
        let waiting = State::claims(state.waiting.iter().map(|it| it.claim.clone()));
        (state.playing(), waiting)
    }

    /// Plays `action` to its end, on these terms. `on_admission` is told what becomes of it before anything
    /// moves for it, and again when its turn has come after a wait.
    ///
    /// # Errors
    /// [`Error::Claimed`] when others are in its way and the policy leaves them alone; otherwise as
    /// [`MotionController::perform`].
    pub fn play(
        &self,
        action: &CompiledAction,
        terms: &Terms,
        options: &mut PlayOptions<'_>,
        on_admission: &mut dyn FnMut(&Admission),
    ) -> Result<PlayReport, Error> {
        let inner = &*self.handle.inner;
        let claim = self.claim(&action.name, action.joints(), terms);
        let stop_generation = inner.stop_generation();
        let (leave, by) = enter(inner, claim, terms.policy, &options.cancel, on_admission)?;
        let is_stopped = inner.stop_generation() != stop_generation;
        if let Some(by) = by.or(is_stopped.then_some(Interruption::Stop)) {
            return Ok(PlayReport::unplayed(&action.name, action.steps.len(), by));
        }
        perform(&StageFloor { inner, id: leave.id, joints: action.joints() }, action, options)
    }

    /// Does something with the whole robot, such as its initialisation, while nothing is played.
    ///
    /// # Errors
    /// [`Error::Claimed`] while something is played, and those of `work`.
    pub fn alone<T>(
        &self,
        what: &str,
        work: impl FnOnce(&mut MotionController) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let inner = &*self.handle.inner;
        let claim = self.claim(what, ALL_JOINTS, &Terms::default());
        let _leave = enter(inner, claim, Policy::Refuse, &CancelToken::new(), &mut |_| {})?;
        let mut motion = inner.motion.lock().unwrap_or_else(PoisonError::into_inner);
        work(&mut motion)
    }

    fn claim(&self, action: &str, joints: u8, terms: &Terms) -> Claim {
        let own = || (self.handle.inner.robot.program().to_owned(), std::process::id());
        let (program, pid) = terms.guest.clone().unwrap_or_else(own);
        Claim { action: action.to_owned(), program, pid, joints }
    }
}

/// Lets a performer onto the stage: at once, or when its turn has come. What kept it from that, if something did.
fn enter<'a>(
    inner: &'a Inner,
    claim: Claim,
    policy: Policy,
    cancel: &CancelToken,
    on_admission: &mut dyn FnMut(&Admission),
) -> Result<(Leave<'a>, Option<Interruption>), Error> {
    let mut state = inner.state();
    let waiting = State::claims(state.waiting.iter().map(|it| it.claim.clone()));
    let admission = match decide(&claim, policy, &state.playing(), &waiting) {
        Verdict::Admitted(admission) => admission,
        Verdict::Refused { by, joints } => {
            let joints = joints.into_iter().map(rsapien_protocol::Joint::name).collect();
            let action = if claim.action.is_empty() { "it".to_owned() } else { claim.action };
            return Err(Error::Claimed { action, by, joints });
        }
    };
    state.next_id += 1;
    let id = state.next_id;
    let replaces = matches!(admission, Admission::Replaces { .. });
    let performer = Performer { id, claim, replaces, ended_by: None };
    let leave = Leave { inner, id };
    match admission {
        Admission::Begins | Admission::Beside { .. } => {
            state.playing.push(performer);
            drop(state);
            on_admission(&admission);
            return Ok((leave, None));
        }
        Admission::Replaces { .. } => {
            let State { playing, waiting, .. } = &mut *state;
            let about_to = waiting.iter_mut().filter(|other| other.replaces);
            for other in playing.iter_mut().chain(about_to) {
                other.ended_by = Some(Interruption::Replaced);
            }
            waiting.push_front(performer);
        }
        Admission::Waits { .. } => state.waiting.push_back(performer),
    }
    let halts = state.halts;
    inner.changed.notify_all();
    drop(state);
    on_admission(&admission);
    let by = wait_for_turn(inner, id, halts, cancel);
    if by.is_none() && !replaces {
        on_admission(&Admission::Begins);
    }
    Ok((leave, by))
}

/// Waits until nothing is played and nobody waits before `id`. What ended the wait before, if something did.
fn wait_for_turn(inner: &Inner, id: u64, halts: u64, cancel: &CancelToken) -> Option<Interruption> {
    let stop_generation = inner.stop_generation();
    let mut state = inner.state();
    loop {
        if cancel.is_cancelled() {
            return Some(Interruption::Cancelled);
        }
        if let Some(by) = state.ended_by(id) {
            return Some(by);
        }
        // A STOP was for the robot, and so for what waits to move it.
        if state.halts != halts || inner.stop_generation() != stop_generation {
            return Some(Interruption::Stop);
        }
        if state.playing.is_empty() && state.waiting.front().is_some_and(|first| first.id == id) {
            let first = state.waiting.pop_front();
            state.playing.extend(first);
            return None;
        }
        state = inner.wait(state);
    }
}

impl Drop for Handle {
    fn drop(&mut self) {
        self.inner.state().is_closing = true;
        self.inner.changed.notify_all();
        if let Some(conductor) = self.conductor.take() {
            let _ = conductor.join();
        }
    }
}
