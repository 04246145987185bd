//! Edge points with positions between pixels.
//!
//! The picture is smoothed by the binomial kernel (1 4 6 4 1) / 16 along rows and columns, a Gaussian of standard
//! deviation 1 px; central differences give the gradient. A pixel is an edge point where the gradient's magnitude is
//! above the threshold and not less than at the two neighbours along the axis (row or column) nearer to the gradient;
//! a parabola through the three magnitudes places the point between pixels. This is Canny's detector with Devernay's
//! correction, without hysteresis: R. Grompone von Gioi and G. Randall, "A Sub-Pixel Edge Detector: an
//! Implementation of the Canny/Devernay Algorithm", Image Processing On Line 7 (2017).
//!
//! Rows stream through a few buffers that stay in the cache; of the whole picture only the points are kept, and a bit
//! for each pixel that tells whether there is one.

mod bitmap;
mod noise;
mod rows;

pub(crate) use bitmap::PointMap;
use rows::Rows;

use crate::image::GrayView;

/// Magnitude that a step of one grey value has, in the units of [`Rows`]: 32 times the central difference over two
/// pixels of a unit step smoothed by the kernel.
const MAGNITUDE_PER_GREY: f32 = 32.0 * 10.0 / 16.0;
/// Least contrast of an edge, in grey values.
const CONTRAST_MIN_GREY: f32 = 8.0;
/// Standard deviation of a gradient component, in units of magnitude, for one grey value of white noise: the smoothed
/// noise has 35/128 of its standard deviation, and the central difference of its correlated values 1.095 of that.
const MAGNITUDE_PER_NOISE: f32 = 32.0 * 0.2734 * 1.095;
/// How many times the noise an edge has to be.
const NOISE_FACTOR: f32 = 3.0;

/// An edge point: position in pixels, and unit vector of the gradient from dark to bright.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct EdgePoint {
    pub(crate) x: f32,
    pub(crate) y: f32,
    pub(crate) gradient_x: f32,
    pub(crate) gradient_y: f32,
}

/// The edge points of a picture, row by row, and where they are.
#[derive(Debug, Clone, Default)]
pub(crate) struct EdgeMap {
    pub(crate) points: Vec<EdgePoint>,
    pub(crate) map: PointMap,
    rows: Rows,
    /// Threshold of the last whole picture.
    threshold: Option<f32>,
}

impl EdgeMap {
    /// Finds the edge points of `picture`, in place of those of the picture before.
    pub(crate) fn find(&mut self, picture: &GrayView<'_>) {
        let threshold = threshold(picture);
        self.threshold = Some(threshold);
        self.find_above(picture, threshold);
    }

    /// Finds the edge points of a part of `whole`, with the threshold of the last picture that was looked at as a whole.
    pub(crate) fn find_again(&mut self, part: &GrayView<'_>, whole: &GrayView<'_>) {
        let threshold = *self.threshold.get_or_insert_with(|| threshold(whole));
        self.find_above(part, threshold);
    }

    fn find_above(&mut self, picture: &GrayView<'_>, threshold: f32) {
        let (width, height) = (picture.width(), picture.height());
        self.points.clear();
        self.map.reset(width, height);
        // Smoothing and differences need neighbours; a smaller picture has no edge point.
        if width >= 3 && height >= 3 {
            self.rows.reset(width);
            // Compiled for several instruction sets; the one of this machine is taken. Nothing is rounded otherwise.
            pulp::Arch::new().dispatch(Streamed { edges: self, picture, threshold });
        }
        self.map.seal();
    }

    /// Streams the rows through.
    #[inline(always)]
    fn stream(&mut self, picture: &GrayView<'_>, threshold: f32) {
        let height = picture.height();
        // Smoothed rows 0 and 1 come before the first gradient, gradients 0 to 2 before the first maximum.
        for y in 0..height + 2 {
            if y < height {
                self.rows.smooth(picture, y);
            }
            if (1..=height).contains(&y) {
                self.rows.differentiate(y - 1, height);
            }
            if y >= 3 && y - 1 < height {
                self.rows.mark_maxima(y - 2, threshold, self.map.row_mut(y - 2));
                self.emit(y - 2);
            }
        }
    }

    /// Appends the points of row `y`.
    #[inline(always)]
    fn emit(&mut self, y: usize) {
        let Self { points, map, rows, .. } = self;
        for (word_at, &word) in map.row(y).iter().enumerate() {
            let mut bits = word;
            while bits != 0 {
                let x = word_at * 64 + bits.trailing_zeros() as usize;
                bits &= bits - 1;
                points.push(rows.point(x, y));
            }
        }
    }
}

/// Least magnitude of an edge point in `picture`.
fn threshold(picture: &GrayView<'_>) -> f32 {
    (CONTRAST_MIN_GREY * MAGNITUDE_PER_GREY)
        .max(NOISE_FACTOR * MAGNITUDE_PER_NOISE * noise::estimate(picture))
}

/// The streaming, to be compiled for an instruction set.
struct Streamed<'a, 'b> {
    edges: &'a mut EdgeMap,
    picture: &'a GrayView<'b>,
    threshold: f32,
}

impl pulp::WithSimd for Streamed<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _instructions: S) {
        self.edges.stream(self.picture, self.threshold);
    }
}

#[cfg(test)]
mod tests;
