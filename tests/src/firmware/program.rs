//! The C core as a program of this machine: builds it, starts it, tells it events, reads its records.

use super::event::{Event, FLUSH};
use super::record::split_first;
use crate::workspace;
use rsapien_protocol::Address;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::OnceLock;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

/// The longest that a program may think about a chunk of events before it is called hung.
const PATIENCE: Duration = Duration::from_secs(20);
/// Events told before their records are read.
const CHUNK: usize = 4096;

/// Why there is nothing to compare with.
#[derive(Debug, thiserror::Error)]
pub enum ProgramError {
    /// The C core could not be built.
    #[error("the C core does not build by `{command}`: {why}")]
    Build {
        /// The command.
        command: String,
        /// What went wrong.
        why: String,
    },
    /// The program does not start.
    #[error("{} does not start: {source}", path.display())]
    Start {
        /// The program.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The program ended, by itself or by a fault.
    #[error("the program ended ({status}) after {records} records of this session: {tail}")]
    Ended {
        /// How it ended.
        status: String,
        /// Records it gave of the events last told.
        records: usize,
        /// The last lines on its standard error.
        tail: String,
    },
    /// The program does not answer.
    #[error("the program gave {records} records of this session, then nothing for {} s", PATIENCE.as_secs())]
    Hung {
        /// Records it gave of the events last told.
        records: usize,
    },
}

/// Which build of the C core.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Build {
    /// As fast as it goes.
    Plain,
    /// With the sanitizers for addresses and undefined behaviour: a fault ends the program.
    Sanitized,
}

/// Builds both forms of the C core for this machine, once in a process. Gives the folder of its programs.
///
/// # Errors
/// When `make` or the C compiler is missing or refuses.
pub fn build() -> Result<PathBuf, ProgramError> {
    static BUILT: OnceLock<Result<(), (String, String)>> = OnceLock::new();
    let root = workspace();
    let outcome = BUILT.get_or_init(|| {
        make(&root.join("firmware-pic/port/host"), &["all".to_owned(), "sanitized".to_owned()])
    });
    match outcome {
        Ok(()) => Ok(root.join("target/firmware/host")),
        Err((command, why)) => {
            Err(ProgramError::Build { command: command.clone(), why: why.clone() })
        }
    }
}

/// Runs `make` in a folder. Gives the command and what it complained of when it fails.
pub(super) fn make(folder: &Path, arguments: &[String]) -> Result<(), (String, String)> {
    let command = format!("make -C {} {}", folder.display(), arguments.join(" "));
    let output = Command::new("make").arg("-C").arg(folder).args(arguments).output();
    let output = output.map_err(|error| {
        (
            command.clone(),
            format!("{error}; is make installed? (apt-get install make gcc libc6-dev)"),
        )
    })?;
    if output.status.success() {
        return Ok(());
    }
    let told = String::from_utf8_lossy(&output.stderr);
    let mut why = last_lines(&told, 20);
    if told.contains("not found") {
        why.push_str("\nis a C compiler installed? (apt-get install gcc libc6-dev)");
    }
    Err((command, why))
}

/// The path of a controller's program.
pub fn path(folder: &Path, address: Address, build: Build) -> PathBuf {
    let ending = match build {
        Build::Plain => "",
        Build::Sanitized => "-sanitized",
    };
    folder.join(format!("rsapien-{}{ending}", address.name()))
}

/// A running controller.
#[derive(Debug)]
pub struct Program {
    child: Child,
    events: Option<ChildStdin>,
    records: Receiver<Vec<u8>>,
    complaints: Receiver<Vec<u8>>,
    address: Address,
}

impl Program {
    /// Starts the program of `address` at `path`.
    ///
    /// # Errors
    /// When it does not start.
    pub fn start(path: &Path, address: Address) -> Result<Program, ProgramError> {
        let mut child = Command::new(path)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|source| ProgramError::Start { path: path.to_owned(), source })?;
        let events = child.stdin.take();
        let records = listen(child.stdout.take());
        let complaints = listen(child.stderr.take());
        Ok(Program { child, events, records, complaints, address })
    }

    /// Tells `events` and gives the records that answer them, one behind the other.
    ///
    /// # Errors
    /// When the program ends or hangs on the way.
    pub fn answers(&mut self, events: &[Event]) -> Result<Vec<u8>, ProgramError> {
        let mut stream = Vec::new();
        let mut complete = 0;
        let mut records = 0;
        for chunk in events.chunks(CHUNK) {
            let mut line = Vec::new();
            for event in chunk {
                event.encode(&mut line);
            }
            line.push(FLUSH);
            // Another thread reads all the while, so neither side can wait for the other for ever.
            // A program that has ended says so where its records are read.
            if let Some(pipe) = &mut self.events {
                let _ = pipe.write_all(&line).and_then(|()| pipe.flush());
            }
            let wanted = records + chunk.len();
            while records < wanted {
                while let Some((record, _)) = split_first(self.address, &stream[complete..]) {
                    complete += record.len();
                    records += 1;
                }
                if records >= wanted {
                    break;
                }
                match self.records.recv_timeout(PATIENCE) {
                    Ok(bytes) => stream.extend(bytes),
                    Err(RecvTimeoutError::Timeout) => return Err(ProgramError::Hung { records }),
                    Err(RecvTimeoutError::Disconnected) => return Err(self.ended(records)),
                }
            }
        }
        Ok(stream)
    }

    fn ended(&mut self, records: usize) -> ProgramError {
        self.events = None;
        let status = self.child.wait().map_or_else(|error| error.to_string(), |s| s.to_string());
        let told: Vec<u8> = self.complaints.iter().flatten().collect();
        let tail = last_lines(&String::from_utf8_lossy(&told), 12);
        ProgramError::Ended { status, records, tail }
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        self.events = None;
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Everything that comes out of a pipe, read by a thread of its own.
fn listen(pipe: Option<impl Read + Send + 'static>) -> Receiver<Vec<u8>> {
    let (sender, receiver) = channel();
    if let Some(mut pipe) = pipe {
        std::thread::spawn(move || {
            let mut buffer = vec![0; 1 << 16];
            while let Ok(count) = pipe.read(&mut buffer) {
                if count == 0 || sender.send(buffer[..count].to_vec()).is_err() {
                    break;
                }
            }
        });
    }
    receiver
}

fn last_lines(text: &str, count: usize) -> String {
    let lines: Vec<&str> = text.lines().collect();
    lines[lines.len().saturating_sub(count)..].join("\n")
}
