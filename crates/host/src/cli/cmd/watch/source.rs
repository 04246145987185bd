//! Where frames come from, as it is written, and its opening.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Duration;

use crate::LinkAddress;
use crate::cli::camera::{Camera, HeadOptions, Source};
use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::output::Style;
use crate::cli::robot::{self, OpenRobot, PaceOptions};
use crate::video::{
    Folder, FrameSource, HttpAddress, HttpOptions, HttpStream, SourceOptions, StreamFormat, Taken,
    VideoError, open_stream,
};

/// How often a camera is asked, in pictures a second: the rate of the paper's video stream.
const RATE_HZ: f64 = 25.0;

/// A source as it is written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Place {
    Input,
    Path(PathBuf),
    Http(HttpAddress),
    Webcam(PathBuf),
    /// The virtual robot's or a simulator's camera.
    Camera(Source),
}

impl FromStr for Place {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        match text {
            "" => {
                Err("expected -, a file, a folder, http://…, camera:DEVICE, virtual or sim:SOCKET"
                    .to_owned())
            }
            "-" => Ok(Self::Input),
            "auto" | "virtual" => Ok(Self::Camera(text.parse()?)),
            _ if text.starts_with("sim:") => Ok(Self::Camera(text.parse()?)),
            _ if text.contains("://") => {
                text.parse().map(Self::Http).map_err(|error: VideoError| error.to_string())
            }
            _ => Ok(match text.strip_prefix("camera:") {
                Some("") => {
                    return Err(
                        "expected a device behind camera:, as in camera:/dev/video0".to_owned()
                    );
                }
                // A camera's number.
                Some(digits) if digits.bytes().all(|byte| byte.is_ascii_digit()) => {
                    Self::Webcam(format!("/dev/video{digits}").into())
                }
                Some(device) => Self::Webcam(device.into()),
                None => Self::Path(text.into()),
            }),
        }
    }
}

/// How a source is to be opened.
pub(super) struct Wanted {
    pub(super) format: Option<StreamFormat>,
    pub(super) size_px: (u32, u32),
    pub(super) head: HeadOptions,
    /// How long a connection may be silent before it counts as lost.
    pub(super) silence: Duration,
    pub(super) options: SourceOptions,
}

/// An open source, and the robot whose camera it is.
pub(super) struct Opened {
    pub(super) source: Box<dyn FrameSource>,
    /// Kept for as long as pictures are taken.
    _robot: Option<OpenRobot>,
}

impl Place {
    /// Opens the source.
    pub(super) fn open(self, context: &Context, wanted: &Wanted) -> Result<Opened> {
        if (wanted.head.pan.is_some() || wanted.head.tilt.is_some())
            && !matches!(self, Self::Camera(_))
        {
            return Err(Failure::new(
                "--pan and --tilt turn the robot's head, and this source is not its camera",
            )
            .hint("leave them away, or watch the robot's camera: rsapien watch virtual --pan 40"));
        }
        let options = wanted.options;
        let source: Box<dyn FrameSource> = match self {
            Self::Input => open_stream(Box::new(io::stdin()), wanted.format, options),
            Self::Path(path) if path.is_dir() => Box::new(Folder::open(&path, options)?),
            Self::Path(path) => {
                let file =
                    File::open(&path).map_err(|error| Failure::file("read", &path, &error))?;
                open_stream(Box::new(file), wanted.format, options)
            }
            Self::Http(address) => {
                let waits = HttpOptions { silence: wanted.silence, ..HttpOptions::default() };
                Box::new(HttpStream::new(address, waits, options))
            }
            Self::Webcam(device) => webcam(&device, wanted)?,
            Self::Camera(camera) => return robot_camera(camera, context, wanted),
        };
        Ok(Opened { source, _robot: None })
    }
}

#[cfg(all(feature = "webcam", target_os = "linux"))]
fn webcam(device: &Path, wanted: &Wanted) -> Result<Box<dyn FrameSource>> {
    Ok(Box::new(crate::video::Webcam::open(device, wanted.size_px, wanted.options)?))
}

