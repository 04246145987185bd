//! Exit statuses: a contract with scripts, told in `--help` and in `docs/cli.md`.

/// How a run of the command ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub(crate) enum Status {
    /// What was asked for was done.
    Done = 0,
    /// The command did its part, and the answer is no: the robot refused or was interrupted, or nothing was found (no
    /// robot on any port, no ellipse, no ball), or the answers of a replay differ.
    Refused = 1,
    /// The command could not do its part: bad usage, a link or file that cannot be opened, a robot that does not answer.
    Failed = 2,
    /// Ended by Ctrl-C or SIGTERM, after the motors were stopped.
    Interrupted = 130,
}

impl Status {
    /// The number given to the shell.
    pub(crate) const fn code(self) -> u8 {
        self as u8
    }
}

/// The part of `--help` that tells the statuses.
pub(crate) const HELP: &str = "\
Exit statuses:
  0    done
  1    the robot refused or was interrupted, nothing was found, or a replay differs
  2    the command failed: bad usage, a link or file that cannot be opened, no answer
  130  ended by Ctrl-C or SIGTERM, after the motors were stopped";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_help_tells_every_status() {
        for status in [Status::Done, Status::Refused, Status::Failed, Status::Interrupted] {
            let code = status.code().to_string();
            assert!(HELP.lines().any(|line| line.trim_start().starts_with(&code)), "{code}");
        }
    }
}
