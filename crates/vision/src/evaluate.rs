//! How good detections are: found ellipses against the true ones of a picture.
//!
//! Both are matched one to one, as many pairs as there can be, among those whose [overlap](Ellipse::overlap) reaches a
//! threshold. Precision, recall and F are micro-averages: counts are summed over the pictures before they are divided.
//!
//! ```
//! use rsapien_vision::Ellipse;
//! use rsapien_vision::evaluate::{Summary, Truth, score_picture};
//!
//! let disc = |x, radius| Ellipse {
//!     center_x_px: x, center_y_px: 50.0, semi_major_px: radius, semi_minor_px: radius, theta_rad: 0.0,
//! };
//! let truth = Truth { image: "two.png".into(), ellipses: vec![disc(40.0, 20.0), disc(90.0, 20.0)], ignore: vec![] };
//! let found = [disc(40.5, 20.0), disc(200.0, 30.0)];
//! let mut summary = Summary::default();
//! summary.add(&score_picture(&found, &truth, &[0.8])[0]);
//! assert_eq!((summary.precision(), summary.recall(), summary.f()), (0.5, 0.5, 0.5));
//! ```

mod matching;
#[cfg(test)]
mod tests;

use crate::ellipse::Ellipse;
use matching::{Pair, maximum_matching};

/// What there is to find in a picture.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Truth {
    /// Name of the picture.
    pub image: String,
    /// The ellipses that a detector should find.
    pub ellipses: Vec<Ellipse>,
    /// Ellipses that it may find or not: a detection without a match that overlaps one of them at the threshold is not
    /// counted.
    pub ignore: Vec<Ellipse>,
}

/// A detection and the true ellipse that it was matched with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Match {
    /// Index among the found ellipses.
    pub found: usize,
    /// Index in [`Truth::ellipses`].
    pub truth: usize,
    /// Overlap of the two, `0..=1`.
    pub overlap: f64,
    /// Distance of the centres in pixels.
    pub center_error_px: f64,
    /// How far the semi-major and the semi-minor axis are from the true ones, in pixels, without sign.
    pub semi_axis_errors_px: [f64; 2],
}

/// The score of one picture at one threshold.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PictureScore {
    /// The matched pairs, in the order of the truth.
    pub matches: Vec<Match>,
    /// Detections that count: all but the ignored ones.
    pub found: usize,
    /// Detections without a match that overlap an ellipse of [`Truth::ignore`].
    pub ignored: usize,
    /// True ellipses.
    pub truths: usize,
}

/// Scores the ellipses found in a picture at each of the thresholds of the overlap, `0..=1`. The scores are in the order
/// of the thresholds.
///
/// A pair whose areas alone show that its overlap is below the least of the thresholds counts as not overlapping.
pub fn score_picture(found: &[Ellipse], truth: &Truth, overlaps_min: &[f64]) -> Vec<PictureScore> {
    let canonical = |ellipses: &[Ellipse]| -> Vec<Ellipse> {
        ellipses.iter().map(|ellipse| ellipse.canonical()).collect()
    };
    let (found, truths) = (canonical(found), canonical(&truth.ellipses));
    let ignore = canonical(&truth.ignore);
    let least = overlaps_min.iter().copied().fold(1.0, f64::min);
    let overlaps: Vec<Vec<Pair>> =
        found.iter().map(|ellipse| overlapping(ellipse, &truths, least)).collect();
    let score = |&overlap_min: &f64| {
        let pairs = maximum_matching(&overlaps, truths.len(), overlap_min);
        let mut is_matched = vec![false; found.len()];
        for &(index, _) in &pairs {
            is_matched[index] = true;
        }
        let is_ignored = |ellipse: &Ellipse| {
            ignore.iter().any(|other| ellipse.overlap_from(other, overlap_min) >= overlap_min)
        };
        let ignored = found
            .iter()
            .zip(&is_matched)
            .filter(|&(e, &matched)| !matched && is_ignored(e))
            .count();
        PictureScore {
            matches: pairs
                .iter()
                .map(|&(index, pair)| compare(index, &found[index], pair, &truths[pair.truth]))
                .collect(),
            found: found.len() - ignored,
            ignored,
            truths: truths.len(),
        }
    };
    overlaps_min.iter().map(score).collect()
}

