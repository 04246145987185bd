//! What the detector promises, through its public interface.
#![allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, clippy::cast_sign_loss)]

mod drawing;

use drawing::{ellipse, picture, scene, table};
use proptest::prelude::*;
use rsapien_vision::{
    DetectedEllipse, Detection, Detector, Ellipse, GrayView, Options, Region, Statistics, Strokes,
};

/// All of a detection but the time it took.
fn content(detection: &Detection) -> (Vec<DetectedEllipse>, Statistics, bool) {
    (detection.ellipses.clone(), detection.statistics, detection.truncated)
}

/// Largest distance of `found` from the contour of `truth`, in pixels.
fn off_px(found: &Ellipse, truth: &Ellipse) -> f64 {
    let off = |t: u32| {
        let (x, y) = found.point_at(f64::from(t) * 0.1);
        truth.distance_px(x, y).abs()
    };
    (0..63).map(off).fold(0.0, f64::max)
}

fn assert_found(detection: &Detection, truths: &[Ellipse], within_px: f64) {
    for truth in truths {
        let nearest = detection
            .ellipses
            .iter()
            .map(|found| off_px(&found.ellipse, truth))
            .fold(f64::INFINITY, f64::min);
        assert!(
            nearest < within_px,
            "{truth:?}: nearest is {nearest} px off in {:#?}",
            detection.ellipses
        );
    }
}

fn default() -> Detector {
    Detector::builder().build().unwrap()
}

#[test]
fn discs_and_rings_are_found_to_a_twentieth_of_a_pixel() {
    let (image, truths) = table(320, 240);
    let mut detector = default();
    let detection = detector.detect(&image.view());
    assert_eq!(detection.ellipses.len(), truths.len(), "{:#?}", detection.ellipses);
    for truth in &truths {
        let center = |found: &&DetectedEllipse| {
            (found.ellipse.center_x_px - truth.center_x_px)
                .hypot(found.ellipse.center_y_px - truth.center_y_px)
        };
        let found =
            detection.ellipses.iter().min_by(|a, b| center(a).total_cmp(&center(b))).unwrap();
        let here = found.ellipse;
        assert!(center(&found) < 0.05, "{here:?} for {truth:?}");
        assert!((here.semi_major_px - truth.semi_major_px).abs() < 0.1, "{here:?} for {truth:?}");
        assert!((here.semi_minor_px - truth.semi_minor_px).abs() < 0.1, "{here:?} for {truth:?}");
        assert!(
            found.score > 0.9 && found.support_share > 0.95 && found.log10_false_alarms < -20.0,
            "{found:?}"
        );
    }
    assert!(detection.ellipses.is_sorted_by(|a, b| a.score >= b.score));
}

#[test]
fn half_hidden_discs_are_found() {
    let front = ellipse(120.0, 80.0, 40.0, 40.0, 0.0);
    let behind = ellipse(75.0, 90.0, 45.0, 35.0, 0.5);
    let cut = ellipse(196.0, 110.0, 34.0, 28.0, 1.2);
    let image = picture(200, 160, |x, y| {
        let cover = |ellipse: &Ellipse| (0.5 - ellipse.distance_px(x, y)).clamp(0.0, 1.0);
        let mut grey = 60.0;
        for (ellipse, paint) in [(cut, 160.0), (behind, 140.0), (front, 220.0)] {
            grey += (paint - grey) * cover(&ellipse);
        }
        grey
    });
    let mut detector = default();
    assert_found(detector.detect(&image.view()), &[front, behind, cut], 0.6);
}

#[test]
fn the_same_picture_gives_the_same_ellipses() {
    let pictures = [
        table(320, 240).0,
        table(401, 333).0,
        scene(65, 63, &[ellipse(30.2, 31.4, 20.0, 15.0, 0.4)], &[]),
        picture(257, 190, |x, y| 128.0 + 120.0 * ((x * x + y * y) / 90.0).sin()),
        picture(3, 3, |x, _| 100.0 * x),
        picture(1, 1, |_, _| 7.0),
    ];
    let fresh: Vec<_> =
        pictures.iter().map(|image| content(default().detect(&image.view()))).collect();
    let mut reused = default();
    for _ in 0..3 {
        for (image, expected) in
            pictures.iter().zip(&fresh).chain(pictures.iter().zip(&fresh).rev())
        {
            assert!(content(reused.detect(&image.view())) == *expected, "{}", image.width());
        }
    }
    for threads in [1, 2, 8] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            for (image, expected) in pictures.iter().zip(&fresh) {
                assert!(content(default().detect(&image.view())) == *expected, "{threads} threads");
            }
        });
    }
    // Any seed finds what is plain to see.
    for seed in [0, 2, u64::MAX] {
        let (image, truths) = table(320, 240);
        let mut detector = Detector::builder().seed(seed).build().unwrap();
        assert_found(detector.detect(&image.view()), &truths, 0.2);
    }
}

