//! A conversation with the simulator of one chip: commands in lines, answered in lines, in lock step.
//!
//! Commands gather in a batch, which is written at once and answered command by command: any number of lines that tell
//! what happened, then one that begins with `ok` or `error`. `firmware-pic/sim` tells the commands.

use std::fmt::{self, Write as _};
use std::fs::File;
use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::os::fd::OwnedFd;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Child, ChildStderr, Command, Stdio};
use std::sync::mpsc::{self, Receiver};
use std::thread;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;

use super::{FirmwareError, FirmwareImage};

/// How long an answer may take: a millisecond of a chip takes less than one here, so this is another kind of trouble.
pub(super) const PATIENCE: Duration = Duration::from_secs(10);
/// How long the last words of a process that has ended may take.
const LAST_WORDS_PATIENCE: Duration = Duration::from_millis(500);
/// The first words of lines that tell what happened.
const EVENTS: [&str; 6] = ["byte", "framing", "heard", "edge", "mark", "reset"];
/// A line of an answer is never longer than this, in bytes.
const LINE_BYTES_MAX: usize = 64 * 1024;

/// The simulator of one chip.
#[derive(Debug)]
pub(super) struct Bridge {
    chip: &'static str,
    to: File,
    from: File,
    /// Commands that wait to be written, or to be answered.
    batch: String,
    /// What came and is no whole line yet.
    received: Vec<u8>,
    patience: Duration,
    process: Option<Process>,
}

/// A process that is ended with its handle.
#[derive(Debug)]
struct Process {
    child: Child,
    last_words: Receiver<String>,
}

impl Bridge {
    /// Starts the simulator at `program` with an image in it.
    pub(super) fn start(program: &Path, image: &FirmwareImage) -> Result<Self, FirmwareError> {
        let failed = |why: String| FirmwareError::NotStarted { path: program.to_owned(), why };
        let mut child = Command::new(program)
            .arg("--hex")
            .arg(image.path())
            .args(["--processor", &image.processor()])
            .args(["--clock-mhz", &image.clock_mhz().to_string()])
            .args(["--baud", &image.baud().to_string()])
            .arg("--lockstep")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            // A group of its own: Ctrl-C is for the program that holds the robot, which stops the motors first.
            .process_group(0)
            .spawn()
            .map_err(|error| failed(error.to_string()))?;
        let (input, output, errors) =
            (child.stdin.take(), child.stdout.take(), child.stderr.take());
        let process = Process { child, last_words: last_line(errors) };
        let (Some(input), Some(output)) = (input, output) else {
            return Err(failed("it has no input and output".to_owned()));
        };
        let (input, output) = (OwnedFd::from(input), OwnedFd::from(output));
        Ok(Self::over(image.controller().name(), input, output, PATIENCE, Some(process)))
    }

    /// A conversation over two descriptors with somebody who need not be a process.
    #[cfg(test)]
    pub(super) fn with(chip: &'static str, to: OwnedFd, from: OwnedFd, patience: Duration) -> Self {
        Self::over(chip, to, from, patience, None)
    }

    fn over(
        chip: &'static str,
        to: OwnedFd,
        from: OwnedFd,
        patience: Duration,
        process: Option<Process>,
    ) -> Self {
        Self {
            chip,
            to: to.into(),
            from: from.into(),
            batch: String::new(),
            received: Vec::new(),
            patience,
            process,
        }
    }

