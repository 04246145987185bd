//! The covariance that a detection tells, against the spread of its parameters over pictures that differ in their noise.

// Counts of a few hundred are exact in f64; grey values are cut to bytes on purpose.
#![allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use rsapien_vision::{Detector, Ellipse, GrayImage};

const SIZE: usize = 160;
/// Standard deviation of the noise in grey values.
const NOISE_GREY: f64 = 6.0;
const PICTURES: u64 = 200;
/// The told standard deviations may be off by this factor: the errors of edge points are neither quite normal nor is
/// their correlation the same everywhere.
const FACTOR_MAX: f64 = 1.25;

/// A dark ellipse on grey, of which only the part left of `cut_px` shows, with normal noise.
fn picture(ellipse: &Ellipse, cut_px: f64, seed: u64) -> GrayImage {
    let mut random = Pcg32::seed_from_u64(seed);
    // Irwin and Hall: twelve uniform numbers have variance 1.
    let mut normal = || {
        let sum: f64 = (0..12).map(|_| f64::from(random.next_u32()) / f64::from(u32::MAX)).sum();
        sum - 6.0
    };
    let data = (0..SIZE * SIZE)
        .map(|i| {
            let (x, y) = ((i % SIZE) as f64, (i / SIZE) as f64);
            let shown = (cut_px + 0.5 - x).clamp(0.0, 1.0);
            let cover = (0.5 - ellipse.distance_px(x, y)).clamp(0.0, 1.0) * shown;
            (180.0 - 120.0 * cover + NOISE_GREY * normal()).round().clamp(0.0, 255.0) as u8
        })
        .collect();
    GrayImage::new(data, SIZE, SIZE).expect("a small picture")
}

#[test]
fn told_deviations_are_those_of_the_spread_over_noise() {
    let ellipse = Ellipse {
        center_x_px: 80.3,
        center_y_px: 78.6,
        semi_major_px: 52.0,
        semi_minor_px: 33.0,
        theta_rad: 0.6,
    };
    let mut detector = Detector::builder().covariance(true).build().expect("within range");
    // The whole contour, and a part of it.
    for cut_px in [1e9, 95.0] {
        let mut told = [0.0; 5];
        let mut values: Vec<[f64; 5]> = Vec::new();
        for seed in 0..PICTURES {
            let picture = picture(&ellipse, cut_px, seed);
            let detection = detector.detect(&picture.view());
            let found = detection
                .ellipses
                .iter()
                .max_by(|a, b| a.ellipse.overlap(&ellipse).total_cmp(&b.ellipse.overlap(&ellipse)))
                .unwrap_or_else(|| panic!("nothing found with seed {seed}, cut at {cut_px}"));
            let covariance = found.covariance.expect("asked for");
            for (sum, (i, row)) in told.iter_mut().zip(covariance.iter().enumerate()) {
                *sum += row[i] / PICTURES as f64;
            }
            let e = found.ellipse;
            let parameters =
                [e.center_x_px, e.center_y_px, e.semi_major_px, e.semi_minor_px, e.theta_rad];
            values.push(parameters);
        }
        for (i, name) in
            ["center x", "center y", "semi-major", "semi-minor", "theta"].iter().enumerate()
        {
            let mean: f64 = values.iter().map(|v| v[i]).sum::<f64>() / PICTURES as f64;
            let spread: f64 =
                values.iter().map(|v| (v[i] - mean).powi(2)).sum::<f64>() / (PICTURES - 1) as f64;
            let ratio = (told[i] / spread).sqrt();
            println!(
                "cut {cut_px:4.0} {name:10} told {:.4} spread {:.4} ratio {ratio:.2}",
                told[i].sqrt(),
                spread.sqrt()
            );
            assert!(
                (1.0 / FACTOR_MAX..FACTOR_MAX).contains(&ratio),
                "{name}, cut at {cut_px}: told {} px or rad, spread {}",
                told[i].sqrt(),
                spread.sqrt()
            );
        }
    }
}
