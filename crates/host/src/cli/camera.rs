//! Where pictures come from: `--camera`.

use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::PoisonError;

use clap::Args;
use rsapien_sim::camera::{CameraSettings, ContourKind, Intrinsics, VisibleEllipse};
use rsapien_sim::control::{ControlClient, ControlError};
use rsapien_sim::geometry::{Ellipse, RobotPose};
use rsapien_vision::Picture;
use serde_json::Value;

use super::diagnostics::{self, Failure, Result};
use crate::behaviour::Pinhole;
use crate::link::virtual_robot::SharedVirtualRobot;
use crate::{LinkAddress, Robot};

/// The option that names a camera.
#[derive(Debug, Clone, Args)]
pub(crate) struct CameraOptions {
    /// Where pictures come from: `auto` is the virtual robot's camera with --link virtual, and the simulator's with a
    /// link made by rsapien sim; `virtual`; `sim:SOCKET` a simulator's control socket; or a picture file, read anew
    /// each time, as a webcam program writes it
    #[arg(long, value_name = "SOURCE", default_value = "auto")]
    pub(crate) camera: Source,
}

/// Where the head is turned before a picture is taken.
#[derive(Debug, Clone, Copy, Default, Args)]
pub(crate) struct HeadOptions {
    /// Turn the head first: degrees to the right, -90 to 90
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = pan)]
    pub(crate) pan: Option<f64>,

    /// Turn the head first: degrees up, -45 to 45
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = tilt)]
    pub(crate) tilt: Option<f64>,
}

/// An angle of pan in degrees.
pub(crate) fn pan(text: &str) -> std::result::Result<f64, String> {
    degrees(text, 90.0)
}

/// An angle of tilt in degrees.
pub(crate) fn tilt(text: &str) -> std::result::Result<f64, String> {
    degrees(text, 45.0)
}

fn degrees(text: &str, limit: f64) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(degrees) if degrees.abs() <= limit => Ok(degrees),
        _ => Err(format!("expected -{limit} to {limit} degrees")),
    }
}

/// A source of pictures as it is written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Source {
    Auto,
    Virtual,
    File(PathBuf),
    Simulator(String),
}

impl FromStr for Source {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        match text {
            "" => Err("expected auto, virtual, sim:SOCKET or a file".to_owned()),
            "auto" => Ok(Self::Auto),
            "virtual" => Ok(Self::Virtual),
            _ => Ok(match text.strip_prefix("sim:") {
                Some("") => {
                    return Err(
                        "expected a socket behind sim:, as in sim:/tmp/robot.control".to_owned()
                    );
                }
                Some(socket) => Self::Simulator(socket.to_owned()),
                None => Self::File(text.into()),
            }),
        }
    }
}

impl Source {
    /// What `auto` means for a link.
    pub(crate) fn resolve(self, link: &LinkAddress) -> Result<Self> {
        if self != Self::Auto {
            return Ok(self);
        }
        match link {
            LinkAddress::Virtual => Ok(Self::Virtual),
            LinkAddress::Serial(path) if Path::new(&control_socket(path)).exists() => {
                Ok(Self::Simulator(control_socket(path)))
            }
            _ => Err(Failure::new(format!("no camera is known for the link {link}")).hint(
                "name one: --camera FILE (a picture that a webcam program writes) or --camera sim:SOCKET; \
                 --link virtual has a camera of its own",
            )),
        }
    }
}

/// How the control channel writes [`ContourKind::BallOutline`].
const BALL_KIND: &str = "ball_outline";

/// Where `rsapien sim --pty LINK` puts its control socket.
fn control_socket(link: &str) -> String {
    format!("{link}.control")
}

/// An open source of pictures.
pub(crate) enum Camera {
    Virtual(SharedVirtualRobot),
    File(PathBuf),
    Simulator(Box<ControlClient>),
}

/// What a simulator knows for certain about the moment.
pub(crate) struct Truth {
    /// Where the robot stands.
    pub(crate) pose: RobotPose,
    /// The outline of each ball that can be seen.
    pub(crate) balls: Vec<Ellipse>,
}