/// The true ellipses that overlap a found one, most first; the earlier of equals first.
fn overlapping(found: &Ellipse, truths: &[Ellipse], least: f64) -> Vec<Pair> {
    let mut pairs: Vec<Pair> = truths
        .iter()
        .enumerate()
        .map(|(truth, ellipse)| Pair { truth, overlap: found.overlap_from(ellipse, least) })
        .filter(|pair| pair.overlap > 0.0)
        .collect();
    pairs.sort_by(|a, b| b.overlap.total_cmp(&a.overlap));
    pairs
}

fn compare(index: usize, found: &Ellipse, pair: Pair, truth: &Ellipse) -> Match {
    Match {
        found: index,
        truth: pair.truth,
        overlap: pair.overlap,
        center_error_px: (found.center_x_px - truth.center_x_px)
            .hypot(found.center_y_px - truth.center_y_px),
        semi_axis_errors_px: [
            (found.semi_major_px - truth.semi_major_px).abs(),
            (found.semi_minor_px - truth.semi_minor_px).abs(),
        ],
    }
}

/// The scores of many pictures at one threshold, added up.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Summary {
    pictures: usize,
    missing: usize,
    found: usize,
    truths: usize,
    overlaps: Vec<f64>,
    center_errors_px: Vec<f64>,
    semi_axis_errors_px: Vec<f64>,
}

impl Summary {
    /// Adds a picture.
    pub fn add(&mut self, score: &PictureScore) {
        self.pictures += 1;
        self.found += score.found;
        self.truths += score.truths;
        for pair in &score.matches {
            self.overlaps.push(pair.overlap);
            self.center_errors_px.push(pair.center_error_px);
            self.semi_axis_errors_px.extend(pair.semi_axis_errors_px);
        }
    }

    /// Adds a picture that has a truth and was not run: all its ellipses are missed.
    pub fn add_missing(&mut self, truth: &Truth) {
        self.missing += 1;
        self.truths += truth.ellipses.len();
    }

    /// Pictures that were run.
    pub fn pictures(&self) -> usize {
        self.pictures
    }

    /// Pictures that have a truth and were not run.
    pub fn missing(&self) -> usize {
        self.missing
    }

    /// Detections that count: all but the ignored ones.
    pub fn found(&self) -> usize {
        self.found
    }

    /// True ellipses.
    pub fn truths(&self) -> usize {
        self.truths
    }

    /// Matched pairs.
    pub fn matched(&self) -> usize {
        self.overlaps.len()
    }

    /// The share of the detections that are true, `0..=1`; 0 without a detection.
    pub fn precision(&self) -> f64 {
        ratio(self.matched(), self.found)
    }

    /// The share of the true ellipses that are found, `0..=1`; 0 without a truth.
    pub fn recall(&self) -> f64 {
        ratio(self.matched(), self.truths)
    }

    /// Harmonic mean of precision and recall, `0..=1`; 0 where both are.
    pub fn f(&self) -> f64 {
        let (precision, recall) = (self.precision(), self.recall());
        if precision + recall > 0.0 { 2.0 * precision * recall / (precision + recall) } else { 0.0 }
    }

    /// Mean overlap of the matched pairs; `None` without any.
    pub fn overlap_mean(&self) -> Option<f64> {
        let count = self.overlaps.len();
        (count > 0).then(|| self.overlaps.iter().sum::<f64>() / count as f64)
    }

    /// Median distance of the matched centres in pixels; `None` without a match.
    pub fn center_error_median_px(&self) -> Option<f64> {
        median(&self.center_errors_px)
    }

    /// Median error of the matched semi-axes in pixels, both of each pair; `None` without a match.
    pub fn semi_axis_error_median_px(&self) -> Option<f64> {
        median(&self.semi_axis_errors_px)
    }
}

fn ratio(part: usize, whole: usize) -> f64 {
    if whole == 0 { 0.0 } else { part as f64 / whole as f64 }
}

/// The middle value, or half way between the two in the middle.
fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let upper = *sorted.get(sorted.len() / 2)?;
    Some(if sorted.len() % 2 == 1 {
        upper
    } else {
        f64::midpoint(sorted[sorted.len() / 2 - 1], upper)
    })
}
