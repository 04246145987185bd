//! Pictures from and to files, through the `image` crate (feature `image`).
//!
//! PNG, JPEG, BMP and PNM are read; the format is recognised by the content, not by the file's name. The size in the
//! file's head is checked before anything is allocated for the pixels, and a file that ends early is an error.

use std::fs;
use std::io::{Cursor, Read};
use std::path::{Path, PathBuf};

use ::image::{ImageDecoder, ImageError as CodecError, ImageFormat, ImageReader, Limits};
use thiserror::Error;

use crate::image::{
    AREA_PX_MAX, ColorView, GrayImage, GrayView, ImageError, PixelLayout, check_size,
};

/// Largest file that is read, in bytes.
pub const FILE_BYTES_MAX: u64 = 512 << 20;

/// Why a picture could not be read or written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The file could not be read or written.
    #[error("cannot {action} {}: {source}", path.display())]
    File {
        /// "read" or "write".
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// The file is longer than any picture within the limits.
    #[error("{} is larger than {FILE_BYTES_MAX} bytes, which no picture within the limits needs", path.display())]
    FileTooLarge {
        /// The file.
        path: PathBuf,
    },
    /// The content is no PNG, JPEG, BMP or PNM picture.
    #[error("not a picture that can be read: it begins like no png, jpeg, bmp or pnm file")]
    UnknownFormat,
    /// A picture of another format.
    #[error("{format} pictures are not read: convert it to png, jpeg, bmp or pnm")]
    UnsupportedFormat {
        /// The format recognised.
        format: &'static str,
    },
    /// The picture breaks off before its end.
    #[error("picture is incomplete: the {format} data ends early")]
    Incomplete {
        /// The format recognised.
        format: &'static str,
    },
    /// The content contradicts its format.
    #[error("picture is broken: {reason}")]
    Broken {
        /// What the decoder or encoder said.
        reason: String,
    },
    /// Empty or too large.
    #[error(transparent)]
    Size(#[from] ImageError),
}

/// An owned 8-bit RGB picture: what was read, and what ellipses are drawn on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    rgb: Vec<u8>,
    width: usize,
    height: usize,
}

impl Picture {
    /// Takes `width * height` pixels of three bytes, row by row; longer data is cut.
    ///
    /// # Errors
    /// [`ImageError`] when the picture is empty or too large, or when the data cannot hold it.
    pub fn new(mut rgb: Vec<u8>, width: usize, height: usize) -> Result<Self, ImageError> {
        ColorView::new(&rgb, width, height, width.saturating_mul(3), PixelLayout::Rgb)?;
        rgb.truncate(width * height * 3);
        Ok(Self { rgb, width, height })
    }

