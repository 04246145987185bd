//! Makes the weights of the default detector's score (`WEIGHTS` in `src/meaning.rs`) from pictures with truth.
//!
//! `cargo run --release -p rsapien-vision --features image --example score-weights -- FOLDER...`
//!
//! Each FOLDER holds `images/` and `gt/`, as for the example `seeds`; folders of one name count as one set. The detector
//! tells everything it finds, whatever its score. A detection that overlaps a true ellipse by 0.8 is true; one that
//! overlaps an ellipse of `ignore` by 0.7, and no true one, is left out; the others are false. A logistic regression on
//! the standardised features, with the squares of its weights as penalty (C = 1), tells the true from the false; every
//! set weighs the same in total. The example prints the weights, and for each set how many true and how many false
//! detections would score above some thresholds: `true+false`; then the same with weights fitted to the other sets alone,
//! which is what to expect of pictures of a new kind.

// Counts of detections are exact in f64.
#![allow(clippy::cast_precision_loss)]

mod truth;

use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;

use nalgebra::{SMatrix, SVector};
use rsapien_vision::evaluate::Truth;
use rsapien_vision::{DetectedEllipse, Detector, Ellipse, Picture};

/// Least overlap with a true ellipse of a detection that is true, and with an ignored one of one that is left out.
const TRUE_OVERLAP: f64 = 0.8;
const IGNORED_OVERLAP: f64 = 0.7;
/// Scores at which is told what would be kept.
const THRESHOLDS: [f64; 5] = [0.3, 0.4, 0.5, 0.6, 0.7];
/// Newton steps at the most; some ten are enough.
const STEPS_MAX: usize = 100;

/// Number of features.
const FEATURES: usize = 6;
/// Features, and the constant.
const TERMS: usize = FEATURES + 1;
type Terms = SVector<f64, TERMS>;

/// A detection.
struct Sample {
    features: [f64; FEATURES],
    is_true: bool,
}

fn main() -> Result<(), Box<dyn Error>> {
    let folders: Vec<String> = std::env::args().skip(1).collect();
    if folders.is_empty() {
        return Err("give folders that hold images/ and gt/".into());
    }
    let mut detector = Detector::builder().score_min(0.0).build()?;
    let mut sets: BTreeMap<String, Vec<Sample>> = BTreeMap::new();
    for folder in &folders {
        let folder = Path::new(folder);
        let name =
            folder.file_name().map_or_else(String::new, |name| name.to_string_lossy().into());
        let samples = sets.entry(name).or_default();
        for truth in truth::read_truths(folder)? {
            let gray = Picture::open(folder.join("images").join(&truth.image))?.to_gray();
            let found = &detector.detect(&gray.view()).ellipses;
            samples.extend(found.iter().filter_map(|found| sample(found, &truth)));
        }
    }
    let weights = regression(&sets.values().map(Vec::as_slice).collect::<Vec<_>>())?;
    let listed: Vec<_> = weights.iter().map(|weight| format!("{weight:.3}")).collect();
    println!("const WEIGHTS: [f64; FEATURES + 1] = [{}];\n", listed.join(", "));
    print_head("set");
    for (name, samples) in &sets {
        print_row(name, samples, &weights);
    }
    if sets.len() > 1 {
        print_head("\nset, by the others");
        for (name, samples) in &sets {
            let others: Vec<_> =
                sets.iter().filter(|(other, _)| *other != name).map(|(_, set)| &set[..]).collect();
            print_row(name, samples, &regression(&others)?);
        }
    }
    Ok(())
}

fn print_head(title: &str) {
    let thresholds = THRESHOLDS.map(|threshold| format!("{:>11}", format!("> {threshold}")));
    println!("{title:20} {:>6} {:>6}{}", "true", "false", thresholds.concat());
}

