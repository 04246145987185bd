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

/// Smooth noise in -1..1 with features of about one unit.
fn smooth_noise(seed: u64, x: f64, y: f64) -> f64 {
    let (floor_x, floor_y) = (x.floor(), y.floor());
    // Coordinates of a world are far below the range of an i64; anything else saturates.
    #[allow(clippy::cast_possible_truncation)]
    let (column, row) = (floor_x as i64, floor_y as i64);
    let ease = |t: f64| t * t * (3.0 - 2.0 * t);
    let (across, down) = (ease(x - floor_x), ease(y - floor_y));
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
    let position = across_m / board_width_m;
    let board = position.floor();
    #[allow(clippy::cast_possible_truncation)] // a board's number, far below the range
    let number = board as i64;
    let board_seed = scramble(seed ^ number.cast_unsigned());
    let tone = 0.10 * (lattice(board_seed, 0, 0) - 0.5);
    // Long wavy streaks, finer fibres on them, and the slow change of tone along a board.
    let wave = 0.012 * smooth_noise(board_seed, 2.2 * along_m, 5.0 * across_m);
    let streaks = |frequency: f64, stretch: f64| {
        left_of(frequency, footprint_m)
            * smooth_noise(board_seed, along_m * frequency / stretch, (across_m + wave) * frequency)
    };
    let grain =
        0.055 * streaks(36.0, 22.0) + 0.040 * streaks(110.0, 30.0) + 0.030 * streaks(330.0, 40.0);
    let slow = 0.035 * smooth_noise(board_seed, 1.7 * along_m, 3.0 * across_m);
    // The joint between two boards: a dark line a millimetre wide, spread over the pixel where that is wider.
    let to_joint_m = (position - board).min(board + 1.0 - position) * board_width_m;
    let spread_m = 0.0012_f64.hypot(footprint_m);
    let joint = 0.34 * (0.0012 / spread_m) * (-(to_joint_m / spread_m).powi(2)).exp();
    (1.0 + tone + grain + slow) * (1.0 - joint)
}
