//! Pictures that keep coming (feature `video`): films, cameras and network streams as one kind of source, and the live
//! way of looking at them, in which frames are dropped rather than delayed.
//!
//! ```text
//!   FrameSource ── its own thread ──► Live: a slot for the newest frame ──► whoever looks at it
//!   folder, Y4M, MJPEG, HTTP, webcam                                            │
//!                                              FrameServer, annotated JPEG ◄────┘
//! ```
//!
//! A source is never trusted: sizes and lengths are checked before memory is taken for them, rubbish is skipped and
//! counted, and what a source survives is a [`Trouble`], told among the frames; a [`VideoError`] ends it.

mod folder;
mod http;
mod jpeg;
mod live;
mod meter;
mod mjpeg;
mod server;
mod stream;
mod taken;
#[cfg(all(feature = "webcam", target_os = "linux"))]
mod webcam;
mod y4m;
mod yuv;

#[cfg(test)]
mod tests;

use std::fmt;
use std::io;
use std::time::{Duration, Instant};

use rsapien_vision::{GrayImage, ImageError, Picture, PictureError};

pub use folder::Folder;
pub use http::{HttpAddress, HttpOptions, HttpStream};
pub use jpeg::{JPEG_QUALITY, encode_jpeg};
pub use live::{Counts, Delivery, Incoming, Live};
pub use meter::{Meter, Rates, Summary};
pub use mjpeg::{MjpegStream, PICTURE_BYTES_MAX, Piece, Splitter};
pub use server::FrameServer;
pub use stream::{StreamFormat, open_stream};
pub use taken::Taken;
#[cfg(all(feature = "webcam", target_os = "linux"))]
pub use webcam::Webcam;
pub use y4m::Y4mStream;
pub use yuv::ColorPlanes;

/// Without a film in so many bytes, there is none.
const BYTES_BEFORE_FIRST_MAX: u64 = 16 << 20;

/// One picture of a source.
#[derive(Debug, Clone)]
pub struct Frame {
    /// Counts the pictures of the source from 0, those included that nobody looked at.
    pub number: u64,
    /// When the picture belongs, from the first picture on: by the film's frame rate where the source has one, by the
    /// clock otherwise.
    pub time: Duration,
    /// When the picture was complete here.
    pub captured: Instant,
    /// The file's name, where the source has files.
    pub name: Option<String>,
    /// What the detector looks at.
    pub gray: GrayImage,
    /// Its colours, where [`SourceOptions::color`] asks for them and the source has them.
    pub color: Option<FrameColor>,
}

/// The colours of a [`Frame`].
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum FrameColor {
    /// The whole picture.
    Rgb(Picture),
    /// Beside the brightness, still to be put together.
    Planes(ColorPlanes),
}

impl Frame {
    /// The picture to draw on: in colour where it is there. Planes are put together now, so that frames that nobody
    /// draws on cost nothing.
    pub fn picture(&self) -> Picture {
        let picture = match &self.color {
            Some(FrameColor::Rgb(picture)) => Some(picture.clone()),
            Some(FrameColor::Planes(planes)) => planes.to_picture(&self.gray).ok(),
            None => None,
        };
        picture.unwrap_or_else(|| Picture::from_gray(&self.gray.view()))
    }
}

/// What a source gives when it is asked.
#[derive(Debug)]
pub enum Next {
    /// The next picture.
    Frame(Box<Frame>),
    /// Something went wrong, and the source goes on.
    Trouble(Trouble),
    /// There are no more.
    End,
}

/// Gives one picture after the other.
pub trait FrameSource: Send {
    /// Waits for the next picture. A call comes back at the latest when a picture, an end, an error or so much rubbish
    /// has come that it is worth a word; a source that is silent keeps it waiting.
    ///
    /// # Errors
    /// [`VideoError`] when the source cannot go on; nothing is to be asked of it then.
    fn next_frame(&mut self) -> Result<Next, VideoError>;

    /// Whether pictures are lost when nobody takes them in time, as a camera's are. Those of a folder wait.
    fn is_live(&self) -> bool {
        true
    }
}

/// What every source may be told.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SourceOptions {
    /// Whether frames carry their colours, too: for drawing on them.
    pub color: bool,
    /// Pictures a second, above 0: sets [`Frame::time`] in place of what the source says.
    pub frame_rate: Option<f64>,
}