    /// Which controller's chip it is.
    pub(super) fn chip(&self) -> &'static str {
        self.chip
    }

    /// Adds a command to the batch.
    pub(super) fn put(&mut self, command: fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.batch, "{command}");
    }

    /// Writes the batch. What it does is done while others are written to.
    pub(super) fn write(&mut self) -> Result<(), FirmwareError> {
        match self.to.write_all(self.batch.as_bytes()) {
            Ok(()) => Ok(()),
            Err(error) => Err(self.ended(&error.to_string())),
        }
    }

    /// Reads the answers to the batch that was written. `told` gets every line that tells what happened, and what stands
    /// behind `ok` of every answer is given to `answered`.
    pub(super) fn read(
        &mut self,
        mut told: impl FnMut(&str) -> Option<()>,
        mut answered: impl FnMut(&str) -> Option<()>,
    ) -> Result<(), FirmwareError> {
        let batch = std::mem::take(&mut self.batch);
        for asked in batch.lines() {
            loop {
                let line = self.read_line(asked)?;
                let line = line.trim();
                let is_taken = match line.split_once(' ').unwrap_or((line, "")) {
                    ("ok", answer) => {
                        if answered(answer.trim()).is_some() {
                            break;
                        }
                        None
                    }
                    (event, _) if EVENTS.contains(&event) => told(line),
                    _ => None,
                };
                if is_taken.is_none() {
                    return Err(FirmwareError::Answer {
                        chip: self.chip,
                        asked: asked.to_owned(),
                        answer: line.to_owned(),
                    });
                }
            }
        }
        Ok(())
    }

    /// One command alone: what stands behind `ok`.
    pub(super) fn ask(&mut self, command: fmt::Arguments<'_>) -> Result<String, FirmwareError> {
        self.put(command);
        self.write()?;
        let mut text = String::new();
        let keep = |answer: &str| {
            answer.clone_into(&mut text);
            Some(())
        };
        self.read(|_| Some(()), keep)?;
        Ok(text)
    }

    fn read_line(&mut self, asked: &str) -> Result<String, FirmwareError> {
        let limit = Instant::now() + self.patience;
        loop {
            if let Some(end) = self.received.iter().position(|byte| *byte == b'\n') {
                let line: Vec<u8> = self.received.drain(..=end).collect();
                return Ok(String::from_utf8_lossy(&line).into_owned());
            }
            if self.received.len() > LINE_BYTES_MAX {
                return Err(self.ended("it told a line without an end"));
            }
            if !self.wait_until(limit)? {
                let patience_s = self.patience.as_secs();
                return Err(FirmwareError::Silent {
                    chip: self.chip,
                    asked: asked.to_owned(),
                    patience_s,
                });
            }
            let mut bytes = [0; 4096];
            match self.from.read(&mut bytes) {
                Ok(0) => return Err(self.ended("it closed its output")),
                Ok(count) => self.received.extend(bytes.iter().take(count)),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(self.ended(&error.to_string())),
            }
        }
    }

    /// Whether something can be read before `limit`.
    fn wait_until(&mut self, limit: Instant) -> Result<bool, FirmwareError> {
        loop {
            let left = limit.saturating_duration_since(Instant::now());
            let left = Timespec {
                tv_sec: i64::try_from(left.as_secs()).unwrap_or(i64::MAX),
                tv_nsec: left.subsec_nanos().into(),
            };
            match poll(&mut [PollFd::new(&self.from, PollFlags::IN)], Some(&left)) {
                Ok(ready) => return Ok(ready > 0),
                Err(Errno::INTR) => {}
                Err(error) => return Err(self.ended(&error.to_string())),
            }
        }
    }

    /// The error of a process that is gone: its last words, or else what the system says.
    fn ended(&mut self, system: &str) -> FirmwareError {
        let words = self.process.as_mut().and_then(Process::end);
        FirmwareError::Ended { chip: self.chip, why: words.unwrap_or_else(|| system.to_owned()) }
    }
}

impl Process {
    /// Ends the process, if it has not ended, and tells its last words, or else how it ended.
    fn end(&mut self) -> Option<String> {
        let limit = Instant::now() + LAST_WORDS_PATIENCE;
        let mut status = None;
        while status.is_none() && Instant::now() < limit {
            status = self.child.try_wait().ok().flatten();
            thread::sleep(Duration::from_millis(5));
        }
        // One that has ended already cannot be killed, and need not.
        let _ = self.child.kill();
        let _ = self.child.wait();
        let words = self.last_words.recv_timeout(LAST_WORDS_PATIENCE).ok();
        words.filter(|words| !words.is_empty()).or_else(|| status.map(|status| status.to_string()))
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Reads a standard error to its end, so that nobody waits to write there, and gives the last line that says something.
fn last_line(errors: Option<ChildStderr>) -> Receiver<String> {
    let (sender, receiver) = mpsc::channel();
    if let Some(errors) = errors {
        thread::spawn(move || {
            let (mut errors, mut bytes) = (BufReader::new(errors), Vec::new());
            let mut last = String::new();
            loop {
                bytes.clear();
                let limit = u64::try_from(LINE_BYTES_MAX).unwrap_or(u64::MAX);
                match errors.by_ref().take(limit).read_until(b'\n', &mut bytes) {
                    Ok(0) | Err(_) => break,
                    Ok(_) if bytes.trim_ascii().is_empty() => {}
                    Ok(_) => last = String::from_utf8_lossy(bytes.trim_ascii()).into_owned(),
                }
            }
            // Nobody asks for the last words of a process that ended with its robot.
            let _ = sender.send(last);
        });
    }
    receiver
}
