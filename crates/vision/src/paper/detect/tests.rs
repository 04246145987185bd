use super::*;
use crate::image::GrayImage;
use crate::paper::noise::NoiseReduction;
use crate::paper::options::{AngleMeasure, ClusterOptions, FilterOptions, HoughOptions};
use crate::paper::threshold::Threshold;
use crate::test_pictures::{noise, rings};
use proptest::prelude::*;

const CUP: Ellipse = Ellipse {
    center_x_px: 120.0,
    center_y_px: 100.0,
    semi_major_px: 60.0,
    semi_minor_px: 40.0,
    theta_rad: 0.25,
};

fn detect(picture: &GrayImage, seed: u64) -> Detection {
    Detector::paper().detect(&picture.view(), seed)
}

#[test]
fn two_drawn_rings_are_found_and_nothing_else() {
    let small = Ellipse {
        center_x_px: 250.0,
        center_y_px: 60.0,
        semi_major_px: 45.0,
        semi_minor_px: 24.0,
        theta_rad: 3.0,
    };
    let picture = rings(320, 240, &[CUP, small], 4.0);
    for seed in 0..5 {
        let found = detect(&picture, seed);
        assert_eq!(found.ellipses.len(), 2, "seed {seed}: {:?}", found.ellipses);
        for truth in [CUP, small] {
            assert!(
                found.ellipses.iter().any(|e| e.ellipse.overlap(&truth) > 0.8),
                "seed {seed}: {:?}",
                found.ellipses
            );
        }
        let statistics = &found.statistics;
        assert_eq!(statistics.search_point_pairs, 2 * statistics.edge_points);
        assert_eq!(statistics.real_ellipses, 2);
        assert!(statistics.virtual_ellipses >= 2 && !found.truncated());
    }
}

#[test]
fn a_ball_that_is_a_circle_is_one_ellipse() {
    let ball = Ellipse { semi_major_px: 45.0, semi_minor_px: 45.0, ..CUP };
    let found = detect(&rings(240, 200, &[ball], 3.0), 2);
    assert_eq!(found.ellipses.len(), 1, "{:?}", found.ellipses);
    assert!(found.ellipses[0].ellipse.overlap(&ball) > 0.85);
}

#[test]
fn threads_do_not_change_the_result() {
    let picture = rings(240, 200, &[CUP], 4.0);
    let on_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        let found = pool.install(|| detect(&picture, 9));
        (found.ellipses, found.statistics)
    };
    let one = on_threads(1);
    assert_eq!(one.0.len(), 1);
    assert_eq!(one, on_threads(2));
    assert_eq!(one, on_threads(8));
}

#[test]
fn pictures_without_ellipses_give_an_empty_list() {
    let flat = |value, width, height| {
        GrayImage::new(vec![value; width * height], width, height).expect("a picture")
    };
    let random =
        |width, height| GrayImage::new(noise(width * height, 4), width, height).expect("a picture");
    let stripes = GrayImage::new([0, 255].repeat(100 * 50), 100, 100).expect("a picture");
    for picture in [
        flat(0, 1, 1),
        flat(255, 2, 9),
        flat(0, 320, 240),
        random(1, 300),
        random(320, 240),
        random(900, 700),
        stripes,
    ] {
        let found = detect(&picture, 1);
        assert_eq!(found.ellipses, [], "{} x {}", picture.width(), picture.height());
    }
}

#[test]
fn noise_is_named_as_the_reason() {
    let picture = GrayImage::new(noise(320 * 240, 4), 320, 240).expect("a picture");
    let found = detect(&picture, 1);
    assert_eq!(found.statistics.limits, [Limit::EdgeShare]);
    assert!(found.truncated());
    assert_eq!(found.statistics.search_point_pairs, 0);
}

#[test]
fn a_flood_of_virtual_ellipses_is_cut_to_the_best() {
    let mut options = Options::paper();
    options.filter = FilterOptions { quality_min: 1, side_proportion_min: 0.0 };
    options.hough.pairs_per_edge_point = 20;
    let picture = rings(240, 200, &[CUP], 4.0);
    let found = Detector::new(options).expect("valid options").detect(&picture.view(), 1);
    assert_eq!(found.statistics.virtual_ellipses, VIRTUAL_ELLIPSES_MAX);
    assert_eq!(found.statistics.limits, [Limit::VirtualEllipses]);
}

