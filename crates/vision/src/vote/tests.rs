use super::*;
use crate::ellipse::Ellipse;
use crate::test_pictures::ellipse;

/// The piece of a contour between two parameters.
fn arc(truth: &Ellipse, from_rad: f64, to_rad: f64) -> Arc {
    let shape = crate::shape::Shape::from_ellipse(truth);
    let place =
        |i: usize| truth.point_at(from_rad + (to_rad - from_rad) * i as f64 / (SAMPLES - 1) as f64);
    let inside = |i: usize| {
        let (x, y) = place(i);
        let (_, normal_x, normal_y) = shape.distance(x, y);
        (-normal_x as f32, -normal_y as f32)
    };
    Arc {
        x: std::array::from_fn(|i| place(i).0 as f32),
        y: std::array::from_fn(|i| place(i).1 as f32),
        inside_x: std::array::from_fn(|i| inside(i).0),
        inside_y: std::array::from_fn(|i| inside(i).1),
        turn_rad: (to_rad - from_rad).abs() as f32,
        length_px: 50.0,
        is_ring: false,
        shape: None,
    }
}

fn votes(one: &Arc, other: &Arc) -> impl Iterator<Item = u8> {
    let mut all = Vec::new();
    for from in 2..SAMPLES - 2 {
        for to in 2..SAMPLES - 2 {
            all.push(vote(one, from, other, to));
        }
    }
    all.into_iter()
}

#[test]
fn two_arcs_of_one_ellipse_agree() {
    for truth in [
        ellipse(100.0, 80.0, 60.0, 60.0, 0.0),
        ellipse(100.0, 80.0, 60.0, 30.0, 0.7),
        ellipse(400.0, 300.0, 300.0, 100.0, 2.0),
    ] {
        for (from_rad, to_rad) in [(2.0, 3.0), (3.5, 5.0), (1.4, 2.2)] {
            let (one, other) = (arc(&truth, 0.0, 1.2), arc(&truth, from_rad, to_rad));
            let least = votes(&one, &other).min().unwrap();
            assert!(
                usize::from(least) >= VOTES - 2,
                "{least} of {VOTES}: {truth:?} {from_rad}..{to_rad}"
            );
        }
    }
}

#[test]
fn arcs_of_two_ellipses_do_not() {
    let one = arc(&ellipse(100.0, 100.0, 60.0, 60.0, 0.0), 0.0, 1.2);
    for other in [
        arc(&ellipse(100.0, 100.0, 100.0, 40.0, 0.0), 2.2, 3.6),
        arc(&ellipse(70.0, 60.0, 25.0, 25.0, 0.0), 2.2, 4.2),
        arc(&ellipse(60.0, 100.0, 90.0, 90.0, 0.0), 3.0, 4.0),
    ] {
        let mut all: Vec<_> = votes(&one, &other).collect();
        all.sort_unstable();
        let median = all[all.len() / 2];
        assert!(
            3 * usize::from(median) < 2 * VOTES,
            "half of the draws give {median} of {VOTES} and more"
        );
    }
}

#[test]
fn points_that_coincide_do_not_vote() {
    let one = arc(&ellipse(100.0, 100.0, 60.0, 40.0, 0.0), 0.0, 1.2);
    assert_eq!(vote(&one, 5, &one, 5), 0);
    let mut point = one.clone();
    (point.x, point.y) = ([0.0; SAMPLES], [0.0; SAMPLES]);
    assert!(votes(&one, &point).all(|votes| votes <= 24));
    assert!(votes(&point, &point).all(|votes| votes == 0));
}
