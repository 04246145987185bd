//! MJPEG over HTTP, as network cameras send it: `multipart/x-mixed-replace`, or JPEG pictures one behind the other.
//!
//! Plain HTTP/1.1 GET on a TCP connection, without encryption, passwords or redirections. The lengths that parts state
//! are not needed and not believed: a picture ends where its markers end.

mod body;

use std::fmt;
use std::io::{BufReader, ErrorKind, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::str::FromStr;
use std::thread;
use std::time::Duration;

use self::body::Body;
use super::{Frame, FrameSource, MjpegStream, Next, SourceOptions, Trouble, VideoError};

/// Where a stream is: `http://HOST[:PORT][/PATH]`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HttpAddress {
    /// Name or number of the host; a number of IPv6 stands in brackets.
    host: String,
    port: u16,
    /// Path and query, from the `/` on.
    path: String,
}

impl FromStr for HttpAddress {
    type Err = VideoError;

    fn from_str(text: &str) -> Result<Self, VideoError> {
        // What a user has put before an @ may be a password and is not repeated.
        let shown =
            text.rsplit_once('@').map_or_else(|| text.to_owned(), |(_, at)| format!("…@{at}"));
        let wrong = |problem| VideoError::Address { address: shown.clone(), problem };
        let rest = text.strip_prefix("http://").ok_or_else(|| {
            wrong("only http:// is read; for others let ffmpeg read it: ffmpeg -i ADDRESS -f mjpeg - | rsapien watch -")
        })?;
        if !rest.chars().all(|c| c.is_ascii_graphic()) {
            return Err(wrong("it holds characters that have to be written as %XX"));
        }
        let rest = rest.split('#').next().unwrap_or_default();
        let end = rest.find(['/', '?']).unwrap_or(rest.len());
        let (place, path) = rest.split_at(end);
        if place.contains('@') {
            return Err(wrong(
                "passwords are not sent; let ffmpeg read it, or open the stream without one",
            ));
        }
        // The colons of an IPv6 number stand before its bracket's end.
        let (host, port) = match place.rsplit_once(':') {
            Some((host, port)) if !port.contains(']') => {
                (host, port.parse().map_err(|_| wrong("its port is no number from 1 to 65535"))?)
            }
            _ => (place, 80),
        };
        if host.is_empty() || port == 0 {
            return Err(wrong("write http://HOST:PORT/PATH"));
        }
        let path = if path.starts_with('/') { path.to_owned() } else { format!("/{path}") };
        Ok(Self { host: host.to_owned(), port, path })
    }
}

impl fmt::Display for HttpAddress {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "http://{}:{}{}", self.host, self.port, self.path)
    }
}

/// How long an [`HttpStream`] waits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HttpOptions {
    /// For a connection.
    pub connect: Duration,
    /// For a byte, before the connection counts as lost.
    pub silence: Duration,
    /// Before the first try to connect again.
    pub retry_first: Duration,
    /// Before any other: each wait is twice the one before, up to this.
    pub retry_longest: Duration,
}

impl Default for HttpOptions {
    fn default() -> Self {
        Self {
            connect: Duration::from_secs(5),
            silence: Duration::from_secs(10),
            retry_first: Duration::from_millis(250),
            retry_longest: Duration::from_secs(5),
        }
    }
}

/// A stream over HTTP. When its first connection fails it ends with [`VideoError::Http`]; a connection lost later is
/// made again, as often as it takes.
pub struct HttpStream {
    address: HttpAddress,
    options: HttpOptions,
    source: SourceOptions,
    pictures: Option<MjpegStream<Body<BufReader<TcpStream>>>>,
    is_connected: bool,
    /// What is waited before the next try, and before the one behind it.
    wait: Option<Duration>,
    retry: Duration,
    /// Whether the loss of a connection was told, and its return was not.
    is_lost: bool,
    /// The first picture of a connection whose return is told first.
    held: Option<Box<Frame>>,
}

impl HttpStream {
    /// The stream at `address`; it is connected to when the first picture is asked for.
    pub fn new(address: HttpAddress, options: HttpOptions, source: SourceOptions) -> Self {
        Self {
            address,
            options,
            source,
            pictures: None,
            is_connected: false,
            wait: None,
            retry: options.retry_first,
            is_lost: false,
            held: None,
        }
    }

    fn connect(&self) -> Result<Body<BufReader<TcpStream>>, String> {
        let place = format!("{}:{}", self.address.host, self.address.port);
        let found = place.to_socket_addrs().map_err(|error| format!("unknown host: {error}"))?;
        let mut failure = "unknown host".to_owned();
        for address in found {
            let connected = TcpStream::connect_timeout(&address, self.options.connect)
                .and_then(|stream| self.ask(stream));
            match connected {
                Ok(stream) => return Body::open(BufReader::with_capacity(1 << 16, stream)),
                Err(error) => failure = error.to_string(),
            }
        }
        Err(failure)
    }

    /// Sends the request.
    fn ask(&self, mut stream: TcpStream) -> std::io::Result<TcpStream> {
        stream.set_read_timeout(Some(self.options.silence))?;
        stream.set_write_timeout(Some(self.options.silence))?;
        let HttpAddress { host, port, path } = &self.address;
        let request = format!(
            "GET {path} HTTP/1.1\r\nHost: {host}:{port}\r\nUser-Agent: rsapien/{}\r\nAccept: multipart/x-mixed-replace, \
             */*\r\nConnection: close\r\n\r\n",
            env!("CARGO_PKG_VERSION")
        );
        stream.write_all(request.as_bytes())?;
        Ok(stream)
    }

    fn lost(&mut self, why: String) -> Next {
        let retry = self.retry;
        self.retry = (retry * 2).min(self.options.retry_longest);
        (self.is_connected, self.is_lost, self.wait) = (false, true, Some(retry));
        Next::Trouble(Trouble::Lost { why, retry })
    }
}

impl FrameSource for HttpStream {
    fn next_frame(&mut self) -> Result<Next, VideoError> {
        if let Some(frame) = self.held.take() {
            return Ok(Next::Frame(frame));
        }
        if let Some(wait) = self.wait.take() {
            thread::sleep(wait);
        }
        if !self.is_connected {
            match (self.connect(), &mut self.pictures) {
                (Ok(body), Some(pictures)) => pictures.replace_reader(body),
                (Ok(body), none) => *none = Some(MjpegStream::new(body, self.source)),
                (Err(problem), Some(_)) => return Ok(self.lost(problem)),
                (Err(problem), None) => {
                    let address = self.address.to_string();
                    return Err(VideoError::Http { address, problem });
                }
            }
            self.is_connected = true;
        }
        let Some(pictures) = &mut self.pictures else { return Ok(Next::End) };
        match pictures.next_frame() {
            Ok(Next::Frame(frame)) => {
                self.retry = self.options.retry_first;
                if std::mem::take(&mut self.is_lost) {
                    self.held = Some(frame);
                    return Ok(Next::Trouble(Trouble::Back));
                }
                Ok(Next::Frame(frame))
            }
            Ok(Next::End) => Ok(self.lost("the other side closed the connection".to_owned())),
            Err(VideoError::Read(error)) => Ok(self.lost(match error.kind() {
                ErrorKind::WouldBlock | ErrorKind::TimedOut => {
                    format!("nothing came for {:.1} s", self.options.silence.as_secs_f64())
                }
                _ => format!("the connection is lost: {error}"),
            })),
            other => other,
        }
    }
}

#[cfg(test)]
mod tests;
