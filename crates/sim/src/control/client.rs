//! The asking end of the control channel.

use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::Duration;

use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::{ControlRequest, Subject};
use crate::camera::{CameraSettings, Picture};
use crate::robot::RobotReading;
use crate::world::World;

/// How long an answer may take.
const PATIENCE: Duration = Duration::from_secs(10);
/// The longest answer line that is read, in bytes.
const LINE_BYTES_MAX: u64 = 4 * 1024 * 1024;
/// The largest picture that is read, in bytes.
const PICTURE_BYTES_MAX: u64 = 64 * 1024 * 1024;

/// Why a request to the control channel failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ControlError {
    /// The simulator did not take the request.
    #[error("the simulator refused: {message}")]
    Refused {
        /// What it said.
        message: String,
    },
    /// The connection failed, or no answer came in ten seconds.
    #[error("the control channel of the simulator failed: {0}")]
    Io(#[from] io::Error),
    /// What came is no answer to the request.
    #[error("the control channel answered something else than asked for: {why}")]
    Answer {
        /// What is wrong with it.
        why: String,
    },
}

#[derive(Deserialize)]
struct Done {
    done_at_ms: u64,
}

#[derive(Deserialize)]
struct Truth {
    truth: Vec<Value>,
}

#[derive(Deserialize)]
struct PictureHeader {
    time_ms: u64,
    width: u32,
    height: u32,
    rgb_bytes: u64,
}

trait Stream: Read + Write + Send {}

impl<S: Read + Write + Send> Stream for S {}

/// A connection to the control channel of a simulator, one request at a time.
pub struct ControlClient {
    stream: BufReader<Box<dyn Stream>>,
}

impl ControlClient {
    /// Connects to a Unix socket, such as `LINK.control`.
    ///
    /// # Errors
    /// What the system says, such as that there is no socket.
    pub fn connect(path: impl AsRef<Path>) -> io::Result<Self> {
        let stream = UnixStream::connect(path)?;
        stream.set_read_timeout(Some(PATIENCE))?;
        stream.set_write_timeout(Some(PATIENCE))?;
        Ok(Self { stream: BufReader::new(Box::new(stream)) })
    }

    /// Connects to `HOST:PORT`.
    ///
    /// # Errors
    /// What the system says, such as that nobody listens there.
    pub fn connect_tcp(address: &str) -> io::Result<Self> {
        let stream = TcpStream::connect(address)?;
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(PATIENCE))?;
        stream.set_write_timeout(Some(PATIENCE))?;
        Ok(Self { stream: BufReader::new(Box::new(stream)) })
    }

    /// Sends a request that is no question, and returns the virtual time in ms at which it was done.
    ///
    /// # Errors
    /// [`ControlError`].
    pub fn request(&mut self, request: &ControlRequest) -> Result<u64, ControlError> {
        Ok(self.ask::<Done>(request)?.done_at_ms)
    }

    /// The truth about the robot.
    ///
    /// # Errors
    /// [`ControlError`].
    pub fn state(&mut self) -> Result<RobotReading, ControlError> {
        self.ask(&ControlRequest::Get { get: Subject::State })
    }

    /// What the camera sees, and the virtual time in ms of the moment.
    ///
    /// # Errors
    /// [`ControlError`].
    pub fn picture(&mut self) -> Result<(u64, Picture), ControlError> {
        let header: PictureHeader = self.ask(&ControlRequest::Get { get: Subject::Picture })?;
        let PictureHeader { time_ms, width, height, rgb_bytes } = header;
        let expected = u64::from(width) * u64::from(height) * 3;
        if rgb_bytes != expected || rgb_bytes > PICTURE_BYTES_MAX {
            let why = format!("a picture of {width}x{height} with {rgb_bytes} bytes");
            return Err(ControlError::Answer { why });
        }
        let mut rgb = Vec::new();
        let count = self.stream.by_ref().take(rgb_bytes).read_to_end(&mut rgb)?;
        if count as u64 != rgb_bytes {
            return Err(io::Error::from(io::ErrorKind::UnexpectedEof).into());
        }
        Ok((time_ms, Picture { width, height, rgb }))
    }

    /// The ellipses that the camera can see now, as [`VisibleEllipse`](crate::camera::VisibleEllipse) writes them.
    ///
    /// # Errors
    /// [`ControlError`].
    pub fn truth(&mut self) -> Result<Vec<Value>, ControlError> {
        Ok(self.ask::<Truth>(&ControlRequest::Get { get: Subject::Truth })?.truth)
    }

    /// The camera's settings, with its pinhole.
    ///
    /// # Errors
    /// [`ControlError`].
    pub fn camera(&mut self) -> Result<CameraSettings, ControlError> {
        self.ask(&ControlRequest::Get { get: Subject::Camera })
    }

    /// The world the robot stands in.
    ///
    /// # Errors
    /// [`ControlError`].
    pub fn world(&mut self) -> Result<World, ControlError> {
        self.ask(&ControlRequest::Get { get: Subject::World })
    }

    fn ask<T: DeserializeOwned>(&mut self, request: &ControlRequest) -> Result<T, ControlError> {
        let unreadable = |error: serde_json::Error| ControlError::Answer { why: error.to_string() };
        let mut line = serde_json::to_vec(request).map_err(unreadable)?;
        line.push(b'\n');
        self.stream.get_mut().write_all(&line)?;
        let mut answer = Vec::new();
        self.stream.by_ref().take(LINE_BYTES_MAX).read_until(b'\n', &mut answer)?;
        if answer.last() != Some(&b'\n') {
            return Err(io::Error::from(io::ErrorKind::UnexpectedEof).into());
        }
        let answer: Value = serde_json::from_slice(&answer).map_err(unreadable)?;
        if let Some(message) = answer.get("error").and_then(Value::as_str) {
            return Err(ControlError::Refused { message: message.to_owned() });
        }
        serde_json::from_value(answer).map_err(unreadable)
    }
}
