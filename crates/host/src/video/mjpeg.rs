//! MJPEG: JPEG pictures one behind the other, as `ffmpeg -f mjpeg`, webcams and network cameras send them.
//!
//! A picture's end is found by walking its markers (ITU-T T.81, annex B), so that a thumbnail inside it ends nothing.
//! What stands between pictures is skipped: the boundaries and heads of `multipart/x-mixed-replace` silently, anything
//! else counted.

use std::io::{ErrorKind, Read};

use rsapien_vision::Picture;

use super::{
    BYTES_BEFORE_FIRST_MAX, FrameSource, Next, SourceOptions, Ticker, Trouble, VideoError,
};

/// Largest picture taken from a stream, in bytes.
pub const PICTURE_BYTES_MAX: usize = 32 << 20;
/// Text between pictures up to this length may be a boundary and a head.
const HEAD_BYTES_MAX: usize = 4096;
/// After so much rubbish at once a word is said.
const SKIPPED_AT_ONCE: u64 = 1 << 20;
/// How much is read at once.
const READ_BYTES: usize = 1 << 16;

/// Markers (their second byte; the first is FF).
mod marker {
    pub(super) const HUFFMAN_TABLES: u8 = 0xC4;
    pub(super) const RESTARTS: std::ops::RangeInclusive<u8> = 0xD0..=0xD7;
    pub(super) const START: u8 = 0xD8;
    pub(super) const END: u8 = 0xD9;
    pub(super) const SCAN: u8 = 0xDA;
    pub(super) const TEMPORARY: u8 = 0x01;
}

/// How a picture begins: its start and the first byte of the next marker.
const START: [u8; 3] = [0xFF, marker::START, 0xFF];
/// A segment that tells decoders to use the standard's Huffman tables, which webcams leave out.
const STANDARD_TABLES: &[u8] = b"\xFF\xE0\x00\x10AVI1\0\0\0\0\0\0\0\0\0\0";

/// What a [`Splitter`] found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Piece {
    /// A whole JPEG picture.
    Picture(Vec<u8>),
    /// So many bytes that were part of no whole picture.
    Skipped(u64),
    /// A picture that broke off after so many bytes.
    Cut(u64),
}

/// Where in a stream the splitter is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    Between,
    /// At a marker of a picture.
    Marker,
    /// In the compressed pixels.
    Pixels,
}

/// What a step over the bytes at hand came to; no step where more have to come first.
enum Step {
    On,
    Found(Piece),
}

/// Takes bytes as they come and gives pictures.
#[derive(Debug)]
pub struct Splitter {
    buffer: Vec<u8>,
    /// Where what is not yet given out begins: the picture's start, or bytes between pictures.
    begin: usize,
    /// What stands before it was looked at.
    position: usize,
    place: Place,
    /// The segment read last, from which a search starts again when the picture turns out to be none.
    segment: usize,
    has_tables: bool,
    skipped: u64,
}

impl Default for Splitter {
    fn default() -> Self {
        Self {
            buffer: Vec::new(),
            begin: 0,
            position: 0,
            place: Place::Between,
            segment: 0,
            has_tables: false,
            skipped: 0,
        }
    }
}

impl Splitter {
    /// Adds what came.
    pub fn push(&mut self, bytes: &[u8]) {
        if self.begin > 0 {
            self.buffer.drain(..self.begin);
            self.position -= self.begin;
            self.segment = self.segment.saturating_sub(self.begin);
            self.begin = 0;
        }
        self.buffer.extend_from_slice(bytes);
    }

    /// The next piece; none when more has to come first.
    pub fn next_piece(&mut self) -> Option<Piece> {
        loop {
            if self.skipped >= SKIPPED_AT_ONCE {
                return self.take_skipped();
            }
            let step = match self.place {
                Place::Between => self.find_start(),
                Place::Marker => self.marker(),
                Place::Pixels => self.pixels(),
            };
            if let Step::Found(piece) = step? {
                return Some(piece);
            }
        }
    }

