//! Pictures in memory: a borrowed grey view, an owned grey image and a borrowed colour view.
//!
//! Rows run from top to bottom; `stride` is the number of bytes from the start of one row to the start of the next.
//! Every constructor checks its arguments, so the stages behind it cannot meet a picture that lies about its size.

use thiserror::Error;

use crate::options::Region;

/// Largest width and height that a picture may have, in pixels.
pub const SIDE_PX_MAX: usize = 16_384;
/// Largest number of pixels that a picture may have.
pub const AREA_PX_MAX: usize = SIDE_PX_MAX * SIDE_PX_MAX;

/// Why a picture was refused.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ImageError {
    /// A picture needs at least one pixel.
    #[error("picture is empty: width is {width} and height is {height}, both must be at least 1")]
    Empty {
        /// Width in pixels.
        width: usize,
        /// Height in pixels.
        height: usize,
    },
    /// The limits bound the memory and the time that a detection takes.
    #[error(
        "picture is too large: {width} x {height} pixels, the limit is {SIDE_PX_MAX} on a side; scale it down first"
    )]
    TooLarge {
        /// Width in pixels.
        width: usize,
        /// Height in pixels.
        height: usize,
    },
    /// Rows would overlap.
    #[error("stride is {stride} bytes, but a row of {width} pixels needs at least {needed}")]
    StrideTooShort {
        /// Bytes from row to row, as given.
        stride: usize,
        /// Width in pixels.
        width: usize,
        /// Bytes in one row.
        needed: usize,
    },
    /// The last row would end behind the data.
    #[error("data holds {given} bytes, but {height} rows of stride {stride} need {needed}")]
    DataTooShort {
        /// Bytes given.
        given: usize,
        /// Height in pixels.
        height: usize,
        /// Bytes from row to row.
        stride: usize,
        /// Bytes needed.
        needed: usize,
    },
}

/// Checks the size alone: what a decoder may ask before it allocates.
///
/// # Errors
/// [`ImageError::Empty`] or [`ImageError::TooLarge`].
pub fn check_size(width: usize, height: usize) -> Result<(), ImageError> {
    if width == 0 || height == 0 {
        return Err(ImageError::Empty { width, height });
    }
    if width > SIDE_PX_MAX || height > SIDE_PX_MAX {
        return Err(ImageError::TooLarge { width, height });
    }
    Ok(())
}

fn check_layout(
    len: usize,
    width: usize,
    height: usize,
    stride: usize,
    bytes_per_pixel: usize,
) -> Result<(), ImageError> {
    check_size(width, height)?;
    let row = width * bytes_per_pixel;
    if stride < row {
        return Err(ImageError::StrideTooShort { stride, width, needed: row });
    }
    // The last row need not be padded. A stride that overflows is longer than any data.
    let needed = stride
        .checked_mul(height - 1)
        .and_then(|bytes| bytes.checked_add(row))
        .unwrap_or(usize::MAX);
    if len < needed {
        return Err(ImageError::DataTooShort { given: len, height, stride, needed });
    }
    Ok(())
}

/// A borrowed 8-bit grey picture.
#[derive(Debug, Clone, Copy)]
pub struct GrayView<'a> {
    data: &'a [u8],
    width: usize,
    height: usize,
    stride: usize,
}

impl<'a> GrayView<'a> {
    /// A view of `height` rows of `width` bytes, `stride` bytes apart; bytes between rows are not read.
    ///
    /// # Errors
    /// [`ImageError`] when the picture is empty or too large, or when the data cannot hold it.
    pub fn new(
        data: &'a [u8],
        width: usize,
        height: usize,
        stride: usize,
    ) -> Result<Self, ImageError> {
        check_layout(data.len(), width, height, stride, 1)?;
        Ok(Self { data, width, height, stride })
    }

