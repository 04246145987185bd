//! Single-pass clustering of the virtual ellipses (paper, section 3.1, formulas 9 and 10).
//!
//! Each ellipse joins the cluster whose centroid is nearest, when that is no farther than `D_T`; otherwise it founds a
//! cluster. The distance is Euclidean in (x0, y0, a, b, α), pixels and radians as they are, as in the paper. The member nearest
//! to the final centroid stands for the cluster.
//!
//! Where the paper is silent:
//! - α is the angle proper, and its difference is taken modulo π: axes at 3.13 and 0.01 radians are neighbours.
//! - Ellipses are taken in the order of falling quality (equals in the order of drawing), so that the best ones found the clusters.
//! - Of several clusters within `D_T` the nearest is joined; of equally near members the one of higher quality is taken.

use crate::ellipse::axis_difference_rad;
use crate::paper::hough::Candidate;
use crate::paper::options::{AngleMeasure, ClusterOptions};

/// Ellipses that are one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cluster {
    /// The member nearest to the centroid.
    pub representative: Candidate,
    /// Mean of the members in (x0, y0, a, b, α).
    pub centroid: [f64; 5],
    /// Number of members.
    pub members: usize,
}

/// The feature vector (9).
pub fn feature_vector(candidate: &Candidate) -> [f64; 5] {
    let ellipse = candidate.ellipse;
    [
        ellipse.center_x_px,
        ellipse.center_y_px,
        ellipse.semi_major_px,
        ellipse.semi_minor_px,
        ellipse.theta_rad,
    ]
}

/// `to - from` by component, the angle modulo π.
fn difference(from: &[f64; 5], to: &[f64; 5]) -> [f64; 5] {
    let mut difference: [f64; 5] = std::array::from_fn(|i| to[i] - from[i]);
    difference[4] = axis_difference_rad(from[4], to[4]);
    difference
}

/// The distance (10) between two feature vectors.
pub fn distance(one: &[f64; 5], other: &[f64; 5], angle: AngleMeasure) -> f64 {
    let mut difference = difference(one, other);
    if angle == AngleMeasure::ContourShift {
        difference[4] *= one[2] - one[3];
    }
    difference.iter().map(|d| d * d).sum::<f64>().sqrt()
}

/// Clusters `candidates`; the clusters come in the order of falling quality of their founders.
pub fn cluster(candidates: &[Candidate], options: &ClusterOptions) -> Vec<Cluster> {
    let mut order: Vec<&Candidate> = candidates.iter().collect();
    order.sort_by_key(|candidate| std::cmp::Reverse(candidate.quality()));
    let mut groups: Vec<([f64; 5], Vec<&Candidate>)> = Vec::new();
    for candidate in order {
        let features = feature_vector(candidate);
        let nearest = groups
            .iter_mut()
            .map(|group| (distance(&group.0, &features, options.angle), group))
            .min_by(|one, other| one.0.total_cmp(&other.0));
        match nearest {
            Some((near, (centroid, members))) if near <= options.distance_max => {
                members.push(candidate);
                let step = difference(centroid, &features);
                for (value, step) in centroid.iter_mut().zip(step) {
                    *value += step / members.len() as f64;
                }
            }
            _ => groups.push((features, vec![candidate])),
        }
    }
    groups
        .iter()
        .filter(|(_, members)| members.len() >= options.members_min as usize)
        .filter_map(|(centroid, members)| {
            let near = |candidate: &Candidate| {
                distance(centroid, &feature_vector(candidate), options.angle)
            };
            let representative =
                members.iter().min_by(|one, other| near(one).total_cmp(&near(other)))?;
            Some(Cluster {
                representative: **representative,
                centroid: *centroid,
                members: members.len(),
            })
        })
        .collect()
}

#[cfg(test)]
mod tests;
