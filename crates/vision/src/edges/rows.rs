//! The rows on the way from pixels to edge points.

use super::EdgePoint;
use crate::image::GrayView;

/// Rows of each kind that are kept: the row at hand and its neighbours, and one for the mask.
const KEPT: usize = 4;

/// One row of gradients with a margin of one value on either side.
#[derive(Debug, Clone, Default)]
struct GradientRow {
    x: Vec<f32>,
    y: Vec<f32>,
    magnitude: Vec<f32>,
}

/// Buffers of a few rows.
#[derive(Debug, Clone, Default)]
pub(super) struct Rows {
    /// Sums of five rows, with two values on either side.
    vertical: Vec<u16>,
    /// Smoothed rows: grey values times 32, with one value on either side.
    smoothed: [Vec<i16>; KEPT],
    gradients: [GradientRow; KEPT],
    mask: Vec<u8>,
    width: usize,
}

impl Rows {
    /// Room for rows of `width` pixels.
    pub(super) fn reset(&mut self, width: usize) {
        self.width = width;
        self.vertical.resize(width + 4, 0);
        for row in &mut self.smoothed {
            row.resize(width + 2, 0);
        }
        for row in &mut self.gradients {
            for values in [&mut row.x, &mut row.y, &mut row.magnitude] {
                values.resize(width + 2, 0.0);
                // The margin is never a maximum.
                values[0] = 0.0;
                values[width + 1] = 0.0;
            }
        }
        self.mask.resize(width.next_multiple_of(64), 0);
        self.mask.fill(0);
    }

    /// Smooths row `y` of the picture; outside the picture its border goes on.
    #[inline(always)]
    pub(super) fn smooth(&mut self, picture: &GrayView<'_>, y: usize) {
        let (width, last) = (self.width, picture.height() - 1);
        // Slices of one length, so that the loops need no checks and become vector code.
        let row = |y: usize| &picture.row(y.min(last))[..width];
        let (a, b, c) = (row(y.saturating_sub(2)), row(y.saturating_sub(1)), row(y));
        let (d, e) = (row(y + 1), row(y + 2));
        add_rows([a, b, c, d, e], &mut self.vertical[2..][..width]);
        let (first, end) = (self.vertical[2], self.vertical[width + 1]);
        self.vertical[..2].fill(first);
        self.vertical[width + 2..].fill(end);
        let sums = |shift: usize| &self.vertical[shift..][..width];
        let out = &mut self.smoothed[y % KEPT];
        add_columns([sums(0), sums(1), sums(2), sums(3), sums(4)], &mut out[1..][..width]);
        out[0] = out[1];
        out[width + 1] = out[width];
    }

    /// Gradients of row `y` from the smoothed rows around it.
    #[inline(always)]
    pub(super) fn differentiate(&mut self, y: usize, height: usize) {
        let width = self.width;
        let above = &self.smoothed[y.saturating_sub(1) % KEPT][1..][..width];
        let here = &self.smoothed[y % KEPT];
        let (left, right) = (&here[..width], &here[2..][..width]);
        let below = &self.smoothed[(y + 1).min(height - 1) % KEPT][1..][..width];
        let out = &mut self.gradients[y % KEPT];
        differences(
            [left, right, above, below],
            &mut out.x[1..][..width],
            &mut out.y[1..][..width],
            &mut out.magnitude[1..][..width],
        );
    }

    /// Sets the bit of every pixel of row `y` that is a maximum along the gradient's main axis and above `threshold`.
    #[inline(always)]
    pub(super) fn mark_maxima(&mut self, y: usize, threshold: f32, bits: &mut [u64]) {
        let width = self.width;
        let above = &self.gradients[(y - 1) % KEPT].magnitude[1..][..width];
        let row = &self.gradients[y % KEPT];
        let below = &self.gradients[(y + 1) % KEPT].magnitude[1..][..width];
        let (left, here, right) =
            (&row.magnitude[..width], &row.magnitude[1..][..width], &row.magnitude[2..][..width]);
        let (along, down) = (&row.x[1..][..width], &row.y[1..][..width]);
        let mask = &mut self.mask[..width];
        maxima([left, here, right, above, below], [along, down], threshold, mask);
        // The frame has no gradient of its own: outside it the border goes on.
        mask[0] = 0;
        mask[width - 1] = 0;
        for (word, bytes) in bits.iter_mut().zip(self.mask.chunks_exact(64)) {
            *word = pack(bytes);
        }
    }

