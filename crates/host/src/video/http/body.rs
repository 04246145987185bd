//! The answer to a request: its head, and its content piece by piece (RFC 9112).

use std::io::{BufRead, Error, ErrorKind, Read, Result as IoResult};

/// Longest line of a head, in bytes, and how many there may be.
const LINE_BYTES_MAX: u64 = 8192;
const LINES_MAX: usize = 100;

/// How the content's end is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Rest {
    /// The connection's end is its end.
    Open,
    /// So many bytes are to come.
    Bytes(u64),
    /// So many bytes of the chunk are to come, and more chunks behind it.
    Chunk(u64),
    /// A chunk's length is the next thing to come.
    NextChunk,
    Over,
}

/// The content of an answer.
#[derive(Debug)]
pub(super) struct Body<R> {
    reader: R,
    rest: Rest,
}

impl<R: BufRead> Body<R> {
    /// Reads the head. An answer that is no stream is refused with the reason.
    pub(super) fn open(mut reader: R) -> Result<Self, String> {
        let mut next = || {
            let line = line(&mut reader).map_err(|error| match error.kind() {
                ErrorKind::WouldBlock | ErrorKind::TimedOut => "no answer came".to_owned(),
                _ => error.to_string(),
            })?;
            line.ok_or_else(|| "the connection was closed before the answer's end".to_owned())
        };
        let status = next()?;
        let mut words = status.split_ascii_whitespace();
        let is_http = words.next().is_some_and(|version| version.starts_with("HTTP/1."));
        let code = words.next().and_then(|code| code.parse::<u16>().ok());
        let (true, Some(code)) = (is_http, code) else {
            return Err("what answers there does not speak HTTP/1".to_owned());
        };
        let (mut rest, mut kind, mut location) = (Rest::Open, String::new(), String::new());
        for count in 0.. {
            let line = next()?;
            if line.is_empty() {
                break;
            }
            if count == LINES_MAX {
                return Err(format!("the answer's head has more than {LINES_MAX} lines"));
            }
            let (name, value) = line.split_once(':').unwrap_or((line.as_str(), ""));
            let value = value.trim();
            match name.trim().to_ascii_lowercase().as_str() {
                "transfer-encoding" if value.to_ascii_lowercase().ends_with("chunked") => {
                    rest = Rest::NextChunk;
                }
                "content-length" if rest == Rest::Open => {
                    rest = value.parse().map_or(Rest::Open, Rest::Bytes);
                }
                "content-type" => kind = value.to_ascii_lowercase(),
                "location" => value.clone_into(&mut location),
                _ => {}
            }
        }
        check(code, &kind, &location)?;
        Ok(Self { reader, rest })
    }

    /// Reads the line that tells how long the next chunk is.
    fn next_chunk(&mut self) -> IoResult<()> {
        let broken = || Error::new(ErrorKind::InvalidData, "the answer's chunks are broken");
        let line = line(&mut self.reader)?.ok_or(ErrorKind::UnexpectedEof)?;
        let length = line.split(';').next().unwrap_or_default().trim();
        let length = u64::from_str_radix(length, 16).map_err(|_| broken())?;
        self.rest = if length == 0 { Rest::Over } else { Rest::Chunk(length) };
        Ok(())
    }
}

/// Refuses what is no stream.
fn check(code: u16, kind: &str, location: &str) -> Result<(), String> {
    match code {
        200 => {}
        401 | 403 => {
            return Err(format!("it asks for a password (status {code}), and none is sent"));
        }
        404 | 410 => return Err(format!("there is nothing at this path (status {code})")),
        300..=399 => {
            let place: String = location.chars().take(200).collect();
            return Err(format!("it stands elsewhere (status {code}): try {place}"));
        }
        _ => return Err(format!("the server answers with status {code}")),
    }
    if kind.starts_with("text/") {
        return Err("this is a page, not a stream: use the address of the picture in it".to_owned());
    }
    if kind.starts_with("image/") {
        return Err(format!("this is a single picture ({kind}), not a stream of them"));
    }
    Ok(())
}

/// A line without its end; none when the connection ended.
fn line(reader: &mut impl BufRead) -> IoResult<Option<String>> {
    let mut line = Vec::new();
    reader.by_ref().take(LINE_BYTES_MAX).read_until(b'\n', &mut line)?;
    if line.pop() != Some(b'\n') {
        if line.len() as u64 + 1 >= LINE_BYTES_MAX {
            return Err(Error::new(ErrorKind::InvalidData, "a line of the answer is too long"));
        }
        return Ok(None);
    }
    if line.last() == Some(&b'\r') {
        line.pop();
    }
    Ok(Some(String::from_utf8_lossy(&line).into_owned()))
}

impl<R: BufRead> Read for Body<R> {
    fn read(&mut self, buffer: &mut [u8]) -> IoResult<usize> {
        if self.rest == Rest::NextChunk {
            self.next_chunk()?;
        }
        let left = match self.rest {
            Rest::Open => return self.reader.read(buffer),
            Rest::Bytes(left) | Rest::Chunk(left) => left,
            Rest::NextChunk | Rest::Over => 0,
        };
        if left == 0 {
            return Ok(0);
        }
        let most = usize::try_from(left).map_or(buffer.len(), |left| left.min(buffer.len()));
        let count = self.reader.read(&mut buffer[..most])?;
        let left = left - count as u64;
        match &mut self.rest {
            Rest::Bytes(rest) => *rest = left,
            Rest::Chunk(rest) if left > 0 => *rest = left,
            Rest::Chunk(_) => {
                // A chunk ends with an empty line.
                line(&mut self.reader)?;
                self.rest = Rest::NextChunk;
            }
            Rest::Open | Rest::NextChunk | Rest::Over => {}
        }
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_ends_where_the_head_says() {
        for (answer, expected) in [
            ("HTTP/1.0 200 OK\r\n\r\nall of it", "all of it"),
            ("HTTP/1.1 200 OK\nContent-Length: 3\n\nall of it", "all"),
            (
                "HTTP/1.1 200\r\nTransfer-Encoding: chunked\r\nContent-Length: 1\r\n\r\n4;x=y\r\nall \r\n5\r\nof it\r\n0\r\n\r\n",
                "all of it",
            ),
        ] {
            let mut content = String::new();
            Body::open(answer.as_bytes()).unwrap().read_to_string(&mut content).unwrap();
            assert_eq!(content, expected);
        }
        let broken = "HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\nxyz\r\n";
        assert!(Body::open(broken.as_bytes()).unwrap().read(&mut [0; 9]).is_err());
    }

    #[test]
    fn what_is_no_stream_is_refused_with_the_reason() {
        let endless = format!("HTTP/1.1 200 OK\r\n{}", "a: b\r\n".repeat(200));
        let long = format!("HTTP/1.1 200 OK\r\n{}", "a".repeat(9000));
        for (answer, words) in [
            ("", "closed"),
            ("SSH-2.0-OpenSSH\r\n", "does not speak HTTP"),
            ("HTTP/1.1 401 Unauthorized\r\n\r\n", "password"),
            ("HTTP/1.1 302 Found\r\nLocation: http://b/\r\n\r\n", "try http://b/"),
            ("HTTP/1.1 200 OK\r\nContent-Type: text/html\r\n\r\n", "page"),
            ("HTTP/1.1 200 OK\r\nContent-Type: image/jpeg\r\n\r\n", "single picture"),
            (endless.as_str(), "100 lines"),
            (long.as_str(), "too long"),
        ] {
            let refused = Body::open(answer.as_bytes()).unwrap_err();
            assert!(refused.contains(words), "{answer}: {refused}");
        }
    }
}