    /// Reads a file.
    ///
    /// # Errors
    /// [`PictureError`]: not there, not a picture, broken, incomplete or too large.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, PictureError> {
        let path = path.as_ref();
        let failed = |source| PictureError::File { action: "read", path: path.to_owned(), source };
        let file = fs::File::open(path).map_err(failed)?;
        let mut bytes = Vec::new();
        // The length is bounded by what is read, since a pipe or device has none to ask for.
        file.take(FILE_BYTES_MAX + 1).read_to_end(&mut bytes).map_err(failed)?;
        if bytes.len() as u64 > FILE_BYTES_MAX {
            return Err(PictureError::FileTooLarge { path: path.to_owned() });
        }
        Self::decode(&bytes)
    }

    /// Decodes a file's content.
    ///
    /// # Errors
    /// [`PictureError`]: not a picture, broken, incomplete or too large.
    pub fn decode(bytes: &[u8]) -> Result<Self, PictureError> {
        let reader = ImageReader::new(Cursor::new(bytes))
            .with_guessed_format()
            .map_err(|error| broken(&error))?;
        let format = reader.format().ok_or(PictureError::UnknownFormat)?;
        let name = format.extensions_str().first().copied().unwrap_or("picture");
        if !format.reading_enabled() {
            return Err(PictureError::UnsupportedFormat { format: name });
        }
        let codec = |error: CodecError| codec_error(error, name);
        let mut reader = reader;
        let mut limits = Limits::default();
        // Room for 16-bit RGBA of the largest picture, and nothing beyond.
        limits.max_alloc = Some(8 * AREA_PX_MAX as u64);
        reader.limits(limits);
        let decoder = reader.into_decoder().map_err(codec)?;
        let (width, height) = decoder.dimensions();
        check_size(width as usize, height as usize)?;
        // The JPEG decoder fills what is missing with grey; the end marker tells.
        if format == ImageFormat::Jpeg && !bytes.windows(2).any(|pair| pair == [0xFF, 0xD9]) {
            return Err(PictureError::Incomplete { format: name });
        }
        let rgb = ::image::DynamicImage::from_decoder(decoder).map_err(codec)?.into_rgb8();
        Ok(Self { rgb: rgb.into_raw(), width: width as usize, height: height as usize })
    }

    /// A grey picture in colour, to be drawn on.
    pub fn from_gray(gray: &GrayView<'_>) -> Self {
        let rgb = gray.rows().flatten().flat_map(|&value| [value; 3]).collect();
        Self { rgb, width: gray.width(), height: gray.height() }
    }

    /// Width in pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The pixels row by row, three bytes each.
    pub fn rgb(&self) -> &[u8] {
        &self.rgb
    }

    /// The three bytes of pixel (`x`, `y`); `None` outside the picture.
    pub fn pixel_mut(&mut self, x: usize, y: usize) -> Option<&mut [u8; 3]> {
        if x >= self.width || y >= self.height {
            return None;
        }
        self.rgb.get_mut((y * self.width + x) * 3..)?.first_chunk_mut()
    }

    /// The borrowed view.
    pub fn view(&self) -> ColorView<'_> {
        ColorView::from_checked_rgb(&self.rgb, self.width, self.height)
    }

    /// The grey picture that the detector takes; see [`ColorView::to_gray`].
    pub fn to_gray(&self) -> GrayImage {
        self.view().to_gray()
    }

    /// Writes the picture as PNG.
    ///
    /// # Errors
    /// [`PictureError::File`] when the file cannot be written.
    pub fn save_png(&self, path: impl AsRef<Path>) -> Result<(), PictureError> {
        save_png(
            path.as_ref(),
            &self.rgb,
            self.width,
            self.height,
            ::image::ExtendedColorType::Rgb8,
        )
    }
}

/// Writes a grey picture as PNG.
///
/// # Errors
/// [`PictureError::File`] when the file cannot be written.
pub fn save_gray_png(gray: &GrayImage, path: impl AsRef<Path>) -> Result<(), PictureError> {
    save_png(
        path.as_ref(),
        gray.pixels(),
        gray.width(),
        gray.height(),
        ::image::ExtendedColorType::L8,
    )
}

fn save_png(
    path: &Path,
    pixels: &[u8],
    width: usize,
    height: usize,
    color: ::image::ExtendedColorType,
) -> Result<(), PictureError> {
    let mut bytes = Cursor::new(Vec::new());
    // Both sides are at most 16384.
    ::image::write_buffer_with_format(
        &mut bytes,
        pixels,
        width as u32,
        height as u32,
        color,
        ImageFormat::Png,
    )
    .map_err(|error| broken(&error))?;
    fs::write(path, bytes.into_inner()).map_err(|source| PictureError::File {
        action: "write",
        path: path.to_owned(),
        source,
    })
}

fn broken(error: &dyn std::error::Error) -> PictureError {
    PictureError::Broken { reason: error.to_string() }
}

fn codec_error(error: CodecError, format: &'static str) -> PictureError {
    match error {
        CodecError::IoError(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => {
            PictureError::Incomplete { format }
        }
        other => broken(&other),
    }
}

#[cfg(test)]
mod tests;
