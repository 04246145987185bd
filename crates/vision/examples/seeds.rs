//! How often the detector finds every true ellipse of a picture and no false one, over many seeds.
//!
//! `cargo run --release -p rsapien-vision --features image --example seeds -- FOLDER [SEEDS] [NAME...]`
//!
//! FOLDER holds `images/` and `gt/`, one JSON file a picture: `{"image": name, "ellipses": [[cx, cy, a, b, theta], ...],
//! "ignore": [...]}`. A detection matches a true ellipse at an overlap of 0.8; the best one to one matching counts.
//! A detection without a match is false unless it overlaps an ellipse of `ignore` by 0.8. NAME takes only the pictures
//! whose name contains it.

// Counts of a few hundred are exact in f64.
#![allow(clippy::cast_precision_loss)]

mod truth;

use std::error::Error;
use std::path::Path;
use std::time::Duration;

use rsapien_vision::evaluate::Truth;
use rsapien_vision::paper::{DetectedEllipse, Detector};
use rsapien_vision::{Ellipse, Picture};

/// Overlap from which two ellipses are the same.
const OVERLAP_MIN: f64 = 0.8;

/// Found, missed and false ellipses of one detection.
#[derive(Default, Clone, Copy)]
struct Score {
    found: usize,
    missed: usize,
    false_ones: usize,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().ok_or("give a folder that holds images/ and gt/")?;
    let seeds: u64 = arguments.next().map_or(Ok(100), |count| count.parse())?;
    let names: Vec<String> = arguments.collect();
    let detector = Detector::paper();
    println!(
        "picture               perfect  missed  false  edge points  pairs  virtual  ms/seed (one thread)"
    );
    for truth in truth::read_truths(Path::new(&folder))? {
        if !names.is_empty() && !names.iter().any(|name| truth.image.contains(name)) {
            continue;
        }
        report(&detector, Path::new(&folder), &truth, seeds)?;
    }
    Ok(())
}

/// Runs one picture over all seeds and prints its line.
fn report(
    detector: &Detector,
    folder: &Path,
    truth: &Truth,
    seeds: u64,
) -> Result<(), Box<dyn Error>> {
    let gray = Picture::open(folder.join("images").join(&truth.image))?.to_gray();
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let (mut perfect, mut missed, mut false_ones, mut virtual_ellipses) = (0, 0, 0, 0);
    let mut time = Duration::ZERO;
    let (mut edge_points, mut pairs) = (0, 0);
    for seed in 0..seeds {
        let detection = one_thread.install(|| detector.detect(&gray.view(), seed));
        let score = score(&detection.ellipses, truth);
        perfect += u64::from(score.found == truth.ellipses.len() && score.false_ones == 0);
        missed += score.missed;
        false_ones += score.false_ones;
        virtual_ellipses += detection.statistics.virtual_ellipses;
        edge_points = detection.statistics.edge_points;
        pairs = detection.statistics.search_point_pairs;
        time += detection.cost.total();
    }
    println!(
        "{:20} {perfect:4}/{seeds:<4} {missed:6} {false_ones:6} {edge_points:12} {pairs:6} {:8.1} {:8.2}",
        truth.image,
        virtual_ellipses as f64 / seeds as f64,
        time.as_secs_f64() * 1e3 / seeds as f64
    );
    Ok(())
}

fn score(detected: &[DetectedEllipse], truth: &Truth) -> Score {
    let overlaps = |ellipses: &[Ellipse]| -> Vec<Vec<bool>> {
        let row = |found: &DetectedEllipse| {
            ellipses.iter().map(|e| found.ellipse.overlap(e) >= OVERLAP_MIN).collect()
        };
        detected.iter().map(row).collect()
    };
    let (matches, ignored) = (overlaps(&truth.ellipses), overlaps(&truth.ignore));
    let mut owner = vec![None; truth.ellipses.len()];
    for detection in 0..detected.len() {
        grow_matching(detection, &matches, &mut owner, &mut vec![false; truth.ellipses.len()]);
    }
    let found = owner.iter().flatten().count();
    let free = |i: &usize| !owner.contains(&Some(*i)) && !ignored[*i].contains(&true);
    Score {
        found,
        missed: owner.len() - found,
        false_ones: (0..detected.len()).filter(free).count(),
    }
}

/// One augmenting path of Kuhn's maximum matching.
fn grow_matching(
    detection: usize,
    matches: &[Vec<bool>],
    owner: &mut [Option<usize>],
    seen: &mut [bool],
) -> bool {
    for truth in 0..owner.len() {
        if matches[detection][truth] && !seen[truth] {
            seen[truth] = true;
            if owner[truth].is_none_or(|other| grow_matching(other, matches, owner, seen)) {
                owner[truth] = Some(detection);
                return true;
            }
        }
    }
    false
}
