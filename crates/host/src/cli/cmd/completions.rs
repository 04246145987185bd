//! `rsapien completions`: what a shell needs to complete our words.

use std::io::Write;

use clap::{Args, CommandFactory};
use clap_complete::Shell;

use crate::cli::Arguments;
use crate::cli::context::Context;
use crate::cli::diagnostics::Result;
use crate::cli::exit::Status;

/// Print the completion script of a shell
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien completions bash > ~/.local/share/bash-completion/completions/rsapien
  rsapien completions zsh > ~/.zfunc/_rsapien
  rsapien completions fish > ~/.config/fish/completions/rsapien.fish")]
pub(crate) struct Cmd {
    /// Which shell
    shell: Shell,
}

impl Cmd {
    pub(crate) fn run(self, _context: &Context, out: &mut impl Write) -> Result<Status> {
        // The generator panics where a write fails, so it writes to memory.
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut Arguments::command(), "rsapien", &mut script);
        out.write_all(&script)?;
        Ok(Status::Done)
    }
}
