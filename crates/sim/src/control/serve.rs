//! The serving end of the control channel.

use std::fs;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::os::unix::fs::FileTypeExt;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use serde::Serialize;
use serde_json::json;

use super::{ControlRequest, Subject};
use crate::server::{SimulatorError, check_folder, wait_readable};
use crate::shared::SharedRobot;

/// The longest line of a request, in bytes.
const LINE_BYTES_MAX: usize = 16 * 1024;
/// Connections at a time; more wait.
const CLIENTS_MAX: usize = 16;
/// How long a read waits before the stop flag is looked at again.
const READ_TURN: Duration = Duration::from_millis(100);
/// How long an answer waits for a client that does not read.
const WRITE_PATIENCE: Duration = Duration::from_secs(2);

/// Serves on a Unix socket until `stop` is set, and removes it then.
pub(crate) fn serve_unix(
    path: PathBuf,
    robot: SharedRobot,
    stop: Arc<AtomicBool>,
) -> Result<JoinHandle<()>, SimulatorError> {
    check_folder(&path)?;
    if let Ok(found) = fs::symlink_metadata(&path) {
        if !found.file_type().is_socket() {
            return Err(SimulatorError::Taken { path, expected: "a control socket" });
        }
        if UnixStream::connect(&path).is_ok() {
            return Err(SimulatorError::InUse { path });
        }
        // A socket that nobody listens on was left behind; binding tells when it stays.
        let _ = fs::remove_file(&path);
    }
    let bound = UnixListener::bind(&path)
        .and_then(|listener| listener.set_nonblocking(true).map(|()| listener));
    let listener = bound.map_err(|source| {
        // The system's limit is about a hundred bytes, and it tells so in its own terms.
        let source = if source.kind() == ErrorKind::InvalidInput {
            io::Error::new(ErrorKind::InvalidInput, "the path is too long for a socket")
        } else {
            source
        };
        SimulatorError::Path { path: path.clone(), source }
    })?;
    Ok(thread::spawn(move || {
        serve(&robot, &stop, || {
            if !wait_readable(&listener)? {
                return Ok(None);
            }
            let (stream, _) = listener.accept()?;
            stream.set_nonblocking(false)?;
            stream.set_read_timeout(Some(READ_TURN))?;
            stream.set_write_timeout(Some(WRITE_PATIENCE))?;
            Ok(Some(stream))
        });
        // Gone already is as good.
        let _ = fs::remove_file(&path);
    }))
}

/// Serves on TCP until `stop` is set.
pub(crate) fn serve_tcp(
    listener: TcpListener,
    robot: SharedRobot,
    stop: Arc<AtomicBool>,
) -> JoinHandle<()> {
    thread::spawn(move || {
        serve(&robot, &stop, || {
            if !wait_readable(&listener)? {
                return Ok(None);
            }
            let (stream, _): (TcpStream, _) = listener.accept()?;
            stream.set_nonblocking(false)?;
            stream.set_nodelay(true)?;
            stream.set_read_timeout(Some(READ_TURN))?;
            stream.set_write_timeout(Some(WRITE_PATIENCE))?;
            Ok(Some(stream))
        });
    })
}

fn serve<S: Read + Write + Send + 'static>(
    robot: &SharedRobot,
    stop: &Arc<AtomicBool>,
    mut accept: impl FnMut() -> io::Result<Option<S>>,
) {
    let mut clients: Vec<JoinHandle<()>> = Vec::new();
    while !stop.load(Ordering::Relaxed) {
        clients.retain(|client| !client.is_finished());
        if clients.len() >= CLIENTS_MAX {
            thread::sleep(READ_TURN);
            continue;
        }
        match accept() {
            Ok(Some(stream)) => {
                let (robot, stop) = (robot.clone(), Arc::clone(stop));
                clients.push(thread::spawn(move || {
                    // A client that went away in the middle of an answer is gone, and that is all.
                    let _ = converse(stream, &robot, &stop);
                }));
            }
            Ok(None) => {}
            Err(_) => thread::sleep(Duration::from_millis(20)),
        }
    }
    for client in clients {
        // A client's thread that panicked has nothing left to clean up.
        let _ = client.join();
    }
}

fn converse(
    mut stream: impl Read + Write,
    robot: &SharedRobot,
    stop: &AtomicBool,
) -> io::Result<()> {
    let (mut line, mut buffer) = (Vec::new(), [0; 4096]);
    while !stop.load(Ordering::Relaxed) {
        let count = match stream.read(&mut buffer) {
            Ok(0) => return Ok(()),
            Ok(count) => count,
            Err(error) => match error.kind() {
                ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted => continue,
                _ => return Err(error),
            },
        };
        for byte in buffer.iter().take(count) {
            if *byte != b'\n' {
                line.push(*byte);
            } else if !line.trim_ascii().is_empty() {
                answer(&mut stream, &line, robot)?;
                line.clear();
            }
            if line.len() > LINE_BYTES_MAX {
                let error = format!("a request is longer than {LINE_BYTES_MAX} bytes");
                return write_line(&mut stream, &json!({ "error": error }));
            }
        }
    }
    Ok(())
}

fn write_line(stream: &mut impl Write, answer: &impl Serialize) -> io::Result<()> {
    let mut line = serde_json::to_vec(answer)?;
    line.push(b'\n');
    stream.write_all(&line)
}

fn answer(stream: &mut impl Write, line: &[u8], robot: &SharedRobot) -> io::Result<()> {
    let request = match ControlRequest::parse(line) {
        Ok(request) => request,
        Err(error) => return write_line(stream, &json!({ "error": error })),
    };
    let ControlRequest::Get { get } = request else {
        let mut robot = robot.lock();
        let applied = request.apply(&mut robot);
        let done_at_ms = robot.now_ms();
        drop(robot);
        return match applied {
            Ok(()) => write_line(stream, &json!({ "done_at_ms": done_at_ms })),
            Err(error) => write_line(stream, &json!({ "error": error.to_string() })),
        };
    };
    match get {
        Subject::State => write_line(stream, &robot.reading()),
        Subject::Truth => write_line(stream, &json!({ "truth": robot.ground_truth() })),
        Subject::Camera => {
            let settings = robot.lock().camera().settings().clone();
            write_line(stream, &settings)
        }
        Subject::World => {
            let world = robot.lock().world().clone();
            write_line(stream, &world)
        }
        Subject::Picture => {
            let (time_ms, view) = {
                let mut robot = robot.lock();
                (robot.now_ms(), robot.view())
            };
            let picture = view.picture();
            let header = json!({
                "time_ms": time_ms,
                "width": picture.width,
                "height": picture.height,
                "rgb_bytes": picture.rgb.len(),
            });
            write_line(stream, &header)?;
            stream.write_all(&picture.rgb)
        }
    }
}
