use proptest::prelude::*;

use super::*;
use crate::test_pictures::{ellipse, noise};

fn any_ellipse() -> impl Strategy<Value = Ellipse> {
    (-50.0..900.0, -50.0..700.0, 3.0..300.0, 0.1..1.0, 0.0..std::f64::consts::PI)
        .prop_map(|(x, y, a, ratio, theta)| ellipse(x, y, a, a * ratio, theta).canonical())
}

/// Points on a part of a contour, each moved off it by up to `off_px`.
fn points(truth: &Ellipse, from_rad: f64, to_rad: f64, off_px: f64, seed: u64) -> Vec<Point> {
    let shape = Shape::from_ellipse(truth);
    let bytes = noise(60, seed);
    (0..60)
        .map(|i| {
            let (x, y) = truth.point_at(from_rad + (to_rad - from_rad) * f64::from(i) / 59.0);
            let (_, normal_x, normal_y) = shape.distance(x, y);
            let off = off_px * (f64::from(bytes[i as usize]) / 127.5 - 1.0);
            (x + off * normal_x, y + off * normal_y)
        })
        .collect()
}

/// Largest difference of the two contours in pixels.
fn difference(one: &Ellipse, other: &Ellipse) -> f64 {
    let off = |t: u32| {
        let (x, y) = one.point_at(f64::from(t) * 0.1);
        other.distance_px(x, y).abs()
    };
    (0..63).map(off).fold(0.0, f64::max)
}

proptest! {
    #[test]
    fn an_ellipse_goes_there_and_back(truth in any_ellipse()) {
        let back = Shape::from_ellipse(&truth).ellipse();
        prop_assert!(difference(&truth, &back) < 1e-6, "{truth:?} {back:?}");
        prop_assert!((back.semi_major_px / truth.semi_major_px - 1.0).abs() < 1e-9);
        prop_assert!((back.semi_minor_px / truth.semi_minor_px - 1.0).abs() < 1e-9);
        prop_assert!(back == back.canonical());
    }

    #[test]
    fn distance_is_that_of_the_ellipse(truth in any_ellipse(), x in -50.0..900.0, y in -50.0..700.0) {
        let (distance, normal_x, normal_y) = Shape::from_ellipse(&truth).distance(x, y);
        let expected = truth.distance_px(x, y);
        prop_assert!((distance - expected).abs() < 1e-6 * (1.0 + expected.abs()));
        prop_assert!((normal_x.hypot(normal_y) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn exact_points_give_their_conic(truth in any_ellipse(), from in 0.0..6.0, span in 3.0..6.2) {
        let fitted = Shape::fit_conic(&points(&truth, from, from + span, 0.0, 0));
        let fitted = fitted.expect("half of a contour tells its ellipse").ellipse();
        prop_assert!(difference(&truth, &fitted) < 1e-3, "{truth:?} {fitted:?}");
    }

    #[test]
    fn the_geometric_fit_goes_down(truth in any_ellipse(), from in 0.0..6.0, span in 3.0..6.2, seed: u64) {
        let points = points(&truth, from, from + span, 0.02 * truth.semi_minor_px, seed);
        if let Some(start) = Shape::fit_conic(&points) {
            let fitted = start.fit_distance(&points, 8);
            let fitted = fitted.expect("points near an ellipse determine one");
            prop_assert!(fitted.is_ellipse());
            let (before, after) = (start.deviation(&points).0, fitted.deviation(&points).0);
            prop_assert!(after <= before * (1.0 + 1e-9), "{before} to {after}");
            // The truth is one of those it had to choose from.
            let of_truth = Shape::from_ellipse(&truth).deviation(&points).0;
            prop_assert!(after <= of_truth * 1.02, "{after} and the truth has {of_truth}");
        }
    }

    /// Whatever the points, there is no panic, and what comes out is an ellipse.
    #[test]
    fn any_points_give_an_ellipse_or_nothing(
        points in prop::collection::vec((-1e4..1e4, -1e4..1e4), 0..20),
        on_grid: bool,
        start in any_ellipse(),
    ) {
        let points: Vec<Point> = if on_grid {
            points.iter().map(|p: &Point| ((p.0 / 4e3).round(), (p.1 / 4e3).round())).collect()
        } else {
            points
        };
        for shape in [Shape::fit_conic(&points), Shape::from_ellipse(&start).fit_distance(&points, 5)] {
            prop_assert!(shape.is_none_or(|shape| shape.is_ellipse()), "{shape:?}");
        }
    }
}

#[test]
fn noise_on_a_whole_contour_averages_out() {
    let truth = ellipse(200.0, 150.0, 80.0, 50.0, 1.0);
    let points = points(&truth, 0.0, 6.2, 0.5, 7);
    let start = Shape::from_ellipse(&ellipse(206.0, 146.0, 88.0, 45.0, 1.2));
    let fitted = start.fit_distance(&points, 8).unwrap().ellipse();
    assert!(difference(&truth, &fitted) < 0.3, "{fitted:?}");
}

#[test]
fn only_ellipses_are_taken() {
    let taken = |conic| Shape::from_conic(conic).is_some();
    assert!(taken([1.0, 0.0, 4.0, 0.0, 0.0, -16.0]));
    assert!(taken([-1.0, 0.0, -4.0, 0.0, 0.0, 16.0]), "the sign of the equation says nothing");
    assert!(!taken([1.0, 0.0, -4.0, 0.0, 0.0, -16.0]), "hyperbola");
    assert!(!taken([1.0, 0.0, 0.0, 0.0, -4.0, 0.0]), "parabola");
    assert!(!taken([1.0, 2.0, 1.0, 0.0, -4.0, 0.0]), "parabola, turned");
    assert!(!taken([1.0, 0.0, 4.0, 0.0, 0.0, 16.0]), "no real point");
    assert!(!taken([1.0, 0.0, 4.0, 0.0, 0.0, 0.0]), "one point");
    assert!(!taken([0.0; 6]));
    assert!(!taken([f64::NAN, 0.0, 1.0, 0.0, 0.0, -1.0]));
    assert!(!taken([f64::INFINITY, 0.0, f64::INFINITY, 0.0, 0.0, -1.0]));
}

#[test]
fn too_few_points_and_lines_determine_nothing() {
    let line: Vec<Point> = (0..20).map(|i| (f64::from(i), 2.0 * f64::from(i))).collect();
    assert_eq!(Shape::fit_conic(&line), None);
    assert_eq!(Shape::fit_conic(&line[..4]), None);
    assert_eq!(Shape::fit_conic(&[(3.0, 3.0); 20]), None);
    let start = Shape::from_ellipse(&ellipse(0.0, 0.0, 5.0, 4.0, 0.0));
    assert_eq!(start.fit_distance(&line[..5], 4), None);
}