    /// What is left when nothing more comes.
    pub fn finish(&mut self) -> Option<Piece> {
        let left = (self.buffer.len() - self.begin) as u64;
        let (is_picture, is_head) =
            (self.place != Place::Between, is_head(&self.buffer[self.begin..]));
        *self = Self { skipped: self.skipped, ..Self::default() };
        if is_picture {
            return Some(Piece::Cut(left));
        }
        if !is_head {
            self.skipped += left;
        }
        self.take_skipped()
    }

    fn take_skipped(&mut self) -> Option<Piece> {
        let skipped = std::mem::take(&mut self.skipped);
        (skipped > 0).then_some(Piece::Skipped(skipped))
    }

    /// Looks for a picture's start and goes there.
    fn find_start(&mut self) -> Option<Step> {
        let unseen = &self.buffer[self.position..];
        let start = unseen.windows(START.len()).position(|bytes| bytes == START);
        if let Some(start) = start {
            let start = self.position + start;
            if !is_head(&self.buffer[self.begin..start]) {
                self.skipped += (start - self.begin) as u64;
            }
            self.start_at(start);
            // Rubbish is told before the picture that ends it.
            return Some(self.take_skipped().map_or(Step::On, Step::Found));
        }
        // The last two bytes may begin a start.
        self.position = self.position.max(self.buffer.len().saturating_sub(START.len() - 1));
        if self.position - self.begin > HEAD_BYTES_MAX {
            self.skipped += (self.position - self.begin) as u64;
            self.begin = self.position;
        }
        None
    }

    /// Begins a picture whose start stands at `start`.
    fn start_at(&mut self, start: usize) {
        (self.begin, self.segment, self.position) = (start, start, start + 2);
        (self.place, self.has_tables) = (Place::Marker, false);
    }

    /// Takes one marker.
    fn marker(&mut self) -> Option<Step> {
        if self.position - self.begin > PICTURE_BYTES_MAX {
            return Some(self.give_up());
        }
        let bytes = self.buffer.get(self.position..)?;
        let (&first, &code) = (bytes.first()?, bytes.get(1)?);
        if first != 0xFF {
            return Some(self.give_up());
        }
        match code {
            // Fill bytes.
            0xFF => self.position += 1,
            marker::END => {
                let end = self.position + 2;
                let mut picture = Vec::with_capacity(end - self.begin + STANDARD_TABLES.len());
                picture.extend_from_slice(&self.buffer[self.begin..self.begin + 2]);
                if !self.has_tables {
                    picture.extend_from_slice(STANDARD_TABLES);
                }
                picture.extend_from_slice(&self.buffer[self.begin + 2..end]);
                (self.begin, self.position, self.place) = (end, end, Place::Between);
                return Some(Step::Found(Piece::Picture(picture)));
            }
            marker::START => {
                let cut = (self.position - self.begin) as u64;
                self.start_at(self.position);
                return Some(Step::Found(Piece::Cut(cut)));
            }
            marker::TEMPORARY => self.position += 2,
            code if marker::RESTARTS.contains(&code) => self.position += 2,
            0x00 => return Some(self.give_up()),
            _ => {
                let length = u16::from_be_bytes([*bytes.get(2)?, *bytes.get(3)?]);
                if length < 2 {
                    return Some(self.give_up());
                }
                self.has_tables |= code == marker::HUFFMAN_TABLES;
                self.segment = self.position;
                self.position += 2 + usize::from(length);
                if code == marker::SCAN {
                    self.place = Place::Pixels;
                }
            }
        }
        Some(Step::On)
    }

    /// Goes on to the next marker behind compressed pixels.
    fn pixels(&mut self) -> Option<Step> {
        loop {
            // A picture longer than it may be is none; that is seen where markers are taken.
            if self.position - self.begin > PICTURE_BYTES_MAX {
                break;
            }
            let unseen = self.buffer.get(self.position..)?;
            let Some(found) = unseen.iter().position(|&byte| byte == 0xFF) else {
                self.position = self.buffer.len();
                return None;
            };
            self.position += found;
            match self.buffer.get(self.position + 1)? {
                0x00 => self.position += 2,
                code if marker::RESTARTS.contains(code) => self.position += 2,
                _ => break,
            }
        }
        self.place = Place::Marker;
        Some(Step::On)
    }

