//! What the tests of the sources share.

use rsapien_vision::Picture;

use super::{Frame, FrameSource, Next, Trouble, VideoError, encode_jpeg};

/// Everything that a source gives to its end.
pub(super) fn drain(
    mut source: impl FrameSource,
) -> Result<(Vec<Frame>, Vec<Trouble>), VideoError> {
    let (mut frames, mut troubles) = (Vec::new(), Vec::new());
    loop {
        match source.next_frame()? {
            Next::Frame(frame) => frames.push(*frame),
            Next::Trouble(trouble) => troubles.push(trouble),
            Next::End => return Ok((frames, troubles)),
        }
    }
}

/// A JPEG picture of this size, with something in it.
pub(super) fn jpeg(width: usize, height: usize) -> Vec<u8> {
    let pixels =
        (0..width * height * 3).map(|index| index.wrapping_mul(7).to_le_bytes()[0]).collect();
    encode_jpeg(&Picture::new(pixels, width, height).unwrap()).unwrap()
}