#[test]
fn bytes_between_rows_are_not_looked_at() {
    let (image, _) = table(320, 240);
    let expected = content(default().detect(&image.view()));
    let mut padded = Vec::new();
    for (y, row) in image.pixels().chunks_exact(320).enumerate() {
        padded.extend_from_slice(row);
        padded.extend((0..37).map(|i| (y * 89 + i * 151) as u8));
    }
    let view = GrayView::new(&padded, 320, 240, 357).unwrap();
    assert!(content(default().detect(&view)) == expected);
}

#[test]
fn semi_axes_and_ratio_bound_what_is_found() {
    let radii = [8.0, 15.0, 25.0, 40.0];
    let discs: Vec<_> = radii
        .iter()
        .zip([20.0, 60.0, 115.0, 200.0])
        .map(|(&r, x)| ellipse(x, 60.0, r, r, 0.0))
        .collect();
    let image = scene(260, 120, &discs, &[]);
    let found = |options: Options| {
        let mut detector = Detector::with_options(options).unwrap();
        let mut radii: Vec<_> = detector
            .detect(&image.view())
            .ellipses
            .iter()
            .map(|found| found.ellipse.semi_major_px.round())
            .collect();
        radii.sort_by(f64::total_cmp);
        radii
    };
    assert_eq!(found(Options::default()), radii);
    assert_eq!(found(Options { semi_axis_min_px: 12.0, ..Options::default() }), radii[1..]);
    assert_eq!(found(Options { semi_axis_max_px: 20.0, ..Options::default() }), radii[..2]);
    let only = Options { semi_axis_min_px: 20.0, semi_axis_max_px: 30.0, ..Options::default() };
    assert_eq!(found(only), radii[2..3]);

    let flat = scene(200, 160, &[ellipse(100.0, 80.0, 60.0, 24.0, 0.4)], &[]);
    for (ratio, count) in [(0.2, 1), (0.35, 1), (0.5, 0)] {
        let mut detector = Detector::builder().axis_ratio_min(ratio).build().unwrap();
        assert_eq!(detector.detect(&flat.view()).ellipses.len(), count, "at least {ratio}");
    }
}

#[test]
fn no_score_lies_below_the_least() {
    // Discs that dissolve, one more than the other.
    let truths: Vec<_> =
        (0..5_u8).map(|i| ellipse(50.0 + 90.0 * f64::from(i), 60.0, 35.0, 30.0, 0.0)).collect();
    let image = picture(460, 120, |x, y| {
        let grey = truths.iter().enumerate().map(|(i, truth)| {
            let torn =
                drawing::random(9, (x / 6.0) as u64 * 1000 + (y / 6.0) as u64) % 10 < 2 * i as u64;
            if torn { 0.0 } else { (0.5 - truth.distance_px(x, y)).clamp(0.0, 1.0) }
        });
        60.0 + 120.0 * grey.fold(0.0, f64::max)
    });
    let found = |least: f64| {
        let mut detector = Detector::builder().score_min(least).build().unwrap();
        detector.detect(&image.view()).ellipses.clone()
    };
    let counts = [0.0, 0.3, 0.6, 0.9].map(|least| {
        let found = found(least);
        assert!(found.iter().all(|found| found.score >= least && found.score <= 1.0));
        found.len()
    });
    assert!(counts.is_sorted_by(|a, b| a >= b) && counts[0] > counts[3], "{counts:?}");
}

#[test]
fn both_edges_of_a_stroke_come_on_request() {
    let truth = ellipse(100.0, 80.0, 60.0, 40.0, 0.4);
    let image = scene(200, 160, &[], &[truth]);
    let mut detector = Detector::builder().strokes(Strokes::BothEdges).build().unwrap();
    assert_eq!(detector.detect(&image.view()).ellipses.len(), 2);
    let detection = default().detect(&image.view()).clone();
    assert_eq!(detection.ellipses.len(), 1);
    assert!((detection.ellipses[0].stroke_width_px.unwrap() - 5.0).abs() < 0.5);
}

#[test]
fn only_the_region_is_looked_at() {
    let (image, truths) = table(320, 240);
    let region = Region { left: 120, top: 20, width: 80, height: 100 };
    let mut detector = Detector::builder().region(Some(region)).build().unwrap();
    let detection = detector.detect(&image.view());
    assert_eq!(detection.ellipses.len(), 1, "{:#?}", detection.ellipses);
    assert_found(detection, &truths[1..2], 0.1);
    // What lies outside the picture is cut, and a region outside has nothing.
    for (region, count) in [
        (Region { left: 0, top: 0, width: 16_384, height: 16_384 }, 5),
        (Region { left: 320, top: 0, width: 10, height: 10 }, 0),
        (Region { left: 5000, top: 16_384, width: 16_384, height: 1 }, 0),
        (Region { left: 319, top: 239, width: 1, height: 1 }, 0),
    ] {
        let mut detector = Detector::builder().region(Some(region)).build().unwrap();
        assert_eq!(detector.detect(&image.view()).ellipses.len(), count, "{region:?}");
    }
}

