//! Bars on the standard error, where that is a terminal.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::output::{Screen, Style};

/// What takes less than this needs no bar.
const PATIENCE: Duration = Duration::from_secs(1);

/// A bar that shows its message beside it; hidden where the standard error is no terminal.
pub(crate) fn bar(style: Style) -> ProgressBar {
    if !style.error.is_terminal() {
        return ProgressBar::hidden();
    }
    let template =
        if style.error == Screen::Color { "{bar:30.green} {msg}" } else { "{bar:30} {msg}" };
    let bar = ProgressBar::new(0);
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.progress_chars("━╸ "));
    }
    bar
}

/// The progress through a number of pictures or actions, shown once it has taken a second.
pub(crate) struct Progress {
    bar: ProgressBar,
    total: usize,
    done: usize,
    started: Instant,
    is_waiting: bool,
}

impl Progress {
    /// Of `total`; of fewer than two nothing is ever shown.
    pub(crate) fn new(style: Style, total: usize) -> Self {
        let is_waiting = style.error.is_terminal() && total > 1;
        let bar = if is_waiting { bar(style) } else { ProgressBar::hidden() };
        bar.set_draw_target(ProgressDrawTarget::hidden());
        bar.set_length(total as u64);
        Self { bar, total, done: 0, started: Instant::now(), is_waiting }
    }

    /// Tells which comes next.
    pub(crate) fn next(&mut self, name: &str) {
        if self.is_waiting && self.started.elapsed() > PATIENCE {
            self.is_waiting = false;
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        self.bar.set_position(self.done as u64);
        self.done += 1;
        self.bar.set_message(format!("{} of {}: {name}", self.done, self.total));
    }

    /// Writes something else to the terminal, without the bar in its way.
    pub(crate) fn aside<T>(&self, write: impl FnOnce() -> T) -> T {
        self.bar.suspend(write)
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