#[cfg(not(all(feature = "webcam", target_os = "linux")))]
fn webcam(device: &Path, wanted: &Wanted) -> Result<Box<dyn FrameSource>> {
    let ((width, height), device) = (wanted.size_px, device.display());
    Err(Failure::new("this build reads no webcams").hint(format!(
        "on Linux, build it with the feature webcam: cargo install --path crates/host --features cli,webcam\n\
         or let ffmpeg read the camera: ffmpeg -f v4l2 -video_size {width}x{height} -i {device} -f mjpeg - | rsapien \
         watch -"
    )))
}

/// The camera of a robot, with its head turned first where that is asked for.
fn robot_camera(camera: Source, context: &Context, wanted: &Wanted) -> Result<Opened> {
    let link = match (&camera, &context.link) {
        (Source::Virtual, None) => LinkAddress::Virtual,
        _ => robot::address(context)?,
    };
    let camera = camera.resolve(&link)?;
    let head = wanted.head;
    let turns = head.pan.is_some() || head.tilt.is_some();
    let robot = if turns || camera == Source::Virtual {
        let open = robot::open_at(context, &link, "watch", PaceOptions::default())?;
        // The standard output is for what is found.
        let quiet = Context { style: Style { json: true, ..context.style }, ..context.clone() };
        let controller = open.ready_camera(&quiet, &mut io::sink())?;
        if turns {
            let now = controller.state().camera_report().map_or((0.0, 0.0), |report| {
                (f64::from(report.pan_centideg) / 100.0, f64::from(report.tilt_centideg) / 100.0)
            });
            let (pan, tilt) = (head.pan.unwrap_or(now.0), head.tilt.unwrap_or(now.1));
            open.done(controller.look(pan, tilt, 0))?;
        }
        Some(open)
    } else {
        None
    };
    let mut camera = Camera::open(camera, robot.as_ref().map(|open| &open.robot))?;
    let take = move || {
        camera.take().map_err(|failure| VideoError::Read(io::Error::other(failure.to_string())))
    };
    // The rate is the camera's, and its clock is the wall's.
    let rate_hz = wanted.options.frame_rate.unwrap_or(RATE_HZ);
    let options = SourceOptions { frame_rate: None, ..wanted.options };
    Ok(Opened { source: Box::new(Taken::new(take, rate_hz, options)), _robot: robot })
}

impl From<VideoError> for Failure {
    fn from(error: VideoError) -> Self {
        let failure = Self::from_error(&error);
        match &error {
            VideoError::Open { place, source } => {
                let failure = Self::file("open", Path::new(place), source);
                match source.kind() {
                    io::ErrorKind::NotFound => {
                        failure.hint("check the name; ls /dev/video* lists cameras")
                    }
                    io::ErrorKind::PermissionDenied => failure.hint(
                        "check who may use it with ls -l; cameras are often the group video's",
                    ),
                    _ => failure,
                }
            }
            VideoError::Http { .. } => failure.hint("does a browser on this machine show it?"),
            VideoError::Empty => failure.hint("does what makes the frames end with an error?"),
            _ => failure,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_are_read_as_they_are_written() {
        for (text, place) in [
            ("-", Place::Input),
            ("film.y4m", Place::Path("film.y4m".into())),
            ("camera:/dev/video2", Place::Webcam("/dev/video2".into())),
            ("camera:0", Place::Webcam("/dev/video0".into())),
            ("virtual", Place::Camera(Source::Virtual)),
            (
                "sim:/tmp/robot.control",
                Place::Camera(Source::Simulator("/tmp/robot.control".into())),
            ),
            ("http://cam/x", Place::Http("http://cam/x".parse().unwrap())),
        ] {
            assert_eq!(text.parse(), Ok(place));
        }
        for (text, words) in
            [("", "expected"), ("camera:", "/dev/video0"), ("rtsp://cam/", "ffmpeg")]
        {
            let refused = text.parse::<Place>().unwrap_err();
            assert!(refused.contains(words), "{text}: {refused}");
        }
    }
}
