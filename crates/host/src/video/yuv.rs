//! Brightness and two colour differences to red, green and blue: ITU-R BT.601, 8 bits.

use rsapien_vision::{GrayImage, ImageError, Picture};

/// Which values mean black and white.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Range {
    /// 16 and 235, as in television: what films have.
    Limited,
    /// 0 and 255, as in JPEG.
    Full,
}

/// Bits of fraction of the factors.
const FRACTION: u32 = 16;

/// What two colour differences add to the brightness, times 2^16.
#[derive(Debug, Clone, Copy)]
struct Shift {
    range: Range,
    red: i32,
    green: i32,
    blue: i32,
}

impl Shift {
    fn new(range: Range, u: u8, v: u8) -> Self {
        // Factors of BT.601 (1.402, 0.344136, 0.714136, 1.772), for the limited range times 255/224.
        let (red_v, green_u, green_v, blue_u) = match range {
            Range::Full => (91_881, 22_554, 46_802, 116_130),
            Range::Limited => (104_597, 25_675, 53_279, 132_201),
        };
        let (u, v) = (i32::from(u) - 128, i32::from(v) - 128);
        Self { range, red: red_v * v, green: -green_u * u - green_v * v, blue: blue_u * u }
    }

    fn rgb(self, y: u8) -> [u8; 3] {
        // 255/219 for the limited range.
        let bright = match self.range {
            Range::Full => i32::from(y) << FRACTION,
            Range::Limited => 76_309 * (i32::from(y) - 16),
        } + (1 << (FRACTION - 1));
        // Clipped to a byte, so that its first one is the value.
        let value = |sum: i32| (sum >> FRACTION).clamp(0, 255).to_le_bytes()[0];
        [value(bright + self.red), value(bright + self.green), value(bright + self.blue)]
    }
}

/// The colour differences of a picture, coarser than its brightness or as fine.
#[derive(Debug, Clone)]
pub struct ColorPlanes {
    /// Pixels across and down that share a colour.
    pub(super) shared: (usize, usize),
    pub(super) range: Range,
    /// Both planes, one after the other, rounded up to whole shares.
    pub(super) bytes: Vec<u8>,
}

impl ColorPlanes {
    /// The picture in colour.
    pub(super) fn to_picture(&self, gray: &GrayImage) -> Result<Picture, ImageError> {
        let (across, down) = self.shared;
        let (width, height) = (gray.width(), gray.height());
        let (coarse_width, coarse_height) = (width.div_ceil(across), height.div_ceil(down));
        let (u, v) = self.bytes.split_at_checked(coarse_width * coarse_height).unwrap_or_default();
        let mut pixels = vec![0; width * height * 3];
        // Each row of colours for as many rows of brightness as share it.
        let rows = pixels.chunks_mut(3 * width * down).zip(gray.pixels().chunks(width * down));
        let colors = u.chunks_exact(coarse_width).zip(v.chunks_exact(coarse_width));
        for ((pixels, bright), (u, v)) in rows.zip(colors) {
            for (pixels, bright) in
                pixels.chunks_exact_mut(3 * width).zip(bright.chunks_exact(width))
            {
                let shares = pixels.chunks_mut(3 * across).zip(bright.chunks(across));
                for ((pixels, bright), (&u, &v)) in shares.zip(u.iter().zip(v)) {
                    let shift = Shift::new(self.range, u, v);
                    for (pixel, &y) in pixels.as_chunks_mut().0.iter_mut().zip(bright) {
                        *pixel = shift.rgb(y);
                    }
                }
            }
        }
        Picture::new(pixels, width, height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_those_of_the_standard() {
        // White, black and the primaries of BT.601 in the limited range, each within rounding.
        for (yuv, expected) in [
            ([235, 128, 128], [255, 255, 255]),
            ([16, 128, 128], [0, 0, 0]),
            ([81, 90, 240], [255, 0, 0]),
            ([145, 54, 34], [0, 255, 0]),
            ([41, 240, 110], [0, 0, 255]),
        ] {
            let found = Shift::new(Range::Limited, yuv[1], yuv[2]).rgb(yuv[0]);
            let near = found.iter().zip(&expected).all(|(a, b): (&u8, &u8)| a.abs_diff(*b) <= 2);
            assert!(near, "{yuv:?} is {found:?}");
        }
        for value in [0, 77, 255] {
            assert_eq!(Shift::new(Range::Full, 128, 128).rgb(value), [value; 3]);
        }
    }
}
