//! Once its buffers have grown, the detector allocates nothing.

mod drawing;

use rsapien_vision::{Detector, GrayImage};

fn allocations(image: &GrayImage) -> (u64, u64) {
    let mut detector = Detector::builder().build().unwrap();
    detector.detect(&image.view());
    detector.detect(&image.view());
    let measured = allocation_counter::measure(|| {
        detector.detect(&image.view());
    });
    (measured.count_total, measured.bytes_total)
}

fn allocations_near(image: &GrayImage) -> u64 {
    let mut detector = Detector::builder().support_points(true).covariance(true).build().unwrap();
    let found = detector.detect(&image.view()).ellipses.clone();
    let predictions: Vec<_> = found.iter().map(|found| found.ellipse).collect();
    detector.detect_near(&image.view(), &predictions);
    detector.detect_near(&image.view(), &predictions);
    let mut near = || {
        detector.detect_near(&image.view(), &predictions);
    };
    allocation_counter::measure(&mut near).count_total
}

#[test]
fn the_third_look_at_a_picture_allocates_nothing() {
    let many = |x: f64, y: f64| {
        let (dx, dy) = (x.rem_euclid(24.0) - 12.0, y.rem_euclid(24.0) - 12.0);
        60.0 + 120.0 * (8.5 - dx.hypot(dy)).clamp(0.0, 1.0)
    };
    for image in [
        drawing::table(320, 240).0,
        drawing::picture(400, 300, many),
        drawing::picture(200, 150, |x, y| 128.0 + 120.0 * ((x * x + y * y) / 90.0).sin()),
        drawing::picture(64, 64, |_, _| 90.0),
    ] {
        assert_eq!(allocations_near(&image), 0, "{} x {}", image.width(), image.height());
        assert_eq!(allocations(&image), (0, 0), "{} x {}", image.width(), image.height());
    }
}
