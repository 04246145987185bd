//! A line behind a TCP server: a virtual robot, or a serial port that a server passes on.

use std::io::{ErrorKind, Read, Write};
use std::net::{IpAddr, TcpStream, ToSocketAddrs};
use std::time::Duration;

use crate::Error;
use crate::link::{Connect, Link, RealClock};

/// How long a server may take to accept, and a write may take to go out.
const CONNECT_TIME: Duration = Duration::from_secs(3);
const WRITE_TIME: Duration = Duration::from_secs(1);

/// Opens a line behind a TCP server.
#[derive(Clone, Debug)]
pub struct TcpConnector {
    target: String,
}

impl TcpConnector {
    /// `target` is `HOST:PORT`.
    pub fn new(target: impl Into<String>) -> TcpConnector {
        TcpConnector { target: target.into() }
    }
}

impl Connect for TcpConnector {
    fn name(&self) -> String {
        format!("tcp://{}", self.target)
    }

    fn lock_key(&self) -> Option<String> {
        Some(lock_key(&self.target))
    }

    fn connect(&mut self, clock: RealClock) -> Result<Box<dyn Link>, Error> {
        let name = self.name();
        let opening = |source| Error::LinkOpen { link: name.clone(), source };
        let mut last = std::io::Error::new(ErrorKind::NotFound, "the host has no address");
        for address in self.target.to_socket_addrs().map_err(opening)? {
            match TcpStream::connect_timeout(&address, CONNECT_TIME) {
                Ok(stream) => {
                    stream.set_nodelay(true).map_err(opening)?;
                    stream.set_write_timeout(Some(WRITE_TIME)).map_err(opening)?;
                    return Ok(Box::new(TcpLink { name, stream, clock }));
                }
                Err(error) => last = error,
            }
        }
        Err(opening(last))
    }
}

/// What stands for the line behind `target` in the locks: this machine is the same by all its names.
fn lock_key(target: &str) -> String {
    let (host, port) = target.rsplit_once(':').unwrap_or((target, ""));
    let host = host.trim_matches(['[', ']']).to_ascii_lowercase();
    let is_loopback =
        host == "localhost" || host.parse::<IpAddr>().is_ok_and(|address| address.is_loopback());
    if is_loopback { format!("tcp://localhost:{port}") } else { format!("tcp://{host}:{port}") }
}

struct TcpLink {
    name: String,
    stream: TcpStream,
    clock: RealClock,
}

impl TcpLink {
    fn lost(&self, why: &dyn std::fmt::Display) -> Error {
        Error::LinkLost { link: self.name.clone(), why: why.to_string() }
    }
}

impl Link for TcpLink {
    fn now_ms(&self) -> u64 {
        self.clock.now_ms()
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Error> {
        self.stream.write_all(bytes).map_err(|error| self.lost(&error))
    }

    fn receive(&mut self, buffer: &mut [u8], until_ms: u64) -> Result<usize, Error> {
        let left = self.clock.left(until_ms);
        self.stream.set_read_timeout(Some(left)).map_err(|error| self.lost(&error))?;
        match self.stream.read(buffer) {
            Ok(0) => Err(self.lost(&"the other end closed the connection")),
            Ok(count) => Ok(count),
            Err(error) if is_no_bytes_yet(error.kind()) => Ok(0),
            Err(error) => Err(self.lost(&error)),
        }
    }

    fn flush_input(&mut self) -> Result<(), Error> {
        let mut rubbish = [0; 256];
        // Bounded, so that a peer that sends without end cannot hold it.
        for _ in 0..64 {
            if self.receive(&mut rubbish, 0)? < rubbish.len() {
                break;
            }
        }
        Ok(())
    }
}

/// Whether a read ended because its time was up, as against an error.
pub(crate) fn is_no_bytes_yet(kind: ErrorKind) -> bool {
    matches!(kind, ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_of_this_machine_is_the_same_line() {
        for target in ["localhost:7000", "LocalHost:7000", "127.0.0.1:7000", "[::1]:7000"] {
            assert_eq!(lock_key(target), "tcp://localhost:7000", "{target}");
        }
        for target in ["localhost:7001", "robot:7000", "10.0.0.1:7000"] {
            assert_eq!(lock_key(target), format!("tcp://{target}"));
        }
    }
}