/// How many of a set are true and false, and how many of them these weights would keep.
fn print_row(name: &str, samples: &[Sample], weights: &Terms) {
    let count = |is_true: bool, threshold: f64| {
        let counts = |sample: &&Sample| {
            sample.is_true == is_true && score(&terms(sample), weights) > threshold
        };
        samples.iter().filter(counts).count()
    };
    print!("{name:20} {:6} {:6}", count(true, 0.0), count(false, 0.0));
    for threshold in THRESHOLDS {
        print!(" {:>10}", format!("{}+{}", count(true, threshold), count(false, threshold)));
    }
    println!();
}

/// What a detection teaches; `None` when it may be found or not.
fn sample(found: &DetectedEllipse, truth: &Truth) -> Option<Sample> {
    let overlap = |others: &[Ellipse]| {
        others.iter().map(|other| found.ellipse.overlap(other)).fold(0.0, f64::max)
    };
    let is_true = overlap(&truth.ellipses) >= TRUE_OVERLAP;
    let is_ignored = !is_true && overlap(&truth.ignore) >= IGNORED_OVERLAP;
    (!is_ignored).then(|| Sample { features: features(found), is_true })
}

/// What the score is computed from: the formula of `Evidence::features` in `src/meaning.rs`, from the fields that a
/// detection tells. Of a stroke, whose middle line is told, the semi-minor axis is off by half its width.
fn features(found: &DetectedEllipse) -> [f64; FEATURES] {
    [
        (found.support_share * found.inside_share).max(0.01).ln(),
        found.gap_share,
        (1.0 - found.gradient_agreement + 1e-3).ln(),
        found.residual_px,
        (-found.log10_false_alarms).clamp(0.0, 200.0).sqrt(),
        found.ellipse.semi_minor_px.ln(),
    ]
}

/// The features and a 1 for the constant.
fn terms(sample: &Sample) -> Terms {
    Terms::from_fn(|i, _| sample.features.get(i).copied().unwrap_or(1.0))
}

fn score(terms: &Terms, weights: &Terms) -> f64 {
    1.0 / (1.0 + (-terms.dot(weights)).exp())
}

/// The weights of the features and the constant.
fn regression(sets: &[&[Sample]]) -> Result<Terms, Box<dyn Error>> {
    let sets: Vec<_> = sets.iter().filter(|samples| !samples.is_empty()).collect();
    let all: Vec<Terms> = sets.iter().flat_map(|samples| samples.iter().map(terms)).collect();
    if all.is_empty() {
        return Err("nothing was found in any picture".into());
    }
    let count = all.len() as f64;
    // Mean and standard deviation of every feature; the constant stays 1.
    let mut mean = all.iter().sum::<Terms>() / count;
    mean[FEATURES] = 0.0;
    let squares: Terms = all.iter().map(|terms| (terms - mean).map(|value| value * value)).sum();
    let scale = (squares / count).map(|variance| variance.sqrt().max(1e-9));
    // Every set weighs the same, and a detection 1 on the mean.
    let rows: Vec<Row> = sets
        .iter()
        .flat_map(|samples| {
            let weight = count / (sets.len() * samples.len()) as f64;
            samples.iter().map(move |sample| (sample, weight))
        })
        .map(|(sample, weight)| Row {
            terms: (terms(sample) - mean).component_div(&scale),
            is_true: sample.is_true,
            weight,
        })
        .collect();
    let mut raw = newton(&rows)?.component_div(&scale);
    raw[FEATURES] -= raw.dot(&mean);
    Ok(raw)
}

/// A detection with standardised features.
struct Row {
    terms: Terms,
    is_true: bool,
    weight: f64,
}

