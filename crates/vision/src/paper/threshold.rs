//! Maximum Variance Threshold: the adaptive binarization of the gradient picture (paper, section 3.1).
//!
//! The level is Otsu's: of all ways to split the histogram in two classes it takes the one with the largest variance
//! between the classes, so it follows the picture's light by itself. Pixels **above** the level are edges.

use crate::image::{GrayImage, GrayView};

/// Value of an edge pixel in a binary picture ("all edge pixels are white"); the others are 0.
pub const EDGE: u8 = 255;

/// How the gradient picture is made binary.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Threshold {
    /// The paper's Maximum Variance Threshold.
    #[default]
    MaximumVariance,
    /// A level of one's own: gradients above it are edges.
    Fixed(u8),
}

/// How often each grey value occurs.
pub fn histogram(view: &GrayView<'_>) -> [u32; 256] {
    // Four tables, since neighbouring pixels often share a value and would wait for each other's count.
    let mut tables = [[0_u32; 256]; 4];
    for row in view.rows() {
        let mut quads = row.chunks_exact(4);
        for quad in &mut quads {
            for (table, &value) in tables.iter_mut().zip(quad) {
                table[usize::from(value)] += 1;
            }
        }
        for &value in quads.remainder() {
            tables[0][usize::from(value)] += 1;
        }
    }
    std::array::from_fn(|value| tables.iter().map(|table| table[value]).sum())
}

/// The level with the largest variance between the values up to it and those above it; of equals the lowest.
///
/// `None` when fewer than two values occur: a constant picture has no two classes, and so no edges.
pub fn maximum_variance_level(histogram: &[u32; 256]) -> Option<u8> {
    let total: u64 = histogram.iter().map(|&count| u64::from(count)).sum();
    let moment: u64 =
        histogram.iter().zip(0_u64..).map(|(&count, value)| u64::from(count) * value).sum();
    let (mut below, mut below_moment) = (0_u64, 0_u64);
    let mut best: Option<(f64, u8)> = None;
    for (level, &count) in (0..=u8::MAX).zip(histogram) {
        below += u64::from(count);
        below_moment += u64::from(count) * u64::from(level);
        let above = total - below;
        if below == 0 || above == 0 {
            continue;
        }
        // Variance between classes w0 w1 (m0 - m1)²; counts stay below 2^53, so the means are good to the last bits.
        let difference =
            below_moment as f64 / below as f64 - (moment - below_moment) as f64 / above as f64;
        let variance = below as f64 * above as f64 * difference * difference;
        if best.is_none_or(|(largest, _)| variance > largest) {
            best = Some((variance, level));
        }
    }
    best.map(|(_, level)| level)
}

/// The level that `threshold` means for this gradient picture; `None` where there is none (see
/// [`maximum_variance_level`]).
pub fn level(gradient: &GrayView<'_>, threshold: Threshold) -> Option<u8> {
    match threshold {
        Threshold::MaximumVariance => maximum_variance_level(&histogram(gradient)),
        Threshold::Fixed(level) => Some(level),
    }
}

/// The binary picture: [`EDGE`] where `gradient` is above `level`, else 0; all 0 without a level.
pub fn binarize(gradient: &GrayView<'_>, level: Option<u8>) -> GrayImage {
    let mut out = GrayImage::filled_like(gradient, 0);
    if let Some(level) = level {
        for (y, row) in gradient.rows().enumerate() {
            for (to, &value) in out.row_mut(y).iter_mut().zip(row) {
                *to = if value > level { EDGE } else { 0 };
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn counts(entries: &[(usize, u32)]) -> [u32; 256] {
        let mut histogram = [0; 256];
        for &(value, count) in entries {
            histogram[value] = count;
        }
        histogram
    }

    #[test]
    fn hand_computed_levels() {
        // Splits {0}|{1,2,10}, {0,1}|{2,10}, {0,1,2}|{10}, counts 8 4 2 2: w0 w1 (m0 - m1)² =
        // 8*8*(0 - 3.5)² = 784, 12*4*(1/3 - 6)² = 1541.3, 14*2*(4/7 - 10)² = 2489.1.
        assert_eq!(maximum_variance_level(&counts(&[(0, 8), (1, 4), (2, 2), (10, 2)])), Some(2));
        // Two values only: every level between them is as good, the lowest is taken.
        assert_eq!(maximum_variance_level(&counts(&[(20, 5), (200, 1)])), Some(20));
    }

    #[test]
    fn a_constant_picture_has_no_level_and_no_edges() {
        let flat = GrayImage::new(vec![77; 12], 4, 3).unwrap();
        let found = level(&flat.view(), Threshold::MaximumVariance);
        assert_eq!(found, None);
        assert!(binarize(&flat.view(), found).pixels().iter().all(|&value| value == 0));
    }

    proptest! {
        #[test]
        fn no_other_level_has_a_larger_variance(data in prop::collection::vec(any::<u8>(), 1..60)) {
            let width = data.len();
            let image = GrayImage::new(data.clone(), width, 1).unwrap();
            let variance = |level: u8| {
                let (low, high): (Vec<f64>, Vec<f64>) =
                    data.iter().map(|&value| f64::from(value)).partition(|&value| value <= f64::from(level));
                let mean = |class: &[f64]| class.iter().sum::<f64>() / class.len() as f64;
                if low.is_empty() || high.is_empty() { return 0.0; }
                low.len() as f64 * high.len() as f64 * (mean(&low) - mean(&high)).powi(2)
            };
            let best = (0..=255).map(variance).fold(0.0, f64::max);
            match level(&image.view(), Threshold::MaximumVariance) {
                Some(level) => prop_assert!(variance(level) >= best * (1.0 - 1e-12)),
                None => prop_assert!(data.iter().all(|&value| value == data[0])),
            }
        }
    }
}
