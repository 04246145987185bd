//! The overlap of two ellipses: area of the intersection over area of the union, sampled.

use super::Ellipse;

/// Samples along the longer side of the joint bounding box.
const SAMPLES: f64 = 192.0;

impl Ellipse {
    /// Area of the intersection over area of the union of the two filled ellipses, in `0..=1`, sampled on a grid of
    /// 192 cells along the longer side of the joint bounding box. This is the usual score of a detection.
    pub fn overlap(&self, other: &Self) -> f64 {
        self.overlap_from(other, 0.0)
    }

    /// The [`overlap`](Self::overlap), and 0 at once where the areas alone show that it is below `least`, `0..=1`.
    pub fn overlap_from(&self, other: &Self, least: f64) -> f64 {
        let (here, there) =
            (self.semi_major_px * self.semi_minor_px, other.semi_major_px * other.semi_minor_px);
        let (smaller, larger) = (here.min(there), here.max(there));
        // Asked so that what is not a number overlaps nothing.
        if !(smaller > 0.0 && smaller >= least * larger) {
            return 0.0;
        }
        let ((w, h), (ow, oh)) = (self.half_extent_px(), other.half_extent_px());
        let Some(columns) = Axis::joint((self.center_x_px, w), (other.center_x_px, ow)) else {
            return 0.0;
        };
        let Some(rows) = Axis::joint((self.center_y_px, h), (other.center_y_px, oh)) else {
            return 0.0;
        };
        let step_px = columns.length_px().max(rows.length_px()) / SAMPLES;
        if !(step_px > 0.0 && step_px.is_finite()) {
            return 0.0;
        }
        let (first, second) = (Rows::new(self), Rows::new(other));
        let (columns, rows) = (columns.samples(step_px), rows.samples(step_px));
        let (mut both, mut either) = (0, 0);
        for row in 0..rows.count {
            let y_px = rows.at(row);
            let (a, b) = (first.inside(y_px, &columns), second.inside(y_px, &columns));
            let common = a.1.min(b.1).saturating_sub(a.0.max(b.0));
            both += common;
            either += (a.1 - a.0) + (b.1 - b.0) - common;
        }
        if either == 0 { 0.0 } else { both as f64 / either as f64 }
    }
}

/// One side of the joint bounding box.
#[derive(Clone, Copy)]
struct Axis {
    start_px: f64,
    end_px: f64,
}

impl Axis {
    /// The side around two intervals, each by centre and half length; `None` where they do not meet.
    fn joint(one: (f64, f64), other: (f64, f64)) -> Option<Self> {
        let (start, end) = (one.0 - one.1, one.0 + one.1);
        let (other_start, other_end) = (other.0 - other.1, other.0 + other.1);
        (end.min(other_end) > start.max(other_start))
            .then(|| Self { start_px: start.min(other_start), end_px: end.max(other_end) })
    }

    fn length_px(self) -> f64 {
        self.end_px - self.start_px
    }

    /// The centres of the cells along this side.
    fn samples(self, step_px: f64) -> Samples {
        let first_px = self.start_px + step_px / 2.0;
        let count = ((self.end_px - first_px) / step_px).ceil();
        // No more than a side's worth, but where the coordinates are so large that rounding moves them by whole steps.
        let count = count.clamp(0.0, SAMPLES + 1.0) as usize;
        Samples { first_px, step_px: (first_px + step_px) - first_px, count }
    }
}

/// Equally spaced coordinates.
struct Samples {
    first_px: f64,
    /// The step as the first two coordinates, once rounded, have it.
    step_px: f64,
    count: usize,
}

impl Samples {
    fn at(&self, index: usize) -> f64 {
        self.first_px + index as f64 * self.step_px
    }

    /// The index below a coordinate, within the range of indices.
    fn below(&self, x_px: f64) -> usize {
        ((x_px - self.first_px) / self.step_px).clamp(0.0, self.count as f64) as usize
    }
}

/// An ellipse prepared for rows of samples.
struct Rows<'a> {
    ellipse: &'a Ellipse,
    sin: f64,
    cos: f64,
    /// The factor of dx² in the quadratic form of the ellipse, which is 1 on the contour.
    across: f64,
    /// Shift of the middle of the chord for each pixel down.
    shear: f64,
    half_height_px: f64,
}

impl<'a> Rows<'a> {
    fn new(ellipse: &'a Ellipse) -> Self {
        let (sin, cos) = ellipse.theta_rad.sin_cos();
        let (major, minor) = (ellipse.semi_major_px.powi(2), ellipse.semi_minor_px.powi(2));
        let across = cos * cos / major + sin * sin / minor;
        Self {
            ellipse,
            sin,
            cos,
            across,
            shear: sin * cos * (1.0 / minor - 1.0 / major) / across,
            half_height_px: ellipse.half_extent_px().1,
        }
    }

