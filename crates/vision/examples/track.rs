//! What following costs beside fresh detections, on a drawn film with truth.
//!
//! `cargo run --release -p rsapien-vision --example track -- [PICTURES]`
//!
//! Eight discs and rings move over a ground with stripes, noise and straight lines; half way the camera is turned. Prints
//! precision, recall and F at an overlap of 0.8 and the mean time a picture, for a detection of every picture by itself and
//! for the tracker, and how many pictures the tracker needs after the turn. One thread.

// Pictures are small, and counts of a few thousand are exact in f64.
#![allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use std::error::Error;
use std::time::{Duration, Instant};

use rsapien_vision::evaluate::{Summary, Truth, score_picture};
use rsapien_vision::tracker::TrackState;
use rsapien_vision::{Detector, Ellipse, GrayImage, Tracker, TrackerOptions};

const SIZE: (usize, usize) = (640, 480);
const OVERLAP_MIN: f64 = 0.8;
const FRAMES_PER_SECOND: f64 = 25.0;
/// How far the camera is turned, in pixels.
const TURN_PX: (f64, f64) = (60.0, 35.0);

fn main() -> Result<(), Box<dyn Error>> {
    let pictures: usize = std::env::args().nth(1).map_or(Ok(200), |count| count.parse())?;
    let turn_at = pictures / 2;
    let mut detector = Detector::default();
    let mut tracker = Tracker::new(Detector::default(), TrackerOptions::default())?;
    let (mut fresh, mut followed) = (Summary::default(), Summary::default());
    let (mut fresh_time, mut followed_time) = (Duration::ZERO, Duration::ZERO);
    let mut recovered_after = None;
    for number in 0..pictures {
        let truth = Truth {
            image: String::new(),
            ellipses: scene(number, number >= turn_at),
            ignore: Vec::new(),
        };
        let picture = draw(&truth.ellipses, number as u64)?;
        let start = Instant::now();
        let found = detector.detect(&picture.view());
        fresh_time += start.elapsed();
        let found: Vec<_> = found.ellipses.iter().map(|found| found.ellipse).collect();
        add(&mut fresh, &found, &truth);

        let start = Instant::now();
        let tracks = tracker.update(&picture.view(), number as f64 / FRAMES_PER_SECOND);
        followed_time += start.elapsed();
        let seen = tracks.iter().filter(|track| track.misses == 0);
        let found: Vec<_> = seen.map(|track| track.ellipse).collect();
        add(&mut followed, &found, &truth);
        let confirmed = |state: TrackState| state == TrackState::Confirmed;
        let all =
            tracks.iter().filter(|track| confirmed(track.state)).count() >= truth.ellipses.len();
        if number >= turn_at && all && recovered_after.is_none() {
            recovered_after = Some(number - turn_at + 1);
        }
    }
    let ms = |time: Duration| time.as_secs_f64() * 1e3 / pictures as f64;
    for (name, summary, time) in
        [("fresh", &fresh, fresh_time), ("tracker", &followed, followed_time)]
    {
        println!(
            "{name:8} P {:.3}  R {:.3}  F {:.3}  {:.3} ms a picture",
            summary.precision(),
            summary.recall(),
            summary.f(),
            ms(time)
        );
    }
    println!("ratio of the times {:.2}", ms(followed_time) / ms(fresh_time));
    match recovered_after {
        Some(count) => println!("all confirmed again in picture {count} after the turn"),
        None => println!("not all confirmed again after the turn"),
    }
    Ok(())
}

fn add(summary: &mut Summary, found: &[Ellipse], truth: &Truth) {
    for score in score_picture(found, truth, &[OVERLAP_MIN]) {
        summary.add(&score);
    }
}

/// Where the eight are in picture `number`.
fn scene(number: usize, is_turned: bool) -> Vec<Ellipse> {
    let time_s = number as f64 / FRAMES_PER_SECOND;
    let shift = if is_turned { TURN_PX } else { (0.0, 0.0) };
    (0..8)
        .map(|i| {
            let (column, row) = (f64::from(i % 4), f64::from(i / 4));
            let phase = f64::from(i) * 0.8;
            Ellipse {
                center_x_px: 95.0 + 130.0 * column + 18.0 * (time_s + phase).sin() + shift.0,
                center_y_px: 120.0 + 190.0 * row + 25.0 * (0.7 * time_s + phase).cos() + shift.1,
                semi_major_px: 34.0 + 5.0 * (0.5 * time_s + phase).sin(),
                semi_minor_px: 24.0 + 2.0 * phase.cos(),
                theta_rad: phase + 0.2 * time_s,
            }
            .canonical()
        })
        .collect()
}

/// Dark discs, every third a ring, on a striped ground with lines and noise.
fn draw(ellipses: &[Ellipse], seed: u64) -> Result<GrayImage, Box<dyn Error>> {
    let (width, height) = SIZE;
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut noise = || {
        // Sum of four bytes of a xorshift: nearly normal, standard deviation 6 grey values.
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        let sum: u64 = (0..4).map(|i| (state >> (8 * i)) & 0xFF).sum();
        (sum as f64 - 510.0) / 147.8 * 6.0
    };
    let mut data = Vec::with_capacity(width * height);
    for y in 0..height {
        for x in 0..width {
            let (fx, fy) = (x as f64, y as f64);
            let mut value = 170.0 + 20.0 * (fx / 37.0).sin() + 0.05 * fy;
            if (x + 2 * y) % 160 < 2 || (3 * x + y) % 230 < 2 {
                value -= 70.0;
            }
            for (i, ellipse) in ellipses.iter().enumerate() {
                let (dx, dy) = (fx - ellipse.center_x_px, fy - ellipse.center_y_px);
                if dx.abs() > 45.0 || dy.abs() > 45.0 {
                    continue;
                }
                let distance = ellipse.distance_px(fx, fy);
                let depth = if i % 3 == 2 { distance.abs() - 2.0 } else { distance };
                value += (50.0 - value) * (0.5 - depth).clamp(0.0, 1.0);
            }
            data.push((value + noise()).round().clamp(0.0, 255.0) as u8);
        }
    }
    Ok(GrayImage::new(data, width, height)?)
}
