//! One run of the player.

use rsapien_protocol::{Address, BumperMask, Mode, MotionReport, Report, Request, Status, Step};

use super::outcome::{Outcome, PlayReport, Progress, ending_bumpers, interruption};
use super::{PlayOptions, check};
use crate::line::{Answer, Line};
use crate::{Error, Interruption};

/// How often the state is asked for while the player has nothing to send, in ms.
pub(super) const POLL_MS: u64 = 50;
/// The shortest sleep, in ms: less than a package takes.
const SLEEP_MS_MIN: u64 = 5;

/// Plays `steps` to their end.
pub(crate) fn play(
    line: &Line,
    steps: &[Step],
    options: &mut PlayOptions<'_>,
) -> Result<PlayReport, Error> {
    check(steps)?;
    let before = wait_until_free(line, steps, options)?;
    let mut run = Run {
        line,
        steps,
        options,
        stop_generation: line.stop_generation(),
        ending: ending_bumpers(steps),
        total_ms: steps.iter().map(|step| u64::from(step.duration_ms)).sum(),
        begun_ms: line.now_ms(),
        before,
        latest: before,
        accepted: 0,
        ended: 0,
        pauses: 0,
        was_paused: false,
    };
    run.tell_progress();
    let outcome = run.run()?;
    Ok(PlayReport {
        outcome,
        reached: None,
        instead: None,
        action: String::new(),
        before: Some(before),
        steps_ended: run.ended,
        steps_accepted: run.accepted,
        steps_total: steps.len(),
        elapsed_ms: line.now_ms().saturating_sub(run.begun_ms),
        pauses: run.pauses,
        evidence: Some(run.latest),
    })
}

/// Asks the motion controller for its state.
pub(super) fn ask(line: &Line) -> Result<MotionReport, Error> {
    let package = line.request(Address::Motion, Request::State)?.accepted()?;
    let Report::Motion(report) = package.report else {
        let kind = Request::State.kind();
        return Err(Error::BadReport { address: Address::Motion, kind });
    };
    Ok(report)
}

/// Waits until what the robot is doing has ended, unless the first step replaces it.
fn wait_until_free(
    line: &Line,
    steps: &[Step],
    options: &PlayOptions<'_>,
) -> Result<MotionReport, Error> {
    let replaces = steps.first().is_some_and(|step| step.replace);
    loop {
        let report = ask(line)?;
        let is_busy = matches!(report.mode, Mode::Initialising | Mode::Executing);
        // A cancelled action is told from the run, which stops the motors first.
        if !is_busy || replaces || options.cancel.is_cancelled() {
            return Ok(report);
        }
        line.sleep_ms(POLL_MS)?;
    }
}

struct Run<'a, 'o> {
    line: &'a Line,
    steps: &'a [Step],
    options: &'a mut PlayOptions<'o>,
    /// STOP since then ends the action, even before the robot tells of it.
    stop_generation: u64,
    ending: BumperMask,
    total_ms: u64,
    begun_ms: u64,
    before: MotionReport,
    latest: MotionReport,
    accepted: usize,
    ended: usize,
    pauses: usize,
    /// Whether nothing was sent for a pause since the last step.
    was_paused: bool,
}

impl Run<'_, '_> {
    fn run(&mut self) -> Result<Outcome, Error> {
        loop {
            if self.options.cancel.is_cancelled() {
                return Ok(self.end_cancelled());
            }
            let next = self.steps.get(self.accepted).copied();
            let may_send = self.may_send();
            let told = match next {
                Some(step) if may_send => self.send(step),
                _ => {
                    self.line.sleep_ms(self.sleep_ms())?;
                    self.ask_twice().map(|report| self.take(report))
                }
            };
            let outcome = match told {
                Ok(outcome) => outcome,
                Err(error) => Some(self.end_failed(error)?),
            };
            if let Some(outcome) = outcome {
                return Ok(outcome);
            }
        }
    }

