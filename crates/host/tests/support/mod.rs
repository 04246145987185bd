//! Runs the built command as a user would, with a data folder of its own.

#[allow(dead_code)]
pub(crate) mod simulator;

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use tempfile::TempDir;

/// A user with an empty data folder, in an empty working folder.
pub(crate) struct User {
    folder: TempDir,
}

/// What a run gave.
pub(crate) struct Run {
    pub(crate) status: i32,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

#[allow(dead_code)] // each test program uses some of them
impl User {
    pub(crate) fn new() -> User {
        User { folder: tempfile::tempdir().expect("a folder") }
    }

    /// A path in the working folder.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The command, not yet started.
    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rsapien"));
        command
            .args(arguments)
            .current_dir(self.folder.path())
            .env("HOME", self.folder.path())
            .env("XDG_DATA_HOME", self.folder.path().join("data"))
            .env("XDG_CONFIG_HOME", self.folder.path().join("config"))
            .env_remove("RSAPIEN_BAUD")
            .env_remove("RSAPIEN_CONFIG")
            .env_remove("RSAPIEN_LINK")
            .env_remove("RSAPIEN_REGISTRY")
            .env_remove("VISUAL")
            .env_remove("EDITOR")
            .stdin(Stdio::null());
        command
    }

    /// Runs the command to its end.
    pub(crate) fn run(&self, arguments: &[&str]) -> Run {
        Run::of(self.command(arguments).output().expect("the command starts"))
    }

    /// Runs the command, which has to end with `status`.
    pub(crate) fn expect(&self, status: i32, arguments: &[&str]) -> Run {
        let run = self.run(arguments);
        assert_eq!(
            run.status,
            status,
            "rsapien {}\n{}{}",
            arguments.join(" "),
            run.stdout,
            run.stderr
        );
        run
    }

    /// Starts the command with its output kept.
    pub(crate) fn start(&self, arguments: &[&str]) -> Child {
        let mut command = self.command(arguments);
        command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the command starts")
    }
}

#[allow(dead_code)]
impl Run {
    fn of(output: Output) -> Run {
        let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
        Run {
            status: output.status.code().unwrap_or(-1),
            stdout: text(output.stdout),
            stderr: text(output.stderr),
        }
    }

    /// Waits for the end of a started command, which has to come within 20 s.
    pub(crate) fn of_child(mut child: Child) -> Run {
        let end = Instant::now() + Duration::from_secs(20);
        while child.try_wait().expect("a child").is_none() {
            if Instant::now() > end {
                // So that the failure leaves nothing running behind.
                let _ = child.kill();
                let _ = child.wait();
                panic!("the command has not ended after 20 s");
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        Run::of(child.wait_with_output().expect("its output"))
    }

    /// The one line of JSON on the standard output.
    pub(crate) fn json(&self) -> serde_json::Value {
        let mut lines = self.json_lines();
        assert_eq!(lines.len(), 1, "{}", self.stdout);
        lines.remove(0)
    }

    /// Every line of the standard output as JSON.
    pub(crate) fn json_lines(&self) -> Vec<serde_json::Value> {
        let parse =
            |line| serde_json::from_str(line).unwrap_or_else(|error| panic!("{error}: {line}"));
        self.stdout.lines().map(parse).collect()
    }

    /// Whether each of `parts` stands on the standard error.
    #[track_caller]
    pub(crate) fn told(&self, parts: &[&str]) {
        for part in parts {
            assert!(self.stderr.contains(part), "{part:?} is not told:\n{}", self.stderr);
        }
    }
}

/// Waits until `condition` holds, at most 10 s.
#[allow(dead_code)]
#[track_caller]
pub(crate) fn wait_until(what: &str, mut condition: impl FnMut() -> bool) {
    let end = Instant::now() + Duration::from_secs(10);
    while !condition() {
        assert!(Instant::now() < end, "10 s passed before {what}");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Sends Ctrl-C to a started command.
#[allow(dead_code)]
pub(crate) fn interrupt(child: &Child) {
    let pid = rustix::process::Pid::from_child(child);
    rustix::process::kill_process(pid, rustix::process::Signal::INT).expect("a signal");
}

/// Whether a file begins like a PNG picture.
#[allow(dead_code)]
pub(crate) fn is_png(path: &Path) -> bool {
    std::fs::read(path).is_ok_and(|bytes| bytes.starts_with(b"\x89PNG"))
}