/// What went wrong in a source that goes on.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Trouble {
    /// Bytes between pictures that are none, and were skipped.
    Skipped {
        /// How many.
        bytes: u64,
    },
    /// A picture that is broken or breaks off, and was left out.
    BadPicture {
        /// Which, where it has a name.
        name: Option<String>,
        /// What is wrong with it.
        why: String,
    },
    /// The connection is lost or could not be made again; it is tried again after a while.
    Lost {
        /// What happened.
        why: String,
        /// How long until the next try.
        retry: Duration,
    },
    /// The connection is back.
    Back,
}

impl fmt::Display for Trouble {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Skipped { bytes: 1 } => {
                formatter.write_str("skipped 1 byte that belongs to no picture")
            }
            Self::Skipped { bytes } => {
                write!(formatter, "skipped {bytes} bytes that belong to no picture")
            }
            Self::BadPicture { name: Some(name), why } => {
                write!(formatter, "left out {name}: {why}")
            }
            Self::BadPicture { name: None, why } => write!(formatter, "left out a picture: {why}"),
            Self::Lost { why, retry } => {
                write!(formatter, "{why}; trying again in {:.1} s", retry.as_secs_f64())
            }
            Self::Back => formatter.write_str("connected again"),
        }
    }
}

/// Why a source cannot be opened or cannot go on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VideoError {
    /// A file, folder or device that cannot be opened.
    #[error("cannot open {place}: {source}")]
    Open {
        /// Its path.
        place: String,
        /// What the system says.
        source: io::Error,
    },
    /// The system failed while the source was read.
    #[error("cannot read the source any more: {0}")]
    Read(#[from] io::Error),
    /// A folder without pictures.
    #[error("{folder} holds no picture: files are looked for that end in {endings}")]
    NoPictures {
        /// Its path.
        folder: String,
        /// The endings, in words.
        endings: &'static str,
    },
    /// Nothing came that looks like a film.
    #[error(
        "no film came in the first {bytes} bytes, neither Y4M nor MJPEG; with ffmpeg, -f yuv4mpegpipe or -f mjpeg makes them"
    )]
    NoVideo {
        /// How much was looked at.
        bytes: u64,
    },
    /// The source ended before its first picture.
    #[error("the source ended before its first picture")]
    Empty,
    /// The first line of a Y4M film says nothing that can be used.
    #[error("the Y4M header is broken: {problem}")]
    Y4mHeader {
        /// What is wrong.
        problem: String,
    },
    /// A Y4M film with pixels of another kind.
    #[error("Y4M with {colors} pixels is not read, only 8-bit: with ffmpeg, add -pix_fmt yuv420p")]
    Y4mColors {
        /// How the header names them.
        colors: String,
    },
    /// A picture of no or of too many pixels.
    #[error(transparent)]
    Size(#[from] ImageError),
    /// A text that names no HTTP stream.
    #[error("`{address}` names no stream: {problem}")]
    Address {
        /// The text.
        address: String,
        /// What is wrong and what to do.
        problem: &'static str,
    },
    /// The first connection to a stream failed.
    #[error("no stream from {address}: {problem}")]
    Http {
        /// Its address.
        address: String,
        /// What happened.
        problem: String,
    },
    /// A camera that gives no pictures that can be used.
    #[error("{device} cannot be used: {problem}")]
    Camera {
        /// Its path.
        device: String,
        /// What is wrong.
        problem: String,
    },
    /// A picture could not be taken or encoded.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The source's thread ended without a word.
    #[error("the source broke off: the thread that reads it has ended")]
    Died,
}

/// Numbers the pictures of a source and gives them their times.
#[derive(Debug, Default)]
struct Ticker {
    next: u64,
    first: Option<Instant>,
    frame_rate: Option<f64>,
}

impl Ticker {
    fn new(frame_rate: Option<f64>) -> Self {
        Self { frame_rate, ..Self::default() }
    }

    /// The frame of a picture that is complete just now.
    fn frame(&mut self, gray: GrayImage, color: Option<FrameColor>) -> Frame {
        let captured = Instant::now();
        let first = *self.first.get_or_insert(captured);
        let number = self.next;
        self.next += 1;
        let time = match self.frame_rate {
            // Exact far beyond any film; what does not fit is a rate next to nothing.
            #[allow(clippy::cast_precision_loss)]
            Some(rate) => Duration::try_from_secs_f64(number as f64 / rate).unwrap_or_default(),
            None => captured - first,
        };
        Frame { number, time, captured, name: None, gray, color }
    }

    /// The frame of a decoded picture that is complete just now.
    fn picture(&mut self, picture: Picture, color: bool) -> Frame {
        let gray = picture.to_gray();
        self.frame(gray, color.then_some(FrameColor::Rgb(picture)))
    }
}