    /// Whether the next step may be sent now.
    fn may_send(&mut self) -> bool {
        let Some(pause) = &self.options.pause else {
            return self.accepted == 0 || self.latest.queue_free > 0;
        };
        if pause.is_paused() {
            let stands = self.ended == self.accepted && self.latest.motors == 0;
            if stands && !self.was_paused {
                self.was_paused = true;
                self.tell_progress();
            }
            return false;
        }
        let has_room = self.accepted == 0 || self.latest.queue_free > 0;
        has_room && self.accepted < self.ended + 2
    }

    /// Sends the next step. The outcome, if that ended the action.
    fn send(&mut self, step: Step) -> Result<Option<Outcome>, Error> {
        let request = Request::Step(step);
        let answer =
            self.line.request_before_stop(Address::Motion, request, self.stop_generation)?;
        let Answer { package, .. } = answer;
        let Report::Motion(report) = package.report else {
            return answer.accepted().map(|_| None);
        };
        match package.status {
            Status::Accepted => {
                let sent_before = self.accepted;
                self.accepted += 1;
                let outcome = self.take(report);
                // Every step before it had ended when it came.
                let ran_dry = sent_before > 0 && self.ended >= sent_before;
                self.pauses += usize::from(ran_dry && !self.was_paused);
                self.was_paused = false;
                Ok(outcome)
            }
            Status::QueueFull => Ok(self.take(MotionReport { queue_free: 0, ..report })),
            status => Ok(Some(self.end_refused(status, report))),
        }
    }

    fn end_refused(&mut self, status: Status, report: MotionReport) -> Outcome {
        if let Some(by) = self.interrupted(&report) {
            self.latest = report;
            return Outcome::Interrupted { by };
        }
        // Another program has taken the session: the robot is its, now.
        let is_ours = !matches!(status, Status::NoSession | Status::OutOfSequence);
        if self.accepted > 0 && is_ours {
            let _ = self.line.stop();
        }
        Outcome::Refused { status }
    }

    /// Takes a report. The outcome, if it tells that the action has ended.
    fn take(&mut self, report: MotionReport) -> Option<Outcome> {
        let newly_ended = usize::from(report.steps_ended.wrapping_sub(self.latest.steps_ended));
        let was_interrupted = self.interrupted(&report);
        self.latest = report;
        // A reset sets the count to zero.
        if !matches!(was_interrupted, Some(Interruption::Reset(_))) && newly_ended > 0 {
            if self.ended + newly_ended > self.accepted {
                return Some(self.end_unaccounted());
            }
            self.ended += newly_ended;
            self.tell_progress();
        }
        if let Some(by) = was_interrupted {
            return Some(Outcome::Interrupted { by });
        }
        if report.mode != Mode::Idle || self.accepted == 0 {
            return None;
        }
        if self.ended < self.accepted {
            return Some(self.end_unaccounted());
        }
        let rests = report.motors == 0 || !self.options.wait_for_rest;
        (self.ended == self.steps.len() && rests).then_some(Outcome::Done)
    }

    fn interrupted(&self, report: &MotionReport) -> Option<Interruption> {
        // Before the first step was accepted, the robot may well stand stopped or held.
        if self.accepted == 0 && report.boot == self.before.boot {
            return None;
        }
        let by = interruption(&self.before, report, self.ending)?;
        let is_cancelled = by == Interruption::Stop && self.options.cancel.is_cancelled();
        Some(if is_cancelled { Interruption::Cancelled } else { by })
    }

    /// The robot's count does not fit to what it was sent: steps are missing, or not ours.
    fn end_unaccounted(&self) -> Outcome {
        let is_stopped = self.line.stop_generation() != self.stop_generation;
        let _ = self.line.stop();
        if is_stopped {
            return Outcome::Interrupted { by: Interruption::Stop };
        }
        let why = format!(
            "the robot's count of ended steps does not fit to the {} it accepted: another program \
             stopped or initialised it, or sent it steps",
            self.accepted
        );
        Outcome::Unknown { why }
    }

