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
    let is_same = found.len() == recorded.len()
        && found.iter().flatten().zip(recorded.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-3);
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
            [150.0016, 70.0019, 37.9921, 37.9861, 0.83830],
            [204.9876, 129.9869, 49.9391, 19.9968, 0.64388],
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
            [69.9876, 69.9911, 51.9748, 36.9952, 0.64343],
            [169.9997, 100.0017, 40.4900, 40.4763, 1.18372],
        ],
    );
    let options = Options { strokes: Strokes::BothEdges, seed: 7, ..Options::default() };
    assert_same(
        "both edges",
        &image,
        options,
        &[
            [69.9830, 69.9853, 48.9644, 33.9892, 0.64369],
            [69.9922, 69.9969, 54.9852, 40.0012, 0.64317],
            [169.9943, 99.9994, 42.9886, 42.9840, 0.89250],
            [170.0051, 100.0041, 37.9914, 37.9686, 1.47495],
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
        Options::default(),
        &[
            [40.0040, 40.1206, 15.9906, 12.0607, 0.65325],
            [43.0010, 61.0004, 30.9162, 15.9400, 0.64004],
            [45.9908, 81.9547, 28.9275, 14.9970, 0.64307],
            [48.9952, 102.9114, 26.9550, 14.1826, 0.65121],
            [51.9939, 123.9392, 24.9334, 13.0364, 0.64555],
            [101.0245, 87.0279, 20.9358, 14.9716, 0.64706],
            [109.9862, 150.0190, 31.6440, 11.9854, 0.64324],
            [161.9919, 133.9865, 25.8866, 12.9825, 0.64250],
            [164.9934, 154.9644, 23.8953, 12.0064, 0.64476],
            [167.9964, 56.0144, 21.9322, 15.9856, 0.64401],
            [170.9987, 76.9323, 19.9664, 15.0121, 0.64993],
        ],
    );
}
