//! The stage as the place where an action is performed.

use std::sync::mpsc::channel;

use rsapien_protocol::{Mode, Step};

use super::Inner;
use super::conductor::{Event, Stream, StreamEnd};
use super::merge::Part;
use crate::line::Line;
use crate::player::{self, Floor, PlayOptions, PlayReport, Progress, duration_ms};
use crate::{Error, Interruption};

/// The stage for one performer.
pub(super) struct StageFloor<'a> {
    pub(super) inner: &'a Inner,
    pub(super) id: u64,
    pub(super) joints: u8,
}

impl Floor for StageFloor<'_> {
    fn line(&self) -> &Line {
        &self.inner.robot.line
    }

    fn play(
        &self,
        steps: &[Step],
        options: &mut PlayOptions<'_>,
        stop_generation: u64,
    ) -> Result<PlayReport, Error> {
        player::check(steps)?;
        let (events, told) = channel();
        let begun_ms = self.line().now_ms();
        let total_ms = duration_ms(steps);
        let mut tell = |progress: &Progress| {
            if let Some(on_progress) = options.on_progress.as_mut() {
                on_progress(progress);
            }
        };
        {
            let own_stops = *self.inner.own_stops();
            let mut state = self.inner.state();
            if state.is_closing {
                return Err(Error::Closed);
            }
            if state.streams.is_empty() {
                state.run_generation = stop_generation + own_stops;
            }
            state.next_id += 1;
            let id = state.next_id;
            state.merge.parts.push(Part::new(id, steps.to_vec()));
            state.streams.push(Stream {
                id,
                performer: self.id,
                joints: self.joints,
                cancel: options.cancel.clone(),
                pause: options.pause.clone(),
                wait_for_rest: options.wait_for_rest,
                begun_ms,
                total_ms,
                events,
                before: None,
                pauses: 0,
                was_paused: false,
                has_begun: false,
            });
            self.inner.changed.notify_all();
        }
        loop {
            match told.recv() {
                Ok(Event::Progress(progress, heard)) => {
                    tell(&progress);
                    if let Some(heard) = heard {
                        // Its conductor waits for it.
                        let _ = heard.send(());
                    }
                }
                Ok(Event::End(end)) => {
                    let elapsed_ms = self.line().now_ms().saturating_sub(begun_ms);
                    return end.map(|end| report(end, steps.len(), elapsed_ms));
                }
                Err(_) => return Err(Error::Closed),
            }
        }
    }

    fn stop_generation(&self) -> u64 {
        self.inner.stop_generation()
    }

    fn release(&self, stop_generation: u64) -> bool {
        let mut own_stops = self.inner.own_stops();
        let line = self.line();
        if line.stop_generation() != stop_generation + *own_stops {
            return false;
        }
        // Another performer that met the same bumper may have released it.
        let is_held = line.state().motion_report().is_none_or(|it| it.mode == Mode::Held);
        if is_held {
            *own_stops += 1;
            return line.stop().is_ok() && line.stop_generation() == stop_generation + *own_stops;
        }
        true
    }

    fn ended(&self) -> Option<Interruption> {
        self.inner.state().ended_by(self.id)
    }

    fn own_stops(&self) -> u64 {
        *self.inner.own_stops()
    }
}

fn report(end: StreamEnd, steps_total: usize, elapsed_ms: u64) -> PlayReport {
    PlayReport {
        outcome: end.outcome,
        reached: None,
        instead: None,
        action: String::new(),
        steps_ended: end.ended,
        steps_accepted: end.accepted,
        steps_total,
        elapsed_ms,
        pauses: end.pauses,
        before: end.before,
        evidence: Some(end.latest),
    }
}
