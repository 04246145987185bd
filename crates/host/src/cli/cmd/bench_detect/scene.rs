//! Pictures that are the same wherever they are drawn: shaded ground, noise, lines, boxes, discs and rings.

use std::f64::consts::{PI, TAU};

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rsapien_vision::image::check_size;
use rsapien_vision::{Ellipse, GrayImage, ImageError};

/// Discs and rings of a scene.
const ELLIPSES: usize = 12;
const LINES: usize = 24;
const BOXES: usize = 8;
/// Greatest deviation of the noise from nothing, in grey values.
const NOISE: f64 = 6.0;
/// Places tried for an ellipse that is to overlap no other; then it overlaps one.
const PLACES_MAX: usize = 200;

/// What a picture is painted on: grey values, row by row.
struct Canvas {
    values: Vec<f64>,
    width: usize,
    height: usize,
}

/// Draws scene number `seed` of this size. Lengths are shares of the picture's sides, so that scenes of one seed and
/// proportion differ in their pixels alone.
///
/// # Errors
/// No picture has this size.
pub(super) fn draw(width: usize, height: usize, seed: u64) -> Result<GrayImage, ImageError> {
    check_size(width, height)?;
    let mut random = Pcg64::seed_from_u64(seed);
    let mut canvas = Canvas { values: vec![0.0; width * height], width, height };
    canvas.shade(&mut random);
    for _ in 0..BOXES {
        canvas.paint_box(&mut random);
    }
    for _ in 0..LINES {
        canvas.paint_line(&mut random);
    }
    let mut ellipses = Vec::new();
    for index in 0..ELLIPSES {
        let ellipse = canvas.place(&ellipses, &mut random);
        canvas.paint_ellipse(&ellipse, index % 3 == 2, &mut random);
        ellipses.push(ellipse);
    }
    let pixels = canvas.values.iter().map(|value| {
        // Two draws make the middle likelier than the ends.
        let noise = random.random_range(-NOISE..NOISE) + random.random_range(-NOISE..NOISE);
        // In a byte's range, so that the cast loses a fraction of 0.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let grey = (value + noise / 2.0).round().clamp(0.0, 255.0) as u8;
        grey
    });
    GrayImage::new(pixels.collect(), width, height)
}

impl Canvas {
    /// A share of the smaller side in pixels.
    fn scaled(&self, share: f64) -> f64 {
        share * to_f64(self.width.min(self.height))
    }

    /// A place anywhere in the picture.
    fn anywhere(&self, random: &mut Pcg64) -> (f64, f64) {
        let (x, y) = (random.random_range(0.0..1.0), random.random_range(0.0..1.0));
        (x * to_f64(self.width), y * to_f64(self.height))
    }

    /// A ground that grows brighter to one side and waves a little.
    fn shade(&mut self, random: &mut Pcg64) {
        let (direction, phase): (f64, f64) =
            (random.random_range(0.0..TAU), random.random_range(0.0..TAU));
        let (sin, cos) = direction.sin_cos();
        for (index, value) in self.values.iter_mut().enumerate() {
            let x = to_f64(index % self.width) / to_f64(self.width) - 0.5;
            let y = to_f64(index / self.width) / to_f64(self.height) - 0.5;
            *value = 125.0 + 50.0 * (x * cos + y * sin) + 8.0 * (7.0 * (x - y) + phase).sin();
        }
    }

    /// Mixes `grey` into the pixels of a box around (`x`, `y`) that reaches `half_width` and `half_height` pixels, as far
    /// as `cover` (clipped to `0..=1`) says of each.
    fn paint(
        &mut self,
        (x, y): (f64, f64),
        (half_width, half_height): (f64, f64),
        grey: f64,
        cover: impl Fn(f64, f64) -> f64,
    ) {
        for row in span(y, half_height, self.height) {
            for column in span(x, half_width, self.width) {
                let cover = cover(to_f64(column), to_f64(row)).clamp(0.0, 1.0);
                let value = &mut self.values[row * self.width + column];
                *value += (grey - *value) * cover;
            }
        }
    }

