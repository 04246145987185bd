//! The stage's thread: plays what is on the stage, as one row of slices.

use std::sync::mpsc::{Sender, SyncSender, sync_channel};

use rsapien_protocol::{BumperMask, MotionReport, Step};

use super::{Inner, State};
use crate::line::Line;
use crate::player::{
    CancelToken, Outcome, POLL_AHEAD_MS, POLL_MS, PauseSwitch, Progress, RunEnd, Seen, Source,
    ending_bumpers, is_paused, run,
};
use crate::{Error, Interruption};

/// What lies in the robot's queue behind the slice under way, at least, in ms: longer than one more
/// takes on its way.
const AHEAD_MS: u64 = 100;

/// The steps that a performer plays right now.
pub(super) struct Stream {
    /// That of its part of the merge.
    pub(super) id: u64,
    pub(super) performer: u64,
    pub(super) joints: u8,
    pub(super) cancel: CancelToken,
    pub(super) pause: Option<PauseSwitch>,
    pub(super) wait_for_rest: bool,
    pub(super) begun_ms: u64,
    pub(super) total_ms: u64,
    pub(super) events: Sender<Event>,
    pub(super) before: Option<MotionReport>,
    pub(super) pauses: usize,
    pub(super) was_paused: bool,
    /// Whether it was told that it begins.
    pub(super) has_begun: bool,
}

/// What a performer is told of its steps.
pub(super) enum Event {
    /// How far they are; where it is there, the sender is used when that has been heard.
    Progress(Progress, Option<SyncSender<()>>),
    End(Result<StreamEnd, Error>),
}

/// How a performer's steps ended.
pub(super) struct StreamEnd {
    pub(super) outcome: Outcome,
    pub(super) before: Option<MotionReport>,
    pub(super) latest: MotionReport,
    pub(super) accepted: usize,
    pub(super) ended: usize,
    pub(super) pauses: usize,
}

/// Plays what comes onto the stage until it closes.
pub(super) fn conduct(inner: &Inner) {
    loop {
        let run_generation = {
            let mut state = inner.state();
            while state.streams.is_empty() {
                if state.is_closing {
                    return;
                }
                state = inner.wait(state);
            }
            state.run_generation
        };
        let own_stops = *inner.own_stops();
        let mut conductor = Conductor { inner, ended: 0, accepted: 0, queue_ends_ms: 0 };
        let end = run(&inner.robot.line, &mut conductor, false, run_generation);
        // The STOPs of this run, and whether there was another.
        let own = *inner.own_stops() - own_stops;
        let is_stopped = inner.robot.line.stop_generation() != run_generation + own;
        let mut state = inner.state();
        state.run_generation = run_generation + own;
        match end {
            Ok(end) => state.settle(&end, is_stopped),
            Err(error) => state.fail(error),
        }
    }
}

struct Conductor<'a> {
    inner: &'a Inner,
    /// Slices accepted and ended, as far as they are accounted for.
    accepted: usize,
    ended: usize,
    /// When the robot's queue will be empty.
    queue_ends_ms: u64,
}

/// What a performer is to be told of its progress, when nothing is locked any more.
type Telling = (Sender<Event>, Progress);

impl Conductor<'_> {
    /// Tells performers how far they are. With a virtual clock it waits until they have heard it, so that a run is the
    /// same each time; with a real one, whoever is slow to hear must not keep the robot waiting.
    fn tell(&self, tellings: Vec<Telling>) {
        let is_awaited = self.inner.robot.line.has_virtual_clock();
        for (events, progress) in tellings {
            let (heard, waiting) = sync_channel(1);
            // A performer that does not listen any more is gone.
            let is_there =
                events.send(Event::Progress(progress, is_awaited.then_some(heard))).is_ok();
            if is_there && is_awaited {
                let _ = waiting.recv();
            }
        }
    }
}

