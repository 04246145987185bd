//! Drawing what was found (feature `image`).

pub mod stages;

use crate::ellipse::Ellipse;
use crate::io::Picture;

/// Red, green, blue.
pub type Color = [u8; 3];
/// Colour of the ellipses and centres in [`annotate`]: a green that few things in a room have.
pub const ELLIPSE_COLOR: Color = [32, 255, 32];
/// Half the width of the drawn contour in pixels.
const HALF_WIDTH_PX: f64 = 0.75;
/// Length of one arm of the cross at a centre, in pixels.
const CROSS_PX: i64 = 4;

/// Draws every ellipse with a cross at its centre.
pub fn annotate<'a>(picture: &mut Picture, ellipses: impl IntoIterator<Item = &'a Ellipse>) {
    for found in ellipses {
        ellipse(picture, found, ELLIPSE_COLOR);
        cross(picture, found, ELLIPSE_COLOR);
    }
}

/// Draws the contour of an ellipse as an anti-aliased line of 1.5 px; what lies outside the picture is cut.
pub fn ellipse(picture: &mut Picture, ellipse: &Ellipse, color: Color) {
    let reach = HALF_WIDTH_PX + 0.5;
    let (half_width, half_height) = ellipse.half_extent_px();
    let rows = clip(ellipse.center_y_px, half_height + reach, picture.height());
    for y in rows {
        for x in clip(ellipse.center_x_px, half_width + reach, picture.width()) {
            let distance = ellipse.distance_px(x as f64, y as f64).abs();
            blend(picture, x, y, color, reach - distance);
        }
    }
}

/// Draws an upright cross at the centre of an ellipse.
pub fn cross(picture: &mut Picture, ellipse: &Ellipse, color: Color) {
    // Casts clip; a centre far outside draws nothing.
    let (x, y) = (ellipse.center_x_px.round() as i64, ellipse.center_y_px.round() as i64);
    for step in -CROSS_PX..=CROSS_PX {
        for (x, y) in [(x.saturating_add(step), y), (x, y.saturating_add(step))] {
            if let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) {
                blend(picture, x, y, color, 1.0);
            }
        }
    }
}

/// The pixels within `reach` of `center` along a side of `length` pixels.
fn clip(center: f64, reach: f64, length: usize) -> std::ops::Range<usize> {
    // Casts clip at 0 and turn what is not a number into 0.
    let first = (center - reach).ceil() as usize;
    let behind = ((center + reach).floor() + 1.0) as usize;
    first..behind.min(length)
}

/// Mixes `color` into a pixel; `cover` is clipped to `0..=1`.
fn blend(picture: &mut Picture, x: usize, y: usize, color: Color, cover: f64) {
    if cover.is_nan() || cover <= 0.0 {
        return;
    }
    let cover = cover.min(1.0);
    if let Some(pixel) = picture.pixel_mut(x, y) {
        for (value, &wanted) in pixel.iter_mut().zip(&color) {
            // A mean of two bytes is a byte.
            *value = (f64::from(*value) * (1.0 - cover) + f64::from(wanted) * cover).round() as u8;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn blank() -> Picture {
        Picture::new(vec![0; 100 * 80 * 3], 100, 80).expect("a picture")
    }

    #[test]
    fn drawn_pixels_lie_on_the_contour_and_all_of_it_is_drawn() {
        let truth = Ellipse {
            center_x_px: 50.0,
            center_y_px: 40.0,
            semi_major_px: 30.0,
            semi_minor_px: 18.0,
            theta_rad: 0.7,
        };
        let mut picture = blank();
        ellipse(&mut picture, &truth, [255, 0, 0]);
        for y in 0..80 {
            for x in 0..100 {
                let red = picture.rgb()[(y * 100 + x) * 3];
                let distance = truth.distance_px(x as f64, y as f64).abs();
                assert!(red == 0 || distance < 1.3, "({x}, {y}) is {red} at {distance} px");
                assert!(red == 255 || distance > 0.2, "({x}, {y}) is {red} at {distance} px");
            }
        }
    }

    #[test]
    fn what_lies_outside_is_cut_and_nonsense_draws_nothing() {
        let shape = |x, y, a, b| Ellipse {
            center_x_px: x,
            center_y_px: y,
            semi_major_px: a,
            semi_minor_px: b,
            theta_rad: 1.0,
        };
        for far in [
            shape(-500.0, 9.0, 30.0, 20.0),
            shape(1e300, -1e300, 5.0, 5.0),
            shape(f64::NAN, 9.0, 30.0, 20.0),
        ] {
            let mut picture = blank();
            ellipse(&mut picture, &far, [255; 3]);
            if far.center_x_px.is_finite() {
                cross(&mut picture, &far, [255; 3]);
            }
            assert_eq!(picture, blank(), "{far:?}");
        }
        let mut picture = blank();
        ellipse(&mut picture, &shape(0.0, 0.0, 30.0, 20.0), [255; 3]);
        cross(&mut picture, &shape(0.0, 0.0, 30.0, 20.0), [255; 3]);
        assert_ne!(picture, blank());
    }
}
