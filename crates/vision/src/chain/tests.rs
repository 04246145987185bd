use super::*;
use crate::test_pictures::{discs, ellipse, patches, picture, rings};

fn linked(image: &crate::image::GrayImage) -> Chains {
    let mut edges = EdgeMap::default();
    edges.find(&image.view());
    let mut chains = Chains::default();
    chains.link(&edges);
    chains
}

/// Whether the bright side stays on the left of the way (y points down).
fn on_one_hand(points: &[EdgePoint]) -> bool {
    points.windows(2).all(|pair| {
        let (dx, dy) = (pair[1].x - pair[0].x, pair[1].y - pair[0].y);
        dy * pair[0].gradient_x - dx * pair[0].gradient_y > 0.0
    })
}

#[test]
fn a_disc_is_one_ring() {
    for (x, y, a, b, theta) in
        [(60.0, 60.0, 40.0, 40.0, 0.0), (58.4, 61.7, 45.0, 20.0, 0.7), (60.2, 60.9, 8.0, 6.5, 2.0)]
    {
        let truth = ellipse(x, y, a, b, theta);
        let chains = linked(&discs(120, 120, &[truth]));
        let rings: Vec<_> = chains.all.iter().filter(|chain| chain.is_ring).collect();
        assert_eq!((rings.len(), chains.all.len()), (1, 1), "{truth:?}: {:?}", chains.all);
        let points = &chains.points[rings[0].range.clone()];
        assert!(points.len() as f64 > 0.6 * truth.perimeter_px());
        let (first, last) = (points[0], points[points.len() - 1]);
        assert!((first.x - last.x).hypot(first.y - last.y) < 3.0);
    }
}

#[test]
fn a_drawn_ring_is_two() {
    let chains = linked(&rings(120, 120, &[ellipse(60.0, 60.0, 40.0, 30.0, 0.3)], 5.0));
    assert_eq!(chains.all.iter().filter(|chain| chain.is_ring).count(), 2);
}

#[test]
fn a_step_is_one_open_chain() {
    let image = picture(90, 60, |x, y| if 3.0 * y > x + 40.0 { 200.0 } else { 50.0 });
    let chains = linked(&image);
    assert_eq!(chains.all.len(), 1, "{:?}", chains.all);
    assert!(!chains.all[0].is_ring);
}

#[test]
fn the_bright_side_stays_on_one_hand_and_no_point_is_in_two_chains() {
    let mut chains = Chains::default();
    for (seed, width, height) in [(1, 150, 90), (2, 64, 65), (3, 129, 20)] {
        let mut edges = EdgeMap::default();
        edges.find(&patches(width, height, seed).view());
        chains.link(&edges);
        assert!(!chains.all.is_empty());
        let mut end = 0;
        for chain in &chains.all {
            assert_eq!(chain.range.start, end, "chains follow each other");
            end = chain.range.end;
            assert!(chain.range.len() >= POINTS_MIN);
            assert!(on_one_hand(&chains.points[chain.range.clone()]));
        }
        assert_eq!(end, chains.points.len());
        let mut places: Vec<_> =
            chains.points.iter().map(|point| (point.x.to_bits(), point.y.to_bits())).collect();
        places.sort_unstable();
        places.dedup();
        assert_eq!(places.len(), chains.points.len());
    }
}
