//! What is told on the standard error: rates once a second on a terminal and now and then elsewhere, and what is wrong
//! with the source.

use std::io::Write;
use std::mem::Discriminant;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::cli::output::Screen;
use crate::video::{Rates, Summary, Trouble};

/// How often rates are told where no terminal is.
const RATES_PERIOD: Duration = Duration::from_secs(10);
/// How often the same kind of trouble is told; the summary counts all of them.
const SAME_TROUBLE_PERIOD: Duration = Duration::from_secs(5);

/// Tells.
pub(super) struct Teller {
    /// A line at the bottom, on a terminal.
    line: Option<ProgressBar>,
    stall: Duration,
    last_frame: Instant,
    is_stalled: bool,
    /// Whether a lost connection was told; then nobody needs to hear that no frames come.
    is_lost: bool,
    rates_told: Instant,
    troubles_told: Vec<(Discriminant<Trouble>, Instant)>,
}

impl Teller {
    /// Tells on this screen; after `stall` without a frame, that the source stalls.
    pub(super) fn new(screen: Screen, stall: Duration) -> Self {
        let now = Instant::now();
        let line = screen.is_terminal().then(|| {
            let line = ProgressBar::new_spinner();
            if let Ok(style) = ProgressStyle::with_template("{msg}") {
                line.set_style(style);
            }
            line
        });
        Self {
            line,
            stall,
            last_frame: now,
            is_stalled: false,
            is_lost: false,
            rates_told: now,
            troubles_told: Vec::new(),
        }
    }

    /// Writes something elsewhere; a line at the bottom of the same terminal makes way.
    pub(super) fn beside<T>(&self, write: impl FnOnce() -> T) -> T {
        match &self.line {
            Some(line) => line.suspend(write),
            None => write(),
        }
    }

    /// A remark.
    pub(super) fn say(&self, text: &str) {
        // When even the standard error is gone, the frames still count.
        let _ = self.beside(|| writeln!(std::io::stderr(), "rsapien: {text}"));
    }

    /// A frame has come.
    pub(super) fn frame(&mut self) {
        if self.is_stalled {
            let silent_s = self.last_frame.elapsed().as_secs_f64();
            self.say(&format!("frames come again, after {silent_s:.1} s"));
        }
        (self.last_frame, self.is_stalled, self.is_lost) = (Instant::now(), false, false);
    }

    /// Time has passed.
    pub(super) fn wait(&mut self) {
        let silent = self.last_frame.elapsed();
        if silent >= self.stall && !self.is_stalled && !self.is_lost {
            self.is_stalled = true;
            let silent_s = silent.as_secs_f64();
            self.say(&format!("the source stalls: no frame for {silent_s:.1} s; still waiting"));
        }
    }

    /// Something is wrong with the source.
    pub(super) fn trouble(&mut self, trouble: &Trouble) {
        let kind = std::mem::discriminant(trouble);
        self.is_lost |= matches!(trouble, Trouble::Lost { .. });
        let told = self.troubles_told.iter_mut().find(|(told, _)| *told == kind);
        match told {
            Some((_, when)) if when.elapsed() < SAME_TROUBLE_PERIOD => return,
            Some((_, when)) => *when = Instant::now(),
            None => self.troubles_told.push((kind, Instant::now())),
        }
        self.say(&trouble.to_string());
    }

    /// What the last second was like.
    pub(super) fn rates(&mut self, rates: &Rates) {
        if let Some(line) = &self.line {
            line.set_message(rates.to_string());
            line.tick();
        } else if self.rates_told.elapsed() >= RATES_PERIOD {
            self.rates_told = Instant::now();
            self.say(&rates.to_string());
        }
    }

    /// What all of it was like.
    pub(super) fn finish(&mut self, summary: &Summary) {
        if let Some(line) = self.line.take() {
            line.finish_and_clear();
        }
        self.say(&summary.to_string());
    }
}
