//! Brightness and two colour differences to red, green and blue: ITU-R BT.601, 8 bits.

use rsapien_vision::{ImageError, Picture};

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

/// The colour of one pixel.
#[inline]
pub(super) fn rgb(range: Range, y: u8, u: u8, v: u8) -> [u8; 3] {
    // Factors of BT.601 (1.402, 0.344136, 0.714136, 1.772), for the limited range times 255/219 and 255/224.
    let (y, gain, red_v, green_u, green_v, blue_u) = match range {
        Range::Full => (i32::from(y), 65_536, 91_881, 22_554, 46_802, 116_130),
        Range::Limited => (i32::from(y) - 16, 76_309, 104_597, 25_675, 53_279, 132_201),
    };
    let (u, v) = (i32::from(u) - 128, i32::from(v) - 128);
    let bright = gain * y + (1 << (FRACTION - 1));
    let value = |sum: i32| u8::try_from((sum >> FRACTION).clamp(0, 255)).unwrap_or(0);
    [
        value(bright + red_v * v),
        value(bright - green_u * u - green_v * v),
        value(bright + blue_u * u),
    ]
}

/// Three planes, one after the other, and how much coarser those of colour are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Planes<'a> {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Pixels across and down that share a colour.
    pub(super) shared: (usize, usize),
    pub(super) range: Range,
    /// Brightness, then the colour planes, rounded up to whole shares.
    pub(super) bytes: &'a [u8],
}

impl Planes<'_> {
    /// The picture in colour.
    pub(super) fn to_picture(self) -> Result<Picture, ImageError> {
        let Self { width, height, shared: (across, down), range, bytes } = self;
        let (coarse_width, coarse_height) = (width.div_ceil(across), height.div_ceil(down));
        let short = || ImageError::DataTooShort {
            given: bytes.len(),
            height,
            stride: width,
            needed: width * height + 2 * coarse_width * coarse_height,
        };
        let (bright, colors) = bytes.split_at_checked(width * height).ok_or_else(short)?;
        let (u, v) = colors.split_at_checked(coarse_width * coarse_height).ok_or_else(short)?;
        let v = v.get(..coarse_width * coarse_height).ok_or_else(short)?;
        let mut pixels = Vec::with_capacity(width * height * 3);
        for (y, row) in bright.chunks_exact(width).enumerate() {
            let start = (y / down) * coarse_width;
            let (u, v) = (&u[start..start + coarse_width], &v[start..start + coarse_width]);
            for (x, &value) in row.iter().enumerate() {
                pixels.extend(rgb(range, value, u[x / across], v[x / across]));
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
            let found = rgb(Range::Limited, yuv[0], yuv[1], yuv[2]);
            let near = found.iter().zip(&expected).all(|(a, b): (&u8, &u8)| a.abs_diff(*b) <= 2);
            assert!(near, "{yuv:?} is {found:?}");
        }
        for value in [0, 77, 255] {
            assert_eq!(rgb(Range::Full, value, 128, 128), [value; 3]);
        }
    }
}