impl Source for Conductor<'_> {
    fn next(&mut self, seen: &Seen) -> Option<Step> {
        let tellings = self.inner.state().pauses(seen);
        self.tell(tellings);
        let mut state = self.inner.state();
        let is_ahead = seen.accepted >= seen.ended + 2 && state.merge.queued_ms() >= AHEAD_MS;
        if is_ahead || !seen.has_room() {
            return None;
        }
        let State { merge, streams, .. } = &mut *state;
        merge.propose(|part| {
            let stream = streams.iter().find(|stream| stream.id == part.id);
            let pause = stream.and_then(|stream| stream.pause.as_ref());
            !(part.is_at_a_step() && is_paused(pause))
        })
    }

    fn accepted(&mut self, seen: &Seen, ran_dry: bool) {
        self.accepted += 1;
        let mut state = self.inner.state();
        let State { merge, streams, .. } = &mut *state;
        let begun = |merge: &super::Merge, id| {
            merge.parts.iter().any(|part| part.id == id && part.accepted > 0)
        };
        let begun_before: Vec<u64> =
            streams.iter().map(|stream| stream.id).filter(|id| begun(merge, *id)).collect();
        let whose = merge.accept();
        self.queue_ends_ms = self.queue_ends_ms.max(seen.now_ms) + merge.latest_ms();
        for stream in streams.iter_mut().filter(|stream| whose.contains(&stream.id)) {
            stream.before.get_or_insert(seen.latest);
            let waited = ran_dry && !stream.was_paused && begun_before.contains(&stream.id);
            stream.pauses += usize::from(waited);
            stream.was_paused = false;
        }
    }

    fn told(&mut self, seen: &Seen) {
        let newly_ended = seen.ended.saturating_sub(self.ended);
        self.ended = seen.ended;
        let tellings = {
            let mut state = self.inner.state();
            let ended = state.merge.end(newly_ended);
            let begun = state.streams.iter_mut().filter(|stream| !stream.has_begun);
            let mut of: Vec<u64> = begun
                .map(|stream| {
                    stream.has_begun = true;
                    stream.id
                })
                .collect();
            of.extend(ended);
            of.into_iter().filter_map(|id| state.progress(id, seen.now_ms, false)).collect()
        };
        self.tell(tellings);
        self.inner.state().end_those_done(seen);
    }

    fn is_over(&self, _seen: &Seen) -> bool {
        self.inner.state().streams.is_empty()
    }

    fn is_cancelled(&self) -> bool {
        let state = self.inner.state();
        state.streams.iter().any(|stream| state.cancelled(stream).is_some())
    }

    fn ending_bumpers(&self) -> BumperMask {
        let state = self.inner.state();
        let bits = state
            .merge
            .parts
            .iter()
            .fold(0, |bits, part| bits | ending_bumpers(&part.steps).bits());
        BumperMask::from_low_bits(bits)
    }

    fn has_more_than(&self, count: usize) -> bool {
        let mut merge = self.inner.state().merge.clone();
        if count > self.accepted {
            merge.accept();
        }
        merge.parts.iter().any(|part| !part.is_sent())
    }

    fn left_ms(&self, _ended: usize) -> u64 {
        let state = self.inner.state();
        let longest_ms = state.merge.parts.iter().map(super::merge::Part::left_ms).max();
        state.merge.queued_ms() + longest_ms.unwrap_or(0)
    }

    fn sleep_ms(&self, seen: &Seen) -> u64 {
        let state = self.inner.state();
        if state.merge.parts.iter().all(super::merge::Part::is_sent) {
            let left_ms = self.queue_ends_ms.saturating_sub(seen.now_ms);
            return left_ms.clamp(POLL_AHEAD_MS / 2, POLL_MS);
        }
        // The next slice has to come before the queue is empty.
        state.merge.queued_ms().saturating_sub(AHEAD_MS / 2).clamp(POLL_AHEAD_MS, POLL_MS)
    }

    fn stop(&self, line: &Line) -> Result<(), Error> {
        let mut own_stops = self.inner.own_stops();
        *own_stops += 1;
        line.stop()
    }
}

impl State {
    /// What ends a stream before its time, if anything does.
    fn cancelled(&self, stream: &Stream) -> Option<Interruption> {
        let cancelled = stream.cancel.is_cancelled().then_some(Interruption::Cancelled);
        cancelled.or_else(|| self.ended_by(stream.performer))
    }

