//! Webcams through Linux's V4L2 (feature `webcam`, Linux): MJPG where the camera has it, YUYV otherwise.

use std::io::Error;
use std::path::Path;

use linuxvideo::format::{PixFormat, PixelFormat};
use linuxvideo::stream::ReadStream;
use linuxvideo::{BufType, Device};
use rsapien_vision::image::check_size;
use rsapien_vision::{GrayImage, Picture};

use super::yuv::{ColorPlanes, Range};
use super::{
    FrameColor, FrameSource, Next, Piece, SourceOptions, Splitter, Ticker, Trouble, VideoError,
};

/// An open webcam.
pub struct Webcam {
    stream: ReadStream,
    /// Width, height and bytes from row to row of YUYV pictures; none for MJPG.
    yuyv: Option<(usize, usize, usize)>,
    options: SourceOptions,
    ticker: Ticker,
}

impl Webcam {
    /// Opens a camera such as `/dev/video0` and asks it for pictures of about `size_px`, width and height. The camera
    /// takes the nearest that it can.
    ///
    /// # Errors
    /// [`VideoError::Open`] when the device is not there or not this user's; [`VideoError::Camera`] when it is no
    /// camera, is in use, or has neither MJPG nor YUYV pictures.
    pub fn open(
        path: &Path,
        size_px: (u32, u32),
        options: SourceOptions,
    ) -> Result<Self, VideoError> {
        let place = path.display().to_string();
        let device = Device::open(path)
            .map_err(|source| VideoError::Open { place: place.clone(), source })?;
        let unusable = |problem: String| VideoError::Camera { device: place.clone(), problem };
        let failed = |error: Error| unusable(error.to_string());
        let mut formats = Vec::new();
        for format in device.formats(BufType::VIDEO_CAPTURE) {
            formats.push(format.map_err(failed)?.pixel_format());
        }
        let wanted = [PixelFormat::MJPG, PixelFormat::JPEG, PixelFormat::YUYV];
        let Some(format) = wanted.into_iter().find(|format| formats.contains(format)) else {
            return Err(unusable(format!(
                "it has neither MJPG nor YUYV pictures, but {formats:?}; let ffmpeg convert: ffmpeg -f v4l2 -i {place} \
                 -f yuv4mpegpipe -pix_fmt yuv420p - | rsapien watch -"
            )));
        };
        let capture =
            device.video_capture(PixFormat::new(size_px.0, size_px.1, format)).map_err(failed)?;
        let given = capture.format();
        if given.pixel_format() != format {
            return Err(unusable(format!("it was asked for {format:?} and gives others")));
        }
        // Both fit: they are 32 bits.
        let (width, height) = (given.width() as usize, given.height() as usize);
        check_size(width, height)?;
        let stride = (given.bytes_per_line() as usize).max(2 * width);
        let yuyv = (format == PixelFormat::YUYV).then_some((width, height, stride));
        let stream = capture.into_stream().map_err(failed)?;
        Ok(Self { stream, yuyv, options, ticker: Ticker::new(options.frame_rate) })
    }
}

impl FrameSource for Webcam {
    fn next_frame(&mut self) -> Result<Next, VideoError> {
        // Copied at once, so that the camera has its buffer back.
        let bytes =
            self.stream.dequeue(|buffer| Ok((!buffer.is_error()).then(|| buffer.to_vec())))?;
        let broken = |why: String| Ok(Next::Trouble(Trouble::BadPicture { name: None, why }));
        let Some(bytes) = bytes else {
            return broken("the camera calls it damaged".to_owned());
        };
        let color = self.options.color;
        let frame = match self.yuyv {
            None => {
                // The splitter adds the tables that webcams leave out and cuts the padding.
                let mut splitter = Splitter::default();
                splitter.push(&bytes);
                let Some(Piece::Picture(picture)) = splitter.next_piece() else {
                    return broken("it is no whole JPEG picture".to_owned());
                };
                match Picture::decode(&picture) {
                    Ok(picture) => self.ticker.picture(picture, color),
                    Err(error) => return broken(error.to_string()),
                }
            }
            Some((width, height, stride)) => {
                let Some((gray, color)) = from_yuyv(&bytes, width, height, stride, color) else {
                    return broken(format!("{} bytes are too few", bytes.len()));
                };
                self.ticker.frame(gray, color)
            }
        };
        Ok(Next::Frame(Box::new(frame)))
    }
}

/// Brightness, and the colours where they are wanted, of pairs of pixels `y u y v`; none when bytes are missing.
fn from_yuyv(
    bytes: &[u8],
    width: usize,
    height: usize,
    stride: usize,
    color: bool,
) -> Option<(GrayImage, Option<FrameColor>)> {
    let mut gray = Vec::with_capacity(width * height);
    let (mut u, mut v) = (Vec::new(), Vec::new());
    for y in 0..height {
        let row = bytes.get(y * stride..)?.get(..2 * width)?;
        gray.extend(row.iter().step_by(2));
        if color {
            u.extend(row.iter().skip(1).step_by(4));
            // A last pixel without a partner has half of its colour.
            v.extend(row.chunks(4).map(|pair| pair.get(3).copied().unwrap_or(128)));
        }
    }
    u.append(&mut v);
    let planes = ColorPlanes { shared: (2, 1), range: Range::Limited, bytes: u };
    let color = color.then_some(FrameColor::Planes(planes));
    Some((GrayImage::new(gray, width, height).ok()?, color))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn yuyv_pictures_are_taken_apart_and_short_ones_left_out() {
        // Two rows of two pixels, red and blue by their pair, with two bytes of padding behind each.
        let bytes = [81, 90, 82, 240, 9, 9, 41, 240, 42, 110, 9, 9];
        let (gray, color) = from_yuyv(&bytes, 2, 2, 6, true).unwrap();
        assert_eq!(gray.pixels(), [81, 82, 41, 42]);
        let picture = Ticker::default().frame(gray, color).picture();
        let bright: Vec<bool> = picture.rgb().iter().map(|&value| value > 128).collect();
        let (red, blue) = ([true, false, false], [false, false, true]);
        assert_eq!(bright, [red, red, blue, blue].concat());
        assert!(from_yuyv(&bytes[..9], 2, 2, 6, false).is_none());
    }

    #[test]
    fn what_is_no_camera_is_told() {
        let options = SourceOptions::default();
        let missing = Webcam::open(Path::new("/dev/no-such-camera"), (640, 480), options);
        assert!(matches!(missing.err(), Some(VideoError::Open { .. })));
        let null = Webcam::open(Path::new("/dev/null"), (640, 480), options).err().unwrap();
        assert!(null.to_string().contains("/dev/null"), "{null}");
    }
}
