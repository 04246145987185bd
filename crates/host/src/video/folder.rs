//! The pictures of a folder, one after the other.

use std::cmp::Ordering;
use std::path::{Path, PathBuf};

use rsapien_vision::Picture;

use super::{FrameSource, Next, SourceOptions, Ticker, Trouble, VideoError};

/// Endings of the pictures looked for, in small letters.
const ENDINGS: [&str; 8] = ["png", "jpg", "jpeg", "bmp", "pgm", "ppm", "pnm", "pbm"];
/// The same in words.
const ENDINGS_IN_WORDS: &str = "png, jpg, jpeg, bmp, pgm, ppm, pnm or pbm";
/// Pictures a second that a folder stands for: the rate of the paper's video stream.
const FRAME_RATE: f64 = 25.0;

/// The pictures of a folder in the order of their names, numbers in them counted: `frame-9` comes before `frame-10`.
#[derive(Debug)]
pub struct Folder {
    paths: std::vec::IntoIter<PathBuf>,
    options: SourceOptions,
    ticker: Ticker,
}

impl Folder {
    /// Lists the folder; pictures are read when they are asked for. Without a frame rate it is a film of 25 pictures a
    /// second.
    ///
    /// # Errors
    /// [`VideoError::Open`] and [`VideoError::NoPictures`].
    pub fn open(folder: &Path, options: SourceOptions) -> Result<Self, VideoError> {
        let failed = |source| VideoError::Open { place: folder.display().to_string(), source };
        let mut paths = Vec::new();
        for entry in std::fs::read_dir(folder).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
            if ending.is_some_and(|ending| ENDINGS.contains(&ending.as_str())) && path.is_file() {
                paths.push(path);
            }
        }
        if paths.is_empty() {
            let folder = folder.display().to_string();
            return Err(VideoError::NoPictures { folder, endings: ENDINGS_IN_WORDS });
        }
        paths.sort_by(|a, b| natural(&name(a), &name(b)));
        let ticker = Ticker::new(options.frame_rate.or(Some(FRAME_RATE)));
        Ok(Self { paths: paths.into_iter(), options, ticker })
    }
}

impl FrameSource for Folder {
    fn next_frame(&mut self) -> Result<Next, VideoError> {
        let Some(path) = self.paths.next() else { return Ok(Next::End) };
        Ok(match Picture::open(&path) {
            Ok(picture) => {
                let mut frame = self.ticker.picture(picture, self.options.color);
                frame.name = Some(name(&path));
                Next::Frame(Box::new(frame))
            }
            Err(error) => Next::Trouble(Trouble::BadPicture {
                name: Some(name(&path)),
                why: error.to_string(),
            }),
        })
    }

    fn is_live(&self) -> bool {
        false
    }
}

fn name(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// Compares names with the numbers in them by value.
fn natural(a: &str, b: &str) -> Ordering {
    let (mut rest_a, mut rest_b) = (a, b);
    loop {
        let (digits_a, digits_b) = (digits(rest_a), digits(rest_b));
        let order = if digits_a > 0 && digits_b > 0 {
            let (number_a, number_b) = (&rest_a[..digits_a], &rest_b[..digits_b]);
            (rest_a, rest_b) = (&rest_a[digits_a..], &rest_b[digits_b..]);
            let (value_a, value_b) =
                (number_a.trim_start_matches('0'), number_b.trim_start_matches('0'));
            value_a.len().cmp(&value_b.len()).then_with(|| value_a.cmp(value_b))
        } else {
            let (mut chars_a, mut chars_b) = (rest_a.chars(), rest_b.chars());
            let pair = (chars_a.next(), chars_b.next());
            (rest_a, rest_b) = (chars_a.as_str(), chars_b.as_str());
            match pair {
                // Equal but for leading zeros.
                (None, None) => return a.cmp(b),
                (one, other) => one.cmp(&other),
            }
        };
        if order != Ordering::Equal {
            return order;
        }
    }
}

/// How many digits `text` begins with.
fn digits(text: &str) -> usize {
    text.bytes().take_while(u8::is_ascii_digit).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_come_by_number_and_a_broken_one_is_told() {
        let mut names = ["f10.png", "f9.png", "f009.png", "a.png", "f1b.png", "f.png"];
        names.sort_by(|a, b| natural(a, b));
        assert_eq!(names, ["a.png", "f.png", "f1b.png", "f009.png", "f9.png", "f10.png"]);

        let folder = tempfile::tempdir().unwrap();
        let picture = |width| Picture::new(vec![9; width * 3], width, 1).unwrap();
        picture(10).save_png(folder.path().join("shot10.PNG")).unwrap();
        picture(2).save_png(folder.path().join("shot2.png")).unwrap();
        std::fs::write(folder.path().join("shot3.jpg"), "no picture").unwrap();
        std::fs::write(folder.path().join("notes.txt"), "no picture").unwrap();
        let mut source = Folder::open(folder.path(), SourceOptions::default()).unwrap();
        let mut told = Vec::new();
        loop {
            told.push(match source.next_frame().unwrap() {
                Next::Frame(frame) => {
                    format!("{} {}", frame.gray.width(), frame.time.as_millis())
                }
                Next::Trouble(trouble) => trouble.to_string(),
                Next::End => break,
            });
        }
        assert_eq!((told.len(), told[0].as_str(), told[2].as_str()), (3, "2 0", "10 40"));
        assert!(told[1].starts_with("left out shot3.jpg: not a picture"), "{told:?}");

        let empty = tempfile::tempdir().unwrap();
        let refused = Folder::open(empty.path(), SourceOptions::default()).unwrap_err();
        assert!(matches!(refused, VideoError::NoPictures { .. }), "{refused}");
    }
}
