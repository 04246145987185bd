//! Where what was found goes: lines of JSON, a film, browsers.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use rsapien_vision::{Picture, TrackState, draw};
use serde::Serialize;

use super::looker::{Followed, Look};
use crate::cli::cmd::detect::answer::numbers;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::output::json_line;
use crate::video::{Frame, FrameServer, encode_jpeg};

/// Colour of what is followed and not seen in the frame.
const PREDICTED_COLOR: draw::Color = [255, 160, 0];

/// Where the film goes.
enum Film {
    None,
    Standard,
    File { file: BufWriter<File>, path: PathBuf },
}

/// Everything that is written.
pub(super) struct Outputs {
    lines: bool,
    film: Film,
    server: Option<FrameServer>,
}

impl Outputs {
    /// Lines on the standard output, a film in `film_path` (`-` is the standard output), pictures for browsers.
    pub(super) fn new(
        lines: bool,
        film_path: Option<&Path>,
        server: Option<FrameServer>,
    ) -> Result<Self> {
        let film = match film_path {
            None => Film::None,
            Some(path) if path == Path::new("-") => {
                if lines {
                    return Err(Failure::new("--json and --mjpeg - both want the standard output")
                        .hint("write the film to a file: --mjpeg FILE"));
                }
                Film::Standard
            }
            Some(path) => {
                let created = File::create(path);
                let created = created.map_err(|error| Failure::file("write", path, &error))?;
                Film::File { file: BufWriter::new(created), path: path.to_owned() }
            }
        };
        Ok(Self { lines, film, server })
    }

    /// Writes what was found in a frame.
    pub(super) fn write(
        &mut self,
        frame: &Frame,
        look: &Look,
        line: &Line<'_>,
        out: &mut impl Write,
    ) -> Result<()> {
        if self.lines {
            json_line(out, line)?;
        }
        let is_watched = self.server.as_ref().is_some_and(|server| server.viewers() > 0);
        if matches!(self.film, Film::None) && !is_watched {
            return Ok(());
        }
        let mut picture = frame.picture();
        look.draw_on(&mut picture);
        let jpeg = encode_jpeg(&picture).map_err(|error| Failure::from_error(&error))?;
        match &mut self.film {
            Film::None => {}
            Film::Standard => {
                out.write_all(&jpeg)?;
                out.flush()?;
            }
            // Whole pictures, so that a player may follow the file.
            Film::File { file, path } => file
                .write_all(&jpeg)
                .and_then(|()| file.flush())
                .map_err(|error| Failure::file("write", path, &error))?,
        }
        if let Some(server) = &self.server {
            server.show(jpeg);
        }
        Ok(())
    }
}

impl Look {
    /// Draws those followed, but for those seen only once so far; without tracks all that are seen.
    fn draw_on(&self, picture: &mut Picture) {
        let Some(tracks) = &self.tracks else {
            return draw::annotate(picture, &self.ellipses);
        };
        let with_state = |state| tracks.iter().filter(move |track| track.state == state);
        for track in with_state(TrackState::Predicted) {
            draw::ellipse(picture, &track.ellipse, PREDICTED_COLOR);
            draw::cross(picture, &track.ellipse, PREDICTED_COLOR);
        }
        draw::annotate(picture, with_state(TrackState::Confirmed).map(|track| &track.ellipse));
    }
}

/// One line; the keys stay in this order.
#[derive(Serialize)]
pub(super) struct Line<'a> {
    frame: u64,
    time_s: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    image: Option<&'a str>,
    width: usize,
    height: usize,
    ms: f64,
    delay_ms: f64,
    ellipses: Vec<[f64; 5]>,
    scores: &'a [f64],
    #[serde(skip_serializing_if = "Option::is_none")]
    tracks: Option<Vec<TrackEntry>>,
}

#[derive(Serialize)]
struct TrackEntry {
    id: u64,
    ellipse: [f64; 5],
    state: &'static str,
}

impl<'a> Line<'a> {
    pub(super) fn new(frame: &'a Frame, look: &'a Look, delay: Duration) -> Self {
        let tracks = look.tracks.as_ref().map(|tracks| {
            let entry = |track: &Followed| TrackEntry {
                id: track.id,
                ellipse: numbers(&track.ellipse),
                state: word(track.state),
            };
            tracks.iter().map(entry).collect()
        });
        Self {
            frame: frame.number,
            time_s: frame.time.as_secs_f64(),
            image: frame.name.as_deref(),
            width: frame.gray.width(),
            height: frame.gray.height(),
            ms: milliseconds(look.took),
            delay_ms: milliseconds(delay),
            ellipses: look.ellipses.iter().map(numbers).collect(),
            scores: &look.scores,
            tracks,
        }
    }
}

/// How a track stands.
fn word(state: TrackState) -> &'static str {
    match state {
        TrackState::Tentative => "tentative",
        TrackState::Confirmed => "confirmed",
        TrackState::Predicted => "predicted",
    }
}

/// To a microsecond.
fn milliseconds(duration: Duration) -> f64 {
    (duration.as_secs_f64() * 1e6).round() / 1e3
}
