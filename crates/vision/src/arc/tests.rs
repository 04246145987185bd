use super::*;
use crate::edges::EdgeMap;
use crate::test_pictures::{discs, ellipse, picture};

fn cut(image: &crate::image::GrayImage) -> Arcs {
    let (mut edges, mut chains, mut arcs) =
        (EdgeMap::default(), Chains::default(), Arcs::default());
    edges.find(&image.view());
    chains.link(&edges);
    arcs.cut(&mut chains);
    arcs
}

#[test]
fn a_disc_is_one_whole_ring() {
    for is_bright in [true, false] {
        let truth = ellipse(60.3, 58.9, 41.0, 28.0, 0.5);
        let mut image = discs(120, 120, &[truth]);
        if !is_bright {
            image.pixels_mut().iter_mut().for_each(|grey| *grey = 255 - *grey);
        }
        let arcs = cut(&image).all;
        assert_eq!(arcs.len(), 1, "{arcs:?}");
        let arc = &arcs[0];
        assert!(arc.is_ring);
        assert!((arc.turn_rad - std::f32::consts::TAU).abs() < 0.2, "{}", arc.turn_rad);
        assert!((f64::from(arc.length_px) / truth.perimeter_px() - 1.0).abs() < 0.15);
        let exact = Shape::from_ellipse(&truth);
        for i in 0..SAMPLES {
            let (_, x, y) = exact.distance(arc.x[i].into(), arc.y[i].into());
            let cosine = -x * f64::from(arc.inside_x[i]) - y * f64::from(arc.inside_y[i]);
            // From one side at the ends, so that they are off by one step's turn.
            let least = if (2..SAMPLES - 2).contains(&i) { 0.98 } else { 0.6 };
            assert!(cosine > least, "sample {i}: {cosine}");
        }
        let fitted = arc.shape.expect("a whole ring tells its ellipse").ellipse();
        assert!((fitted.center_x_px - truth.center_x_px).abs() < 0.1, "{fitted:?}");
        assert!((fitted.semi_minor_px - truth.semi_minor_px).abs() < 0.1, "{fitted:?}");
    }
}

#[test]
fn a_polygon_has_no_arc() {
    for theta in [0.0_f64, 0.3, std::f64::consts::FRAC_PI_4] {
        let (sin, cos) = theta.sin_cos();
        let image = picture(160, 160, |x, y| {
            let (dx, dy) = (x - 80.0, y - 80.0);
            let outside = (dx * cos + dy * sin).abs().max((dy * cos - dx * sin).abs()) - 45.0;
            40.0 + 160.0 * (0.5 - outside).clamp(0.0, 1.0)
        });
        let arcs = cut(&image).all;
        assert!(arcs.is_empty(), "turned by {theta}: {arcs:?}");
    }
}

#[test]
fn two_discs_that_overlap_are_cut_where_they_meet() {
    let (one, other) =
        (ellipse(55.0, 60.0, 35.0, 35.0, 0.0), ellipse(105.0, 60.0, 35.0, 35.0, 0.0));
    let arcs = cut(&discs(160, 120, &[one, other])).all;
    let mut seen = [0.0_f32; 2];
    for arc in &arcs {
        let on = [one, other].map(|truth| {
            let near = |&i: &usize| truth.distance_px(arc.x[i].into(), arc.y[i].into()).abs() < 1.5;
            (0..SAMPLES).filter(near).count()
        });
        assert!(on[0].max(on[1]) >= SAMPLES - 2, "no arc has parts of both: {on:?} {arc:?}");
        seen[usize::from(on[1] > on[0])] += arc.turn_rad;
    }
    assert!(seen.iter().all(|&turn_rad| turn_rad > 3.0), "{seen:?}");
}

/// A spiral turns one way all along, thousands of sides in a row of which no long run is elliptic.
#[test]
fn a_spiral_is_cut_in_bounded_time() {
    let image = picture(1400, 1400, |x, y| {
        let (dx, dy) = (x - 700.0, y - 700.0);
        128.0 + 100.0 * (dx.hypot(dy) * std::f64::consts::TAU / 10.0 + dy.atan2(dx)).sin()
    });
    let start = std::time::Instant::now();
    let arcs = cut(&image).all;
    // Without the bound it takes about a minute, with it less than a second, in a debug build.
    assert!(start.elapsed().as_secs() < 10, "{:?}", start.elapsed());
    assert!(arcs.len() > 50);
    let on_circle = arcs.iter().filter(|arc| {
        let radius = |i: usize| (arc.x[i] - 700.0).hypot(arc.y[i] - 700.0);
        (0..SAMPLES).all(|i| (radius(i) - radius(SAMPLES / 2)).abs() < 12.0)
    });
    assert!(on_circle.count() * 10 > arcs.len() * 9, "arcs stay on one turn of the spiral");
}
