//! How fast the images are, measured in cycles in the simulator, and the tables of
//! `docs/firmware-timing.md`.

mod load;
mod motors;
mod rig;
mod routines;
mod table;

pub use table::{document, other_images, tables_of_the_committed_images};

use std::fmt::Write as _;

/// What was measured of one thing, in instruction cycles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Measured {
    best: u64,
    worst: u64,
    samples: u64,
}

impl Measured {
    fn add(&mut self, cycles: u64) {
        self.best = if self.samples == 0 { cycles } else { self.best.min(cycles) };
        self.worst = self.worst.max(cycles);
        self.samples += 1;
    }

    fn of(cycles: impl IntoIterator<Item = u64>) -> Measured {
        let mut measured = Measured::default();
        cycles.into_iter().for_each(|cycles| measured.add(cycles));
        measured
    }
}

/// A time in cycles as it is told, at a clock with so many cycles a ms.
fn time(cycles: u64, cycles_a_ms: u64) -> String {
    let tenths_of_us = (cycles * 10_000 + cycles_a_ms / 2) / cycles_a_ms;
    let mut text = String::new();
    let _ = if tenths_of_us < 10_000 {
        write!(text, "{}.{} µs", tenths_of_us / 10, tenths_of_us % 10)
    } else {
        let hundredths_of_ms = (tenths_of_us + 50) / 100;
        write!(text, "{}.{:02} ms", hundredths_of_ms / 100, hundredths_of_ms % 100)
    };
    text
}
