//! The filters of false ellipses (paper, section 3.1 and Table 3).
//!
//! - Quality: "the threshold of a high pass filter", on the number of points on the contour.
//! - Both sides: "points distributed on both sides of the major axis".
//! - Proportion: "the number of points is proportional on either side". The paper gives no number; here the poorer side
//!   must have at least `side_proportion_min` times the points of the richer one.

use crate::hough::Candidate;
use crate::options::FilterOptions;

/// Whether a candidate passes all three filters.
pub fn passes(candidate: &Candidate, options: &FilterOptions) -> bool {
    let [one, other] = candidate.votes_by_side;
    let (poorer, richer) = (one.min(other), one.max(other));
    candidate.quality() >= options.quality_min
        && poorer > 0
        && f64::from(poorer) >= options.side_proportion_min * f64::from(richer)
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
        let passes = |one, other, options: &FilterOptions| {
            super::passes(&Candidate { ellipse, votes_by_side: [one, other] }, options)
        };
        assert!(passes(50, 50, &options));
        assert!(!passes(50, 49, &options), "quality");
        assert!(passes(40, 80, &options));
        assert!(!passes(39, 80, &options) && !passes(80, 39, &options), "proportion");
        let any_proportion = FilterOptions { side_proportion_min: 0.0, ..options };
        assert!(passes(1, 150, &any_proportion));
        assert!(!passes(0, 150, &any_proportion), "both sides");
    }
}
