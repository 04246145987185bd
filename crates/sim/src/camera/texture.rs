//! Wood, drawn from a seed.

use super::noise::scramble;

/// A number in 0..1 that belongs to a lattice point.
fn lattice(seed: u64, x: i64, y: i64) -> f64 {
    let mixed = scramble(
        seed ^ (x.cast_unsigned()).wrapping_mul(0x8DA6_B343_D816_3841)
            ^ y.cast_unsigned().rotate_left(32),
    );
    // The upper 32 bits, which a float holds exactly.
    #[allow(clippy::cast_possible_truncation)]
    let upper = (mixed >> 32) as u32;
    f64::from(upper) / f64::from(u32::MAX)
}

/// The whole number below `value` and what is left of it, 0 to 1.
fn split(value: f64) -> (i64, f64) {
    // Coordinates of a world are far below the range of an i64; anything else saturates.
    #[allow(clippy::cast_possible_truncation)]
    let towards_zero = value as i64;
    #[allow(clippy::cast_precision_loss)] // small whole numbers
    let rest = value - towards_zero as f64;
    if rest < 0.0 { (towards_zero.saturating_sub(1), rest + 1.0) } else { (towards_zero, rest) }
}

/// Smooth noise in -1..1 with features of about one unit.
fn smooth_noise(seed: u64, x: f64, y: f64) -> f64 {
    let ease = |t: f64| t * t * (3.0 - 2.0 * t);
    let ((column, x), (row, y)) = (split(x), split(y));
    let (across, down) = (ease(x), ease(y));
    let at = |dx: i64, dy: i64| lattice(seed, column.saturating_add(dx), row.saturating_add(dy));
    let upper = at(0, 0) + across * (at(1, 0) - at(0, 0));
    let lower = at(0, 1) + across * (at(1, 1) - at(0, 1));
    2.0 * (upper + down * (lower - upper)) - 1.0
}

/// How much of a texture with this many features a metre is left where a pixel covers `footprint_m`; finer detail
/// than a pixel would flicker.
fn left_of(frequency: f64, footprint_m: f64) -> f64 {
    (1.5 - 2.0 * frequency * footprint_m).clamp(0.0, 1.0)
}

/// Brightness of boards of wood, about 1.
///
/// `along_m` runs with the grain, `across_m` over the boards; `footprint_m` is the size of a pixel on the surface.
pub(super) fn wood(
    seed: u64,
    along_m: f64,
    across_m: f64,
    board_width_m: f64,
    footprint_m: f64,
) -> f64 {
    let (board, share) = split(across_m / board_width_m);
    let board_seed = scramble(seed ^ board.cast_unsigned());
    let tone = 0.10 * (lattice(board_seed, 0, 0) - 0.5);
    // A slow change along the board, which also bends the long streaks and the finer fibres on them.
    let slow = smooth_noise(board_seed, 2.0 * along_m, 4.0 * across_m);
    let streaks = |frequency: f64, stretch: f64| match left_of(frequency, footprint_m) {
        0.0 => 0.0,
        left => {
            let (along, across) = (along_m / stretch, across_m + 0.012 * slow);
            left * smooth_noise(board_seed, along * frequency, across * frequency)
        }
    };
    let grain =
        0.055 * streaks(36.0, 22.0) + 0.040 * streaks(110.0, 30.0) + 0.030 * streaks(330.0, 40.0);
    // The joint between two boards: a dark line a millimetre wide, spread over the pixel where that is wider.
    let to_joint_m = share.min(1.0 - share) * board_width_m;
    let spread_m = 0.0012 + footprint_m;
    let near = (1.0 - to_joint_m / (2.0 * spread_m)).max(0.0);
    let joint = 0.34 * (0.0012 / spread_m) * near * near;
    (1.0 + tone + grain + 0.035 * slow) * (1.0 - joint)
}
