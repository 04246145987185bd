//! The filters of false ellipses (paper, section 3.1 and Table 3).
//!
//! - Quality: "the threshold of a high pass filter", on the number of points on the contour.
//! - Both sides: "points distributed on both sides of the major axis".
//! - Proportion: "the number of points is proportional on either side". The paper gives no number; here the poorer side
//!   must have at least `side_proportion_min` times the points of the richer one.

use crate::paper::hough::Candidate;
use crate::paper::options::FilterOptions;

/// Whether a candidate passes all the filters.
pub fn passes(candidate: &Candidate, options: &FilterOptions) -> bool {
    candidate.quality() >= options.quality_min
        && candidate.votes_by_major_side().iter().all(|&votes| votes > 0)
        && in_proportion(candidate.votes_by_major_side(), options.side_proportion_min)
        && in_proportion(candidate.votes_by_minor_side(), options.side_proportion_min)
}

/// Whether the poorer of two sides has at least `least` times the points of the richer one.
fn in_proportion([one, other]: [u32; 2], least: f64) -> bool {
    f64::from(one.min(other)) >= least * f64::from(one.max(other))
}

/// The candidates that pass, in their order: the paper's "virtual ellipses".
pub fn filter(candidates: &[Candidate], options: &FilterOptions) -> Vec<Candidate> {
    candidates.iter().filter(|candidate| passes(candidate, options)).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ellipse::Ellipse;

    #[test]
    fn each_filter_refuses_alone() {
        let ellipse = Ellipse {
            center_x_px: 0.0,
            center_y_px: 0.0,
            semi_major_px: 9.0,
            semi_minor_px: 5.0,
            theta_rad: 0.0,
        };
        let options = FilterOptions { quality_min: 100, side_proportion_min: 0.5 };
        let passes = |votes_by_quadrant, options: &FilterOptions| {
            super::passes(&Candidate { ellipse, votes_by_quadrant }, options)
        };
        assert!(passes([25, 25, 25, 25], &options));
        assert!(!passes([25, 25, 25, 24], &options), "quality");
        assert!(passes([40, 40, 20, 20], &options) && passes([40, 20, 40, 20], &options));
        assert!(!passes([40, 41, 20, 20], &options), "proportion across the major axis");
        assert!(!passes([40, 20, 41, 20], &options), "proportion across the minor axis");
        let any_proportion = FilterOptions { side_proportion_min: 0.0, ..options };
        assert!(passes([99, 0, 1, 0], &any_proportion));
        assert!(!passes([80, 80, 0, 0], &any_proportion), "both sides of the major axis");
    }

    #[test]
    fn the_least_votes_of_a_side_are_what_the_filters_ask_for() {
        // Quality 380 in proportion 0.5: 127 against 253 is the poorest that passes.
        let options = FilterOptions { quality_min: 380, side_proportion_min: 0.5 };
        assert_eq!(options.side_votes_min(), 126);
        assert!(in_proportion([127, 253], 0.5) && !in_proportion([126, 254], 0.5));
    }
}
