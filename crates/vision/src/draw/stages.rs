//! The stages of a detection as pictures.

use std::f32::consts::TAU;

use super::{Color, blend};
use crate::ellipse::Ellipse;
use crate::image::GrayView;
use crate::io::Picture;
use crate::stages::{ArcStage, Stages};

/// Colours of candidates with the scores 0 and 1.
const CANDIDATE_COLORS: [Color; 2] = [[32, 56, 144], [128, 192, 255]];
/// Half the width of an arc in pixels, and of a candidate.
const ARC_HALF_WIDTH_PX: f32 = 1.25;
const CANDIDATE_HALF_WIDTH_PX: f32 = 0.75;
/// Radius of a sample on an arc in pixels, and the least distance of two: nearer ones would hide the arc.
const SAMPLE_RADIUS_PX: f32 = 1.75;
const SAMPLE_SPACING_PX: f32 = 5.0;
/// Straight pieces between two samples of an arc.
const PIECES: usize = 8;
/// Length of the straight pieces of a candidate's contour in pixels.
const PIECE_PX: f64 = 3.0;
/// Neighbouring numbers get hues this far apart, as a share of the circle: no two of the next few are alike.
const HUE_STEP: f32 = 0.618_034;

/// A darkened copy of a picture, on which the stages show: `brightness` is the share that it keeps, `0..=1`; 0 gives black.
pub fn ground(gray: &GrayView<'_>, brightness: f32) -> Picture {
    let mut picture = Picture::from_gray(gray);
    for y in 0..picture.height() {
        for x in 0..picture.width() {
            if let Some(pixel) = picture.pixel_mut(x, y) {
                // The cast clips.
                *pixel = pixel.map(|value| (f32::from(value) * brightness) as u8);
            }
        }
    }
    picture
}

/// Marks the pixel of every edge point. The hue is the direction of its gradient: red where it gets brighter to the
/// right, and on through yellow-green (downwards), cyan (to the left) and violet (upwards).
pub fn edge_points(picture: &mut Picture, stages: Stages<'_>) {
    for point in stages.edge_points() {
        mark(picture, (point.x_px, point.y_px), hue(point.gradient_rad / TAU));
    }
}

/// Marks the pixels of every chain in a colour of its own.
pub fn chains(picture: &mut Picture, stages: Stages<'_>) {
    for (number, (points, _)) in stages.chains().enumerate() {
        for point in points {
            mark(picture, (point.x_px, point.y_px), color_of(number));
        }
    }
}

/// Draws every arc as a thick line in a colour of its own, with its twelve samples as white dots where the arc is long
/// enough to show them.
pub fn arcs(picture: &mut Picture, stages: Stages<'_>) {
    for (number, arc) in stages.arcs().enumerate() {
        curve(picture, &arc, color_of(number));
        let [(x, y), (next_x, next_y), ..] = arc.points;
        if (next_x - x).hypot(next_y - y) >= SAMPLE_SPACING_PX {
            for point in arc.points {
                line(picture, point, point, SAMPLE_RADIUS_PX, [255; 3]);
            }
        }
    }
}

/// Draws every candidate in blue, the brighter the better its score; the best lie on top.
pub fn candidates(picture: &mut Picture, stages: Stages<'_>) {
    let mut all: Vec<_> = stages.candidates().collect();
    all.reverse();
    for (ellipse, score) in all {
        let [dark, bright] = CANDIDATE_COLORS;
        let mixed = |i: usize| {
            let (dark, bright) = (f64::from(dark[i]), f64::from(bright[i]));
            // A mean of two bytes is a byte.
            (dark + (bright - dark) * score.clamp(0.0, 1.0)).round() as u8
        };
        contour(picture, &ellipse, [mixed(0), mixed(1), mixed(2)]);
    }
}

/// The contour of an ellipse in straight pieces: work in proportion to its length, however many there are.
fn contour(picture: &mut Picture, ellipse: &Ellipse, color: Color) {
    let pieces = (ellipse.perimeter_px() / PIECE_PX).clamp(16.0, 4096.0) as usize;
    let (sin, cos) = ellipse.theta_rad.sin_cos();
    let place = |piece: usize| {
        let turn = std::f64::consts::TAU * piece as f64 / pieces as f64;
        let (u, v) = (ellipse.semi_major_px * turn.cos(), ellipse.semi_minor_px * turn.sin());
        let x = ellipse.center_x_px + u * cos - v * sin;
        let y = ellipse.center_y_px + u * sin + v * cos;
        (x as f32, y as f32)
    };
    for piece in 0..pieces {
        line(picture, place(piece), place(piece + 1), CANDIDATE_HALF_WIDTH_PX, color);
    }
}

