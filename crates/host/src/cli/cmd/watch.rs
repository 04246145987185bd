//! `rsapien watch`: the ellipses in pictures that keep coming.

mod looker;
mod outputs;
mod source;
mod teller;

use std::io::Write;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};
use rsapien_sim::server::socket_address;

use self::looker::{Looker, LookerOptions};
use self::outputs::{Line, Outputs};
use self::source::Place;
use self::teller::Teller;
use crate::cli::camera::HeadOptions;
use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::exit::Status;
use crate::cli::signal::Interrupt;
use crate::video::{
    Delivery, Frame, FrameServer, Incoming, Live, Meter, SourceOptions, StreamFormat,
};

/// Find and follow ellipses in a film, a camera or a stream, live
///
/// SOURCE is `-` (the standard input) or a file, each a Y4M or MJPEG film; a folder of pictures in the order of their
/// names; `http://HOST/PATH`, an MJPEG stream; `camera:/dev/video0`, a webcam (in builds with the feature webcam);
/// `virtual`, the virtual robot's camera; or `sim:SOCKET`, that of a simulator.
///
/// Frames are dropped rather than delayed: when a frame comes before the last one was looked at, the newest waits and
/// the others are dropped and counted. Of a folder, and with --every-frame, each is looked at.
///
/// Each frame looked at is one line: {"frame": its number in the source, "time_s": its time from the first one on, by
/// the film's rate or the clock, "width": w, "height": h, "ms": time of the detection, "delay_ms": from the complete
/// frame to the result, "ellipses": [[cx, cy, a, b, theta], ...], "scores": [...], "tracks": [{"id": n, "ellipse":
/// [...], "state": "tentative", "confirmed" or "predicted"}, ...]}; coordinates as of rsapien detect. With --mjpeg or --serve the lines are left out
/// unless --json asks for them.
///
/// Frame rates, delay, drops and everything wrong with the source are told on the standard error. A source that stalls
/// is waited for, rubbish is skipped and counted, a lost HTTP connection is made again. The exit status is 1 when no
/// frame showed an ellipse; Ctrl-C ends with 0.
#[allow(clippy::doc_markdown)] // --help shows it as it stands
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  ffmpeg -i film.mp4 -f yuv4mpegpipe - | rsapien watch - --every-frame
  ffmpeg -f v4l2 -i /dev/video0 -f mjpeg - | rsapien watch - --serve 8080
  rsapien watch http://camera.local:8080/video --mjpeg found.mjpeg
  rsapien watch photographs/ --no-tracks --min-axis 10 > ellipses.jsonl
  rsapien watch virtual --pan 40 --tilt -20 --frames 50")]
pub(crate) struct Cmd {
    /// Where frames come from
    #[arg(value_name = "SOURCE")]
    source: Place,

    /// How the bytes of `-` or a file are to be understood; told by the first of them by default
    #[arg(long, value_enum)]
    format: Option<FormatName>,

    /// Write the frames with the ellipses drawn as an MJPEG film; `-` is the standard output
    #[arg(long, value_name = "FILE")]
    mjpeg: Option<PathBuf>,

    /// Show the frames with the ellipses drawn to browsers, at http://HOST:PORT/; PORT alone is on this machine, 0 takes
    /// a free one
    #[arg(long, value_name = "HOST:PORT")]
    serve: Option<String>,

    /// Let --serve have an address that other machines reach; nobody is asked for a password there
    #[arg(long, requires = "serve")]
    allow_remote: bool,

    /// End after so many frames were looked at
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    frames: Option<u64>,

    /// Look at every frame, however late: the source waits where it can
    #[arg(long)]
    every_frame: bool,

    /// Frames a second, 0.01 to 1000: sets the time of a film's or folder's frames, and how often the virtual robot's
    /// camera is asked; 25 for these two by default
    #[arg(long, value_name = "RATE", value_parser = rate)]
    fps: Option<f64>,

    /// After so many milliseconds without a frame, say that the source stalls
    #[arg(long, value_name = "MS", default_value_t = 2000, value_parser = clap::value_parser!(u64).range(10..=3_600_000))]
    stall_ms: u64,

    /// Size of the pictures a webcam is asked for, in pixels
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "640x480", value_parser = size)]
    size: (u32, u32),

    #[command(flatten)]
    head: HeadOptions,

    #[command(flatten)]
    looker: LookerOptions,
}

/// Formats by name.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum FormatName {
    Y4m,
    Mjpeg,
}