    fn contains(&self, x_px: f64, y_px: f64) -> bool {
        let (dx, dy) = (x_px - self.ellipse.center_x_px, y_px - self.ellipse.center_y_px);
        let (u, v) = (dx * self.cos + dy * self.sin, dy * self.cos - dx * self.sin);
        (u / self.ellipse.semi_major_px).powi(2) + (v / self.ellipse.semi_minor_px).powi(2) <= 1.0
    }

    /// The samples of a row inside the ellipse: the first one and the one after the last. The chord gives them up to
    /// rounding; asking the ellipse itself about those at its ends makes them those of a sample by sample count.
    fn inside(&self, y_px: f64, columns: &Samples) -> (usize, usize) {
        let dy = y_px - self.ellipse.center_y_px;
        let share = 1.0 - (dy / self.half_height_px).powi(2);
        if share < -1e-9 {
            return (0, 0);
        }
        let middle = self.ellipse.center_x_px + dy * self.shear;
        let half = (share.max(0.0) / self.across).sqrt();
        let mut first = columns.below(middle - half);
        let mut end = (columns.below(middle + half) + 2).min(columns.count);
        while first < end && !self.contains(columns.at(first), y_px) {
            first += 1;
        }
        while first < end && !self.contains(columns.at(end - 1), y_px) {
            end -= 1;
        }
        (first, end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn ellipse(values: [f64; 5]) -> Ellipse {
        Ellipse {
            center_x_px: values[0],
            center_y_px: values[1],
            semi_major_px: values[2],
            semi_minor_px: values[3],
            theta_rad: values[4],
        }
    }

    #[test]
    fn overlaps_are_those_of_a_sample_by_sample_count() {
        // Counted by an independent program on the same grid.
        let expected = [
            ([100.0, 80.0, 40.0, 30.0, 0.3], [103.0, 78.0, 38.0, 31.0, 0.5], 0.866_966_499_936_951),
            (
                [235.5, 164.5, 60.0, 37.0, 0.253],
                [230.0, 160.0, 30.0, 62.0, 2.0],
                0.734_780_944_046_381_8,
            ),
            (
                [10.25, -3.5, 200.0, 5.0, 1.1],
                [12.0, -3.0, 190.0, 6.0, 1.09],
                0.687_716_262_975_778_6,
            ),
            ([0.0, 0.0, 1.0, 1.0, 0.0], [0.5, 0.0, 1.0, 1.0, 0.0], 0.521_211_126_610_322_4),
            ([500.0, 400.0, 20.0, 20.0, 0.0], [500.0, 400.0, 20.0, 20.0, 0.0], 1.0),
            ([50.0, 50.0, 40.0, 40.0, 0.0], [85.0, 50.0, 10.0, 9.0, 0.0], 0.043_947_155_567_538_42),
        ];
        for (here, there, overlap) in expected {
            let value = ellipse(here).canonical().overlap(&ellipse(there).canonical());
            assert!((value - overlap).abs() < 1e-15, "{here:?} {there:?} {value}");
        }
    }

    #[test]
    fn what_has_no_extent_or_is_no_number_overlaps_nothing() {
        let disc = [10.0, 10.0, 5.0, 5.0, 0.0];
        let strange = [0.0, -1.0, f64::NAN, f64::INFINITY, f64::MIN_POSITIVE, f64::MAX];
        for (field, value) in (0..5).flat_map(|field| strange.map(|value| (field, value))) {
            let mut values = disc;
            values[field] = value;
            let overlap = ellipse(values).overlap(&ellipse(disc));
            assert!((0.0..=1.0).contains(&overlap), "{values:?} {overlap}");
        }
        assert!(ellipse([10.0, 10.0, 0.0, 0.0, 0.0]).overlap(&ellipse(disc)) == 0.0);
    }

    proptest! {
        #[test]
        fn the_areas_alone_bound_the_overlap(
            x in -30.0..30.0_f64, major in 5.0..60.0_f64, ratio in 0.1..1.0_f64, theta in 0.0..3.0_f64,
        ) {
            let (one, other) =
                (ellipse([x, 3.0, major, major * ratio, theta]), ellipse([0.0, 0.0, 30.0, 20.0, 0.5]));
            let overlap = one.overlap(&other);
            // The grid is coarse, so a bound met within a hundredth may be missed.
            prop_assert!((one.overlap_from(&other, (overlap - 0.01).max(0.0)) - overlap).abs() < 1e-15);
            prop_assert!((overlap - other.overlap(&one)).abs() < 1e-15);
        }
    }
}
