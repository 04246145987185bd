//! An action played on the virtual robot beside its timeline, over which a bar goes.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use rsapien_registry::{CompiledAction, Timeline};

use crate::cli::diagnostics::Result;
use crate::cli::robot::OpenRobot;
use crate::{MotionController, PlayOptions, PlayReport, Progress};

/// How often the bar is moved.
const FRAME: Duration = Duration::from_millis(50);

/// How far an action is: at a time of its own that goes on with the clock, until the step under way has ended.
#[derive(Clone, Copy)]
struct Now {
    begun_ms: u64,
    ends_ms: u64,
    since: Instant,
}

impl Now {
    /// After so many steps of `action`; a wait stands still.
    fn of(action: &CompiledAction, progress: &Progress) -> Now {
        let durations = action.steps.iter().map(|step| u64::from(step.duration_ms));
        let begun_ms = durations.clone().take(progress.steps_ended).sum();
        let is_waiting = !progress.waiting_for.is_empty();
        let lasts_ms = durations.clone().nth(progress.steps_ended).filter(|_| !is_waiting);
        Now { begun_ms, ends_ms: begun_ms + lasts_ms.unwrap_or(0), since: Instant::now() }
    }

    fn ms(self) -> u64 {
        let elapsed_ms = u64::try_from(self.since.elapsed().as_millis()).unwrap_or(u64::MAX);
        self.begun_ms.saturating_add(elapsed_ms).min(self.ends_ms)
    }
}

/// Plays `action`, which takes real time, and draws its timeline on the standard error meanwhile.
pub(super) fn play(
    open: &OpenRobot,
    motion: &mut MotionController,
    action: &CompiledAction,
    columns: usize,
    with_colour: bool,
) -> Result<PlayReport> {
    let timeline = Timeline::of(action);
    let bar = ProgressBar::new_spinner();
    if let Ok(style) = ProgressStyle::with_template("{msg}") {
        bar.set_style(style);
    }
    let now = Mutex::new(Now { begun_ms: 0, ends_ms: 0, since: Instant::now() });
    let is_over = AtomicBool::new(false);
    let played = std::thread::scope(|scope| {
        scope.spawn(|| {
            while !is_over.load(Ordering::SeqCst) {
                let now_ms = lock(&now).ms();
                bar.set_message(timeline.to_text_at(columns, with_colour, Some(now_ms)));
                std::thread::sleep(FRAME);
            }
        });
        let mut options = PlayOptions {
            cancel: open.cancel.clone(),
            on_progress: Some(Box::new(|progress| {
                // What is played instead of the rest has no place on this timeline.
                if progress.handler.is_none() {
                    *lock(&now) = Now::of(action, progress);
                }
            })),
            ..PlayOptions::default()
        };
        let played = motion.perform(action, &mut options);
        drop(options);
        is_over.store(true, Ordering::SeqCst);
        played
    });
    // It stays, with the place where it ended.
    let now_ms = lock(&now).ms();
    bar.finish_with_message(timeline.to_text_at(columns, with_colour, Some(now_ms)));
    open.done(played)
}

fn lock(now: &Mutex<Now>) -> MutexGuard<'_, Now> {
    now.lock().unwrap_or_else(PoisonError::into_inner)
}
