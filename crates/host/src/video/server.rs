//! Pictures for browsers: `multipart/x-mixed-replace` over HTTP, to several viewers, none of whom anybody waits for.

use std::io::{BufRead, BufReader, Read, Result as IoResult, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

/// Viewers at one time; others are told to come later.
const VIEWERS_MAX: usize = 16;
/// Longest request that is read, in bytes.
const REQUEST_BYTES_MAX: u64 = 8192;
/// For so long a viewer may say or take nothing before it is left.
const PATIENCE: Duration = Duration::from_secs(5);
/// A wait after a connection that could not be accepted.
const ACCEPT_AGAIN: Duration = Duration::from_millis(100);

#[derive(Default)]
struct State {
    picture: Option<Arc<Vec<u8>>>,
    /// Counts the pictures.
    number: u64,
    viewers: usize,
    is_closed: bool,
}

#[derive(Default)]
struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for a picture that is not number `seen`; none when there will be no more.
    fn next(&self, seen: u64) -> Option<(Arc<Vec<u8>>, u64)> {
        let mut state = self.lock();
        loop {
            if state.is_closed {
                return None;
            }
            match &state.picture {
                Some(picture) if state.number != seen => {
                    return Some((Arc::clone(picture), state.number));
                }
                _ => {}
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

/// Shows JPEG pictures at `/`. Each viewer gets the newest when it has taken the one before; a slow one loses pictures.
pub struct FrameServer {
    shared: Arc<Shared>,
    address: SocketAddr,
}

impl FrameServer {
    /// Listens at `address`; port 0 takes a free one. Nobody is asked for a password.
    ///
    /// # Errors
    /// What the system says when it cannot listen there.
    pub fn bind(address: SocketAddr) -> IoResult<Self> {
        let listener = TcpListener::bind(address)?;
        let address = listener.local_addr()?;
        let shared = Arc::new(Shared::default());
        let for_thread = Arc::clone(&shared);
        thread::Builder::new().name("viewers".to_owned()).spawn(move || {
            for stream in listener.incoming() {
                if for_thread.lock().is_closed {
                    return;
                }
                match stream {
                    Ok(stream) => welcome(&for_thread, stream),
                    // Such as too many open files: it passes.
                    Err(_) => thread::sleep(ACCEPT_AGAIN),
                }
            }
        })?;
        Ok(Self { shared, address })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// How many watch. Without any, no picture needs to be made.
    pub fn viewers(&self) -> usize {
        self.shared.lock().viewers
    }

    /// Shows the next picture, the content of a JPEG file.
    pub fn show(&self, jpeg: Vec<u8>) {
        let mut state = self.shared.lock();
        state.picture = Some(Arc::new(jpeg));
        state.number += 1;
        drop(state);
        self.shared.changed.notify_all();
    }
}

impl Drop for FrameServer {
    fn drop(&mut self) {
        self.shared.lock().is_closed = true;
        self.shared.changed.notify_all();
        // Wakes the listening thread.
        let _ = TcpStream::connect_timeout(&self.address, ACCEPT_AGAIN);
    }
}

/// Gives a viewer a thread of its own.
fn welcome(shared: &Arc<Shared>, mut stream: TcpStream) {
    let mut state = shared.lock();
    if state.viewers >= VIEWERS_MAX {
        drop(state);
        let _ = stream.set_write_timeout(Some(ACCEPT_AGAIN));
        let _ = refuse(&mut stream, "503 Service Unavailable", "there are viewers enough");
        return;
    }
    state.viewers += 1;
    drop(state);
    let viewer = Viewer(Arc::clone(shared));
    // A thread that cannot be made drops its viewer.
    let _ = thread::Builder::new().name("viewer".to_owned()).spawn(move || {
        // A viewer that goes away is none of our troubles.
        let _ = viewer.serve(stream);
    });
}

/// One of the viewers counted.
struct Viewer(Arc<Shared>);

impl Viewer {
    fn serve(&self, mut stream: TcpStream) -> IoResult<()> {
        stream.set_read_timeout(Some(PATIENCE))?;
        stream.set_write_timeout(Some(PATIENCE))?;
        stream.set_nodelay(true)?;
        let mut reader = BufReader::new((&stream).take(REQUEST_BYTES_MAX));
        let mut request = String::new();
        reader.read_line(&mut request)?;
        // The head is read to its end, so that closing does not cut off the answer.
        let mut line = String::new();
        while reader.read_line(&mut line)? > 0 && !line.trim_end().is_empty() {
            line.clear();
        }
        let mut words = request.split_ascii_whitespace();
        if words.next() != Some("GET") {
            return refuse(&mut stream, "405 Method Not Allowed", "only GET is answered");
        }
        if words.next().and_then(|path| path.split('?').next()) != Some("/") {
            return refuse(&mut stream, "404 Not Found", "the pictures are at /");
        }
        stream.write_all(
            b"HTTP/1.1 200 OK\r\nContent-Type: multipart/x-mixed-replace; boundary=frame\r\nCache-Control: \
              no-store\r\nConnection: close\r\n\r\n--frame\r\n",
        )?;
        let mut seen = 0;
        while let Some((picture, number)) = self.0.next(seen) {
            seen = number;
            let length = picture.len();
            write!(stream, "Content-Type: image/jpeg\r\nContent-Length: {length}\r\n\r\n")?;
            stream.write_all(&picture)?;
            // Browsers show a picture when they see the boundary behind it.
            stream.write_all(b"\r\n--frame\r\n")?;
        }
        Ok(())
    }
}

impl Drop for Viewer {
    fn drop(&mut self) {
        self.0.lock().viewers -= 1;
    }
}

fn refuse(stream: &mut TcpStream, status: &str, why: &str) -> IoResult<()> {
    let length = why.len() + 1;
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: text/plain\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n{why}\n"
    )
}

#[cfg(test)]
mod tests {
    use super::super::tests::jpeg;
    use super::super::{FrameSource, HttpOptions, HttpStream, Next, SourceOptions};
    use super::*;

    fn ask(address: SocketAddr, request: &str) -> String {
        let mut stream = TcpStream::connect(address).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        answer
    }

    #[test]
    fn viewers_see_the_newest_and_one_that_takes_nothing_holds_up_nobody() {
        let server = FrameServer::bind("127.0.0.1:0".parse().unwrap()).unwrap();
        let address = server.address();
        assert!(ask(address, "GET /other HTTP/1.1\r\n\r\n").starts_with("HTTP/1.1 404"));
        assert!(ask(address, "POST / HTTP/1.1\r\n\r\n").starts_with("HTTP/1.1 405"));

        let mut lazy = TcpStream::connect(address).unwrap();
        lazy.write_all(b"GET / HTTP/1.1\r\n\r\n").unwrap();
        let large = jpeg(1200, 900);
        // More than the system keeps for a connection.
        for _ in 0..200 {
            server.show(large.clone());
        }
        let stream = format!("http://{address}/").parse().unwrap();
        let mut viewer = HttpStream::new(stream, HttpOptions::default(), SourceOptions::default());
        for width in [20, 40] {
            server.show(jpeg(width, 8));
            let Next::Frame(frame) = viewer.next_frame().unwrap() else { panic!("a frame") };
            assert_eq!(frame.gray.width(), width);
        }
        assert_eq!(server.viewers(), 2);
        drop(server);
        let Next::Trouble(closed) = viewer.next_frame().unwrap() else { panic!("an end") };
        assert!(closed.to_string().contains("closed"), "{closed}");
    }
}