#[test]
fn the_stages_fit_together() {
    let picture = rings(240, 200, &[CUP], 4.0);
    let (found, stages) = Detector::paper().detect_with_stages(&picture.view(), 1);
    let white: usize = stages.binary.pixels().iter().map(|&value| usize::from(value / 255)).sum();
    assert_eq!((white, stages.edge_points.len()), (found.statistics.edge_points, white));
    assert_eq!(stages.virtual_ellipses.len(), found.statistics.virtual_ellipses);
    let level = found.statistics.threshold_level.expect("a level");
    assert!(
        stages
            .gradient
            .pixels()
            .iter()
            .zip(stages.binary.pixels())
            .all(|(&g, &b)| (g > level) == (b == 255))
    );
}

#[test]
fn options_are_refused_by_name_value_and_range() {
    let refused = |change: fn(&mut Options)| {
        let mut options = Options::paper();
        change(&mut options);
        Detector::new(options).expect_err("out of range").to_string()
    };
    assert_eq!(
        refused(|o| o.hough.bin_width_px = 0.0),
        "option hough.bin_width_px is 0, allowed is 0.25 to 50"
    );
    assert_eq!(
        refused(|o| o.hough.semi_major_max_px = 20.0),
        "option hough.semi_major_max_px is 20, allowed is 36 to 2000"
    );
    assert_eq!(
        refused(|o| o.filter.side_proportion_min = f64::NAN),
        "option filter.side_proportion_min is NaN, allowed is 0 to 1"
    );
    assert!(refused(|o| o.hough.semi_minor_max_px = 75.5).contains("15 to 75"));
    assert!(refused(|o| o.edge_share_max = -0.1).starts_with("option edge_share_max is -0.1"));
    let too_fine = |o: &mut Options| {
        o.hough = HoughOptions {
            semi_major_max_px: 2000.0,
            semi_minor_max_px: 2000.0,
            bin_width_px: 0.25,
            ..o.hough
        };
    };
    assert!(
        refused(too_fine).starts_with("option hough.bin_width_px is 0.25, allowed is at least 1.9")
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn a_ring_is_found_wherever_it_lies_and_however_it_is_turned(
        x in 100.0..140.0_f64, y in 95.0..105.0_f64, theta_rad in 0.0..std::f64::consts::PI, seed in any::<u64>(),
    ) {
        let truth = Ellipse { center_x_px: x, center_y_px: y, theta_rad, ..CUP };
        let found = detect(&rings(240, 200, &[truth], 4.0), seed);
        prop_assert_eq!(found.ellipses.len(), 1, "{:?}", found.ellipses);
        let ellipse = found.ellipses[0].ellipse;
        prop_assert!(ellipse.overlap(&truth) > 0.8, "{:?}", ellipse);
        prop_assert!((ellipse.center_x_px - x).hypot(ellipse.center_y_px - y) < 5.0, "{:?}", ellipse);
    }

    #[test]
    fn any_small_picture_and_any_valid_options_end_without_a_panic(
        width in 1_usize..70, height in 1_usize..70, bytes in any::<u64>(), levels in 1_u8..=255,
        c in 1_u32..5, major in (1.0..40.0_f32, 0.0..2000.0_f32), minor in (0.0..1.0_f32, 0.0..1.0_f32), bin in 2.0..50.0_f32,
        quality_min in 1_u32..50, proportion in 0.0..=1.0_f64, share in 0.0..=1.0_f64, filter in 0_usize..4, seed in any::<u64>(),
    ) {
        let data: Vec<_> = noise(width * height, bytes).into_iter().map(|value| value / levels * levels).collect();
        let picture = GrayImage::new(data, width, height).expect("a picture");
        let greatest = (major.0 + major.1).min(2000.0);
        let least_minor = 1.0 + minor.0 * (greatest - 1.0);
        let options = Options {
            noise: [NoiseReduction::None, NoiseReduction::Median, NoiseReduction::Gaussian, NoiseReduction::MedianGaussian][filter],
            threshold: if levels > 100 { Threshold::MaximumVariance } else { Threshold::Fixed(levels) },
            edge_share_max: share,
            hough: HoughOptions {
                pairs_per_edge_point: c,
                semi_major_min_px: major.0,
                semi_major_max_px: greatest,
                semi_minor_min_px: least_minor,
                semi_minor_max_px: (least_minor + minor.1 * (greatest - least_minor)).min(greatest),
                bin_width_px: bin,
            },
            filter: FilterOptions { quality_min, side_proportion_min: proportion },
            cluster: ClusterOptions { distance_max: 20.0, angle: AngleMeasure::Radians, members_min: 1 },
        };
        let found = Detector::new(options).expect("valid options").detect(&picture.view(), seed);
        for detected in &found.ellipses {
            let e = detected.ellipse;
            prop_assert!(e.semi_major_px >= e.semi_minor_px && (0.0..std::f64::consts::PI).contains(&e.theta_rad), "{:?}", e);
            prop_assert!(detected.quality >= quality_min);
        }
    }
}
