//! Gradient magnitude, from which the paper's binarized picture is made.
//!
//! The paper names no operator; this is the 3 x 3 Sobel pair, whose magnitude `sqrt(gx² + gy²)` is cut down to an
//! integer and clipped at 255. A step of 64 grey levels along an axis already reaches 255: every strong contour looks
//! alike, which is what the threshold behind it wants. The outermost pixels have no whole neighbourhood and get 0, so
//! the picture's frame never becomes an edge.

use crate::image::{GrayImage, GrayView};

/// The Sobel magnitude of the picture, clipped to 8 bits, 0 on the outermost pixels.
pub fn sobel_magnitude(view: &GrayView<'_>) -> GrayImage {
    let mut out = GrayImage::filled_like(view, 0);
    let width = view.width();
    if width < 3 {
        return out;
    }
    // Per column: the weighted sum over the three rows (for gx) and the difference of the outer rows (for gy).
    let mut smooth = vec![0_i16; width];
    let mut slope = vec![0_i16; width];
    for y in 1..view.height().saturating_sub(1) {
        let (above, here, below) = (view.row(y - 1), view.row(y), view.row(y + 1));
        for (x, ((&a, &h), &b)) in above.iter().zip(here).zip(below).enumerate() {
            let (a, h, b) = (i16::from(a), i16::from(h), i16::from(b));
            smooth[x] = a + 2 * h + b;
            slope[x] = b - a;
        }
        let row = &mut out.row_mut(y)[1..width - 1];
        for ((to, smooth), slope) in row.iter_mut().zip(smooth.windows(3)).zip(slope.windows(3)) {
            let gx = f32::from(smooth[2] - smooth[0]);
            let gy = f32::from(slope[0] + 2 * slope[1] + slope[2]);
            // The squares are integers below 2^24, so the sum is exact; the cast cuts down and clips at 255.
            *to = (gx * gx + gy * gy).sqrt() as u8;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn hand_computed_values() {
        // gx = (3 + 2*6 + 9) - (1 + 2*4 + 7) = 8, gy = (7 + 2*8 + 9) - (1 + 2*2 + 3) = 24, sqrt(640) = 25.3.
        let image = GrayImage::new(vec![1, 2, 3, 4, 5, 6, 7, 8, 9], 3, 3).unwrap();
        assert_eq!(sobel_magnitude(&image.view()).pixels(), [0, 0, 0, 0, 25, 0, 0, 0, 0]);
        // A step of 63 along x gives 4 * 63 = 252, one of 64 is clipped.
        for (step, magnitude) in [(63, 252), (64, 255), (255, 255)] {
            let image = GrayImage::new([0, 0, step].repeat(3), 3, 3).unwrap();
            assert_eq!(sobel_magnitude(&image.view()).pixels()[4], magnitude);
        }
    }

    proptest! {
        #[test]
        fn equals_the_convolution_written_out(width in 1_usize..9, height in 1_usize..9, data in any::<[u8; 64]>()) {
            let image = GrayImage::new(data[..width * height].to_vec(), width, height).unwrap();
            let at = |x: usize, y: usize| i32::from(data[y * width + x]);
            let gradient = sobel_magnitude(&image.view());
            for y in 0..height {
                for x in 0..width {
                    let inside = x > 0 && y > 0 && x + 1 < width && y + 1 < height;
                    let expected = if inside {
                        let gx = at(x + 1, y - 1) + 2 * at(x + 1, y) + at(x + 1, y + 1)
                            - at(x - 1, y - 1) - 2 * at(x - 1, y) - at(x - 1, y + 1);
                        let gy = at(x - 1, y + 1) + 2 * at(x, y + 1) + at(x + 1, y + 1)
                            - at(x - 1, y - 1) - 2 * at(x, y - 1) - at(x + 1, y - 1);
                        (gx * gx + gy * gy).isqrt().min(255)
                    } else {
                        0
                    };
                    prop_assert_eq!(i32::from(gradient.pixels()[y * width + x]), expected);
                }
            }
        }
    }
}
