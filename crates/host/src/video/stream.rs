//! A film on any reader: the standard input, a file, a pipe.

use std::io::{Cursor, ErrorKind, Read};

use super::y4m::MAGIC;
use super::{FrameSource, MjpegStream, Next, SourceOptions, VideoError, Y4mStream};

/// How a film's bytes are to be understood.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StreamFormat {
    /// Uncompressed planes.
    Y4m,
    /// JPEG pictures one behind the other.
    Mjpeg,
}

type Reader = Box<dyn Read + Send>;

/// The film that `reader` gives. Without a format it is told by the first bytes, when the first picture is asked for.
pub fn open_stream(
    reader: Reader,
    format: Option<StreamFormat>,
    options: SourceOptions,
) -> Box<dyn FrameSource> {
    match format {
        Some(StreamFormat::Y4m) => Box::new(Y4mStream::new(reader, options)),
        Some(StreamFormat::Mjpeg) => Box::new(MjpegStream::new(reader, options)),
        None => Box::new(Unknown { reader: Some(reader), options, found: None }),
    }
}

/// A film whose first bytes are still to come.
struct Unknown {
    reader: Option<Reader>,
    options: SourceOptions,
    found: Option<Box<dyn FrameSource>>,
}

impl FrameSource for Unknown {
    fn next_frame(&mut self) -> Result<Next, VideoError> {
        if let Some(mut reader) = self.reader.take() {
            let head = head(&mut reader)?;
            let format = if head == MAGIC { StreamFormat::Y4m } else { StreamFormat::Mjpeg };
            let whole: Reader = Box::new(Cursor::new(head).chain(reader));
            self.found = Some(open_stream(whole, Some(format), self.options));
        }
        self.found.as_mut().map_or(Ok(Next::End), |source| source.next_frame())
    }
}

/// As many bytes as a film's magic has; fewer where there are no more.
fn head(reader: &mut Reader) -> Result<Vec<u8>, VideoError> {
    let mut head = vec![0; MAGIC.len()];
    let mut count = 0;
    while count < head.len() {
        match reader.read(&mut head[count..]) {
            Ok(0) => break,
            Ok(more) => count += more,
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error.into()),
        }
    }
    head.truncate(count);
    Ok(head)
}