    /// The edge point at a marked pixel.
    #[inline(always)]
    pub(super) fn point(&self, x: usize, y: usize) -> EdgePoint {
        let row = &self.gradients[y % KEPT];
        let (along, down, middle) = (row.x[x + 1], row.y[x + 1], row.magnitude[x + 1]);
        let is_across = along.abs() >= down.abs();
        let (before, behind) = if is_across {
            (row.magnitude[x], row.magnitude[x + 2])
        } else {
            let at = |y: usize| self.gradients[y % KEPT].magnitude[x + 1];
            (at(y - 1), at(y + 1))
        };
        // The vertex of the parabola through the three; the middle one is greater than the first.
        let offset = 0.5 * (before - behind) / (before - 2.0 * middle + behind);
        let (x, y) = (x as f32, y as f32);
        EdgePoint {
            x: if is_across { x + offset } else { x },
            y: if is_across { y } else { y + offset },
            gradient_x: along / middle,
            gradient_y: down / middle,
        }
    }
}

/// The weighted sum of five rows of pixels.
#[inline(always)]
fn add_rows([a, b, c, d, e]: [&[u8]; 5], sums: &mut [u16]) {
    for (((((sum, a), b), c), d), e) in sums.iter_mut().zip(a).zip(b).zip(c).zip(d).zip(e) {
        let outer = u16::from(*a) + u16::from(*e);
        let inner = u16::from(*b) + u16::from(*d);
        *sum = outer + 4 * inner + 6 * u16::from(*c);
    }
}

/// The weighted sum of five neighbours in a row of such sums, at most 256 * 255, over 8.
#[inline(always)]
fn add_columns([a, b, c, d, e]: [&[u16]; 5], smoothed: &mut [i16]) {
    for (((((out, a), b), c), d), e) in smoothed.iter_mut().zip(a).zip(b).zip(c).zip(d).zip(e) {
        *out = ((a + e + 4 * (b + d) + 6 * c) >> 3) as i16;
    }
}

/// Central differences and their length, from the values to the left, to the right, above and below.
#[inline(always)]
fn differences(
    [left, right, above, below]: [&[i16]; 4],
    along: &mut [f32],
    down: &mut [f32],
    magnitude: &mut [f32],
) {
    let inputs = left.iter().zip(right).zip(above).zip(below);
    let outputs = along.iter_mut().zip(down).zip(magnitude);
    for ((((left, right), above), below), ((along, down), magnitude)) in inputs.zip(outputs) {
        let (x, y) = (f32::from(right - left), f32::from(below - above));
        (*along, *down) = (x, y);
        *magnitude = (x * x + y * y).sqrt();
    }
}

/// 1 where a magnitude is above `threshold` and a maximum along the main axis of its gradient, else 0.
#[inline(always)]
#[expect(clippy::needless_bitwise_bool, reason = "without branches the loop becomes vector code")]
fn maxima(
    [left, here, right, above, below]: [&[f32]; 5],
    [along, down]: [&[f32]; 2],
    threshold: f32,
    mask: &mut [u8],
) {
    let neighbours = left.iter().zip(right).zip(above).zip(below);
    let values = here.iter().zip(along).zip(down);
    for ((mask, (((left, right), above), below)), ((here, along), down)) in
        mask.iter_mut().zip(neighbours).zip(values)
    {
        let across = (here > left) & (here >= right) & (along.abs() >= down.abs());
        let upright = (here > above) & (here >= below) & (along.abs() < down.abs());
        *mask = u8::from((*here > threshold) & (across | upright));
    }
}

/// Bytes of 0 and 1 to bits, the first byte to the lowest bit.
#[inline(always)]
fn pack(bytes: &[u8]) -> u64 {
    let mut word = 0;
    for (at, group) in bytes.chunks_exact(8).enumerate() {
        let group = u64::from_le_bytes([
            group[0], group[1], group[2], group[3], group[4], group[5], group[6], group[7],
        ]);
        // The product gathers the lowest bit of every byte in the top byte.
        let bits = group.wrapping_mul(0x0102_0408_1020_4080) >> 56;
        word |= bits << (8 * at);
    }
    word
}
