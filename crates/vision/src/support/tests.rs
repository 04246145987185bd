use super::*;
use crate::ellipse::Ellipse;
use crate::test_pictures::{discs, ellipse, patches, rings};

fn look(image: &crate::image::GrayImage, along: &Ellipse) -> (Support, Along) {
    let (mut edges, mut buffers) = (EdgeMap::default(), Along::default());
    edges.find(&image.view());
    let support = buffers.gather(&edges, &Shape::from_ellipse(along), 1.5, 0.9, STEPS_MAX);
    (support, buffers)
}

#[test]
fn a_disc_supports_its_contour() {
    for truth in [
        ellipse(100.2, 80.7, 60.0, 60.0, 0.0),
        ellipse(100.2, 80.7, 70.0, 30.0, 0.5),
        ellipse(100.0, 80.0, 12.3, 8.0, 1.0),
        ellipse(99.5, 80.5, 5.0, 4.0, 0.0),
    ] {
        let (support, along) = look(&discs(200, 160, &[truth]), &truth);
        assert!(support.share > 0.97, "{truth:?}: {support:?}");
        assert!(support.agreement > 0.99, "{truth:?}: {support:?}");
        // Smoothing moves a contour by half its curvature, in pixels.
        let moved_px = 0.5 * truth.semi_major_px / truth.semi_minor_px.powi(2);
        assert!(support.residual < 0.1 + moved_px, "{truth:?}: {support:?}");
        assert!((support.inside - 1.0).abs() < 1e-6, "{truth:?}: {support:?}");
        assert!((support.length / truth.perimeter_px() - 1.0).abs() < 0.03, "{truth:?}");
        assert!((0.0..0.03).contains(&support.gap), "{truth:?}: {support:?}");
        assert_eq!(support.inward, support.hits, "a bright disc");
        assert!(along.hits.len() >= 10);
    }
}

#[test]
fn where_there_is_no_edge_there_is_no_support() {
    let disc = ellipse(100.0, 80.0, 50.0, 50.0, 0.0);
    let image = discs(200, 160, &[disc]);
    for elsewhere in [
        ellipse(100.0, 80.0, 40.0, 40.0, 0.0),
        ellipse(-400.0, 900.0, 60.0, 50.0, 0.0),
        ellipse(1e9, -1e9, 60.0, 50.0, 0.0),
    ] {
        let (support, along) = look(&image, &elsewhere);
        assert!(support.hits == 0 && along.hits.is_empty(), "{elsewhere:?}: {support:?}");
        assert!(support.share == 0.0 && support.agreement == 0.0 && support.residual == 0.0);
    }
}

#[test]
fn half_of_a_contour_is_half_a_support() {
    // The right half is painted over.
    let truth = ellipse(100.0, 80.0, 50.0, 40.0, 0.0);
    let mut image = discs(200, 160, &[truth]);
    for row in image.pixels_mut().chunks_exact_mut(200) {
        row[100..].fill(40);
    }
    let support = look(&image, &truth).0;
    assert!((support.share - 0.5).abs() < 0.05 && (support.gap - 0.5).abs() < 0.05, "{support:?}");
    // The right half is outside the picture.
    let cut: Vec<u8> = discs(200, 160, &[truth])
        .pixels()
        .chunks_exact(200)
        .flat_map(|row| row[..100].to_vec())
        .collect();
    let support = look(&crate::image::GrayImage::new(cut, 100, 160).unwrap(), &truth).0;
    assert!((support.inside - 0.5).abs() < 0.05 && support.share > 0.9, "{support:?}");
}

#[test]
fn the_sense_of_the_gradient_is_counted() {
    let middle = ellipse(100.0, 80.0, 50.0, 40.0, 0.0);
    let image = rings(200, 160, &[middle], 6.0);
    let outer = look(&image, &ellipse(100.0, 80.0, 53.0, 43.0, 0.0)).0;
    let inner = look(&image, &ellipse(100.0, 80.0, 47.0, 37.0, 0.0)).0;
    assert!(outer.share > 0.97 && outer.inward == 0, "{outer:?}");
    assert!(inner.share > 0.97 && inner.inward == inner.hits, "{inner:?}");
}

#[test]
fn patches_support_nothing_whole() {
    let image = patches(200, 160, 5);
    for along in [ellipse(100.0, 80.0, 50.0, 40.0, 0.0), ellipse(60.0, 60.0, 12.0, 9.0, 0.0)] {
        let support = look(&image, &along).0;
        assert!(support.share < 0.6, "{support:?}");
    }
}