    /// What those are told who stand for a pause.
    fn pauses(&mut self, seen: &Seen) -> Vec<Telling> {
        let State { merge, streams, .. } = self;
        let mut standing = Vec::new();
        for stream in streams.iter_mut() {
            let part = merge.parts.iter().find(|part| part.id == stream.id);
            let stands = part.is_some_and(|part| part.is_at_a_step() && part.stands());
            let rests = seen.latest.motors & stream.joints == 0;
            if is_paused(stream.pause.as_ref()) && stands && rests && !stream.was_paused {
                stream.was_paused = true;
                standing.push(stream.id);
            }
        }
        standing.into_iter().filter_map(|id| self.progress(id, seen.now_ms, true)).collect()
    }

    fn progress(&self, id: u64, now_ms: u64, is_paused: bool) -> Option<Telling> {
        let part = self.merge.parts.iter().find(|part| part.id == id)?;
        let stream = self.streams.iter().find(|stream| stream.id == id)?;
        let progress = Progress {
            steps_ended: part.ended,
            steps_total: part.steps.len(),
            elapsed_ms: now_ms.saturating_sub(stream.begun_ms),
            total_ms: stream.total_ms,
            label: None,
            waiting_for: BumperMask::NONE,
            is_paused,
            handler: None,
        };
        Some((stream.events.clone(), progress))
    }

    fn end_those_done(&mut self, seen: &Seen) {
        let is_done = |stream: &Stream| {
            let rests = seen.latest.motors & stream.joints == 0 || !stream.wait_for_rest;
            let part = self.merge.parts.iter().find(|part| part.id == stream.id);
            rests && part.is_none_or(|part| part.is_sent() && part.stands())
        };
        let done: Vec<u64> =
            self.streams.iter().filter(|stream| is_done(stream)).map(|it| it.id).collect();
        for id in done {
            self.end(id, Outcome::Done, seen.latest);
        }
    }

    /// Ends the steps of one performer.
    fn end(&mut self, id: u64, outcome: Outcome, latest: MotionReport) {
        let stream = self.streams.iter().position(|stream| stream.id == id);
        let part = self.merge.parts.iter().position(|part| part.id == id);
        let (Some(stream), Some(part)) = (stream, part) else { return };
        let (stream, part) = (self.streams.remove(stream), self.merge.parts.remove(part));
        let end = StreamEnd {
            outcome,
            before: stream.before,
            latest,
            accepted: part.accepted,
            ended: part.ended,
            pauses: stream.pauses,
        };
        let _ = stream.events.send(Event::End(Ok(end)));
    }

    /// Tells everybody how the run ended, and keeps those for whom it goes on.
    fn settle(&mut self, end: &RunEnd, is_stopped: bool) {
        if is_stopped || matches!(end.outcome, Outcome::Interrupted { by: Interruption::Stop }) {
            self.halts += 1;
        }
        let is_for_one =
            !is_stopped && end.outcome == Outcome::Interrupted { by: Interruption::Cancelled };
        let ids: Vec<u64> = self.streams.iter().map(|stream| stream.id).collect();
        for id in ids {
            let Some(stream) = self.streams.iter().find(|stream| stream.id == id) else { continue };
            let cancelled = self.cancelled(stream);
            if is_for_one && cancelled.is_none() {
                continue;
            }
            let is_sent = self.merge.parts.iter().any(|part| part.id == id && part.is_sent());
            let outcome = outcome_of_one(&end.outcome, cancelled, is_sent);
            self.end(id, outcome, end.latest);
        }
        self.merge.rewind();
    }

    fn fail(&mut self, error: Error) {
        let mut error = Some(error);
        for stream in self.streams.drain(..) {
            let told = error.take().unwrap_or(Error::Closed);
            let _ = stream.events.send(Event::End(Err(told)));
        }
        self.merge.parts.clear();
        self.merge.rewind();
    }
}

/// What the end of a run is for one of those in it.
fn outcome_of_one(outcome: &Outcome, cancelled: Option<Interruption>, is_sent: bool) -> Outcome {
    match outcome {
        Outcome::Interrupted { by: Interruption::Stop | Interruption::Cancelled } => {
            Outcome::Interrupted { by: cancelled.unwrap_or(Interruption::Stop) }
        }
        // Others had more to send; of this one the robot may have done all.
        Outcome::Interrupted { by: Interruption::LinkLost } if is_sent => Outcome::Unknown {
            why: "the link was lost when all of it was in the robot's queue".to_owned(),
        },
        other => other.clone(),
    }
}