    /// Width in pixels, at least 1.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels, at least 1.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The rows from top to bottom, each `width` bytes long.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &'a [u8]> + '_ {
        (0..self.height).map(|y| self.row(y))
    }

    /// Row `y`; `y` must be below the height.
    pub(crate) fn row(&self, y: usize) -> &'a [u8] {
        let start = y * self.stride;
        &self.data[start..start + self.width]
    }

    /// A part of the picture, where it stands; `None` when it has no pixel or reaches beyond the border.
    pub(crate) fn part(&self, region: Region) -> Option<Self> {
        let Region { left, top, width, height } = region;
        if width == 0 || height == 0 || left + width > self.width || top + height > self.height {
            return None;
        }
        let data = &self.data[top * self.stride + left..];
        Some(Self { data, width, height, stride: self.stride })
    }

    /// A copy without padding.
    pub fn to_image(&self) -> GrayImage {
        GrayImage {
            data: self.rows().flatten().copied().collect(),
            width: self.width,
            height: self.height,
        }
    }
}

/// An owned 8-bit grey picture without padding between rows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GrayImage {
    data: Vec<u8>,
    width: usize,
    height: usize,
}

impl GrayImage {
    /// Takes `width * height` bytes, row by row; longer data is cut.
    ///
    /// # Errors
    /// [`ImageError`] when the picture is empty or too large, or when the data cannot hold it.
    pub fn new(mut data: Vec<u8>, width: usize, height: usize) -> Result<Self, ImageError> {
        check_layout(data.len(), width, height, width, 1)?;
        data.truncate(width * height);
        Ok(Self { data, width, height })
    }

    /// The 8-bit picture of `height` rows of `width` 16-bit pixels, `stride` pixels apart: 0 stays 0, 65535 becomes 255,
    /// and what is between is divided by 257 and rounded. Contrast below 1/257 of the range is lost; stretch a picture
    /// that uses little of it first.
    ///
    /// # Errors
    /// [`ImageError`] when the picture is empty or too large, or when the data cannot hold it; counts are in pixels of
    /// two bytes.
    pub fn from_gray16(
        data: &[u16],
        width: usize,
        height: usize,
        stride: usize,
    ) -> Result<Self, ImageError> {
        check_layout(data.len(), width, height, stride, 1)?;
        // At most 255, since 65535 + 128 is below 256 * 257.
        let byte = |value: &u16| ((u32::from(*value) + 128) / 257) as u8;
        let rows = data.chunks(stride).take(height);
        let data = rows.flat_map(|row| row.iter().take(width).map(byte)).collect();
        Ok(Self { data, width, height })
    }

    /// A picture of one grey value and of the size of `like`.
    pub(crate) fn filled_like(like: &GrayView<'_>, value: u8) -> Self {
        Self { data: vec![value; like.width * like.height], width: like.width, height: like.height }
    }

    /// The borrowed view that every stage takes.
    pub fn view(&self) -> GrayView<'_> {
        GrayView { data: &self.data, width: self.width, height: self.height, stride: self.width }
    }

    /// Width in pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The pixels row by row.
    pub fn pixels(&self) -> &[u8] {
        &self.data
    }

    /// The pixels row by row, to be written.
    pub fn pixels_mut(&mut self) -> &mut [u8] {
        &mut self.data
    }

    pub(crate) fn row_mut(&mut self, y: usize) -> &mut [u8] {
        let start = y * self.width;
        &mut self.data[start..start + self.width]
    }
}

/// How the bytes of a colour pixel follow each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PixelLayout {
    /// Red, green, blue.
    Rgb,
    /// Blue, green, red.
    Bgr,
    /// Red, green, blue, and an opacity that is not looked at.
    Rgba,
}

impl PixelLayout {
    /// Bytes a pixel: 3 or 4.
    pub fn bytes_per_pixel(self) -> usize {
        match self {
            Self::Rgb | Self::Bgr => 3,
            Self::Rgba => 4,
        }
    }
}

/// A borrowed 8-bit colour picture.
#[derive(Debug, Clone, Copy)]
pub struct ColorView<'a> {
    data: &'a [u8],
    width: usize,
    height: usize,
    stride: usize,
    layout: PixelLayout,
}

impl<'a> ColorView<'a> {
    /// A view of `height` rows of `width` pixels, `stride` bytes apart.
    ///
    /// # Errors
    /// [`ImageError`] when the picture is empty or too large, or when the data cannot hold it.
    pub fn new(
        data: &'a [u8],
        width: usize,
        height: usize,
        stride: usize,
        layout: PixelLayout,
    ) -> Result<Self, ImageError> {
        check_layout(data.len(), width, height, stride, layout.bytes_per_pixel())?;
        Ok(Self { data, width, height, stride, layout })
    }

