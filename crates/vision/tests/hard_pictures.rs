//! Pictures that would take forever, or break, if something in the detector had no bound. What is looked at are counts,
//! which are the same on every machine; a clock only tells that a test ended, generously.
#![allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, clippy::cast_sign_loss)]

mod drawing;

use std::time::{Duration, Instant};

use drawing::{picture, random};
use rsapien_vision::{Detection, Detector, GrayImage};

/// More than a hundred times what a picture of these sizes takes, in a debug build.
const TIME_MAX: Duration = Duration::from_mins(1);

fn look(name: &str, image: &GrayImage) -> Detection {
    let start = Instant::now();
    let mut detector = Detector::builder().build().unwrap();
    let detection = detector.detect(&image.view()).clone();
    let (took, counts) = (start.elapsed(), detection.statistics);
    println!(
        "{name} {}x{}: {} ms, {counts:?}, {} found, truncated {}",
        image.width(),
        image.height(),
        took.as_millis(),
        detection.ellipses.len(),
        detection.truncated
    );
    assert!(took < TIME_MAX, "{name}: {took:?}, {counts:?}");
    assert!(counts.pairs <= 60_000 && counts.candidates <= 6_000, "{name}: {counts:?}");
    assert!(counts.edge_points <= image.width() * image.height() / 2, "{name}: {counts:?}");
    assert!(counts.accepted <= counts.candidates && detection.ellipses.len() <= counts.accepted);
    detection
}

#[test]
fn every_small_size_and_the_longest() {
    let shades: [fn(f64, f64) -> f64; 3] =
        [|_, _| 0.0, |_, _| 255.0, |x, y| (random(1, (y * 20_000.0 + x) as u64) & 255) as f64];
    let sides = [1, 2, 3, 4, 5, 7, 63, 64, 65, 127, 128, 129];
    for shade in shades {
        for width in sides {
            for height in sides {
                let found = look("small", &picture(width, height, shade)).ellipses;
                assert!(found.is_empty() || width.min(height) > 5, "{width} x {height}: {found:?}");
            }
        }
        for (width, height) in [
            (16_384, 1),
            (1, 16_384),
            (16_384, 2),
            (2, 16_384),
            (16_384, 3),
            (3, 16_384),
            (16_383, 5),
        ] {
            assert!(look("long", &picture(width, height, shade)).ellipses.is_empty());
        }
    }
}

#[test]
fn nothing_is_found_where_there_is_nothing() {
    for (name, image) in [
        ("black", picture(333, 251, |_, _| 0.0)),
        ("white", picture(333, 251, |_, _| 255.0)),
        ("ramp", picture(333, 251, |x, _| x * 0.7)),
        (
            "saturated noise",
            picture(333, 251, |x, y| 255.0 * (random(2, (y * 333.0 + x) as u64) & 1) as f64),
        ),
        ("grey noise", picture(333, 251, |x, y| (random(3, (y * 333.0 + x) as u64) & 255) as f64)),
        ("stripes", picture(333, 251, |x, y| 255.0 * f64::from((x + 2.0 * y) as u32 / 9 % 2))),
    ] {
        assert!(look(name, &image).ellipses.is_empty(), "{name}");
    }
}

#[test]
fn checkerboards_of_every_period() {
    for period in 1..=8 {
        let image = picture(320, 240, |x, y| {
            255.0 * f64::from((x as u32 / period + y as u32 / period) % 2)
        });
        assert!(look("checkerboard", &image).ellipses.is_empty(), "period {period}");
    }
}

#[test]
fn patterns_that_turn_everywhere() {
    look("moiré", &picture(640, 480, |x, y| 128.0 + 127.0 * ((x * x + y * y) / 150.0).sin()));
    look(
        "rings",
        &picture(640, 480, |x, y| 128.0 + 127.0 * ((x - 320.0).hypot(y - 240.0) * 0.8).sin()),
    );
    look(
        "waves",
        &picture(640, 480, |x, y| {
            128.0 + 60.0 * (0.5 * x + 4.0 * (0.3 * y).sin()).sin() + 60.0 * (0.5 * y).sin()
        }),
    );
    let found = look(
        "spiral",
        &picture(800, 800, |x, y| {
            let (dx, dy) = (x - 400.0, y - 400.0);
            128.0 + 100.0 * (dx.hypot(dy) * std::f64::consts::TAU / 12.0 + dy.atan2(dx)).sin()
        }),
    );
    assert!(found.statistics.arcs > 30);
}

#[test]
fn crowds() {
    // Strokes of every direction in cells like letters.
    let text = |x: f64, y: f64| {
        let (cell_x, cell_y) = ((x / 9.0) as u64, (y / 14.0) as u64);
        let letter = random(5, cell_y * 1000 + cell_x);
        let (u, v) = (x % 9.0 - 4.0, y % 14.0 - 6.0);
        let on = (0..3).any(|i| {
            let bits = letter >> (8 * i);
            let radius = 2.0 + (bits & 3) as f64;
            let (cx, cy) = (((bits >> 2) & 3) as f64 - 2.0, ((bits >> 4) & 7) as f64 - 4.0);
            ((u - cx).hypot(v - cy) - radius).abs() < 0.8
        });
        if on { 30.0 } else { 220.0 }
    };
    look("text", &picture(640, 480, text));
    // Boxes on boxes.
    let boxes: Vec<_> = (0..500)
        .map(|i| {
            let side = |at: u64, size: u64| (random(6, 4 * i + at) % size) as f64;
            (side(0, 640), side(1, 480), side(2, 60), side(3, 60), (random(7, i) & 255) as f64)
        })
        .collect();
    let found = look(
        "boxes",
        &picture(640, 480, |x, y| {
            boxes
                .iter()
                .rev()
                .find(|(left, top, width, height, _)| {
                    (0.0..*width).contains(&(x - left)) && (0.0..*height).contains(&(y - top))
                })
                .map_or(128.0, |shape| shape.4)
        }),
    );
    assert!(found.ellipses.len() < 10, "{:#?}", found.ellipses);
    let patch =
        |x: f64, y: f64| (random(8, (y / 4.0) as u64 * 1000 + (x / 4.0) as u64) & 255) as f64;
    look("patches", &picture(640, 480, patch));
    // Discs side by side, as many as find room.
    let found = look(
        "discs",
        &picture(640, 480, |x, y| {
            let (dx, dy) = (x.rem_euclid(16.0) - 8.0, y.rem_euclid(16.0) - 8.0);
            60.0 + 120.0 * (6.5 - dx.hypot(dy)).clamp(0.0, 1.0)
        }),
    );
    assert!(found.ellipses.len() > 1100, "{} of 1200", found.ellipses.len());
}
