//! Where a run of the player has its steps from: a list of them, or several actions side by side.

use rsapien_protocol::{BumperMask, MotionReport, Step};

use super::outcome::{Progress, ending_bumpers};
use super::{PauseSwitch, PlayOptions};
use crate::Error;
use crate::line::Line;

/// What a run knows of the robot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    /// Steps that the robot has accepted.
    pub(crate) accepted: usize,
    /// Those of them that it has ended.
    pub(crate) ended: usize,
    /// Its last report.
    pub(crate) latest: MotionReport,
    /// The line's clock.
    pub(crate) now_ms: u64,
}

impl Seen {
    /// Whether the robot takes another step. It is asked once without being known to have a place.
    pub(crate) const fn has_room(&self) -> bool {
        self.accepted == 0 || self.latest.queue_free > 0
    }

    /// Whether everything accepted has ended and no motor runs.
    pub(crate) const fn stands(&self) -> bool {
        self.ended == self.accepted && self.latest.motors == 0
    }
}

/// Gives a run its steps, and is told what became of them.
pub(crate) trait Source {
    /// The step to send now; none while nothing is to be sent. It is asked again until it was accepted.
    fn next(&mut self, seen: &Seen) -> Option<Step>;
    /// The robot accepted the step that was given last. `ran_dry`: it had ended all before it.
    fn accepted(&mut self, seen: &Seen, ran_dry: bool);
    /// The robot reported.
    fn told(&mut self, seen: &Seen);
    /// Whether the robot has done all there is to do.
    fn is_over(&self, seen: &Seen) -> bool;
    /// Whether the caller wants it to end.
    fn is_cancelled(&self) -> bool;
    /// The bumpers that may end what was sent.
    fn ending_bumpers(&self) -> BumperMask;
    /// Whether there is more than the first `count` steps, for all that is known.
    fn has_more_than(&self, count: usize) -> bool;
    /// How long everything behind the step under way lasts, in ms.
    fn left_ms(&self, ended: usize) -> u64;
    /// How long nothing can happen that matters, in ms.
    fn sleep_ms(&self, seen: &Seen) -> u64;
    /// Stops the robot.
    fn stop(&self, line: &Line) -> Result<(), Error>;
}

/// How often the state is asked for while there is nothing to send, in ms.
pub(crate) const POLL_MS: u64 = 50;
/// The shortest sleep, in ms: less than a package takes.
const SLEEP_MS_MIN: u64 = 5;
/// Where a step is queued one ahead only, the next has to come soon after one has ended.
pub(crate) const POLL_AHEAD_MS: u64 = POLL_MS / 5;

/// Steps that are all known at the beginning.
pub(super) struct List<'a, 'o> {
    steps: &'a [Step],
    options: &'a mut PlayOptions<'o>,
    total_ms: u64,
    begun_ms: u64,
    told_ended: Option<usize>,
    /// How often the robot's queue ran dry.
    pub(super) pauses: usize,
    /// Whether nothing was sent for a pause since the last step.
    was_paused: bool,
}

impl<'a, 'o> List<'a, 'o> {
    pub(super) fn new(steps: &'a [Step], options: &'a mut PlayOptions<'o>) -> List<'a, 'o> {
        let total_ms = duration_ms(steps);
        List {
            steps,
            options,
            total_ms,
            begun_ms: 0,
            told_ended: None,
            pauses: 0,
            was_paused: false,
        }
    }

    fn tell_progress(&mut self, seen: &Seen) {
        let progress = Progress {
            steps_ended: seen.ended,
            steps_total: self.steps.len(),
            elapsed_ms: seen.now_ms.saturating_sub(self.begun_ms),
            total_ms: self.total_ms,
            label: None,
            waiting_for: BumperMask::NONE,
            is_paused: self.was_paused,
            handler: None,
        };
        if let Some(on_progress) = self.options.on_progress.as_mut() {
            on_progress(&progress);
        }
    }
}

impl Source for List<'_, '_> {
    fn next(&mut self, seen: &Seen) -> Option<Step> {
        if let Some(pause) = &self.options.pause {
            if pause.is_paused() {
                if seen.stands() && !self.was_paused {
                    self.was_paused = true;
                    self.tell_progress(seen);
                }
                return None;
            }
            if seen.accepted >= seen.ended + 2 {
                return None;
            }
        }
        self.steps.get(seen.accepted).copied().filter(|_| seen.has_room())
    }

    fn accepted(&mut self, _seen: &Seen, ran_dry: bool) {
        self.pauses += usize::from(ran_dry && !self.was_paused);
        self.was_paused = false;
    }

    fn told(&mut self, seen: &Seen) {
        if self.told_ended != Some(seen.ended) {
            if self.told_ended.is_none() {
                self.begun_ms = seen.now_ms;
            }
            self.told_ended = Some(seen.ended);
            self.tell_progress(seen);
        }
    }

    fn is_over(&self, seen: &Seen) -> bool {
        let rests = seen.latest.motors == 0 || !self.options.wait_for_rest;
        seen.ended == self.steps.len() && rests
    }

    fn is_cancelled(&self) -> bool {
        self.options.cancel.is_cancelled()
    }

    fn ending_bumpers(&self) -> BumperMask {
        ending_bumpers(self.steps)
    }

    fn has_more_than(&self, count: usize) -> bool {
        count < self.steps.len()
    }

    fn left_ms(&self, ended: usize) -> u64 {
        duration_ms(self.steps.get(ended + 1..).unwrap_or_default())
    }

    fn sleep_ms(&self, seen: &Seen) -> u64 {
        if self.options.pause.is_some() {
            return POLL_AHEAD_MS;
        }
        let elapsed_ms = seen.now_ms.saturating_sub(self.begun_ms);
        self.total_ms.saturating_sub(elapsed_ms).clamp(SLEEP_MS_MIN, POLL_MS)
    }

    fn stop(&self, line: &Line) -> Result<(), Error> {
        line.stop()
    }
}

/// Whether a switch is there and set.
pub(crate) fn is_paused(switch: Option<&PauseSwitch>) -> bool {
    switch.is_some_and(PauseSwitch::is_paused)
}

/// What the steps' durations sum up to, in ms.
pub(crate) fn duration_ms(steps: &[Step]) -> u64 {
    steps.iter().map(|step| u64::from(step.duration_ms)).sum()
}