/// A smooth curve through the samples of an arc (a spline of Catmull and Rom).
fn curve(picture: &mut Picture, arc: &ArcStage, color: Color) {
    let last = arc.points.len() - 1;
    for at in 0..last {
        let points = [at.saturating_sub(1), at, at + 1, (at + 2).min(last)].map(|i| arc.points[i]);
        let place = |piece: usize| {
            let t = piece as f32 / PIECES as f32;
            let along = |[a, b, c, d]: [f32; 4]| {
                let bend =
                    (2.0 * a - 5.0 * b + 4.0 * c - d) * t + (3.0 * b - a - 3.0 * c + d) * t * t;
                b + 0.5 * t * (c - a + bend)
            };
            (along(points.map(|point| point.0)), along(points.map(|point| point.1)))
        };
        for piece in 0..PIECES {
            line(picture, place(piece), place(piece + 1), ARC_HALF_WIDTH_PX, color);
        }
    }
}

/// A straight line with round ends; what lies outside the picture is cut.
fn line(picture: &mut Picture, from: (f32, f32), to: (f32, f32), half_width_px: f32, color: Color) {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length2 = (dx * dx + dy * dy).max(f32::MIN_POSITIVE);
    let reach = half_width_px + 0.5;
    // Casts clip at 0 and turn what is not a number into 0.
    let span = |a: f32, b: f32, length: usize| {
        let behind = ((a.max(b) + reach).floor() + 1.0) as usize;
        (a.min(b) - reach).ceil() as usize..behind.min(length)
    };
    for y in span(from.1, to.1, picture.height()) {
        for x in span(from.0, to.0, picture.width()) {
            let (px, py) = (x as f32 - from.0, y as f32 - from.1);
            let t = ((px * dx + py * dy) / length2).clamp(0.0, 1.0);
            let distance = (px - t * dx).hypot(py - t * dy);
            blend(picture, x, y, color, f64::from(reach - distance));
        }
    }
}

/// Colours the pixel that holds a point; points lie inside the picture.
fn mark(picture: &mut Picture, (x, y): (f32, f32), color: Color) {
    if let Some(pixel) = picture.pixel_mut(x.round() as usize, y.round() as usize) {
        *pixel = color;
    }
}

/// The colour of the chain or arc with this number.
fn color_of(number: usize) -> Color {
    hue(number as f32 * HUE_STEP)
}

/// A bright colour, `turn` times round the circle of hues from red.
fn hue(turn: f32) -> Color {
    let channel = |shift: f32| {
        let distance = ((turn + shift).rem_euclid(1.0) * 6.0 - 3.0).abs() - 1.0;
        // From 56 to 255: no channel is dark altogether, so that blue shows on black.
        56 + (distance.clamp(0.0, 1.0) * 199.0).round() as u8
    };
    [channel(0.0), channel(2.0 / 3.0), channel(1.0 / 3.0)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detector::Detector;
    use crate::test_pictures::rings;

    #[test]
    fn what_is_drawn_of_a_ring_lies_along_it() {
        let truth = Ellipse {
            center_x_px: 80.0,
            center_y_px: 60.0,
            semi_major_px: 50.0,
            semi_minor_px: 35.0,
            theta_rad: 0.4,
        };
        let gray = rings(160, 120, &[truth], 4.0);
        let mut detector = Detector::default();
        detector.detect(&gray.view());
        let all: [fn(&mut Picture, Stages<'_>); 4] = [edge_points, chains, arcs, candidates];
        for (stage, draw) in all.iter().enumerate() {
            let mut picture = Picture::new(vec![0; 160 * 120 * 3], 160, 120).unwrap();
            draw(&mut picture, detector.stages());
            let mut drawn = 0;
            for (index, pixel) in picture.rgb().chunks_exact(3).enumerate() {
                if pixel != [0; 3] {
                    let (x, y) = ((index % 160) as f64, (index / 160) as f64);
                    let distance = truth.distance_px(x, y).abs();
                    assert!(distance < 6.0, "stage {stage}: ({x}, {y}) at {distance} px");
                    drawn += 1;
                }
            }
            assert!(drawn > 200, "stage {stage}: {drawn} pixels");
        }
    }

    #[test]
    fn hues_go_round() {
        assert_eq!(
            [hue(0.0), hue(1.0 / 3.0), hue(2.0 / 3.0)],
            [[255, 56, 56], [56, 255, 56], [56, 56, 255]]
        );
        assert_eq!(hue(-1.0 / 3.0), hue(2.0 / 3.0));
    }
}
