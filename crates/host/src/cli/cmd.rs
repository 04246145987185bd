//! The subcommands, one a file.

mod actions;
mod completions;
mod detect;

use std::io::Write;

use clap::Subcommand;

use super::context::Context;
use super::diagnostics::Result;
use super::exit::Status;

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Actions(actions::Cmd),
    Detect(detect::Cmd),
    Completions(completions::Cmd),
}

impl Command {
    /// Does it.
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        match self {
            Self::Actions(cmd) => cmd.run(context, out),
            Self::Detect(cmd) => cmd.run(context, out),
            Self::Completions(cmd) => cmd.run(context, out),
        }
    }
}
