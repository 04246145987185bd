//! Against figures of an independent program, which asks every sample of the grid by itself.

use super::*;

fn ellipses(values: &[[f64; 5]]) -> Vec<Ellipse> {
    let ellipse = |value: &[f64; 5]| Ellipse {
        center_x_px: value[0],
        center_y_px: value[1],
        semi_major_px: value[2],
        semi_minor_px: value[3],
        theta_rad: value[4],
    };
    values.iter().map(ellipse).collect()
}

/// Two pictures and what was found in them, and one that was not run. In the first a double of the first two, one whose
/// axes are swapped, one to ignore and a false one.
fn scene() -> ([(Vec<Ellipse>, Truth); 2], Truth) {
    let truth = |image: &str, values: &[[f64; 5]], ignore: &[[f64; 5]]| Truth {
        image: image.to_owned(),
        ellipses: ellipses(values),
        ignore: ellipses(ignore),
    };
    let first = truth(
        "a",
        &[
            [100.0, 80.0, 40.0, 30.0, 0.3],
            [108.0, 82.0, 40.0, 30.0, 0.3],
            [300.0, 200.0, 60.0, 20.0, 1.2],
            [50.0, 300.0, 10.0, 10.0, 0.0],
        ],
        &[[104.0, 84.0, 20.0, 12.0, 0.1]],
    );
    let second =
        truth("b", &[[200.0, 150.0, 80.0, 70.0, 2.9], [400.0, 300.0, 25.0, 12.0, 0.7]], &[]);
    let found_first = [
        [103.0, 80.5, 40.0, 30.0, 0.3],
        [98.0, 79.5, 40.0, 30.0, 0.3],
        [300.4, 200.3, 19.5, 60.5, 1.2 - std::f64::consts::FRAC_PI_2],
        [104.0, 84.0, 20.5, 12.0, 0.1],
        [420.0, 50.0, 30.0, 20.0, 0.0],
    ];
    let found_second = [
        [201.0, 151.0, 79.0, 71.0, -0.2],
        [404.0, 300.0, 25.0, 12.0, 0.7],
        [200.0, 150.0, 60.0, 52.0, 2.9],
    ];
    (
        [(ellipses(&found_first), first), (ellipses(&found_second), second)],
        truth("c", &[[60.0, 60.0, 30.0, 30.0, 0.0]], &[]),
    )
}

#[test]
fn figures_are_those_of_the_reference() {
    let ([first, second], not_run) = scene();
    let thresholds = [0.7, 0.8, 0.9];
    let mut summaries = [(); 3].map(|()| Summary::default());
    for (found, truth) in [&first, &second] {
        for (summary, score) in summaries.iter_mut().zip(score_picture(found, truth, &thresholds)) {
            summary.add(&score);
        }
    }
    for summary in &mut summaries {
        summary.add_missing(&not_run);
    }
    // Matched pairs, then mean overlap and median errors of centre and semi-axes.
    let expected = [(5, 0.8599, 3.041, 0.0), (4, 0.932, 1.738, 0.25), (3, 0.9606, 1.414, 0.5)];
    for (summary, (matched, overlap, center_px, axis_px)) in summaries.iter().zip(expected) {
        assert_eq!((summary.pictures(), summary.missing()), (2, 1));
        assert_eq!((summary.matched(), summary.found(), summary.truths()), (matched, 7, 7));
        assert!((summary.f() - matched as f64 / 7.0).abs() < 1e-12);
        let close = |value: Option<f64>, expected: f64| (value.unwrap() - expected).abs() < 6e-4;
        assert!(close(summary.overlap_mean(), overlap), "{:?}", summary.overlap_mean());
        assert!(close(summary.center_error_median_px(), center_px));
        assert!(close(summary.semi_axis_error_median_px(), axis_px));
    }
}

#[test]
fn every_owner_moves_on_where_that_gives_one_pair_more() {
    // Every found circle prefers the truth after its own, which the last one has not: to match it, all have to move.
    let circle = |x: f64| [x, 50.0, 20.0, 20.0, 0.0];
    let truths: Vec<_> = (0..300).map(|i| circle(f64::from(i) * 2.0)).collect();
    let found: Vec<_> = (0..300).map(|i| circle(f64::from(i) * 2.0 + 1.2)).collect();
    let truth = Truth { ellipses: ellipses(&truths), ..Truth::default() };
    let score = score_picture(&ellipses(&found), &truth, &[0.9]);
    assert_eq!(score[0].matches.len(), 300);
}

#[test]
fn nothing_found_and_nothing_to_find_have_figures() {
    let mut summary = Summary::default();
    assert_eq!((summary.precision(), summary.recall(), summary.f()), (0.0, 0.0, 0.0));
    summary.add(&score_picture(&[], &Truth::default(), &[0.8])[0]);
    assert_eq!(
        (summary.f(), summary.overlap_mean(), summary.center_error_median_px()),
        (0.0, None, None)
    );
}
