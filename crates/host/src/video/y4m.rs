//! Y4M, the uncompressed film that `ffmpeg -f yuv4mpegpipe` and mjpegtools write: a line of text, then for each picture
//! the word FRAME, a line's rest, and its planes. The plane of brightness is the grey picture as it stands.

use std::io::{BufRead, BufReader, Read};

use rsapien_vision::GrayImage;
use rsapien_vision::image::check_size;

use super::yuv::{ColorPlanes, Range};
use super::{
    BYTES_BEFORE_FIRST_MAX, FrameColor, FrameSource, Next, SourceOptions, Ticker, Trouble,
    VideoError,
};

/// What every film begins with.
pub(super) const MAGIC: &[u8] = b"YUV4MPEG2 ";
/// What every picture begins with; parameters may follow before the line ends.
const FRAME: [&[u8]; 2] = [b"FRAME\n", b"FRAME "];
/// Longest line of text that is read, in bytes.
const LINE_BYTES_MAX: u64 = 1024;
/// After so many bytes of rubbish a word is said, before more is looked at.
const SKIPPED_AT_ONCE: u64 = 1 << 20;

/// What the header says.
#[derive(Debug, Clone, PartialEq)]
struct Layout {
    width: usize,
    height: usize,
    /// Pixels across and down that share a colour; none without colours.
    shared: Option<(usize, usize)>,
    range: Range,
    /// Bytes of a picture's planes.
    frame_bytes: usize,
    /// Pictures a second, where it is known.
    frame_rate: Option<f64>,
}

impl Layout {
    /// Reads the header's line, without its end.
    fn parse(line: &str) -> Result<Self, VideoError> {
        let wrong = |problem: String| VideoError::Y4mHeader { problem };
        let (mut width, mut height, mut frame_rate) = (None, None, None);
        let (mut colors, mut range) = ("420", Range::Limited);
        for field in line.split_ascii_whitespace().skip(1) {
            let (key, value) = field.split_at_checked(1).unwrap_or_default();
            let side = || {
                let number = value.parse::<usize>();
                number.map_err(|_| wrong(format!("{field:?} is no number of pixels")))
            };
            match key {
                "W" => width = Some(side()?),
                "H" => height = Some(side()?),
                "F" => frame_rate = rate(value),
                "C" => colors = value,
                "X" if value.eq_ignore_ascii_case("COLORRANGE=FULL") => range = Range::Full,
                // Interlacing, the pixels' shape and remarks change nothing here.
                _ => {}
            }
        }
        let (Some(width), Some(height)) = (width, height) else {
            return Err(wrong("it gives no width (W) or no height (H)".to_owned()));
        };
        check_size(width, height)?;
        let (shared, alpha) = match colors {
            "mono" => (None, false),
            "420" | "420jpeg" | "420mpeg2" | "420paldv" => (Some((2, 2)), false),
            "410" => (Some((4, 4)), false),
            "411" => (Some((4, 1)), false),
            "422" => (Some((2, 1)), false),
            "440" => (Some((1, 2)), false),
            "444" => (Some((1, 1)), false),
            "444alpha" => (Some((1, 1)), true),
            _ => return Err(VideoError::Y4mColors { colors: colors.chars().take(40).collect() }),
        };
        let color_bytes =
            shared.map_or(0, |(across, down)| 2 * width.div_ceil(across) * height.div_ceil(down));
        // At most four times the largest picture.
        let frame_bytes = width * height * (1 + usize::from(alpha)) + color_bytes;
        Ok(Self { width, height, shared, range, frame_bytes, frame_rate })
    }
}

/// Pictures a second from a fraction such as `30000:1001`; 0:0 means unknown.
fn rate(text: &str) -> Option<f64> {
    let (above, below) = text.split_once(':')?;
    let (above, below) = (above.parse::<u32>().ok()?, below.parse::<u32>().ok()?);
    (above > 0 && below > 0).then(|| f64::from(above) / f64::from(below))
}

/// What stands at the reader's place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mark {
    /// A header: at the beginning, and again where films are put one behind the other.
    Header,
    /// A picture whose word has parameters behind it.
    FrameWithParameters,
    /// A picture's planes.
    Frame,
}

/// A Y4M film on a reader.
pub struct Y4mStream<R> {
    reader: BufReader<R>,
    options: SourceOptions,
    layout: Option<Layout>,
    ticker: Ticker,
    /// Read already, and still to be acted on.
    mark: Option<Mark>,
    planes: Vec<u8>,
    /// The beginning of a mark whose rest is still to be read.
    begun: Vec<u8>,
    /// Bytes skipped in all.
    skipped: u64,
    is_over: bool,
}

impl<R: Read + Send> Y4mStream<R> {
    /// A film whose header is the next thing to be read.
    pub fn new(reader: R, options: SourceOptions) -> Self {
        Self {
            reader: BufReader::with_capacity(1 << 16, reader),
            options,
            layout: None,
            ticker: Ticker::new(options.frame_rate),
            mark: None,
            planes: Vec::new(),
            begun: Vec::new(),
            skipped: 0,
            is_over: false,
        }
    }

