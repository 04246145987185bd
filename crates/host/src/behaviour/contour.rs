//! Whether an ellipse is a contour: the brightness changes across it, all around.

use rsapien_vision::{Ellipse, GrayImage};

/// Points of the contour that are looked at.
const POINTS: u32 = 90;
/// How far from the contour its edge may be, in pixels.
const REACH_PX: f64 = 2.0;
/// Least change of brightness over two pixels that is no noise, in grey levels.
const CHANGE_MIN: f64 = 16.0;
/// Least cosine of the angle between the brightest change and the contour's normal: 26 degrees.
const COSINE_MIN: f64 = 0.9;
/// Least share of the contour that has to lie in the picture.
const INSIDE_MIN: f64 = 0.6;

/// Share of the contour, as far as it lies in the picture, across which the brightness changes, `0..=1`; 0 when less
/// than three fifths of it lie there.
///
/// The contour of a thing has 0.8 and more. What a search puts together from the grain of wood has about a third,
/// since the grain's edges all run the same way.
pub fn contour_share(picture: &GrayImage, ellipse: &Ellipse) -> f64 {
    let (mut inside, mut crossed) = (0_u32, 0_u32);
    for (x, y) in ellipse.outline(POINTS) {
        // The gradient of the implicit equation, from two points a little apart.
        let normal_x = ellipse.distance_px(x + 0.5, y) - ellipse.distance_px(x - 0.5, y);
        let normal_y = ellipse.distance_px(x, y + 0.5) - ellipse.distance_px(x, y - 0.5);
        let length = normal_x.hypot(normal_y).max(f64::EPSILON);
        let normal = (normal_x / length, normal_y / length);
        let Some((change, cosine)) = strongest_change(picture, (x, y), normal) else { continue };
        inside += 1;
        crossed += u32::from(change >= CHANGE_MIN && cosine >= COSINE_MIN);
    }
    if f64::from(inside) < INSIDE_MIN * f64::from(POINTS) {
        return 0.0;
    }
    f64::from(crossed) / f64::from(inside)
}

/// The strongest change of brightness near a point along its normal, with its direction's cosine to the normal; none
/// at the picture's edge or outside.
fn strongest_change(
    picture: &GrayImage,
    (x, y): (f64, f64),
    normal: (f64, f64),
) -> Option<(f64, f64)> {
    let mut strongest = (0.0, 0.0);
    for step in -2..=2 {
        let along = REACH_PX / 2.0 * f64::from(step);
        let (gradient_x, gradient_y) =
            gradient(picture, x + normal.0 * along, y + normal.1 * along)?;
        let change = gradient_x.hypot(gradient_y);
        if change > strongest.0 {
            let cosine = (gradient_x * normal.0 + gradient_y * normal.1).abs() / change;
            strongest = (change, cosine);
        }
    }
    Some(strongest)
}

/// Change of brightness over two pixels along x and y, by the Sobel kernels.
fn gradient(picture: &GrayImage, x: f64, y: f64) -> Option<(f64, f64)> {
    // The casts clip: below to 0, which has no neighbour on that side, above to where no picture reaches.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let (x, y) = (x.round() as usize, y.round() as usize);
    let first = x.checked_sub(1)?;
    let row = |y: usize| -> Option<[f64; 3]> {
        let begin = y.checked_mul(picture.width())?;
        let row = picture.pixels().get(begin..)?.get(..picture.width())?;
        Some(row.get(first..)?.first_chunk::<3>()?.map(f64::from))
    };
    let (above, here, below) = (row(y.checked_sub(1)?)?, row(y)?, row(y.checked_add(1)?)?);
    let across = |row: [f64; 3]| row[2] - row[0];
    let sum = |row: [f64; 3]| row[0] + 2.0 * row[1] + row[2];
    Some((
        (across(above) + 2.0 * across(here) + across(below)) / 4.0,
        (sum(below) - sum(above)) / 4.0,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(brightness: impl Fn(f64, f64) -> u8) -> GrayImage {
        #[allow(clippy::cast_precision_loss)]
        let pixel = |index: usize| brightness((index % 160) as f64, (index / 160) as f64);
        GrayImage::new((0..160 * 120).map(pixel).collect(), 160, 120).unwrap()
    }

    fn circle(center_x_px: f64) -> Ellipse {
        Ellipse {
            center_x_px,
            center_y_px: 60.0,
            semi_major_px: 30.0,
            semi_minor_px: 30.0,
            theta_rad: 0.0,
        }
    }

    #[test]
    fn a_disc_has_its_contour_and_no_other() {
        let disc = picture(|x, y| if (x - 80.0).hypot(y - 60.0) < 30.0 { 200 } else { 90 });
        assert!(contour_share(&disc, &circle(80.0)) > 0.95);
        assert!(contour_share(&disc, &circle(81.5)) > 0.8);
        assert!(contour_share(&disc, &circle(100.0)) < 0.3);
        assert!(contour_share(&picture(|_, _| 90), &circle(80.0)) < 1e-9);
    }

    #[test]
    fn grain_is_no_contour_however_dense_its_edges_are() {
        let grain = picture(|_, y| if (y / 3.0).fract() < 0.5 { 60 } else { 180 });
        assert!(contour_share(&grain, &circle(80.0)) < 0.45);
    }

    #[test]
    fn what_is_mostly_outside_is_none() {
        let disc = picture(|x, y| if x.hypot(y - 60.0) < 30.0 { 200 } else { 90 });
        assert!(contour_share(&disc, &circle(0.0)) < 1e-9);
        assert!(contour_share(&disc, &circle(1e300)) < 1e-9);
    }
}
