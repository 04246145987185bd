//! `rsapien completions`: what a shell needs to complete our words.

use std::io::Write;
use std::path::PathBuf;

use clap::{Args, CommandFactory};
use clap_complete::Shell;
use directories::BaseDirs;

use crate::cli::Arguments;
use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::exit::Status;
use crate::cli::install;

/// Print the completion script of a shell, or install it for you
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien completions bash --install
  rsapien completions zsh --install
  rsapien completions fish > rsapien.fish")]
pub(crate) struct Cmd {
    /// Which shell
    shell: Shell,

    /// Put it where the shell finds it: bash, zsh and fish
    #[arg(long)]
    install: bool,
}

impl Cmd {
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        // The generator panics where a write fails, so it writes to memory.
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut Arguments::command(), "rsapien", &mut script);
        if !self.install {
            out.write_all(&script)?;
            return Ok(Status::Done);
        }
        let (path, advice) = place(self.shell)?;
        install::write(&path, &script)?;
        let answer = serde_json::json!({"file": path});
        let text = format!("wrote {}; {advice}", path.display());
        context.style.answer(out, &answer, text)?;
        Ok(Status::Done)
    }
}

/// Where a shell looks for the script, and what else it needs.
fn place(shell: Shell) -> Result<(PathBuf, &'static str)> {
    let folders = BaseDirs::new().ok_or_else(install::no_home)?;
    let data = folders.data_dir();
    match shell {
        Shell::Bash => Ok((
            data.join("bash-completion/completions/rsapien"),
            "a new shell completes, where the package bash-completion is installed",
        )),
        Shell::Zsh => Ok((
            data.join("zsh/site-functions/_rsapien"),
            "put its folder into fpath in ~/.zshrc, before compinit: fpath+=(FOLDER)",
        )),
        Shell::Fish => Ok((
            folders.config_dir().join("fish/completions/rsapien.fish"),
            "a new shell completes",
        )),
        other => Err(Failure::new(format!("{other} has no place of its own for completions"))
            .hint(format!("rsapien completions {other} > FILE, and load FILE in its start file"))),
    }
}
