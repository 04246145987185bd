//! Pictures drawn by the tests of the public interface.
#![allow(dead_code, reason = "each test file takes what it needs")]
#![allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, clippy::cast_sign_loss)]

use rsapien_vision::{Ellipse, GrayImage};

/// Centre, semi-axes and angle.
pub(crate) fn ellipse(x: f64, y: f64, a: f64, b: f64, theta_rad: f64) -> Ellipse {
    Ellipse { center_x_px: x, center_y_px: y, semi_major_px: a, semi_minor_px: b, theta_rad }
}

/// A picture whose grey values are a function of the place; values outside `0..=255` are cut.
pub(crate) fn picture(width: usize, height: usize, grey: impl Fn(f64, f64) -> f64) -> GrayImage {
    let places = (0..width * height).map(|i| ((i % width) as f64, (i / width) as f64));
    let pixels = places.map(|(x, y)| grey(x, y).round() as u8).collect();
    GrayImage::new(pixels, width, height).expect("a test picture is within the limits")
}

/// Grey 40 with an anti-aliased disc of grey 200 in each of `discs`, and a dark stroke of 5 px along each of `rings`.
pub(crate) fn scene(
    width: usize,
    height: usize,
    discs: &[Ellipse],
    rings: &[Ellipse],
) -> GrayImage {
    picture(width, height, |x, y| {
        let inside = |ellipse: &Ellipse| (0.5 - ellipse.distance_px(x, y)).clamp(0.0, 1.0);
        let stroke = |ellipse: &Ellipse| (3.0 - ellipse.distance_px(x, y).abs()).clamp(0.0, 1.0);
        let disc = discs.iter().map(inside).fold(0.0, f64::max);
        let ring = rings.iter().map(stroke).fold(0.0, f64::max);
        90.0 + 110.0 * disc - 80.0 * ring * (1.0 - disc)
    })
}

/// Numbers that look random and are the same in every run (`SplitMix64`).
pub(crate) fn random(seed: u64, at: u64) -> u64 {
    let mut z = seed.wrapping_add(at.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Three discs and two rings, and where they are.
pub(crate) fn table(width: usize, height: usize) -> (GrayImage, Vec<Ellipse>) {
    let (x, y) = (width as f64 / 320.0, height as f64 / 240.0);
    let discs = [
        ellipse(60.3 * x, 60.7 * y, 40.0, 30.0, 0.3),
        ellipse(160.2 * x, 70.1 * y, 35.5, 35.5, 0.0),
        ellipse(250.8 * x, 60.4 * y, 45.2, 18.3, 2.1),
    ];
    let rings = [
        ellipse(80.6 * x, 175.2 * y, 50.3, 40.9, 1.0),
        ellipse(220.4 * x, 170.9 * y, 48.7, 33.2, 2.8),
    ];
    (scene(width, height, &discs, &rings), discs.into_iter().chain(rings).collect())
}
