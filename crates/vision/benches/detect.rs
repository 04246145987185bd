//! The stages and the whole detection, on a drawn picture of the size and edge count of the paper's, on one thread.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use rsapien_vision::image::GrayView;
use rsapien_vision::paper::edge::edge_points;
use rsapien_vision::paper::gradient::sobel_magnitude;
use rsapien_vision::paper::hough::search;
use rsapien_vision::paper::noise::{NoiseReduction, reduce_noise};
use rsapien_vision::paper::threshold::{binarize, maximum_variance_level};
use rsapien_vision::paper::{Detector, Options};
use rsapien_vision::{Ellipse, Picture, draw};

/// Two cup rims, each drawn as three neighbouring outlines, on grey.
fn picture() -> Picture {
    let mut picture =
        Picture::new(vec![180; 320 * 240 * 3], 320, 240).expect("a picture within the limits");
    for (center_x_px, center_y_px, a, b, theta_rad) in
        [(235.5, 164.5, 60.0, 37.0, 0.253), (71.0, 49.0, 44.0, 22.0, 0.045)]
    {
        for offset in [-1.5, 0.0, 1.5] {
            let ellipse = Ellipse {
                center_x_px,
                center_y_px,
                semi_major_px: a + offset,
                semi_minor_px: b + offset,
                theta_rad,
            };
            draw::ellipse(&mut picture, &ellipse, [30, 30, 30]);
        }
    }
    picture
}

fn stages(criterion: &mut Criterion) {
    let one_thread =
        rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool of one thread");
    let gray = picture().to_gray();
    let denoised = reduce_noise(&gray.view(), NoiseReduction::Gaussian);
    let gradient = sobel_magnitude(&denoised.view());
    let level =
        maximum_variance_level(&rsapien_vision::paper::threshold::histogram(&gradient.view()));
    let binary = binarize(&gradient.view(), level);
    let points = edge_points(&binary.view());
    let options = Options::paper();

    criterion.bench_function("noise median", |b| {
        b.iter(|| reduce_noise(&black_box(&gray).view(), NoiseReduction::Median));
    });
    criterion.bench_function("noise gaussian", |b| {
        b.iter(|| reduce_noise(&black_box(&gray).view(), NoiseReduction::Gaussian));
    });
    criterion
        .bench_function("gradient", |b| b.iter(|| sobel_magnitude(&black_box(&denoised).view())));
    criterion.bench_function("threshold", |b| {
        let binarized = |gradient: &GrayView<'_>| {
            binarize(
                gradient,
                maximum_variance_level(&rsapien_vision::paper::threshold::histogram(gradient)),
            )
        };
        b.iter(|| binarized(&black_box(&gradient).view()));
    });
    criterion.bench_function("edge points", |b| b.iter(|| edge_points(&black_box(&binary).view())));
    criterion.bench_function(&format!("hough, {} edge points", points.len()), |b| {
        one_thread.install(|| {
            b.iter(|| {
                search(black_box(&points), &options.hough, options.filter.side_votes_min(), 1)
            });
        });
    });
    criterion.bench_function("detect", |b| {
        one_thread.install(|| b.iter(|| Detector::paper().detect(&black_box(&gray).view(), 1)));
    });
}

criterion_group!(benches, stages);
criterion_main!(benches);
