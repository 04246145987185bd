//! Frame rates and delays, to be told once a second and at the end.

use std::fmt;
use std::time::{Duration, Instant};

use super::Counts;

/// Width of a step in which delays are counted, and how many there are: up to 2 s.
const STEP: Duration = Duration::from_micros(100);
const STEPS: usize = 20_000;
/// How often rates are told.
const PERIOD: Duration = Duration::from_secs(1);

/// Counts delays in memory of one size, however many there are.
#[derive(Debug, Clone)]
struct Delays {
    steps: Vec<u32>,
    count: u64,
    longest: Duration,
}

impl Delays {
    fn new() -> Self {
        Self { steps: vec![0; STEPS], count: 0, longest: Duration::ZERO }
    }

    fn add(&mut self, delay: Duration) {
        let step = usize::try_from(delay.as_micros() / STEP.as_micros()).unwrap_or(STEPS);
        if let Some(count) = self.steps.get_mut(step.min(STEPS - 1)) {
            *count = count.saturating_add(1);
        }
        self.count += 1;
        self.longest = self.longest.max(delay);
    }

    /// The delay that half of them keep below, to a tenth of a millisecond, in ms; 0 without any.
    fn median_ms(&self) -> f64 {
        let mut seen = 0;
        for (step, &count) in (0_u32..).zip(&self.steps) {
            seen += u64::from(count);
            if count > 0 && 2 * seen >= self.count {
                return STEP.as_secs_f64() * 1e3 * f64::from(step);
            }
        }
        0.0
    }

    fn clear(&mut self) {
        self.steps.fill(0);
        (self.count, self.longest) = (0, Duration::ZERO);
    }
}

/// Measures how frames come and how long they take.
#[derive(Debug)]
pub struct Meter {
    started: Instant,
    /// The second being measured.
    since: Instant,
    before: Counts,
    recent: Delays,
    all: Delays,
}

/// What the last second was like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rates {
    /// Frames a second that came.
    pub in_hz: f64,
    /// Frames a second that were looked at.
    pub out_hz: f64,
    /// From the complete picture to the result: half of the frames took less, in ms.
    pub delay_median_ms: f64,
    /// The frame that took longest, in ms.
    pub delay_longest_ms: f64,
    /// Frames dropped in this second.
    pub dropped: u64,
}

/// What all of it was like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Summary {
    /// How long it was, in s.
    pub elapsed_s: f64,
    /// Frames looked at.
    pub frames: u64,
    /// As of [`Rates`], over all of it.
    pub rates: Rates,
    /// What the source gave.
    pub counts: Counts,
}

impl Meter {
    /// A meter that begins now.
    pub fn new(now: Instant) -> Self {
        Self {
            started: now,
            since: now,
            before: Counts::default(),
            recent: Delays::new(),
            all: Delays::new(),
        }
    }

    /// A frame was looked at, so long after it was complete.
    pub fn looked(&mut self, delay: Duration) {
        self.recent.add(delay);
        self.all.add(delay);
    }

    /// The rates of the time since they were asked for last, when that is a second or more.
    pub fn rates(&mut self, now: Instant, counts: Counts) -> Option<Rates> {
        let elapsed = now.saturating_duration_since(self.since);
        if elapsed < PERIOD {
            return None;
        }
        let rates = rates(&self.recent, elapsed, self.before, counts);
        (self.since, self.before) = (now, counts);
        self.recent.clear();
        Some(rates)
    }

    /// What it was like from the beginning until now.
    pub fn summary(&self, now: Instant, counts: Counts) -> Summary {
        let elapsed = now.saturating_duration_since(self.started);
        Summary {
            elapsed_s: elapsed.as_secs_f64(),
            frames: self.all.count,
            rates: rates(&self.all, elapsed, Counts::default(), counts),
            counts,
        }
    }
}

fn rates(delays: &Delays, elapsed: Duration, before: Counts, after: Counts) -> Rates {
    let seconds = elapsed.as_secs_f64().max(1e-3);
    // Exact far beyond any number of frames.
    #[allow(clippy::cast_precision_loss)]
    let per_second = |count: u64| count as f64 / seconds;
    Rates {
        in_hz: per_second(after.frames.saturating_sub(before.frames)),
        out_hz: per_second(delays.count),
        delay_median_ms: delays.median_ms(),
        delay_longest_ms: delays.longest.as_secs_f64() * 1e3,
        dropped: after.dropped.saturating_sub(before.dropped),
    }
}

impl fmt::Display for Rates {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { in_hz, out_hz, delay_median_ms, delay_longest_ms, dropped } = self;
        write!(
            formatter,
            "{in_hz:.1} frames/s in, {out_hz:.1} looked at, {dropped} dropped; delay {delay_median_ms:.1} ms, at most \
             {delay_longest_ms:.1}"
        )
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { elapsed_s, frames, rates, counts } = self;
        write!(formatter, "{frames} frames in {elapsed_s:.1} s: {rates}")?;
        let Counts { bad_pictures, skipped_bytes, losses, .. } = counts;
        for (count, one, many) in [
            (*bad_pictures, "picture left out", "pictures left out"),
            (*skipped_bytes, "byte skipped", "bytes skipped"),
            (*losses, "try without connection", "tries without connection"),
        ] {
            match count {
                0 => {}
                1 => write!(formatter, "; 1 {one}")?,
                _ => write!(formatter, "; {count} {many}")?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_and_all_of_it_are_told_apart() {
        let start = Instant::now();
        let after = |ms| start + Duration::from_millis(ms);
        let mut meter = Meter::new(start);
        for delay_ms in [5, 6, 300] {
            meter.looked(Duration::from_millis(delay_ms));
        }
        let counts = |frames, dropped| Counts { frames, dropped, ..Counts::default() };
        assert_eq!(meter.rates(after(999), counts(5, 2)), None);
        let rates = meter.rates(after(2000), counts(5, 2)).unwrap();
        assert_eq!(
            rates.to_string(),
            "2.5 frames/s in, 1.5 looked at, 2 dropped; delay 6.0 ms, at most 300.0"
        );
        meter.looked(Duration::from_millis(7));
        let rates = meter.rates(after(3000), counts(6, 2)).unwrap();
        assert_eq!((rates.dropped, rates.delay_longest_ms), (0, 7.0));
        let summary = meter.summary(after(4000), Counts { losses: 1, ..counts(6, 2) });
        assert_eq!(
            summary.to_string(),
            "4 frames in 4.0 s: 1.5 frames/s in, 1.0 looked at, 2 dropped; delay 6.0 ms, at most 300.0; 1 try \
             without connection"
        );
        assert!(meter.rates(after(9000), counts(6, 2)).is_some_and(|rates| rates.in_hz == 0.0));
    }
}
