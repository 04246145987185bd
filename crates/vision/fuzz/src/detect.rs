//! The detector on any picture, with any options. Used by the fuzz target and by the test that replays its corpus.
//!
//! The first bytes are size, options and how the rest becomes a picture: as pixels, or as discs and boxes painted over
//! each other, since a fuzzer draws none.

use rsapien_vision::{Detection, Detector, Ellipse, GrayView, Options, Region, Strokes};

const HEADER_BYTES: usize = 12;
const SIDE_PX_MAX: usize = 96;

pub(crate) fn drive(input: &[u8]) {
    let Some((header, rest)) = input.split_first_chunk::<HEADER_BYTES>() else { return };
    let [width, height, padding, flags, least, range, ratio, score, left, top, columns, rows] =
        *header;
    let width = 1 + usize::from(width) % SIDE_PX_MAX;
    let height = 1 + usize::from(height) % SIDE_PX_MAX;
    let stride = width + usize::from(padding % 8);
    let semi_axis_min_px = 1.5 + f64::from(least) / 16.0;
    let options = Options {
        semi_axis_min_px,
        semi_axis_max_px: semi_axis_min_px + f64::from(range),
        axis_ratio_min: 0.05 + 0.95 * f64::from(ratio) / 255.0,
        score_min: f64::from(score) / 255.0,
        region: (flags & 1 == 1).then(|| Region {
            left: usize::from(left),
            top: usize::from(top),
            width: 1 + usize::from(columns),
            height: 1 + usize::from(rows),
        }),
        strokes: if flags & 2 == 0 { Strokes::MiddleLine } else { Strokes::BothEdges },
        support_points: flags & 4 != 0,
        covariance: flags & 8 != 0,
        seed: u64::from(flags >> 4),
    };
    let pixels = if flags & 16 == 0 {
        let mut pixels = rest.to_vec();
        pixels.resize(stride * height, 128);
        pixels
    } else {
        painted(stride, height, rest)
    };
    let view = GrayView::new(&pixels, width, height, stride).expect("rows fit");
    let mut detector = Detector::with_options(options).expect("within the ranges");
    let first = detector.detect(&view).clone();
    check(&first, &options, width, height);
    // What was found is a prediction, and so is anything else.
    let mut predictions: Vec<_> = first.ellipses.iter().map(|found| found.ellipse).collect();
    predictions.extend(rest.chunks_exact(5).take(4).map(shape));
    let near = detector.detect_near(&view, &predictions).clone();
    check(&near, &options, width, height);
    assert!(near.ellipses.len() <= predictions.len());
    // Nothing of the other pictures is left.
    let again = detector.detect(&view);
    assert_eq!(again.ellipses, first.ellipses);
    assert_eq!(again.support, first.support);
    assert_eq!(again.statistics, first.statistics);
}

fn check(detection: &Detection, options: &Options, width: usize, height: usize) {
    assert!(!detection.truncated, "a small picture uses no budget up");
    for found in &detection.ellipses {
        let ellipse = found.ellipse;
        assert_eq!(ellipse, ellipse.canonical());
        assert!(ellipse.center_x_px.is_finite() && ellipse.center_y_px.is_finite());
        // The middle line of a stroke may lie a little outside.
        assert!(ellipse.semi_minor_px >= options.semi_axis_min_px - 1e-9, "{found:?}");
        assert!(ellipse.semi_major_px <= options.semi_axis_max_px + 1e-9, "{found:?}");
        assert!((options.score_min..=1.0).contains(&found.score), "{found:?}");
        for share in
            [found.support_share, found.inside_share, found.gap_share, found.gradient_agreement]
        {
            assert!((0.0..=1.0 + 1e-6).contains(&share), "{found:?}");
        }
        assert!(found.log10_false_alarms.is_finite() && found.residual_px >= 0.0, "{found:?}");
        assert_eq!(detection.support_of(found).is_empty(), !options.support_points, "{found:?}");
        for point in detection.support_of(found) {
            assert!(point.x_px >= 0.0 && point.x_px < width as f32, "{point:?}");
            assert!(point.y_px >= 0.0 && point.y_px < height as f32, "{point:?}");
        }
        let covariance = found.covariance.unwrap_or_default();
        assert!(covariance.iter().flatten().all(|value| value.is_finite()), "{found:?}");
    }
}

/// Centre, semi-axes and angle, a byte each.
fn shape(bytes: &[u8]) -> Ellipse {
    let [x, y, a, b, theta] = [0, 1, 2, 3, 4].map(|at| f64::from(bytes[at]));
    Ellipse {
        center_x_px: x / 2.0 - 16.0,
        center_y_px: y / 2.0 - 16.0,
        semi_major_px: a / 4.0,
        semi_minor_px: b / 4.0,
        theta_rad: theta / 40.0,
    }
}

/// Each six bytes: a shape, and its grey value, whose lowest bit tells discs from boxes.
fn painted(stride: usize, height: usize, shapes: &[u8]) -> Vec<u8> {
    let mut pixels = vec![90; stride * height];
    for bytes in shapes.chunks_exact(6).take(24) {
        let (ellipse, grey) = (shape(bytes), bytes[5]);
        for (at, pixel) in pixels.iter_mut().enumerate() {
            let (x, y) = ((at % stride) as f64, (at / stride) as f64);
            let cover = if grey & 1 == 0 {
                (0.5 - ellipse.distance_px(x, y)).clamp(0.0, 1.0)
            } else {
                let (dx, dy) = (x - ellipse.center_x_px, y - ellipse.center_y_px);
                f64::from(u8::from(
                    dx.abs() < ellipse.semi_major_px && dy.abs() < ellipse.semi_minor_px,
                ))
            };
            *pixel = (f64::from(*pixel) + (f64::from(grey) - f64::from(*pixel)) * cover) as u8;
        }
    }
    pixels
}
