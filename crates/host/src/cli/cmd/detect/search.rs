//! A detector of either preset, and what it found.

use std::time::{Duration, Instant};

use rsapien_vision::paper;
use rsapien_vision::{Detection, Detector, Ellipse, GrayView};

/// A detector of either preset.
pub(in crate::cli::cmd) enum Search {
    Default(Box<Detector>),
    Paper { detector: paper::Detector, seed: u64 },
}

/// What was found in a picture.
pub(in crate::cli::cmd) struct Found {
    pub(in crate::cli::cmd) detection: Either,
    /// What the detection took, without reading the file: the median of its repetitions.
    pub(in crate::cli::cmd) duration: Duration,
}

/// The detection of either preset.
pub(in crate::cli::cmd) enum Either {
    Default(Detection),
    Paper(paper::Detection),
}

impl From<Detector> for Search {
    fn from(detector: Detector) -> Self {
        Self::Default(Box::new(detector))
    }
}

impl Search {
    /// The detector of the paper.
    pub(in crate::cli::cmd) fn paper(detector: paper::Detector, seed: u64) -> Self {
        Self::Paper { detector, seed }
    }

    /// Looks `repeat` times at a picture, at least once.
    pub(in crate::cli::cmd) fn look_at(&mut self, view: &GrayView<'_>, repeat: u32) -> Found {
        let mut durations = Vec::new();
        for _ in 1..repeat {
            let start = Instant::now();
            match self {
                Self::Default(detector) => {
                    detector.detect(view);
                }
                Self::Paper { detector, seed } => {
                    detector.detect(view, *seed);
                }
            }
            durations.push(start.elapsed());
        }
        let start = Instant::now();
        let detection = match self {
            Self::Default(detector) => {
                let found = detector.detect(view);
                durations.push(start.elapsed());
                Either::Default(found.clone())
            }
            Self::Paper { detector, seed } => {
                let found = detector.detect(view, *seed);
                durations.push(start.elapsed());
                Either::Paper(found)
            }
        };
        Found { detection, duration: median(&mut durations) }
    }
}

/// The middle one, or the mean of the two in the middle.
fn median(durations: &mut [Duration]) -> Duration {
    durations.sort_unstable();
    let middle = durations.len() / 2;
    match (durations.get(middle.saturating_sub(1)), durations.get(middle)) {
        (Some(below), Some(above)) if durations.len().is_multiple_of(2) => (*below + *above) / 2,
        (_, Some(middle)) => *middle,
        _ => Duration::ZERO,
    }
}

impl Found {
    /// The ellipses, best first.
    pub(in crate::cli::cmd) fn ellipses(&self) -> Vec<Ellipse> {
        match &self.detection {
            Either::Default(detection) => {
                detection.ellipses.iter().map(|found| found.ellipse).collect()
            }
            Either::Paper(detection) => {
                detection.ellipses.iter().map(|found| found.ellipse).collect()
            }
        }
    }

    /// Whether a limit was met, so that there may be more.
    pub(in crate::cli::cmd) fn is_truncated(&self) -> bool {
        match &self.detection {
            Either::Default(detection) => detection.truncated,
            Either::Paper(detection) => detection.truncated(),
        }
    }

    /// Edge points the detection began with.
    pub(in crate::cli::cmd) fn edge_points(&self) -> usize {
        match &self.detection {
            Either::Default(detection) => detection.statistics.edge_points,
            Either::Paper(detection) => detection.statistics.edge_points,
        }
    }

    /// What the detection took, in milliseconds.
    pub(in crate::cli::cmd) fn duration_ms(&self) -> f64 {
        self.duration.as_secs_f64() * 1e3
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_the_middle_or_the_mean_of_two() {
        let of = |ms: &[u64]| {
            median(&mut ms.iter().map(|&ms| Duration::from_millis(ms)).collect::<Vec<_>>())
                .as_millis()
        };
        assert_eq!((of(&[]), of(&[7]), of(&[9, 1]), of(&[3, 9, 1])), (0, 7, 5, 3));
    }
}