impl Camera {
    /// Opens a resolved source; `robot` is the one whose camera `virtual` is.
    pub(crate) fn open(source: Source, robot: Option<&Robot>) -> Result<Self> {
        match source {
            Source::File(path) => Ok(Self::File(path)),
            Source::Simulator(socket) => {
                let connected = if socket.contains('/') {
                    ControlClient::connect(&socket)
                } else {
                    ControlClient::connect_tcp(&socket)
                };
                let client = connected.map_err(|error| {
                    Failure::new(format!("no simulator answers at {socket}: {error}"))
                        .hint("start one: rsapien sim --pty /tmp/robot has its socket at /tmp/robot.control")
                })?;
                Ok(Self::Simulator(Box::new(client)))
            }
            Source::Virtual | Source::Auto => robot
                .and_then(Robot::virtual_robot)
                .map(Self::Virtual)
                .ok_or_else(|| {
                    Failure::new("--camera virtual is the camera of the virtual robot, and the link leads to another")
                        .hint("use --link virtual with it")
                }),
        }
    }

    /// Takes a picture.
    pub(crate) fn take(&mut self) -> Result<Picture> {
        let taken = match self {
            Self::File(path) => {
                return Picture::open(&*path).map_err(|error| diagnostics::picture(path, &error));
            }
            Self::Virtual(robot) => {
                let view = robot.lock().unwrap_or_else(PoisonError::into_inner).view();
                // Rendered while the robot goes on.
                view.picture()
            }
            Self::Simulator(client) => client.picture()?.1,
        };
        // Both sides are at most some thousand pixels.
        let (width, height) = (taken.width as usize, taken.height as usize);
        Picture::new(taken.rgb, width, height).map_err(|error| Failure::from_error(&error))
    }

    /// The camera's pinhole; of a file only the field of view across is known, and that from the user.
    pub(crate) fn pinhole(&mut self, field_of_view_deg: f64) -> Result<Pinhole> {
        let settings: CameraSettings = match self {
            Self::Virtual(robot) => {
                robot.lock().unwrap_or_else(PoisonError::into_inner).camera().settings().clone()
            }
            Self::Simulator(client) => client.camera()?,
            Self::File(_) => {
                let picture = self.take()?;
                let (width, height) = (picture.width(), picture.height());
                return Ok(Pinhole::with_field_of_view(width, height, field_of_view_deg));
            }
        };
        let Intrinsics { fx, fy, cx, cy, .. } = settings.intrinsics;
        Ok(Pinhole { focal_px: (fx, fy), center_px: (cx, cy) })
    }

    /// What the simulator knows about what the camera sees now; none where the camera is a file.
    pub(crate) fn truth(&mut self) -> Result<Option<Truth>> {
        let (pose, balls) = match self {
            Self::File(_) => return Ok(None),
            Self::Virtual(robot) => {
                let robot = robot.lock().unwrap_or_else(PoisonError::into_inner);
                let seen = robot.ground_truth().into_iter();
                let is_ball = |seen: &VisibleEllipse| seen.kind == ContourKind::BallOutline;
                (robot.pose(), seen.filter(is_ball).map(|seen| seen.ellipse).collect())
            }
            Self::Simulator(client) => {
                let pose = client.state()?.pose;
                let is_ball = |seen: &Value| seen["kind"] == BALL_KIND;
                let outline = |seen: Value| serde_json::from_value(seen).ok();
                (pose, client.truth()?.into_iter().filter(is_ball).filter_map(outline).collect())
            }
        };
        Ok(Some(Truth { pose, balls }))
    }
}

impl From<ControlError> for Failure {
    fn from(error: ControlError) -> Self {
        Self::from_error(&error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_are_read_as_they_are_written() {
        for (text, source) in [
            ("auto", Source::Auto),
            ("virtual", Source::Virtual),
            ("sim:/tmp/robot.control", Source::Simulator("/tmp/robot.control".into())),
            ("frame.png", Source::File("frame.png".into())),
        ] {
            assert_eq!(text.parse(), Ok(source));
        }
        assert!("".parse::<Source>().is_err() && "sim:".parse::<Source>().is_err());
    }

    #[test]
    fn auto_follows_the_link() {
        let auto = |link: LinkAddress| Source::Auto.resolve(&link);
        assert_eq!(auto(LinkAddress::Virtual).unwrap(), Source::Virtual);
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("robot").to_string_lossy().into_owned();
        assert!(auto(LinkAddress::Serial(link.clone())).is_err());
        std::fs::write(format!("{link}.control"), "").unwrap();
        let found = auto(LinkAddress::Serial(link.clone())).unwrap();
        assert_eq!(found, Source::Simulator(format!("{link}.control")));
        let message = auto(LinkAddress::Auto).unwrap_err().to_string();
        assert!(message.contains("no camera"), "{message}");
    }
}