    /// RGB data without padding that is known to fit.
    #[cfg(feature = "image")]
    pub(crate) fn from_checked_rgb(data: &'a [u8], width: usize, height: usize) -> Self {
        Self { data, width, height, stride: 3 * width, layout: PixelLayout::Rgb }
    }

    /// The grey picture: the paper's "greyscale transform", luma after ITU-R BT.601 in integers.
    ///
    /// `(19595 R + 38470 G + 7471 B + 32768) >> 16`: the weights 0.299, 0.587 and 0.114 scaled to a sum of 65536, so
    /// that a grey pixel keeps its value.
    pub fn to_gray(&self) -> GrayImage {
        let size = self.layout.bytes_per_pixel();
        let mut data = Vec::with_capacity(self.width * self.height);
        for y in 0..self.height {
            let start = y * self.stride;
            let row = &self.data[start..start + self.width * size];
            data.extend(row.chunks_exact(size).map(|pixel| {
                let (first, green, third) = (pixel[0], pixel[1], pixel[2]);
                if self.layout == PixelLayout::Bgr {
                    luma(third, green, first)
                } else {
                    luma(first, green, third)
                }
            }));
        }
        GrayImage { data, width: self.width, height: self.height }
    }
}

/// Luma after BT.601 in 16 bits of fraction.
fn luma(red: u8, green: u8, blue: u8) -> u8 {
    let sum = 19_595 * u32::from(red) + 38_470 * u32::from(green) + 7_471 * u32::from(blue);
    // At most 255 * 65536 + 32768, so the shift leaves a byte.
    ((sum + 32_768) >> 16) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refusals_name_what_is_wrong() {
        assert_eq!(
            GrayView::new(&[], 0, 4, 0).unwrap_err(),
            ImageError::Empty { width: 0, height: 4 }
        );
        assert_eq!(
            GrayView::new(&[0; 8], 4, 2, 3).unwrap_err(),
            ImageError::StrideTooShort { stride: 3, width: 4, needed: 4 }
        );
        assert_eq!(
            GrayView::new(&[0; 8], 4, 2, 5).unwrap_err(),
            ImageError::DataTooShort { given: 8, height: 2, stride: 5, needed: 9 }
        );
        assert!(GrayView::new(&[0; 8], 4, 2, usize::MAX).is_err());
        for (width, height) in [(SIDE_PX_MAX + 1, 1), (1, usize::MAX)] {
            assert_eq!(check_size(width, height), Err(ImageError::TooLarge { width, height }));
        }
        assert_eq!(check_size(SIDE_PX_MAX, SIDE_PX_MAX), Ok(()));
    }

    #[test]
    fn a_strided_view_skips_the_padding() {
        let data = [1, 2, 9, 3, 4];
        let view = GrayView::new(&data, 2, 2, 3).unwrap();
        assert_eq!(view.to_image().pixels(), [1, 2, 3, 4]);
    }

    #[test]
    fn sixteen_bits_become_the_nearest_of_eight() {
        let data = [0, 128, 129, 9, 65_535, 257 * 200, 257 * 200 + 129];
        let picture = GrayImage::from_gray16(&data, 3, 2, 4).unwrap();
        assert_eq!(picture.pixels(), [0, 0, 1, 255, 200, 201]);
        assert!(GrayImage::from_gray16(&data, 3, 2, 5).is_err());
        assert!(GrayImage::from_gray16(&data, 0, 2, 0).is_err());
    }

    #[test]
    fn grey_is_bt601_and_keeps_grey_pixels() {
        // 0.299 * 255 = 76.2, 0.587 * 255 = 149.7, 0.114 * 255 = 29.07.
        let data = [255, 0, 0, 0, 255, 0, 0, 0, 255];
        let view = ColorView::new(&data, 3, 1, 9, PixelLayout::Rgb).unwrap();
        assert_eq!(view.to_gray().pixels(), [76, 150, 29]);
        let view = ColorView::new(&data, 3, 1, 9, PixelLayout::Bgr).unwrap();
        assert_eq!(view.to_gray().pixels(), [29, 150, 76]);
        for value in 0..=255 {
            let pixel = [value, value, value, 7];
            let view = ColorView::new(&pixel, 1, 1, 4, PixelLayout::Rgba).unwrap();
            assert_eq!(view.to_gray().pixels(), [value]);
        }
    }
}
