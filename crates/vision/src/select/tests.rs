use super::*;
use crate::detector::Detector;
use crate::test_pictures::{discs, ellipse, rings};

fn found(image: &crate::image::GrayImage, strokes: Strokes) -> Vec<DetectedEllipse> {
    let mut detector = Detector::builder().strokes(strokes).build().unwrap();
    detector.detect(&image.view()).ellipses.clone()
}

#[test]
fn a_stroke_gives_its_middle_line() {
    for width_px in [4.0, 6.0, 9.0] {
        let truth = ellipse(100.3, 79.6, 62.0, 45.0, 0.5);
        let image = rings(200, 160, &[truth], width_px);
        let ellipses = found(&image, Strokes::MiddleLine);
        assert_eq!(ellipses.len(), 1, "{width_px} px: {ellipses:?}");
        let width = ellipses[0].stroke_width_px.expect("a stroke has a width");
        assert!((width - width_px).abs() < 0.3, "{width} for {width_px} px");
        let middle = ellipses[0].ellipse;
        assert!((middle.semi_major_px - 62.0).abs() < 0.2, "{middle:?}");
        assert!((middle.semi_minor_px - 45.0).abs() < 0.2, "{middle:?}");
    }
}

#[test]
fn a_stroke_gives_both_edges_on_request() {
    let truth = ellipse(100.3, 79.6, 62.0, 45.0, 0.5);
    for width_px in [4.0, 6.0, 9.0] {
        let ellipses = found(&rings(200, 160, &[truth], width_px), Strokes::BothEdges);
        let mut semi_majors: Vec<_> =
            ellipses.iter().map(|found| found.ellipse.semi_major_px).collect();
        semi_majors.sort_by(f64::total_cmp);
        assert_eq!(semi_majors.len(), 2, "{width_px} px: {ellipses:?}");
        assert!((semi_majors[0] - (62.0 - width_px / 2.0)).abs() < 0.3, "{ellipses:?}");
        assert!((semi_majors[1] - (62.0 + width_px / 2.0)).abs() < 0.3, "{ellipses:?}");
        assert!(ellipses.iter().all(|found| found.stroke_width_px.is_none()));
    }
}

#[test]
fn an_edge_is_no_stroke_and_comes_once() {
    let truths = [ellipse(60.0, 60.0, 40.0, 30.0, 0.2), ellipse(150.0, 90.0, 30.0, 30.0, 0.0)];
    for strokes in [Strokes::MiddleLine, Strokes::BothEdges] {
        let ellipses = found(&discs(200, 160, &truths), strokes);
        assert_eq!(ellipses.len(), 2, "{ellipses:?}");
        assert!(ellipses.iter().all(|found| found.stroke_width_px.is_none()));
        assert!(ellipses[0].score >= ellipses[1].score, "best first");
    }
}
