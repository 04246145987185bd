//! A compiled action: sections of steps, waits for bumpers between them, and what is done instead of the
//! rest.

use rsapien_protocol::{BumperMask, Mode, MotionReport};
use rsapien_registry::{CompiledAction, Reaction, Wait};

use super::outcome::{Outcome, PlayReport, Progress, StepReached, interruption};
use super::run::ask;
use super::source::POLL_MS;
use super::{Floor, PlayOptions, ProgressSink};
use crate::line::Line;
use crate::{Error, Interruption};

/// Plays `action` to its end on `floor`.
pub(crate) fn perform(
    floor: &dyn Floor,
    action: &CompiledAction,
    options: &mut PlayOptions<'_>,
) -> Result<PlayReport, Error> {
    let first = first_step(action, options.from_label.as_deref())?;
    if action.steps.is_empty() && action.waits.is_empty() {
        // Refused as an action without steps is.
        return floor.play(&[], options, floor.stop_generation());
    }
    let mut told = Performance {
        floor,
        line: floor.line(),
        action,
        on_progress: options.on_progress.take(),
        begun_ms: floor.line().now_ms(),
        stop_generation: floor.stop_generation(),
        report: PlayReport {
            outcome: Outcome::Done,
            reached: None,
            instead: None,
            action: action.name.clone(),
            steps_ended: 0,
            steps_accepted: 0,
            steps_total: action.steps.len() - first,
            elapsed_ms: 0,
            pauses: 0,
            before: None,
            evidence: None,
        },
        first,
    };
    let played = told.sections(options);
    options.on_progress = told.on_progress.take();
    played?;
    told.report.elapsed_ms = told.line.now_ms().saturating_sub(told.begun_ms);
    Ok(told.report)
}

/// The step at a label.
fn first_step(action: &CompiledAction, label: Option<&str>) -> Result<usize, Error> {
    let Some(label) = label else { return Ok(0) };
    let found = action.labels.iter().find(|known| &*known.name == label);
    found.map(|known| known.step).ok_or_else(|| {
        let mut names: Vec<String> =
            action.labels.iter().map(|known| known.name.to_string()).collect();
        names.dedup();
        Error::UnknownLabel { action: action.name.clone(), label: label.to_owned(), names }
    })
}

struct Performance<'a, 'o> {
    floor: &'a dyn Floor,
    line: &'a Line,
    action: &'a CompiledAction,
    on_progress: Option<ProgressSink<'o>>,
    begun_ms: u64,
    /// STOP since then ends it, and nothing is played after it.
    stop_generation: u64,
    report: PlayReport,
    /// The first step that is played.
    first: usize,
}

impl Performance<'_, '_> {
    fn sections(&mut self, options: &PlayOptions<'_>) -> Result<(), Error> {
        let waits: Vec<&Wait> =
            self.action.waits.iter().filter(|wait| wait.before_step >= self.first).collect();
        let mut next = self.first;
        for wait in waits {
            self.section(next, wait.before_step, false, options)?;
            if !self.report.outcome.is_done() {
                return Ok(());
            }
            next = wait.before_step;
            self.wait(wait, options)?;
            if !self.report.outcome.is_done() {
                return Ok(());
            }
        }
        self.section(next, self.action.steps.len(), true, options)
    }