    /// Goes to the next mark; gives it, none at the end, and how many bytes before it were none of the film's.
    fn find_mark(&mut self) -> Result<(Option<Mark>, u64), VideoError> {
        let marks =
            [(MAGIC, Mark::Header), (FRAME[0], Mark::Frame), (FRAME[1], Mark::FrameWithParameters)];
        let is_begun = |bytes: &[u8]| marks.iter().any(|(mark, _)| mark.starts_with(bytes));
        let mut skipped = 0;
        while skipped < SKIPPED_AT_ONCE {
            let Some(byte) = self.byte()? else {
                return Ok((None, skipped + std::mem::take(&mut self.begun).len() as u64));
            };
            self.begun.push(byte);
            if !is_begun(&self.begun) {
                // No mark begins inside itself or another, so that a mismatch starts over with the byte itself.
                skipped += self.begun.len() as u64;
                self.begun.clear();
                if is_begun(&[byte]) {
                    self.begun.push(byte);
                    skipped -= 1;
                }
            }
            if let Some((_, mark)) = marks.iter().find(|(mark, _)| *mark == self.begun.as_slice()) {
                self.begun.clear();
                return Ok((Some(*mark), skipped));
            }
        }
        Ok((None, skipped))
    }

    fn byte(&mut self) -> Result<Option<u8>, VideoError> {
        let byte = loop {
            match self.reader.fill_buf() {
                Ok(bytes) => break bytes.first().copied(),
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error.into()),
            }
        };
        match byte {
            Some(_) => self.reader.consume(1),
            None => self.is_over = true,
        }
        Ok(byte)
    }

    /// The rest of a line, without its end; none when it is longer than any should be or breaks off.
    fn line(&mut self) -> Result<Option<String>, VideoError> {
        let mut line = Vec::new();
        (&mut self.reader).take(LINE_BYTES_MAX).read_until(b'\n', &mut line)?;
        let is_whole = line.pop() == Some(b'\n');
        Ok(is_whole.then(|| String::from_utf8_lossy(&line).into_owned()))
    }

    fn header(&mut self) -> Result<(), VideoError> {
        let problem = "its line does not end";
        let line =
            self.line()?.ok_or_else(|| VideoError::Y4mHeader { problem: problem.to_owned() })?;
        let layout = Layout::parse(&format!("YUV4MPEG2 {line}"))?;
        if self.options.frame_rate.is_none() {
            // A film of unknown rate is timed as it comes.
            self.ticker.frame_rate = layout.frame_rate;
        }
        self.layout = Some(layout);
        Ok(())
    }

    /// Reads the planes of a picture.
    fn picture(&mut self) -> Result<Next, VideoError> {
        let Some(layout) = &self.layout else {
            return Err(VideoError::Y4mHeader { problem: "pictures come before it".to_owned() });
        };
        self.planes.clear();
        // Grows with what comes, so that a header alone takes no memory.
        let wanted = layout.frame_bytes;
        let read = (&mut self.reader).take(wanted as u64).read_to_end(&mut self.planes)?;
        if read < wanted {
            self.is_over = true;
            let why = format!("the film breaks off in it, after {read} of {wanted} bytes");
            return Ok(Next::Trouble(Trouble::BadPicture { name: None, why }));
        }
        let (width, height) = (layout.width, layout.height);
        let bright = self.planes.get(..width * height).unwrap_or_default().to_vec();
        let gray = GrayImage::new(bright, width, height)?;
        let color = layout.shared.filter(|_| self.options.color).map(|shared| {
            let bytes = self.planes.get(width * height..).unwrap_or_default().to_vec();
            FrameColor::Planes(ColorPlanes { shared, range: layout.range, bytes })
        });
        Ok(Next::Frame(Box::new(self.ticker.frame(gray, color))))
    }
}