impl From<FormatName> for StreamFormat {
    fn from(name: FormatName) -> Self {
        match name {
            FormatName::Y4m => Self::Y4m,
            FormatName::Mjpeg => Self::Mjpeg,
        }
    }
}

fn rate(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(rate) if (0.01..=1000.0).contains(&rate) => Ok(rate),
        _ => Err("expected 0.01 to 1000 frames a second".to_owned()),
    }
}

fn size(text: &str) -> std::result::Result<(u32, u32), String> {
    let wrong = || format!("expected a width and a height such as 640x480, not {text:?}");
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(wrong)?;
    let side = |text: &str| text.parse().ok().filter(|side| (1..=16_384).contains(side));
    side(width).zip(side(height)).ok_or_else(wrong)
}

/// How often it is seen whether the user wants the end.
const LOOK: Duration = Duration::from_millis(50);

impl Cmd {
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        let looker = self.looker.looker()?;
        let interrupt = Interrupt::install()?;
        let server = self.server()?;
        let mut teller = Teller::new(context.style.error, Duration::from_millis(self.stall_ms));
        if let Some(server) = &server {
            teller.say(&format!("showing the frames at http://{}/", server.address()));
        }
        let is_drawn = self.mjpeg.is_some() || server.is_some();
        let outputs = Outputs::new(context.style.json || !is_drawn, self.mjpeg.as_deref(), server)?;
        let options = SourceOptions { color: is_drawn, frame_rate: self.fps };
        let wanted = source::Wanted {
            format: self.format.map(StreamFormat::from),
            size_px: self.size,
            head: self.head,
            silence: Duration::from_millis(self.stall_ms).max(Duration::from_secs(10)),
            options,
        };
        let opened = self.source.open(context, &wanted)?;
        let delivery = if self.every_frame || !opened.source.is_live() {
            Delivery::Every
        } else {
            Delivery::Newest
        };
        let live = Live::start(opened.source, delivery);
        let mut watch = Watch { looker, outputs, meter: None, ellipses: 0, frames: 0 };
        let result = watch.run(&live, &mut teller, interrupt, self.frames, out);
        if let Some(meter) = &watch.meter {
            teller.finish(&meter.summary(Instant::now(), live.counts()));
        }
        result?;
        Ok(if watch.ellipses > 0 || interrupt.is_raised() { Status::Done } else { Status::Refused })
    }

    fn server(&self) -> Result<Option<FrameServer>> {
        let Some(text) = &self.serve else { return Ok(None) };
        let address = socket_address(text, self.allow_remote)?;
        let server = FrameServer::bind(address).map_err(|error| {
            Failure::new(format!("cannot listen at {address}: {error}"))
                .hint("is another program there? port 0 takes a free one")
        })?;
        Ok(Some(server))
    }
}

/// A run.
struct Watch {
    looker: Looker,
    outputs: Outputs,
    /// Runs from the first frame on.
    meter: Option<Meter>,
    ellipses: usize,
    frames: u64,
}

impl Watch {
    /// Looks at frames until there are no more or the user wants the end.
    fn run(
        &mut self,
        live: &Live,
        teller: &mut Teller,
        interrupt: Interrupt,
        frames_max: Option<u64>,
        out: &mut impl Write,
    ) -> Result<()> {
        while !interrupt.is_raised() && frames_max.is_none_or(|most| self.frames < most) {
            match live.next(LOOK)? {
                Incoming::Frame(frame) => {
                    teller.frame();
                    self.look_at(&frame, teller, out)?;
                }
                Incoming::Trouble(trouble) => teller.trouble(&trouble),
                Incoming::Nothing => {}
                Incoming::End => break,
            }
            teller.wait();
            if let Some(meter) = &mut self.meter
                && let Some(rates) = meter.rates(Instant::now(), live.counts())
            {
                teller.rates(&rates);
            }
        }
        Ok(())
    }

    fn look_at(&mut self, frame: &Frame, teller: &Teller, out: &mut impl Write) -> Result<()> {
        let look = self.looker.look(&frame.gray.view(), frame.time.as_secs_f64());
        let delay = frame.captured.elapsed();
        self.meter.get_or_insert_with(|| Meter::new(frame.captured)).looked(delay);
        self.frames += 1;
        self.ellipses += look.ellipses.len();
        let line = Line::new(frame, &look, delay);
        teller.beside(|| self.outputs.write(frame, &look, &line, out))
    }
}
