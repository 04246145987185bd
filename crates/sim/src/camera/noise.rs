//! Sensor noise that depends on seed, frame and row alone.

use std::f64::consts::TAU;

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

/// Values in the table below; a power of two, so that random bits choose one evenly.
const VALUES: usize = 1 << 12;
const BITS: u32 = VALUES.trailing_zeros();

/// Spreads every bit of `value` over the whole word (the finaliser of Steele, Lea and Flood's `SplitMix`, 2014).
pub(super) fn scramble(value: u64) -> u64 {
    let value = value.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let value = (value ^ (value >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let value = (value ^ (value >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    value ^ (value >> 31)
}

/// Draws from a normal distribution by choosing from a table of its values, which takes about a nanosecond.
#[derive(Debug, Clone)]
pub(super) struct NormalTable {
    values: Vec<f32>,
}

impl NormalTable {
    /// A table of mean 0 and standard deviation 1.
    pub(super) fn new() -> Self {
        // The transform of Box and Muller (1958), with evenly spread radii and angles by the golden ratio in place
        // of random ones, so that the table itself has no gaps and no bias.
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        #[allow(clippy::cast_precision_loss)] // small whole numbers
        let raw: Vec<f64> = (0..VALUES)
            .map(|index| {
                let share = (index as f64 + 0.5) / VALUES as f64;
                (-2.0 * share.ln()).sqrt() * (TAU * GOLDEN * index as f64).cos()
            })
            .collect();
        #[allow(clippy::cast_precision_loss)]
        let count = raw.len() as f64;
        let mean = raw.iter().sum::<f64>() / count;
        let deviation =
            (raw.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt();
        #[allow(clippy::cast_possible_truncation)] // to the precision of the picture
        let values = raw.iter().map(|value| ((value - mean) / deviation) as f32).collect();
        Self { values }
    }

    /// Adds noise of `sigma` to every value of one row.
    pub(super) fn add_to_row(
        &self,
        row: &mut [f32],
        sigma: f32,
        seed: u64,
        frame: u64,
        row_index: u64,
    ) {
        let mut random =
            Pcg64::seed_from_u64(scramble(scramble(scramble(seed) ^ frame) ^ row_index));
        // One word of 64 bits chooses five values of 12 bits.
        for chunk in row.chunks_mut((u64::BITS / BITS) as usize) {
            let mut bits = random.next_u64();
            for value in chunk {
                // The lowest bits alone, which any machine's word holds.
                #[allow(clippy::cast_possible_truncation)]
                let choice = bits as usize & (VALUES - 1);
                *value += sigma * self.values[choice];
                bits >>= BITS;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_has_the_spread_and_shape_of_a_normal_distribution() {
        const COUNT: u32 = 200_000;
        let mut row: Vec<f32> = vec![0.0; COUNT as usize];
        NormalTable::new().add_to_row(&mut row, 3.0, 1, 2, 3);
        let mean_of =
            |of: &dyn Fn(&[f32]) -> f64| row.windows(2).map(of).sum::<f64>() / f64::from(COUNT - 1);
        let share = |limit: f32| mean_of(&|pair| if pair[0].abs() < limit { 1.0 } else { 0.0 });
        assert!((share(3.0) - 0.6827).abs() < 0.01, "{}", share(3.0));
        assert!((share(6.0) - 0.9545).abs() < 0.005, "{}", share(6.0));
        let mean = mean_of(&|pair| f64::from(pair[0]));
        assert!(mean.abs() < 0.03, "{mean}");
        let neighbours = mean_of(&|pair| f64::from(pair[0]) * f64::from(pair[1]));
        assert!(neighbours.abs() < 0.1, "neighbours go together: {neighbours}");
    }

    #[test]
    fn seed_frame_and_row_each_change_the_noise() {
        let draw = |seed, frame, row| {
            let mut values = vec![0.0; 64];
            NormalTable::new().add_to_row(&mut values, 1.0, seed, frame, row);
            values
        };
        let first = draw(1, 1, 1);
        assert_eq!(first, draw(1, 1, 1));
        for other in [draw(2, 1, 1), draw(1, 2, 1), draw(1, 1, 2)] {
            assert!(
                first
                    .iter()
                    .zip(&other)
                    .filter(|(one, other)| one.to_bits() == other.to_bits())
                    .count()
                    < 8
            );
        }
    }
}