#[test]
fn support_and_covariance_come_on_request() {
    let (image, _) = table(320, 240);
    let mut detector = Detector::builder().support_points(true).covariance(true).build().unwrap();
    let detection = detector.detect(&image.view());
    for found in &detection.ellipses {
        let points = detection.support_of(found);
        assert!(points.len() > 50, "{found:?}");
        let covariance = found.covariance.expect("asked for");
        for (i, row) in covariance.iter().enumerate() {
            assert!(row[i] > 0.0);
            for (j, value) in row.iter().enumerate() {
                assert!((value - covariance[j][i]).abs() <= 1e-9 * row[i].max(1.0));
            }
        }
    }
    let plain = default().detect(&image.view()).clone();
    assert!(
        plain.support.is_empty() && plain.ellipses.iter().all(|found| found.covariance.is_none())
    );
}

#[test]
fn near_predictions_only_what_is_there_is_found() {
    let (image, truths) = table(320, 240);
    let moved = |e: &Ellipse| Ellipse {
        center_x_px: e.center_x_px + 2.0,
        center_y_px: e.center_y_px - 1.5,
        semi_major_px: e.semi_major_px + 1.0,
        ..*e
    };
    let predictions =
        [moved(&truths[3]), ellipse(160.0, 130.0, 15.0, 12.0, 0.0), moved(&truths[0])];
    let mut detector = default();
    let detection = detector.detect_near(&image.view(), &predictions);
    assert_eq!(detection.ellipses.len(), 2, "{:#?}", detection.ellipses);
    assert!(off_px(&detection.ellipses[0].ellipse, &truths[3]) < 0.2);
    assert!(off_px(&detection.ellipses[1].ellipse, &truths[0]) < 0.2);
    // Predictions that are none, or lie elsewhere, give nothing.
    let nothing = [
        ellipse(f64::NAN, 60.0, 20.0, 20.0, 0.0),
        ellipse(60.0, 60.0, f64::INFINITY, 20.0, f64::NAN),
        ellipse(60.0, 60.0, 0.0, -5.0, 0.0),
        ellipse(1e300, -1e300, 1e300, 1e300, 1e300),
        ellipse(-500.0, 9000.0, 30.0, 20.0, 0.0),
    ];
    for prediction in nothing {
        assert!(
            detector.detect_near(&image.view(), &[prediction]).ellipses.is_empty(),
            "{prediction:?}"
        );
    }
    assert!(detector.detect_near(&image.view(), &[]).ellipses.is_empty());
    assert!(detector.detect_near(&image.view(), &nothing).ellipses.is_empty());
    let tiny = picture(2, 2, |x, _| 200.0 * x);
    assert!(detector.detect_near(&tiny.view(), &truths).ellipses.is_empty());
}

/// Small pictures of every kind that chance makes: whatever is found is finite, in canonical form and within the options.
fn any_picture() -> impl Strategy<Value = (usize, usize, Vec<u8>)> {
    let size = || prop_oneof![1_usize..6, 6_usize..70, 126_usize..131];
    (size(), size()).prop_flat_map(|(width, height)| {
        let bytes = prop::collection::vec(any::<u8>(), width * height);
        let shapes = prop::collection::vec(
            (
                -20.0..150.0,
                -20.0..150.0,
                1.0..60.0,
                1.0..60.0,
                0.0..3.2,
                any::<u8>(),
                any::<bool>(),
            ),
            0..9,
        );
        let drawn = shapes.prop_map(move |shapes: Vec<(f64, f64, f64, f64, f64, u8, bool)>| {
            picture(width, height, |x, y| {
                shapes.iter().fold(90.0, |grey, &(cx, cy, a, b, theta, paint, is_box)| {
                    let cover = if is_box {
                        f64::from(u8::from((x - cx).abs() < a && (y - cy).abs() < b))
                    } else {
                        (0.5 - ellipse(cx, cy, a, b, theta).distance_px(x, y)).clamp(0.0, 1.0)
                    };
                    grey + (f64::from(paint) - grey) * cover
                })
            })
            .pixels()
            .to_vec()
        });
        prop_oneof![bytes, drawn].prop_map(move |pixels| (width, height, pixels))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn any_small_picture_gives_sound_ellipses((width, height, pixels) in any_picture(), least in 0.0..0.6) {
        let view = GrayView::new(&pixels, width, height, width).unwrap();
        let mut detector = Detector::builder().score_min(least).build().unwrap();
        let detection = detector.detect(&view);
        for found in &detection.ellipses {
            let ellipse = found.ellipse;
            prop_assert!(ellipse == ellipse.canonical());
            prop_assert!(ellipse.center_x_px.is_finite() && ellipse.center_y_px.is_finite());
            prop_assert!(ellipse.semi_minor_px >= 2.0 && ellipse.semi_major_px <= 16_384.0, "{found:?}");
            prop_assert!((least..=1.0).contains(&found.score), "{found:?}");
            prop_assert!((0.0..=1.0 + 1e-9).contains(&found.support_share), "{found:?}");
            prop_assert!((0.0..=1.0 + 1e-9).contains(&found.gradient_agreement), "{found:?}");
            prop_assert!(found.log10_false_alarms.is_finite() && found.residual_px.is_finite());
        }
        prop_assert!(!detection.truncated);
    }
}
