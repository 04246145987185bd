use super::*;
use crate::ellipse::Ellipse;

fn candidate(x: f64, b: f64, theta_rad: f64, quality: u32) -> Candidate {
    let ellipse = Ellipse {
        center_x_px: x,
        center_y_px: 50.0,
        semi_major_px: 60.0,
        semi_minor_px: b,
        theta_rad,
    };
    Candidate { ellipse, votes_by_quadrant: [quality, 0, 0, 0] }
}

const OPTIONS: ClusterOptions =
    ClusterOptions { distance_max: 20.0, angle: AngleMeasure::Radians, members_min: 1 };

#[test]
fn distance_is_euclidean_in_five_dimensions() {
    let distance = |to: [f64; 5], angle| super::distance(&[0.0, 0.0, 60.0, 40.0, 0.0], &to, angle);
    let apart = distance([2.0, 4.0, 65.0, 46.0, 0.0], AngleMeasure::Radians);
    assert!((apart - 9.0).abs() < 1e-12, "4 + 16 + 25 + 36 = 81, {apart}");
    let turned = [0.0, 0.0, 60.0, 40.0, 0.3];
    assert!((distance(turned, AngleMeasure::Radians) - 0.3).abs() < 1e-12);
    assert!((distance(turned, AngleMeasure::ContourShift) - 6.0).abs() < 1e-12, "(60 - 40) 0.3");
}

#[test]
fn the_member_nearest_to_the_centroid_stands_for_its_cluster() {
    // x: 10, 12 and 20 have their mean at 14; the far one is alone.
    let candidates = [
        candidate(10.0, 40.0, 0.0, 9),
        candidate(12.0, 40.0, 0.0, 8),
        candidate(20.0, 40.0, 0.0, 7),
        candidate(90.0, 40.0, 0.0, 6),
    ];
    let clusters = cluster(&candidates, &OPTIONS);
    assert_eq!(clusters.len(), 2);
    assert_eq!((clusters[0].representative, clusters[0].members), (candidates[1], 3));
    assert!((clusters[0].centroid[0] - 14.0).abs() < 1e-12);
    assert_eq!(clusters[1].representative, candidates[3]);
    let pairs_only = cluster(&candidates, &ClusterOptions { members_min: 2, ..OPTIONS });
    assert_eq!(pairs_only, clusters[..1]);
}

#[test]
fn the_threshold_itself_still_belongs_to_the_cluster() {
    assert_eq!(
        cluster(&[candidate(0.0, 40.0, 0.0, 2), candidate(20.0, 40.0, 0.0, 1)], &OPTIONS).len(),
        1
    );
    assert_eq!(
        cluster(&[candidate(0.0, 40.0, 0.0, 2), candidate(20.1, 40.0, 0.0, 1)], &OPTIONS).len(),
        2
    );
}

#[test]
fn axes_on_either_side_of_the_half_turn_are_neighbours() {
    let options =
        ClusterOptions { angle: AngleMeasure::ContourShift, distance_max: 5.0, ..OPTIONS };
    let clusters =
        cluster(&[candidate(0.0, 20.0, 3.12, 2), candidate(0.0, 20.0, 0.02, 1)], &options);
    assert_eq!(clusters.len(), 1);
    // The mean of 3.12 and 0.02 + π.
    assert!((clusters[0].centroid[4] - 3.140_796).abs() < 1e-5, "{}", clusters[0].centroid[4]);
}

#[test]
fn no_candidates_give_no_clusters() {
    assert_eq!(cluster(&[], &OPTIONS), []);
}
