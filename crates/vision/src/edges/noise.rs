//! How noisy a picture is.

use crate::image::GrayView;

/// Pixels that are looked at, about.
const SAMPLES: usize = 8192;
/// Histogram bins: the greatest response of the mask is 16 * 255 / 2.
const BINS: usize = 2048;

/// Standard deviation of the white noise of a picture, in grey values.
///
/// The mask (1 -2 1; -2 4 -2; 1 -2 1) answers neither to planes nor to straight edges along the axes, and to white noise
/// with six times its standard deviation (J. Immerkær, "Fast Noise Variance Estimation", Computer Vision and Image
/// Understanding 64, 1996). Its median over a grid of pixels, instead of the mean, is little moved by texture and
/// corners.
pub(super) fn estimate(picture: &GrayView<'_>) -> f32 {
    let (width, height) = (picture.width(), picture.height());
    if width < 3 || height < 3 {
        return 0.0;
    }
    let area = (width - 2) * (height - 2);
    // Steps that share no factor with usual periods of textures.
    let step = ((area as f64 / SAMPLES as f64).sqrt() as usize).max(1) | 1;
    let mut histogram = [0_u32; BINS];
    let mut count = 0_u32;
    for y in (1..height - 1).step_by(step) {
        let [above, here, below] = [picture.row(y - 1), picture.row(y), picture.row(y + 1)];
        for x in (1..width - 1).step_by(step) {
            let sum =
                |row: &[u8]| i32::from(row[x - 1]) - 2 * i32::from(row[x]) + i32::from(row[x + 1]);
            let response = sum(above) - 2 * sum(here) + sum(below);
            histogram[(response.unsigned_abs() as usize / 2).min(BINS - 1)] += 1;
            count += 1;
        }
    }
    let mut below = 0;
    for (bin, &here) in histogram.iter().enumerate() {
        if 2 * (below + here) >= count {
            // Half of the values lie below: within the bin they are taken as evenly spread.
            let part = (count as f32 / 2.0 - below as f32) / here.max(1) as f32;
            let median = 2.0 * (bin as f32 + part) - 1.0;
            return (median / (6.0 * 0.6745)).max(0.0);
        }
        below += here;
    }
    0.0
}
