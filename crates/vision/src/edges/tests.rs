use proptest::prelude::*;

use super::*;
use crate::test_pictures::{discs, ellipse, noise as random_bytes, patches, picture};

fn found(image: &crate::image::GrayImage) -> EdgeMap {
    let mut edges = EdgeMap::default();
    edges.find(&image.view());
    edges
}

fn angle_deg(point: &EdgePoint, normal: (f64, f64)) -> f64 {
    let (x, y) = (f64::from(point.gradient_x), f64::from(point.gradient_y));
    (x * normal.1 - y * normal.0).atan2(x * normal.0 + y * normal.1).to_degrees().abs()
}

proptest! {
    /// Around the borders of the words, where shifts go wrong.
    #[test]
    fn a_run_visits_what_a_set_holds(
        width in prop_oneof![1_usize..4, 62_usize..67, 126_usize..131, 190_usize..194],
        height in 1_usize..4,
        marks in prop::collection::vec(any::<u64>(), 16),
        sparse in any::<bool>(),
        x in -40_i32..240,
        y in -2_i32..5,
        reach in 0_i32..=31,
    ) {
        let is_marked = |x: usize, y: usize| {
            let at = y * width + x;
            let dense = marks[at / 64 % 16] >> (at % 64) & 1 == 1;
            dense && (!sparse || at.is_multiple_of(7))
        };
        let mut map = PointMap::default();
        // What a larger picture left behind is gone.
        map.reset(width + 70, height + 3);
        for row in 0..height + 3 {
            map.row_mut(row).fill(u64::MAX);
        }
        map.seal();
        map.reset(width, height);
        let mut places = Vec::new();
        for row in 0..height {
            for column in (0..width).filter(|&column| is_marked(column, row)) {
                map.row_mut(row)[column / 64] |= 1 << (column % 64);
                places.push((i32::try_from(column).unwrap(), i32::try_from(row).unwrap()));
            }
        }
        map.seal();
        let mut visited = Vec::new();
        map.visit_run(x, y, reach, |number| visited.push(number));
        let expected: Vec<u32> = (0..places.len() as u32)
            .filter(|&number| {
                let (column, row) = places[number as usize];
                row == y && (column - x).abs() <= reach
            })
            .collect();
        prop_assert_eq!(visited, expected);
    }

    /// A straight edge at any angle: no point is off by more than a tenth of a pixel.
    #[test]
    fn a_step_is_found_between_pixels(theta_rad in 0.0..std::f64::consts::TAU, shift in -0.5..0.5) {
        let (sin, cos) = f64::sin_cos(theta_rad);
        let offset = |x: f64, y: f64| -> f64 { (x - 32.0) * cos + (y - 32.0) * sin - shift };
        let image = picture(65, 65, |x, y| 60.0 + 120.0 * (0.5 + offset(x, y)).clamp(0.0, 1.0));
        let edges = found(&image);
        prop_assert!(edges.points.len() >= 40, "{} points", edges.points.len());
        for point in &edges.points {
            let (x, y) = (f64::from(point.x), f64::from(point.y));
            // Where the edge leaves the picture, the border that goes on bends it.
            if (4.0..=60.0).contains(&x) && (4.0..=60.0).contains(&y) {
                prop_assert!(offset(x, y).abs() < 0.1, "{point:?} is off by {}", offset(x, y));
                prop_assert!(angle_deg(point, (cos, sin)) < 3.0, "{point:?}");
            }
        }
    }
}

#[test]
fn the_contour_of_a_disc_is_found_between_pixels() {
    let truth = ellipse(50.3, 47.8, 34.6, 25.2, 0.6);
    let edges = found(&discs(100, 100, &[truth]));
    assert!(edges.points.len() as f64 > 0.6 * truth.perimeter_px());
    let shape = crate::shape::Shape::from_ellipse(&truth);
    for point in &edges.points {
        let (distance, x, y) = shape.distance(f64::from(point.x), f64::from(point.y));
        assert!(distance.abs() < 0.1, "{point:?} is off by {distance}");
        // A bright disc: the gradient points inwards.
        assert!(angle_deg(point, (-x, -y)) < 3.0, "{point:?}");
    }
}

#[test]
fn each_point_lies_at_its_own_pixel() {
    let edges = found(&patches(130, 67, 3));
    let mut number = 0;
    for y in 0..67 {
        for x in 0..130 {
            edges.map.visit_run(x, y, 0, |here| {
                assert_eq!(here, number);
                let point = edges.points[here as usize];
                assert!((point.x - x as f32).abs() <= 0.5 && (point.y - y as f32).abs() <= 0.5);
                assert!((point.gradient_x.hypot(point.gradient_y) - 1.0).abs() < 1e-5);
                number += 1;
            });
        }
    }
    assert_eq!(number as usize, edges.points.len());
    assert!(number > 100, "patches have edges");
}

#[test]
fn noise_is_told_from_structure() {
    // Sums of bytes are nearly normal; twelve of them have the standard deviation 255.
    let normal = |seed: u64| {
        random_bytes(12 * 160 * 120, seed)
            .chunks_exact(12)
            .map(|bytes| (bytes.iter().map(|&b| f64::from(b)).sum::<f64>() - 1530.0) / 256.0)
            .collect::<Vec<_>>()
    };
    for (seed, deviation) in [(1, 2.0), (2, 5.0), (3, 12.0), (4, 30.0)] {
        let values = normal(seed);
        let truth = ellipse(80.0, 60.0, 40.0, 30.0, 0.4);
        let image = picture(160, 120, |x, y| {
            let clean = if truth.contains(x, y) { 150.0 } else { 100.0 };
            clean + deviation * values[y as usize * 160 + x as usize]
        });
        let estimate = f64::from(noise::estimate(&image.view()));
        assert!((estimate / deviation - 1.0).abs() < 0.15, "{estimate} for {deviation}");
    }
    let clean = discs(90, 70, &[ellipse(45.0, 35.0, 20.0, 20.0, 0.0)]);
    assert!(noise::estimate(&clean.view()) < 0.3);
}

#[test]
fn white_noise_has_few_edges() {
    let values = random_bytes(12 * 200 * 200, 9);
    let image = picture(200, 200, |x, y| {
        let at = 12 * (y as usize * 200 + x as usize);
        128.0
            + 6.0 * (values[at..at + 12].iter().map(|&b| f64::from(b)).sum::<f64>() - 1530.0)
                / 256.0
    });
    let share = found(&image).points.len() as f64 / 40_000.0;
    assert!(share < 0.02, "{share} of the pixels");
}