    fn end_cancelled(&self) -> Outcome {
        if self.accepted == 0 && !matches!(self.before.mode, Mode::Initialising | Mode::Executing) {
            return Outcome::Interrupted { by: Interruption::Cancelled };
        }
        match self.line.stop() {
            Ok(()) => Outcome::Interrupted { by: Interruption::Cancelled },
            Err(error) => {
                let why = format!("it was cancelled, but STOP was not confirmed: {error}");
                Outcome::Unknown { why }
            }
        }
    }

    /// What a request that failed makes of the action.
    fn end_failed(&mut self, error: Error) -> Result<Outcome, Error> {
        if self.line.stop_generation() != self.stop_generation {
            let is_cancelled = self.options.cancel.is_cancelled();
            let by = if is_cancelled { Interruption::Cancelled } else { Interruption::Stop };
            return Ok(Outcome::Interrupted { by });
        }
        match error {
            Error::Refused { status, .. } => Ok(Outcome::Refused { status }),
            Error::OutcomeUnknown { .. } => {
                let Ok(report) = ask(self.line) else {
                    return Ok(self.end_without_link(&error, self.accepted + 1));
                };
                if let Some(by) = self.interrupted(&report) {
                    self.latest = report;
                    return Ok(Outcome::Interrupted { by });
                }
                let _ = self.line.stop();
                Ok(Outcome::Unknown { why: error.to_string() })
            }
            Error::NoAnswer { .. } | Error::LinkLost { .. } => {
                Ok(self.end_without_link(&error, self.accepted))
            }
            other => Err(other),
        }
    }

    /// The robot cannot be asked; at most `arrived` steps have reached it.
    fn end_without_link(&self, error: &Error, arrived: usize) -> Outcome {
        let cannot_be_done = arrived < self.steps.len() || self.is_cut_by_the_dead_man();
        // Nothing can be done but to try; silence ends motion all the same.
        let _ = self.line.stop();
        if cannot_be_done {
            return Outcome::Interrupted { by: Interruption::LinkLost };
        }
        // With every step in its queue, the robot may have done them all.
        Outcome::Unknown { why: error.to_string() }
    }

    /// Whether the steps left at the last report last longer than the robot can have gone on since,
    /// with nothing heard.
    fn is_cut_by_the_dead_man(&self) -> bool {
        let state = self.line.state();
        let dead_man_ms = match state.motion_information {
            None => return false,
            Some(information) if information.dead_man_ms == 0 => return false,
            Some(information) => u64::from(information.dead_man_ms),
        };
        let Some(last) = state.motion else { return false };
        let silent_ms = self.line.now_ms().saturating_sub(last.time_ms);
        let left = self.steps.iter().skip(self.ended + 1);
        let left_ms: u64 = left.map(|step| u64::from(step.duration_ms)).sum();
        left_ms > silent_ms.saturating_add(dead_man_ms)
    }

    /// Asks for the state, and once more when no answer comes: another program that sends STOP may
    /// take answers away, and what it did is worth knowing.
    fn ask_twice(&self) -> Result<MotionReport, Error> {
        match ask(self.line) {
            Err(Error::NoAnswer { .. }) => ask(self.line),
            other => other,
        }
    }

    /// Until the action should have ended, at most until the next poll.
    fn sleep_ms(&self) -> u64 {
        if self.options.pause.is_some() {
            // One step ahead only: the next has to come soon after this one has ended.
            return POLL_MS / 5;
        }
        let elapsed_ms = self.line.now_ms().saturating_sub(self.begun_ms);
        let left_ms = self.total_ms.saturating_sub(elapsed_ms);
        left_ms.clamp(SLEEP_MS_MIN, POLL_MS)
    }

    fn tell_progress(&mut self) {
        let progress = Progress {
            steps_ended: self.ended,
            steps_total: self.steps.len(),
            elapsed_ms: self.line.now_ms().saturating_sub(self.begun_ms),
            total_ms: self.total_ms,
            label: None,
            waiting_for: BumperMask::NONE,
            is_paused: self.was_paused,
        };
        if let Some(on_progress) = self.options.on_progress.as_mut() {
            on_progress(&progress);
        }
    }
}
