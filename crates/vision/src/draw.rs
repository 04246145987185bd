//! Drawing what was found (feature `image`).

use crate::detect::Detection;
use crate::ellipse::Ellipse;
use crate::io::Picture;

/// Red, green, blue.
pub type Color = [u8; 3];
/// Colour of the ellipses in [`annotate`].
pub const ELLIPSE_COLOR: Color = [255, 32, 32];
/// Colour of the centres in [`annotate`].
pub const CENTER_COLOR: Color = [32, 224, 32];
/// Half the width of the drawn contour in pixels.
const HALF_WIDTH_PX: f64 = 0.75;
/// Length of one arm of the cross at a centre, in pixels.
const CROSS_PX: i64 = 4;

/// Draws every ellipse of a detection with a cross at its centre.
pub fn annotate(picture: &mut Picture, detection: &Detection) {
    for detected in &detection.ellipses {
        ellipse(picture, &detected.ellipse, ELLIPSE_COLOR);
        cross(picture, &detected.ellipse, CENTER_COLOR);
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