    /// A filled rectangle, upright.
    fn paint_box(&mut self, random: &mut Pcg64) {
        let (x, y) = self.anywhere(random);
        let half = (
            self.scaled(random.random_range(0.03..0.2)),
            self.scaled(random.random_range(0.03..0.2)),
        );
        let grey = random.random_range(60.0..190.0);
        self.paint((x, y), half, grey, |column, row| {
            let inside = (half.0 - (column - x).abs()).min(half.1 - (row - y).abs());
            inside + 0.5
        });
    }

    /// A stroke between two places.
    fn paint_line(&mut self, random: &mut Pcg64) {
        let (from, to) = (self.anywhere(random), self.anywhere(random));
        let half_width = self.scaled(random.random_range(0.002..0.008)).max(0.5);
        let grey = random.random_range(20.0..235.0);
        let middle = (f64::midpoint(from.0, to.0), f64::midpoint(from.1, to.1));
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let length = dx.hypot(dy).max(1.0);
        let reach = (dx.abs() / 2.0 + half_width, dy.abs() / 2.0 + half_width);
        self.paint(middle, reach, grey, |column, row| {
            let (u, v) = (column - middle.0, row - middle.1);
            let along = (u * dx + v * dy).abs() / length - length / 2.0;
            let across = (v * dx - u * dy).abs() / length;
            half_width - across.max(along) + 0.5
        });
    }

    /// A place for an ellipse: apart from the others where there is one.
    fn place(&self, others: &[Ellipse], random: &mut Pcg64) -> Ellipse {
        let semi_major_px = self.scaled(random.random_range(0.04..0.16));
        let semi_minor_px = semi_major_px * random.random_range(0.4..1.0);
        let theta_rad = random.random_range(0.0..PI);
        let at = |(center_x_px, center_y_px)| Ellipse {
            center_x_px,
            center_y_px,
            semi_major_px,
            semi_minor_px,
            theta_rad,
        };
        let is_apart = |ellipse: &Ellipse| {
            others.iter().all(|other| {
                let (dx, dy) = (
                    ellipse.center_x_px - other.center_x_px,
                    ellipse.center_y_px - other.center_y_px,
                );
                dx.hypot(dy) > 1.05 * (ellipse.semi_major_px + other.semi_major_px)
            })
        };
        let mut tried = (0..PLACES_MAX).map(|_| at(self.anywhere(random)));
        match tried.find(is_apart) {
            Some(ellipse) => ellipse,
            None => at(self.anywhere(random)),
        }
    }

    /// A disc, or a ring drawn with a stroke.
    fn paint_ellipse(&mut self, ellipse: &Ellipse, is_ring: bool, random: &mut Pcg64) {
        // Dark or bright, so that it stands out from any ground.
        let grey = if random.random_bool(0.5) {
            random.random_range(15.0..50.0)
        } else {
            random.random_range(205.0..240.0)
        };
        let half_stroke = self.scaled(0.004).max(1.0);
        let (half_width, half_height) = ellipse.half_extent_px();
        let reach = (half_width + half_stroke, half_height + half_stroke);
        self.paint((ellipse.center_x_px, ellipse.center_y_px), reach, grey, |column, row| {
            let distance = ellipse.distance_px(column, row);
            if is_ring { half_stroke - distance.abs() + 0.5 } else { 0.5 - distance }
        });
    }
}

/// The pixels of a side of `length` pixels that lie within `reach`, or one more, of `center`.
fn span(center: f64, reach: f64, length: usize) -> std::ops::Range<usize> {
    // Casts clip at 0.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let (first, behind) =
        ((center - reach - 1.0).floor() as usize, (center + reach + 2.0).ceil() as usize);
    first.min(length)..behind.min(length)
}

/// Sides have at most 16384 pixels.
#[expect(clippy::cast_precision_loss)]
fn to_f64(count: usize) -> f64 {
    count as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_is_the_same_again_and_scales() {
        let mean = |picture: &GrayImage| {
            let sum: u64 = picture.pixels().iter().map(|&grey| u64::from(grey)).sum();
            sum / picture.pixels().len() as u64
        };
        let small = draw(160, 120, 1).unwrap();
        assert_eq!(small, draw(160, 120, 1).unwrap());
        assert_ne!(small, draw(160, 120, 2).unwrap());
        let large = draw(640, 480, 1).unwrap();
        assert!(mean(&small).abs_diff(mean(&large)) <= 2, "{} {}", mean(&small), mean(&large));
        assert!(draw(1, 1, 1).is_ok() && draw(0, 1, 1).is_err());
    }
}
