use super::*;
use crate::paper::edge::EdgePoint;
use crate::test_pictures::noise;
use proptest::prelude::*;

const FIRST_PX: f64 = 5.0;
const BINS: usize = 12;

/// Equations (7) and (8) as printed, for vertices `v1` and `v2` and a third point; `None` where they give no number.
#[allow(clippy::many_single_char_names)] // the paper's names
fn semi_minor_as_printed(v1: (f64, f64), v2: (f64, f64), third: (f64, f64)) -> Option<f64> {
    let length = |one: (f64, f64), other: (f64, f64)| (one.0 - other.0).hypot(one.1 - other.1);
    let center = (f64::midpoint(v1.0, v2.0), f64::midpoint(v1.1, v2.1));
    let a = length(v1, v2) / 2.0;
    let d = length(center, third);
    let f = length(v2, third);
    if d == 0.0 {
        return None;
    }
    let cos_t = (a * a + d * d - f * f) / (2.0 * a * d);
    let sin2_t = 1.0 - cos_t * cos_t;
    let b = ((a * a * d * d * sin2_t) / (a * a - d * d * cos_t * cos_t)).sqrt();
    b.is_finite().then_some(b)
}

/// The bins by which `b` may be counted, and whether it is sure which: it is not on a border within the declared
/// tolerance.
fn bins_of(b: f64, width_px: f64) -> (Vec<usize>, bool) {
    let place = |b: f64| ((b - FIRST_PX) / width_px).floor();
    let mut bins: Vec<_> = [b * (1.0 - 1e-5), b * (1.0 + 1e-5)].map(place).into_iter().collect();
    bins.dedup();
    let is_sure = bins.len() == 1;
    let there = |bin: &f64| *bin >= 0.0 && *bin < BINS as f64;
    (bins.into_iter().filter(there).map(|bin| bin as usize).collect(), is_sure)
}

fn axis_of(v1: (u16, u16), v2: (u16, u16)) -> Axis {
    let half = |one: u16, other: u16| f32::midpoint(f32::from(one), f32::from(other));
    let (half_x, half_y) =
        ((f32::from(v2.0) - f32::from(v1.0)) / 2.0, (f32::from(v2.1) - f32::from(v1.1)) / 2.0);
    Axis { center_x: half(v1.0, v2.0), center_y: half(v1.1, v2.1), half_x, half_y }
}

proptest! {
    #[test]
    fn votes_equal_the_printed_formulas(
        coordinates in prop::collection::btree_set((0_u16..80, 0_u16..80), 2..300),
        v1 in (0_u16..40, 0_u16..80), v2 in (41_u16..80, 0_u16..80), width_px in prop::sample::select(vec![1.0, 1.5, 4.0]),
    ) {
        let points: Vec<_> = coordinates.iter().map(|&(x, y)| EdgePoint { x, y }).collect();
        let grid = PointGrid::new(&points);
        let axis = axis_of(v1, v2);
        let mut halves = Halves::default();
        let mut accumulator = Accumulator::new(FIRST_PX as f32, width_px as f32, BINS);
        grid.halves_around(axis, accumulator.reach_px(axis), &mut halves);
        accumulator.vote(&grid, &halves, axis, 0);

        // Between these bounds lie the votes that the formulas give, points on a border counted on either side.
        let (mut least, mut most) = ([0_u32; BINS], [0_u32; BINS]);
        let float = |point: (u16, u16)| (f64::from(point.0), f64::from(point.1));
        for &point in &coordinates {
            let Some(b) = semi_minor_as_printed(float(v1), float(v2), float(point)) else { continue };
            let (bins, is_sure) = bins_of(b, width_px);
            // `b <= a` in whole bins; `a` may lie on a border itself.
            let a = f64::from(axis.half_x.hypot(axis.half_y));
            let bin_of = |value: f64| ((value - FIRST_PX) / width_px).floor();
            let (last_sure, last) = (bin_of(a * (1.0 - 1e-5)), bin_of(a * (1.0 + 1e-5)));
            for &bin in &bins {
                most[bin] += u32::from(bin as f64 <= last);
                least[bin] += u32::from(is_sure && bin as f64 <= last_sure);
            }
        }
        for bin in 0..BINS {
            let votes: u32 = accumulator.votes(bin).iter().sum();
            prop_assert!((least[bin]..=most[bin]).contains(&votes), "bin {bin}: {votes}, {}..={}", least[bin], most[bin]);
        }
    }

    #[test]
    fn ending_half_way_loses_no_peak_that_has_the_votes(seed in any::<u64>(), side_votes_min in 1_u32..12) {
        let bytes = noise(400, seed);
        let points: Vec<_> = bytes.chunks_exact(2).map(|b| EdgePoint { x: (b[0] / 4).into(), y: (b[1] / 4).into() }).collect();
        let grid = PointGrid::new(&points);
        let mut halves = Halves::default();
        let mut accumulator = Accumulator::new(FIRST_PX as f32, 2.0, BINS);
        for pair in points.chunks_exact(2) {
            let (left, right) = if pair[0] <= pair[1] { (pair[0], pair[1]) } else { (pair[1], pair[0]) };
            let axis = axis_of((left.x, left.y), (right.x, right.y));
            grid.halves_around(axis, accumulator.reach_px(axis), &mut halves);
            let whole = accumulator.vote(&grid, &halves, axis, 0);
            let cut = accumulator.vote(&grid, &halves, axis, side_votes_min);
            let expected = whole.filter(|peak| {
                let [a, b, c, d] = peak.votes_by_quadrant;
                a + c >= side_votes_min && b + d >= side_votes_min
            });
            prop_assert_eq!(cut, expected);
        }
    }
}

#[test]
fn the_four_quadrants_are_told_apart() {
    // One point a quadrant of an ellipse with a = 20 and b = 10 around (30, 30), on a horizontal axis: at u = 12, v = 8.
    for (point, quadrant) in [((42, 38), 0), ((18, 38), 1), ((42, 22), 2), ((18, 22), 3)] {
        let grid = PointGrid::new(&[EdgePoint { x: point.0, y: point.1 }]);
        let axis = axis_of((10, 30), (50, 30));
        let mut halves = Halves::default();
        let mut accumulator = Accumulator::new(9.5, 1.0, 5);
        grid.halves_around(axis, accumulator.reach_px(axis), &mut halves);
        let peak = accumulator.vote(&grid, &halves, axis, 0).expect("a vote");
        let mut expected = [0; 4];
        expected[quadrant] = 1;
        assert_eq!(peak, Peak { semi_minor_px: 10.0, votes_by_quadrant: expected });
    }
}
