//! A detector's score on a set.

use rsapien_vision::evaluate::{PictureScore, Summary, Truth};
use serde::Serialize;
use serde::ser::{SerializeStruct, Serializer};

/// The columns for people.
pub(super) const HEAD: [&str; 12] = [
    "set", "detector", "pictures", "truths", "P", "R", "F", "ms", "IoU", "centre", "axes", "ratio",
];

/// The score of a detector on a set.
pub(super) struct Row {
    set: String,
    detector: String,
    summary: Summary,
    times_ms: Times,
    /// Our mean time over that of this detector.
    ratio: Option<f64>,
}

/// A mean of times.
#[derive(Debug, Clone, Copy, Default)]
struct Times {
    sum: f64,
    count: u32,
}

impl Times {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.count += 1;
    }

    fn mean(self) -> Option<f64> {
        (self.count > 0).then(|| self.sum / f64::from(self.count))
    }
}

impl Row {
    fn new(set: &str, detector: &str) -> Self {
        Self {
            set: set.to_owned(),
            detector: detector.to_owned(),
            summary: Summary::default(),
            times_ms: Times::default(),
            ratio: None,
        }
    }

    /// Mean time of a picture in milliseconds.
    pub(super) fn mean_ms(&self) -> Option<f64> {
        self.times_ms.mean()
    }

    /// The row for people.
    pub(super) fn cells(&self) -> [String; 12] {
        let number = |value: Option<f64>, digits: usize| {
            value.map_or("-".to_owned(), |value| format!("{value:.digits$}"))
        };
        let summary = &self.summary;
        let pictures = match summary.missing() {
            0 => summary.pictures().to_string(),
            missing => format!("{} (-{missing})", summary.pictures()),
        };
        [
            self.set.clone(),
            self.detector.clone(),
            pictures,
            summary.truths().to_string(),
            format!("{:.3}", summary.precision()),
            format!("{:.3}", summary.recall()),
            format!("{:.3}", summary.f()),
            number(self.mean_ms(), 2),
            number(summary.overlap_mean(), 3),
            number(summary.center_error_median_px(), 2),
            number(summary.semi_axis_error_median_px(), 2),
            number(self.ratio, 2),
        ]
    }
}

/// The row for programs.
impl Serialize for Row {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let summary = &self.summary;
        let mut row = serializer.serialize_struct("Row", 15)?;
        row.serialize_field("set", &self.set)?;
        row.serialize_field("detector", &self.detector)?;
        row.serialize_field("pictures", &summary.pictures())?;
        row.serialize_field("missing", &summary.missing())?;
        row.serialize_field("truths", &summary.truths())?;
        row.serialize_field("detections", &summary.found())?;
        row.serialize_field("matched", &summary.matched())?;
        row.serialize_field("precision", &summary.precision())?;
        row.serialize_field("recall", &summary.recall())?;
        row.serialize_field("f", &summary.f())?;
        row.serialize_field("ms_mean", &self.mean_ms())?;
        row.serialize_field("overlap_mean", &summary.overlap_mean())?;
        row.serialize_field("center_error_median_px", &summary.center_error_median_px())?;
        row.serialize_field("axis_error_median_px", &summary.semi_axis_error_median_px())?;
        row.serialize_field("ms_ratio", &self.ratio)?;
        row.end()
    }
}

/// A detector's way through the sets.
pub(super) struct Scores {
    row: Row,
    total: Row,
    ratios: Times,
}

impl Scores {
    pub(super) fn new(detector: &str) -> Self {
        Self {
            row: Row::new("", detector),
            total: Row::new("all", detector),
            ratios: Times::default(),
        }
    }

    /// Begins a set.
    pub(super) fn begin(&mut self, set: &str) {
        self.row = Row::new(set, &self.row.detector);
    }

    /// Adds a picture of the set, and its time in milliseconds where that is known.
    pub(super) fn add(&mut self, score: &PictureScore, ms: Option<f64>) {
        for row in [&mut self.row, &mut self.total] {
            row.summary.add(score);
            if let Some(ms) = ms {
                row.times_ms.add(ms);
            }
        }
    }

    /// Adds a picture of the set that was not looked at.
    pub(super) fn add_missing(&mut self, truth: &Truth) {
        self.row.summary.add_missing(truth);
        self.total.summary.add_missing(truth);
    }

    /// Our mean time on the set over this detector's.
    pub(super) fn compare_with(&mut self, ours_ms: Option<f64>) {
        self.row.ratio = ours_ms.zip(self.row.mean_ms()).map(|(ours, theirs)| ours / theirs);
        if let Some(ratio) = self.row.ratio {
            self.ratios.add(ratio);
        }
    }

    /// The row of the set.
    pub(super) fn row(&self) -> &Row {
        &self.row
    }

    /// The row of all pictures together, with the mean of the sets' ratios.
    pub(super) fn total(mut self) -> Row {
        self.total.ratio = self.ratios.mean();
        self.total
    }
}
