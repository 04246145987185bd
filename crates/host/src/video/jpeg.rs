//! Pictures to JPEG.

use image::codecs::jpeg::JpegEncoder;
use rsapien_vision::{Picture, PictureError};

/// Quality of the pictures written, 1 to 100: beyond it they grow quickly and look the same.
pub const JPEG_QUALITY: u8 = 85;

/// A picture as a JPEG file's content.
///
/// # Errors
/// [`PictureError::Broken`] with what the encoder said.
pub fn encode_jpeg(picture: &Picture) -> Result<Vec<u8>, PictureError> {
    let mut bytes = Vec::new();
    let broken = |reason: String| PictureError::Broken { reason };
    let side = |side_px: usize| u32::try_from(side_px).map_err(|error| broken(error.to_string()));
    let (width, height) = (side(picture.width())?, side(picture.height())?);
    JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY)
        .encode(picture.rgb(), width, height, image::ExtendedColorType::Rgb8)
        .map_err(|error| broken(error.to_string()))?;
    Ok(bytes)
}