    /// Plays the steps from `from` to before `to`.
    fn section(
        &mut self,
        from: usize,
        to: usize,
        is_last: bool,
        options: &PlayOptions<'_>,
    ) -> Result<(), Error> {
        let steps = self.action.steps.get(from..to).unwrap_or_default();
        if steps.is_empty() {
            return Ok(());
        }
        let (report, on_progress) = {
            let mut sink = self.on_progress.take();
            let tell = self.teller();
            let mut own = PlayOptions {
                cancel: options.cancel.clone(),
                pause: options.pause.clone(),
                from_label: None,
                on_progress: sink.as_mut().map(|sink| -> ProgressSink<'_> {
                    Box::new(move |progress| sink(&tell.of_section(from, progress)))
                }),
                wait_for_rest: options.wait_for_rest || !is_last,
            };
            let report = self.floor.play(steps, &mut own, self.stop_generation);
            drop(own);
            (report, sink)
        };
        self.on_progress = on_progress;
        let report = report?;
        self.report.steps_ended += report.steps_ended;
        self.report.steps_accepted += report.steps_accepted;
        self.report.pauses += report.pauses;
        self.report.before = self.report.before.or(report.before);
        self.report.evidence = report.evidence.or(self.report.evidence);
        self.report.outcome = report.outcome;
        if self.report.outcome.is_done() {
            return Ok(());
        }
        let index = (from + report.steps_ended).min(to.saturating_sub(1));
        self.reach(index);
        if let Outcome::Interrupted { by: Interruption::Bumper(pressed) } = &self.report.outcome {
            let reactions = self.action.reactions.get(index).copied().unwrap_or_default();
            self.react(reactions.to(*pressed), options)?;
        }
        Ok(())
    }

    fn reach(&mut self, index: usize) {
        let source = self.action.sources.get(index);
        self.report.reached =
            source.map(|source| StepReached { number: index + 1, source: source.clone() });
    }

    /// Plays what a reaction asks for instead of the rest. The hold of a bumper is released for it.
    fn react(&mut self, reaction: Reaction, options: &PlayOptions<'_>) -> Result<(), Error> {
        let Reaction::Play(index) = reaction else { return Ok(()) };
        let Some(handler) = self.action.handlers.get(index) else { return Ok(()) };
        // A STOP of somebody else is not to be followed by a motion.
        if self.floor.ended().is_some()
            || options.cancel.is_cancelled()
            || !self.floor.release(self.stop_generation)
        {
            return Ok(());
        }
        let mut sink = self.on_progress.take();
        let mut own = PlayOptions {
            cancel: options.cancel.clone(),
            pause: options.pause.clone(),
            from_label: None,
            on_progress: sink.as_mut().map(|sink| -> ProgressSink<'_> {
                Box::new(move |told| sink(&Progress { handler: Some(index), ..*told }))
            }),
            wait_for_rest: options.wait_for_rest,
        };
        let instead = perform(self.floor, handler, &mut own);
        drop(own);
        self.on_progress = sink;
        self.report.instead = Some(Box::new(instead?));
        Ok(())
    }

    /// Watches the bumpers. A press is seen by the robot's count of presses, however short it is.
    fn wait(&mut self, wait: &Wait, options: &PlayOptions<'_>) -> Result<(), Error> {
        let mut own_stops = self.floor.own_stops();
        let mut begun = match ask(self.line) {
            Ok(report) => report,
            Err(error) => return self.end_wait_without_link(wait, error),
        };
        self.report.before = self.report.before.or(Some(begun));
        let until_ms = self.line.now_ms().saturating_add(u64::from(wait.limit_ms));
        let tell = self.teller();
        if let Some(sink) = &mut self.on_progress {
            sink(&tell.of_wait(wait));
        }
        let mut latest = begun;
        loop {
            self.report.evidence = Some(latest);
            let is_cancelled = options.cancel.is_cancelled();
            let ended = is_cancelled.then_some(Interruption::Cancelled).or(self.floor.ended());
            if let Some(by) = ended {
                self.end_wait(wait, by);
                return Ok(());
            }
            if self.floor.own_stops() != own_stops {
                // The floor stopped the robot for another action, which ended; this one goes on.
                own_stops = self.floor.own_stops();
                begun = MotionReport { mode: latest.mode, ..begun };
            }
            if let Some(by) = interruption(&begun, &latest, BumperMask::NONE) {
                // Before the first step the robot may well stand stopped or held.
                let stood_so = begun.mode == latest.mode && begun.boot == latest.boot;
                if !stood_so {
                    self.end_wait(wait, by);
                    return Ok(());
                }
            }
            if self.floor.stop_generation() != self.stop_generation {
                self.end_wait(wait, Interruption::Stop);
                return Ok(());
            }
            if is_pressed(wait.bumpers, &begun, &latest) {
                return Ok(());
            }
            let now_ms = self.line.now_ms();
            if now_ms >= until_ms {
                break;
            }
            self.line.sleep_ms(POLL_MS.min(until_ms - now_ms))?;
            latest = match ask(self.line) {
                Ok(report) => report,
                Err(error) => return self.end_wait_without_link(wait, error),
            };
        }
        if wait.otherwise == Reaction::GoOn {
            return Ok(());
        }
        self.end_wait(wait, Interruption::WaitInVain(wait.bumpers));
        let stands = matches!(latest.mode, Mode::Idle | Mode::Stopped);
        if stands { self.react(wait.otherwise, options) } else { Ok(()) }
    }

    fn end_wait(&mut self, wait: &Wait, by: Interruption) {
        self.report.outcome = Outcome::Interrupted { by };
        self.report.reached =
            Some(StepReached { number: wait.before_step + 1, source: wait.source.clone() });
    }

    fn end_wait_without_link(&mut self, wait: &Wait, error: Error) -> Result<(), Error> {
        match error {
            Error::NoAnswer { .. } | Error::LinkLost { .. } => {
                self.end_wait(wait, Interruption::LinkLost);
                Ok(())
            }
            _ => Err(error),
        }
    }

    fn teller(&self) -> Teller {
        Teller {
            labels: self.action.labels.iter().map(|label| label.step).collect(),
            first: self.first,
            steps_total: self.report.steps_total,
            total_ms: self
                .action
                .steps
                .iter()
                .skip(self.first)
                .map(|it| u64::from(it.duration_ms))
                .sum(),
            begun_ms: self.begun_ms,
            now_ms: self.line.now_ms(),
        }
    }
}

/// Whether one of `bumpers` is pressed, or was since `begun`.
fn is_pressed(bumpers: BumperMask, begun: &MotionReport, latest: &MotionReport) -> bool {
    let counts = begun.presses.iter().zip(&latest.presses);
    let counted =
        counts.enumerate().any(|(index, (before, now))| bumpers.contains(index) && before != now);
    counted || !latest.bumpers.intersection(bumpers).is_empty()
}

/// Makes of a section's progress that of the whole action.
struct Teller {
    labels: Vec<usize>,
    first: usize,
    steps_total: usize,
    total_ms: u64,
    begun_ms: u64,
    now_ms: u64,
}

impl Teller {
    fn of_section(&self, from: usize, section: &Progress) -> Progress {
        let ended = from - self.first + section.steps_ended;
        Progress {
            steps_ended: ended,
            steps_total: self.steps_total,
            elapsed_ms: self.now_ms.saturating_sub(self.begun_ms) + section.elapsed_ms,
            total_ms: self.total_ms,
            label: self.label(self.first + ended),
            ..*section
        }
    }

    fn of_wait(&self, wait: &Wait) -> Progress {
        Progress {
            steps_ended: wait.before_step - self.first,
            steps_total: self.steps_total,
            elapsed_ms: self.now_ms.saturating_sub(self.begun_ms),
            total_ms: self.total_ms,
            label: self.label(wait.before_step),
            waiting_for: wait.bumpers,
            is_paused: false,
            handler: None,
        }
    }

    /// The last label at or before a step.
    fn label(&self, step: usize) -> Option<usize> {
        self.labels.partition_point(|at| *at <= step).checked_sub(1)
    }
}