    /// The picture is none: goes on behind the beginning of its last segment, in which the next one may begin.
    fn give_up(&mut self) -> Step {
        let next = (self.segment + 2).min(self.buffer.len());
        let cut = (next - self.begin) as u64;
        (self.begin, self.position, self.place) = (next, next, Place::Between);
        Step::Found(Piece::Cut(cut))
    }
}

/// Whether this is nothing, or the boundary and the head of a part of `multipart/x-mixed-replace`.
fn is_head(bytes: &[u8]) -> bool {
    if bytes.len() > HEAD_BYTES_MAX {
        return false;
    }
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    let text = text.trim_ascii_start();
    let is_text = text.chars().all(|c| c.is_ascii_graphic() || " \r\n\t".contains(c));
    text.is_empty() || (is_text && text.starts_with("--"))
}

/// An MJPEG film on a reader.
pub struct MjpegStream<R> {
    reader: R,
    options: SourceOptions,
    splitter: Splitter,
    chunk: Vec<u8>,
    ticker: Ticker,
    /// Bytes read before the first picture; none behind it.
    before_first: Option<u64>,
    is_over: bool,
}

impl<R: Read + Send> MjpegStream<R> {
    /// The pictures that `reader` gives.
    pub fn new(reader: R, options: SourceOptions) -> Self {
        Self {
            reader,
            options,
            splitter: Splitter::default(),
            chunk: vec![0; READ_BYTES],
            ticker: Ticker::new(options.frame_rate),
            before_first: Some(0),
            is_over: false,
        }
    }

    /// Puts another reader in the place of one that has ended; the pictures are counted on.
    pub(super) fn replace_reader(&mut self, reader: R) {
        self.reader = reader;
        self.splitter = Splitter::default();
        self.is_over = false;
    }

    fn next_from(&mut self, piece: Piece) -> Next {
        let broken = |why| Next::Trouble(Trouble::BadPicture { name: None, why });
        match piece {
            Piece::Skipped(bytes) => Next::Trouble(Trouble::Skipped { bytes }),
            Piece::Cut(bytes) => broken(format!("it breaks off after {bytes} bytes")),
            Piece::Picture(bytes) => match Picture::decode(&bytes) {
                Ok(picture) => {
                    self.before_first = None;
                    Next::Frame(Box::new(self.ticker.picture(picture, self.options.color)))
                }
                Err(error) => broken(error.to_string()),
            },
        }
    }
}