/// The weights with the least loss: Newton's method, with steps halved until the loss falls.
fn newton(rows: &[Row]) -> Result<Terms, Box<dyn Error>> {
    let penalty = Terms::from_fn(|i, _| if i < FEATURES { 1.0 } else { 0.0 });
    let loss = |weights: &Terms| -> f64 {
        let of_row = |row: &Row| {
            let sum = row.terms.dot(weights);
            let wrong = if row.is_true { -sum } else { sum };
            // ln(1 + exp(wrong)), which does not overflow this way.
            row.weight * (wrong.max(0.0) + (-wrong.abs()).exp().ln_1p())
        };
        let squares: f64 = (0..FEATURES).map(|i| weights[i] * weights[i]).sum();
        rows.iter().map(of_row).sum::<f64>() + squares / 2.0
    };
    let mut weights = Terms::zeros();
    let mut least = loss(&weights);
    for _ in 0..STEPS_MAX {
        let mut gradient = weights.component_mul(&penalty);
        let mut hessian = SMatrix::from_diagonal(&penalty);
        for row in rows {
            let score = score(&row.terms, &weights);
            let error = score - f64::from(u8::from(row.is_true));
            gradient += row.terms * (row.weight * error);
            hessian += row.terms * row.terms.transpose() * (row.weight * score * (1.0 - score));
        }
        let mut step =
            hessian.cholesky().ok_or("the sets tell true from false too well")?.solve(&gradient);
        while loss(&(weights - step)) > least && step.amax() > 1e-12 {
            step /= 2.0;
        }
        if step.amax() < 1e-9 {
            return Ok(weights);
        }
        weights -= step;
        least = loss(&weights);
    }
    Err("the regression does not settle".into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rsapien_vision::{GrayImage, Strokes};

    /// A disc among grains, less and less of it.
    fn picture(seed: u32) -> GrayImage {
        let (width, height) = (200_u32, 160_u32);
        let mut state = seed;
        let pixels = (0..width * height).map(|at| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let (x, y) = (f64::from(at % width) - 90.0, f64::from(at / width) - 80.0);
            let radius = 30.0 + f64::from(seed);
            let is_inside = (x / radius).hypot(y / 40.0) < 1.0 && x < 60.0 - 5.0 * f64::from(seed);
            let grain = (state >> 26) as u8;
            if is_inside { 140 + grain } else { 60 + grain }
        });
        GrayImage::new(pixels.collect(), width as usize, height as usize).unwrap()
    }

    #[test]
    fn the_detectors_score_is_a_logistic_function_of_these_features() {
        let options = Detector::builder().score_min(0.0).strokes(Strokes::BothEdges);
        let mut detector = options.build().unwrap();
        let mut rows: Vec<(Terms, f64)> = Vec::new();
        for seed in 0..16 {
            let gray = picture(seed);
            rows.extend(detector.detect(&gray.view()).ellipses.iter().map(|found| {
                let sample = Sample { features: features(found), is_true: true };
                (terms(&sample), (found.score / (1.0 - found.score)).ln())
            }));
        }
        assert!(rows.len() > 2 * TERMS, "{} detections are too few to tell", rows.len());
        // Were the formula another one, no weights would give all the scores.
        let normal: SMatrix<f64, TERMS, TERMS> =
            rows.iter().map(|(terms, _)| terms * terms.transpose()).sum();
        let right: Terms = rows.iter().map(|(terms, logit)| terms * *logit).sum();
        let weights = normal.cholesky().unwrap().solve(&right);
        for (terms, logit) in rows {
            assert!((terms.dot(&weights) - logit).abs() < 1e-4, "{} {logit}", terms.dot(&weights));
        }
    }

    #[test]
    fn the_regression_finds_the_weights_that_made_the_labels() {
        let made = Terms::from_column_slice(&[1.5, -2.0, 0.5, 0.0, 1.0, -1.0, 0.3]);
        let mut state = 1_u32;
        let mut draw = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 24)
        };
        let samples = (0..40_000).map(|_| {
            let features = std::array::from_fn(|_| 4.0 * draw() - 2.0);
            let sample = Sample { features, is_true: false };
            let is_true = draw() < score(&terms(&sample), &made);
            Sample { is_true, ..sample }
        });
        let found = regression(&[&samples.collect::<Vec<_>>()]).unwrap();
        assert!((found - made).amax() < 0.1, "{found}");
    }
}
