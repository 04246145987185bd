//! One run of the player.

use rsapien_protocol::{Address, Mode, MotionReport, Report, Request, Status, Step};

use super::outcome::{Outcome, PlayReport, interruption};
use super::source::{List, POLL_MS, Seen, Source};
use super::{PlayOptions, check};
use crate::line::{Answer, Line};
use crate::{Error, Interruption};

/// Plays `steps` to their end; STOP since `stop_generation` ends them.
pub(crate) fn play(
    line: &Line,
    steps: &[Step],
    options: &mut PlayOptions<'_>,
    stop_generation: u64,
) -> Result<PlayReport, Error> {
    check(steps)?;
    let replaces = steps.first().is_some_and(|step| step.replace);
    let mut list = List::new(steps, options);
    let run = run(line, &mut list, replaces, stop_generation)?;
    Ok(PlayReport {
        outcome: run.outcome,
        reached: None,
        instead: None,
        action: String::new(),
        before: Some(run.before),
        steps_ended: run.ended,
        steps_accepted: run.accepted,
        steps_total: steps.len(),
        elapsed_ms: line.now_ms().saturating_sub(run.begun_ms),
        pauses: list.pauses,
        evidence: Some(run.latest),
    })
}

/// How a run ended.
pub(crate) struct RunEnd {
    pub(crate) outcome: Outcome,
    pub(crate) before: MotionReport,
    pub(crate) latest: MotionReport,
    pub(crate) accepted: usize,
    pub(crate) ended: usize,
    pub(crate) begun_ms: u64,
}

/// Sends what `source` gives until it is over or something ends it, STOP since `stop_generation` among
/// it. What the robot is doing ends first, unless the first step replaces it.
pub(crate) fn run(
    line: &Line,
    source: &mut dyn Source,
    replaces: bool,
    stop_generation: u64,
) -> Result<RunEnd, Error> {
    let before = wait_until_free(line, source, replaces)?;
    let mut run =
        Run { line, source, stop_generation, before, latest: before, accepted: 0, ended: 0 };
    let begun_ms = line.now_ms();
    run.tell();
    let outcome = run.run()?;
    let Run { latest, accepted, ended, .. } = run;
    Ok(RunEnd { outcome, before, latest, accepted, ended, begun_ms })
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

/// Waits until what the robot is doing has ended.
fn wait_until_free(
    line: &Line,
    source: &dyn Source,
    replaces: bool,
) -> Result<MotionReport, Error> {
    loop {
        let report = ask(line)?;
        let is_busy = matches!(report.mode, Mode::Initialising | Mode::Executing);
        // A cancelled action is told from the run, which stops the motors first.
        if !is_busy || replaces || source.is_cancelled() {
            return Ok(report);
        }
        line.sleep_ms(POLL_MS)?;
    }
}

struct Run<'a> {
    line: &'a Line,
    source: &'a mut dyn Source,
    /// STOP since then ends the action, even before the robot tells of it.
    stop_generation: u64,
    before: MotionReport,
    latest: MotionReport,
    accepted: usize,
    ended: usize,
}

impl Run<'_> {
    fn seen(&self) -> Seen {
        let Run { accepted, ended, latest, line, .. } = self;
        Seen { accepted: *accepted, ended: *ended, latest: *latest, now_ms: line.now_ms() }
    }

    fn tell(&mut self) {
        let seen = self.seen();
        self.source.told(&seen);
    }

    fn run(&mut self) -> Result<Outcome, Error> {
        loop {
            if self.source.is_cancelled() {
                return Ok(self.end_cancelled());
            }
            let seen = self.seen();
            let told = if let Some(step) = self.source.next(&seen) {
                self.send(step)
            } else {
                self.line.sleep_ms(self.source.sleep_ms(&seen))?;
                self.ask_twice().map(|report| self.take(report))
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
                // Every step before it had ended when it came.
                let ran_dry =
                    self.accepted > 0 && self.ended + self.newly_ended(&report) >= self.accepted;
                let seen = self.seen();
                self.source.accepted(&seen, ran_dry);
                self.accepted += 1;
                Ok(self.take(report))
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
            let _ = self.source.stop(self.line);
        }
        Outcome::Refused { status }
    }

    /// Takes a report. The outcome, if it tells that the action has ended.
    fn take(&mut self, report: MotionReport) -> Option<Outcome> {
        let newly_ended = self.newly_ended(&report);
        let was_interrupted = self.interrupted(&report);
        self.latest = report;
        // A reset sets the count to zero.
        if !matches!(was_interrupted, Some(Interruption::Reset(_))) && newly_ended > 0 {
            if self.ended + newly_ended > self.accepted {
                return Some(self.end_unaccounted());
            }
            self.ended += newly_ended;
        }
        self.tell();
        if let Some(by) = was_interrupted {
            return Some(Outcome::Interrupted { by });
        }
        if report.mode != Mode::Idle || self.accepted == 0 {
            return None;
        }
        if self.ended < self.accepted {
            return Some(self.end_unaccounted());
        }
        self.source.is_over(&self.seen()).then_some(Outcome::Done)
    }

    fn newly_ended(&self, report: &MotionReport) -> usize {
        usize::from(report.steps_ended.wrapping_sub(self.latest.steps_ended))
    }

    fn interrupted(&self, report: &MotionReport) -> Option<Interruption> {
        // Before the first step was accepted, the robot may well stand stopped or held.
        if self.accepted == 0 && report.boot == self.before.boot {
            return None;
        }
        let by = interruption(&self.before, report, self.source.ending_bumpers())?;
        let is_cancelled = by == Interruption::Stop && self.source.is_cancelled();
        Some(if is_cancelled { Interruption::Cancelled } else { by })
    }

    /// The robot's count does not fit to what it was sent: steps are missing, or not ours.
    fn end_unaccounted(&self) -> Outcome {
        let is_stopped = self.line.stop_generation() != self.stop_generation;
        let _ = self.source.stop(self.line);
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
        match self.source.stop(self.line) {
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
            let is_cancelled = self.source.is_cancelled();
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
                let _ = self.source.stop(self.line);
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
        let cannot_be_done = self.source.has_more_than(arrived) || self.is_cut_by_the_dead_man();
        // Nothing can be done but to try; silence ends motion all the same.
        let _ = self.source.stop(self.line);
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
        self.source.left_ms(self.ended) > silent_ms.saturating_add(dead_man_ms)
    }

    /// Asks for the state, and once more when no answer comes: another program that sends STOP may
    /// take answers away, and what it did is worth knowing.
    fn ask_twice(&self) -> Result<MotionReport, Error> {
        match ask(self.line) {
            Err(Error::NoAnswer { .. }) => ask(self.line),
            other => other,
        }
    }
}