impl<R: Read + Send> FrameSource for Y4mStream<R> {
    fn next_frame(&mut self) -> Result<Next, VideoError> {
        loop {
            if self.is_over {
                return Ok(Next::End);
            }
            let mark = if let Some(mark) = self.mark.take() {
                mark
            } else {
                let (mark, skipped) = self.find_mark()?;
                self.skipped += skipped;
                if self.layout.is_none() && self.skipped > BYTES_BEFORE_FIRST_MAX {
                    return Err(VideoError::NoVideo { bytes: self.skipped });
                }
                if skipped > 0 {
                    self.mark = mark;
                    return Ok(Next::Trouble(Trouble::Skipped { bytes: skipped }));
                }
                let Some(mark) = mark else { continue };
                mark
            };
            match mark {
                Mark::Header => self.header()?,
                Mark::Frame => return self.picture(),
                Mark::FrameWithParameters => {
                    if self.line()?.is_some() {
                        return self.picture();
                    }
                    return Ok(Next::Trouble(Trouble::Skipped { bytes: LINE_BYTES_MAX }));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::drain;
    use super::*;

    /// A film of `count` pictures whose brightness is their number and whose other planes are 200.
    fn film(colors: &str, width: usize, height: usize, other_bytes: usize, count: u8) -> Vec<u8> {
        let mut film =
            format!("YUV4MPEG2 W{width} H{height} F25:1 Ip A1:1 {colors}\n").into_bytes();
        for number in 0..count {
            film.extend(b"FRAME\n");
            film.resize(film.len() + width * height, number);
            film.resize(film.len() + other_bytes, 200);
        }
        film
    }

    #[test]
    fn every_kind_of_planes_is_read_at_odd_sizes() {
        for (colors, other_bytes) in [
            ("", 2 * 3 * 2),
            ("C420jpeg XYSCSS=420JPEG", 2 * 3 * 2),
            ("C420mpeg2", 2 * 3 * 2),
            ("C410", 2 * 2),
            ("C411", 2 * 2 * 3),
            ("C422", 2 * 3 * 3),
            ("C440", 2 * 5 * 2),
            ("C444", 2 * 15),
            ("C444alpha", 3 * 15),
            ("Cmono", 0),
        ] {
            for color in [false, true] {
                let film = film(colors, 5, 3, other_bytes, 3);
                let options = SourceOptions { color, ..SourceOptions::default() };
                let (frames, troubles) = drain(Y4mStream::new(film.as_slice(), options)).unwrap();
                assert_eq!((frames.len(), troubles.len()), (3, 0), "{colors}: {troubles:?}");
                for (number, frame) in (0..).zip(&frames) {
                    assert_eq!(frame.gray.pixels(), [number; 15], "{colors}");
                    assert_eq!(frame.color.is_some(), color && colors != "Cmono");
                    let picture = frame.picture();
                    let is_gray =
                        picture.rgb().as_chunks().0.iter().all(|[r, g, b]| r == g && g == b);
                    assert_eq!(is_gray, frame.color.is_none());
                }
                assert_eq!(frames[2].time.as_millis(), 80);
            }
        }
    }

    #[test]
    fn colours_go_where_their_pixels_are() {
        // 3 x 1 pixels of 4:2:2: the left two red, the right one blue.
        let film = b"YUV4MPEG2 W3 H1 C422\nFRAME\n\x51\x51\x29\x5a\xf0\xf0\x6e";
        let options = SourceOptions { color: true, ..SourceOptions::default() };
        let (frames, _) = drain(Y4mStream::new(film.as_slice(), options)).unwrap();
        let picture = frames[0].picture();
        let pixels: Vec<bool> = picture.rgb().iter().map(|&value| value > 128).collect();
        assert_eq!(pixels, [true, false, false, true, false, false, false, false, true]);
    }

    #[test]
    fn rubbish_and_films_behind_each_other_are_survived_and_a_cut_end_is_told() {
        let mut mixed = film("Cmono", 4, 4, 0, 2);
        mixed.extend(b"no FRAM of the film FRAMEd");
        let second = film("Cmono", 6, 2, 0, 2);
        mixed.extend(&second[..second.len() - 5]);
        let source = Y4mStream::new(mixed.as_slice(), SourceOptions::default());
        let (frames, troubles) = drain(source).unwrap();
        let widths: Vec<usize> = frames.iter().map(|frame| frame.gray.width()).collect();
        assert_eq!(widths, [4, 4, 6]);
        assert_eq!(troubles.len(), 2, "{troubles:?}");
        assert_eq!(troubles[0], Trouble::Skipped { bytes: 26 });
        assert!(troubles[1].to_string().contains("after 7 of 12 bytes"), "{troubles:?}");
    }

    #[test]
    fn headers_that_cannot_be_are_refused_with_the_reason() {
        for (header, words) in [
            ("YUV4MPEG2 W4 F25:1\n", "no width (W) or no height (H)"),
            ("YUV4MPEG2 W4 H-4\n", "\"H-4\" is no number"),
            ("YUV4MPEG2 W0 H4\n", "empty"),
            ("YUV4MPEG2 W99999 H99999\n", "too large: 99999 x 99999"),
            ("YUV4MPEG2 W18446744073709551615 H18446744073709551615\n", "too large"),
            ("YUV4MPEG2 W4 H4 C420p10\n", "-pix_fmt yuv420p"),
            ("YUV4MPEG2 W4 H4 and no end", "does not end"),
            ("FRAME\n", "pictures come before it"),
        ] {
            let source = Y4mStream::new(header.as_bytes(), SourceOptions::default());
            let error = drain(source).unwrap_err().to_string();
            assert!(error.contains(words), "{header}: {error}");
        }
        let rubbish = Y4mStream::new(std::io::repeat(b'F'), SourceOptions::default());
        assert!(matches!(drain(rubbish).unwrap_err(), VideoError::NoVideo { .. }));
    }
}
