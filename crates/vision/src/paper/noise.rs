//! Noise reduction, the first box of the paper's Fig. 7.
//!
//! The paper names the step and no filter. Both filters here look at a 3 x 3 neighbourhood; at the border the nearest
//! pixel stands in for the missing one.

use crate::image::{GrayImage, GrayView};

/// Which filter reduces the noise of the grey picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum NoiseReduction {
    /// The picture as it is.
    None,
    /// The median of 3 x 3 pixels: removes single wrong pixels and keeps steps sharp.
    Median,
    /// The 3 x 3 binomial kernel (1 2 1) x (1 2 1) / 16, rounded to nearest: a Gaussian of standard deviation 0.71 px.
    #[default]
    Gaussian,
    /// The median first, then the Gaussian.
    MedianGaussian,
}

/// The picture with its noise reduced.
pub fn reduce_noise(view: &GrayView<'_>, filter: NoiseReduction) -> GrayImage {
    match filter {
        NoiseReduction::None => view.to_image(),
        NoiseReduction::Median => median(view),
        NoiseReduction::Gaussian => gaussian(view),
        NoiseReduction::MedianGaussian => gaussian(&median(view).view()),
    }
}

/// The rows above, at and below `y`, the border repeated.
fn three_rows<'a>(view: &GrayView<'a>, y: usize) -> [&'a [u8]; 3] {
    [view.row(y.saturating_sub(1)), view.row(y), view.row((y + 1).min(view.height() - 1))]
}

/// One row with its first and last value repeated once on either side, so that a window of three is always whole.
fn pad_row(padded: &mut [u8], row: impl Iterator<Item = u8>) {
    let last = padded.len() - 1;
    for (to, value) in padded[1..last].iter_mut().zip(row) {
        *to = value;
    }
    padded[0] = padded[1];
    padded[last] = padded[last - 1];
}

/// Median of 3 x 3: sort the columns, then the median of (the largest of the least, the median of the middle, the
/// least of the largest), which touches each pixel with minima and maxima only.
fn median(view: &GrayView<'_>) -> GrayImage {
    let mut out = GrayImage::filled_like(view, 0);
    let mut sorted = [const { Vec::new() }; 3];
    for column in &mut sorted {
        *column = vec![0_u8; view.width() + 2];
    }
    let [low, middle, high] = &mut sorted;
    for y in 0..view.height() {
        let [above, here, below] = three_rows(view, y);
        let columns = || above.iter().zip(here).zip(below).map(|((&a, &h), &b)| (a, h, b));
        pad_row(low, columns().map(|(a, h, b)| a.min(h).min(b)));
        pad_row(middle, columns().map(|(a, h, b)| median_of_three(a, h, b)));
        pad_row(high, columns().map(|(a, h, b)| a.max(h).max(b)));
        let row = out.row_mut(y);
        let width = row.len();
        let (low, middle, high) = (&low[..width + 2], &middle[..width + 2], &high[..width + 2]);
        for x in 0..width {
            let greatest_low = low[x].max(low[x + 1]).max(low[x + 2]);
            let middle_middle = median_of_three(middle[x], middle[x + 1], middle[x + 2]);
            let least_high = high[x].min(high[x + 1]).min(high[x + 2]);
            row[x] = median_of_three(greatest_low, middle_middle, least_high);
        }
    }
    out
}

fn median_of_three(a: u8, b: u8, c: u8) -> u8 {
    a.min(b).max(a.max(b).min(c))
}

fn gaussian(view: &GrayView<'_>) -> GrayImage {
    let mut out = GrayImage::filled_like(view, 0);
    let mut sums = vec![0_u16; view.width() + 2];
    let last = sums.len() - 1;
    for y in 0..view.height() {
        let [above, here, below] = three_rows(view, y);
        for (sum, ((&a, &h), &b)) in sums[1..last].iter_mut().zip(above.iter().zip(here).zip(below))
        {
            *sum = u16::from(a) + 2 * u16::from(h) + u16::from(b);
        }
        sums[0] = sums[1];
        sums[last] = sums[last - 1];
        for (to, window) in out.row_mut(y).iter_mut().zip(sums.windows(3)) {
            // At most (16 * 255 + 8) / 16 = 255.
            *to = ((window[0] + 2 * window[1] + window[2] + 8) >> 4) as u8;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The neighbourhood of (x, y), the border repeated.
    fn window(image: &GrayImage, x: usize, y: usize) -> Vec<u8> {
        let mut window = Vec::new();
        for dy in 0..3 {
            for dx in 0..3 {
                let yy = (y + dy).saturating_sub(1).min(image.height() - 1);
                let xx = (x + dx).saturating_sub(1).min(image.width() - 1);
                window.push(image.pixels()[yy * image.width() + xx]);
            }
        }
        window
    }

    proptest! {
        #[test]
        fn both_filters_equal_the_slow_and_obvious_ones(
            width in 1_usize..9, height in 1_usize..9, seed in any::<[u8; 64]>(),
        ) {
            let image = GrayImage::new(seed[..width * height].to_vec(), width, height).unwrap();
            let median = reduce_noise(&image.view(), NoiseReduction::Median);
            let gaussian = reduce_noise(&image.view(), NoiseReduction::Gaussian);
            for y in 0..height {
                for x in 0..width {
                    let mut sorted = window(&image, x, y);
                    let weighted: u32 = sorted.iter().zip([1, 2, 1, 2, 4, 2, 1, 2, 1]).map(|(&v, w)| u32::from(v) * w).sum();
                    prop_assert_eq!(u32::from(gaussian.pixels()[y * width + x]), (weighted + 8) / 16);
                    sorted.sort_unstable();
                    prop_assert_eq!(median.pixels()[y * width + x], sorted[4]);
                }
            }
        }
    }

    #[test]
    fn the_median_removes_a_single_bright_pixel() {
        let mut image = GrayImage::new(vec![10; 25], 5, 5).unwrap();
        image.pixels_mut()[12] = 255;
        assert!(
            reduce_noise(&image.view(), NoiseReduction::Median).pixels().iter().all(|&v| v == 10)
        );
    }
}
