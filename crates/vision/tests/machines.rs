//! The same ellipses on every machine: recorded results of pictures that are drawn in integers. Who changes the detector
//! on purpose records them anew, from what the test prints.
#![allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, clippy::cast_sign_loss)]
#![allow(clippy::cast_possible_wrap, clippy::many_single_char_names)]

use rsapien_vision::{Detector, GrayImage, Options, Strokes};

/// Centre and semi-axes in pixels; the major axis is turned by the angle whose tangent is 3/4.
struct Turned(i64, i64, i64, i64);

/// Sixty-fourths of the pixel that lie in the ellipse.
fn cover(&Turned(x, y, a, b): &Turned, column: i64, row: i64) -> i64 {
    let mut count = 0;
    for part in 0..64 {
        // In sixteenths of a pixel.
        let dx = 16 * (column - x) + 2 * (part % 8) - 7;
        let dy = 16 * (row - y) + 2 * (part / 8) - 7;
        // Five times the offset along the axes.
        let (u, v) = (4 * dx + 3 * dy, 4 * dy - 3 * dx);
        count += i64::from((u * b).pow(2) + (v * a).pow(2) < (80 * a * b).pow(2));
    }
    count
}

fn drawn(width: i64, height: i64, shapes: &[(Turned, i64)], noise: i64) -> GrayImage {
    let mut random = 1_u64;
    let pixels = (0..width * height).map(|at| {
        let mut grey = 64 * 90;
        for (shape, paint) in shapes {
            let cover = cover(shape, at % width, at / width);
            grey = (grey * (64 - cover) + 64 * paint * cover) / 64;
        }
        random =
            random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let off = if noise > 0 { (random >> 40) as i64 % (2 * noise + 1) - noise } else { 0 };
        (grey / 64 + off).clamp(0, 255) as u8
    });
    GrayImage::new(pixels.collect(), width as usize, height as usize).unwrap()
}

/// `[center x, center y, semi-major, semi-minor]` in pixels and the angle in radians.
fn assert_same(name: &str, image: &GrayImage, options: Options, recorded: &[[f64; 5]]) {
    let mut detector = Detector::with_options(options).unwrap();
    let mut found: Vec<_> = detector
        .detect(&image.view())
        .ellipses
        .iter()
        .map(|found| {
            let e = found.ellipse;
            [e.center_x_px, e.center_y_px, e.semi_major_px, e.semi_minor_px, e.theta_rad]
        })
        .collect();
    // From left to right, so that another weighting of the score changes nothing.
    found.sort_by(|a, b| a[0].total_cmp(&b[0]));
    for row in &found {
        println!("[{:.4}, {:.4}, {:.4}, {:.4}, {:.5}],", row[0], row[1], row[2], row[3], row[4]);
    }
    // An angle counts by what it moves on the contour, which for a circle is nothing.
    let off_px = |one: &[f64; 5], other: &[f64; 5]| {
        let turned_px = (one[4] - other[4]).sin().abs() * (other[2] - other[3]);
        (0..4).map(|at| (one[at] - other[at]).abs()).fold(turned_px, f64::max)
    };
    let is_same = found.len() == recorded.len()
        && found.iter().zip(recorded).all(|(one, other)| off_px(one, other) < 1e-3);
    assert!(is_same, "{name}: the ellipses have changed, see above; recorded are {recorded:?}");
}

#[test]
fn discs() {
    let shapes = [
        (Turned(60, 60, 45, 30), 200),
        (Turned(150, 70, 38, 38), 20),
        (Turned(205, 130, 50, 20), 230),
        (Turned(70, 150, 20, 9), 160),
    ];
    assert_same(
        "discs",
        &drawn(260, 190, &shapes, 0),
        Options::default(),
        &[
            [60.0000, 60.0000, 44.9623, 29.9840, 0.64337],
            [70.0004, 150.0008, 19.8352, 8.9858, 0.64395],
            [150.0016, 70.0020, 37.9913, 37.9870, 0.98687],
            [204.9875, 129.9869, 49.9392, 19.9968, 0.64387],
        ],
    );
}

#[test]
fn strokes_in_noise() {
    let shapes = [
        (Turned(70, 70, 55, 40), 30),
        (Turned(70, 70, 49, 34), 90),
        (Turned(170, 100, 43, 43), 190),
        (Turned(170, 100, 38, 38), 90),
    ];
    let image = drawn(240, 160, &shapes, 9);
    assert_same(
        "middle lines",
        &image,
        Options::default(),
        &[
            [69.9878, 69.9911, 51.9751, 36.9953, 0.64344],
            [169.9997, 100.0013, 40.4904, 40.4772, 1.27847],
        ],
    );
    let options = Options { strokes: Strokes::BothEdges, seed: 7, ..Options::default() };
    assert_same(
        "both edges",
        &image,
        options,
        &[
            [69.9833, 69.9854, 48.9650, 33.9895, 0.64370],
            [69.9922, 69.9969, 54.9852, 40.0012, 0.64317],
            [169.9944, 99.9991, 42.9901, 42.9855, 1.07332],
            [170.0051, 100.0035, 37.9907, 37.9689, 1.48361],
        ],
    );
}

#[test]
fn discs_on_discs() {
    let shapes: Vec<_> = (0..14_i64)
        .map(|i| {
            let shape =
                Turned(40 + i * 61 % 180, 40 + i * 47 % 120, 16 + i * 5 % 17, 12 + i * 3 % 5);
            (shape, (40 + i * 83) % 256)
        })
        .collect();
    assert_same(
        "discs on discs",
        &drawn(260, 200, &shapes, 2),
        Options { score_min: 0.5, ..Options::default() },
        &[
            [40.0044, 40.1202, 15.9908, 12.0598, 0.65325],
            [43.0013, 60.9986, 30.9154, 15.9368, 0.63985],
            [45.9911, 81.9594, 28.9380, 15.0183, 0.64419],
            [51.9949, 123.9398, 24.9321, 13.0366, 0.64556],
            [101.0245, 87.0274, 20.9357, 14.9717, 0.64702],
            [109.9862, 150.0189, 31.6440, 11.9854, 0.64324],
            [161.9919, 133.9865, 25.8866, 12.9825, 0.64250],
            [164.9932, 154.9677, 23.8938, 12.0049, 0.64456],
            [167.9967, 56.0117, 21.9310, 15.9846, 0.64365],
            [170.9987, 76.9323, 19.9664, 15.0121, 0.64993],
        ],
    );
}