impl<R: Read + Send> FrameSource for MjpegStream<R> {
    fn next_frame(&mut self) -> Result<Next, VideoError> {
        loop {
            if let Some(piece) = self.splitter.next_piece() {
                return Ok(self.next_from(piece));
            }
            if self.is_over {
                return Ok(Next::End);
            }
            let count = match self.reader.read(&mut self.chunk) {
                Ok(count) => count,
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(error) => return Err(error.into()),
            };
            self.splitter.push(self.chunk.get(..count).unwrap_or_default());
            if let Some(before) = &mut self.before_first {
                *before += count as u64;
                if *before > BYTES_BEFORE_FIRST_MAX {
                    return Err(VideoError::NoVideo { bytes: *before });
                }
            }
            if count == 0 {
                self.is_over = true;
                if let Some(piece) = self.splitter.finish() {
                    return Ok(self.next_from(piece));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{drain, jpeg};
    use super::*;

    /// Pieces of a stream that comes `step` bytes at a time.
    fn split(stream: &[u8], step: usize) -> Vec<Piece> {
        let mut splitter = Splitter::default();
        let mut pieces = Vec::new();
        for bytes in stream.chunks(step) {
            splitter.push(bytes);
            pieces.extend(std::iter::from_fn(|| splitter.next_piece()));
        }
        pieces.extend(splitter.finish());
        pieces
    }

    #[test]
    fn pictures_are_split_whatever_stands_between_and_however_they_come() {
        let (one, two) = (jpeg(30, 20), jpeg(50, 40));
        // A whole picture as a thumbnail in a segment of its own ends nothing.
        let mut with_thumbnail = one[..2].to_vec();
        let length = u16::try_from(two.len() + 2).unwrap().to_be_bytes();
        with_thumbnail.extend([0xFF, 0xE1, length[0], length[1]]);
        with_thumbnail.extend(&two);
        with_thumbnail.extend(&one[2..]);

        let mut stream = b"rubbish\xFF".to_vec();
        stream.extend(&one);
        stream.extend(b"\r\n--frame\r\nContent-Type: image/jpeg\r\n\r\n");
        stream.extend(&with_thumbnail);
        stream.extend(&two[..two.len() - 30]);
        stream.extend(&two);
        stream.extend(&one[..one.len() / 2]);
        let expected = [
            Piece::Skipped(8),
            Piece::Picture(one.clone()),
            Piece::Picture(with_thumbnail),
            Piece::Cut(two.len() as u64 - 30),
            Piece::Picture(two),
            Piece::Cut(one.len() as u64 / 2),
        ];
        for step in [1, 2, 3, 7, 1000, stream.len()] {
            assert_eq!(split(&stream, step), expected, "{step} bytes at a time");
        }
    }

    #[test]
    fn a_picture_that_is_cut_in_a_segment_costs_no_other() {
        let (one, two) = (jpeg(30, 20), jpeg(50, 40));
        // Cut within the quantisation tables: what the segment's length skips is the next picture's beginning.
        let mut stream = one[..60].to_vec();
        stream.extend(&two);
        stream.extend(&one);
        for step in [1, 100, stream.len()] {
            let pieces = split(&stream, step);
            let whole: Vec<&Piece> =
                pieces.iter().filter(|piece| matches!(piece, Piece::Picture(_))).collect();
            assert_eq!(whole, [&Piece::Picture(two.clone()), &Piece::Picture(one.clone())]);
        }
    }

    #[test]
    fn pictures_without_their_huffman_tables_are_decoded() {
        let whole = jpeg(40, 24);
        let mut bare = whole[..2].to_vec();
        let mut position = 2;
        while whole[position + 1] != marker::SCAN {
            let length =
                usize::from(u16::from_be_bytes([whole[position + 2], whole[position + 3]]));
            if whole[position + 1] != marker::HUFFMAN_TABLES {
                bare.extend(&whole[position..position + 2 + length]);
            }
            position += 2 + length;
        }
        bare.extend(&whole[position..]);
        assert!(bare.len() < whole.len());
        let options = SourceOptions::default();
        let (frames, troubles) = drain(MjpegStream::new(bare.as_slice(), options)).unwrap();
        assert_eq!((frames.len(), troubles.len()), (1, 0), "{troubles:?}");
        let expected = Picture::decode(&whole).unwrap().to_gray();
        assert_eq!(frames[0].gray, expected);
    }

    #[test]
    fn rubbish_is_bounded_in_memory_and_told_and_without_a_picture_it_ends() {
        let mut splitter = Splitter::default();
        let rubbish: Vec<u8> = (0..=250).cycle().take(READ_BYTES).collect();
        let mut told = 0;
        for _ in 0..64 {
            splitter.push(&rubbish);
            while let Some(piece) = splitter.next_piece() {
                let Piece::Skipped(bytes) = piece else { panic!("{piece:?}") };
                told += bytes;
            }
            assert!(splitter.buffer.len() <= READ_BYTES + HEAD_BYTES_MAX);
        }
        assert!(told >= 3 << 20, "{told}");
        let source = MjpegStream::new(std::io::repeat(0x55), SourceOptions::default());
        assert!(matches!(drain(source).unwrap_err(), VideoError::NoVideo { .. }));
        // One start, and then no end.
        let endless = START.as_slice().chain([0xDA, 0, 2].as_slice()).chain(std::io::repeat(0x55));
        let source = MjpegStream::new(endless, SourceOptions::default());
        assert!(matches!(drain(source).unwrap_err(), VideoError::NoVideo { .. }));
    }
}
