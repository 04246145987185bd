//! A serial port: 8N1, no flow control (`PROTOCOL`, section 1 of the specification).

use std::io::{self, Read, Write};
use std::path::Path;
use std::time::Duration;

use serialport::{ClearBuffer, DataBits, FlowControl, Parity, SerialPort, StopBits};

use crate::Error;
use crate::link::tcp::is_no_bytes_yet;
use crate::link::{Connect, Link, RealClock};

/// How long a write may take to go out: a package takes 3 ms, so a port that takes longer is stuck.
const WRITE_TIME: Duration = Duration::from_millis(500);

/// Opens a serial port.
#[derive(Clone, Debug)]
pub struct SerialConnector {
    path: String,
    baud: u32,
}

impl SerialConnector {
    /// The port at `path` at `baud` bit/s.
    pub fn new(path: impl Into<String>, baud: u32) -> SerialConnector {
        SerialConnector { path: path.into(), baud }
    }
}

impl Connect for SerialConnector {
    fn name(&self) -> String {
        self.path.clone()
    }

    fn lock_key(&self) -> Option<String> {
        Some(lock_key(&self.path))
    }

    fn connect(&mut self, clock: RealClock) -> Result<Box<dyn Link>, Error> {
        // Not exclusive: `stop` from another program has to get through. The lock files keep two
        // programs of this library off one line.
        let port = serialport::new(&self.path, self.baud)
            .data_bits(DataBits::Eight)
            .parity(Parity::None)
            .stop_bits(StopBits::One)
            .flow_control(FlowControl::None)
            .exclusive(false)
            .timeout(WRITE_TIME)
            .open()
            .map_err(|error| opening(&self.path, into_io(&self.path, error)))?;
        Ok(Box::new(SerialLink { name: self.path.clone(), port, clock }))
    }
}

/// What stands for the port at `path` in the locks: the device itself, whichever way it is named.
pub(crate) fn lock_key(path: &str) -> String {
    let device = std::fs::canonicalize(path);
    device.map_or_else(|_| path.to_owned(), |device| device.to_string_lossy().into_owned())
}

/// The error of opening `path`, told apart by what the system says.
pub(crate) fn opening(path: &str, source: io::Error) -> Error {
    let link = path.to_owned();
    match source.kind() {
        io::ErrorKind::NotFound => Error::LinkNotFound { link },
        io::ErrorKind::PermissionDenied => Error::PermissionDenied { link },
        _ => Error::LinkOpen { link, source },
    }
}

fn into_io(path: &str, error: serialport::Error) -> io::Error {
    let kind = match error.kind {
        serialport::ErrorKind::Io(kind) => kind,
        // "No device" also stands for one that cannot be locked or is no terminal.
        serialport::ErrorKind::NoDevice if !Path::new(path).exists() => io::ErrorKind::NotFound,
        serialport::ErrorKind::NoDevice | serialport::ErrorKind::Unknown => io::ErrorKind::Other,
        serialport::ErrorKind::InvalidInput => io::ErrorKind::InvalidInput,
    };
    // What systems say of a file that takes no line speed; they differ, and none helps.
    let is_no_terminal = ["Not a typewriter", "Inappropriate ioctl", "Not a tty"]
        .iter()
        .any(|words| error.description.contains(words));
    let description =
        if is_no_terminal { "it is not a serial port".to_owned() } else { error.description };
    io::Error::new(kind, description)
}

struct SerialLink {
    name: String,
    port: Box<dyn SerialPort>,
    clock: RealClock,
}

impl SerialLink {
    fn lost(&self, why: &dyn std::fmt::Display) -> Error {
        Error::LinkLost { link: self.name.clone(), why: why.to_string() }
    }
}

impl Link for SerialLink {
    fn now_ms(&self) -> u64 {
        self.clock.now_ms()
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Error> {
        self.port.set_timeout(WRITE_TIME).map_err(|error| self.lost(&error))?;
        self.port.write_all(bytes).map_err(|error| self.lost(&error))
    }

    fn receive(&mut self, buffer: &mut [u8], until_ms: u64) -> Result<usize, Error> {
        let left = self.clock.left(until_ms);
        self.port.set_timeout(left).map_err(|error| self.lost(&error))?;
        match self.port.read(buffer) {
            Ok(0) => Err(self.lost(&"the device is gone")),
            Ok(count) => Ok(count),
            Err(error) if is_no_bytes_yet(error.kind()) => Ok(0),
            Err(error) => Err(self.lost(&error)),
        }
    }

    fn flush_input(&mut self) -> Result<(), Error> {
        self.port.clear(ClearBuffer::Input).map_err(|error| self.lost(&error))
    }
}
