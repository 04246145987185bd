//! `rsapien actions`: the actions in `RoboRegistry`.

mod add;
mod check;
mod diff;
mod edit;
mod keep;
mod list;
mod remove;
pub(super) mod save;
mod show;
mod text;
mod transfer;

use std::io::Write;

use clap::{Args, Subcommand};

use crate::cli::context::Context;
use crate::cli::diagnostics::Result;
use crate::cli::exit::Status;
use crate::cli::registry::RegistryOptions;

/// List, write and exchange actions
///
/// An action is a text in the action language: steps of motion primitives that run together for a time, waits, other
/// actions, repeats and more (docs/actions.md). Every change is a new version; the old ones are kept. A new registry knows the actions that an owner
/// expects: stand, walk-forward, wave, bow, dance and more.
#[derive(Debug, Args)]
#[command(
    arg_required_else_help = true,
    subcommand_required = true,
    after_help = "\
Examples:
  rsapien actions list
  rsapien actions show walk-forward
  rsapien actions add greet right-arm-up:600 wave right-arm-down:600 --description \"says hello\"
  rsapien actions edit greet
  rsapien actions export greet > greet.rsa"
)]
pub(crate) struct Cmd {
    #[command(flatten)]
    registry: RegistryOptions,
    #[command(subcommand)]
    command: Command,
}

/// What to do with actions.
#[derive(Debug, Subcommand)]
enum Command {
    List(list::Cmd),
    Show(show::Cmd),
    Add(add::Cmd),
    Edit(edit::Cmd),
    Remove(remove::Cmd),
    Import(transfer::Import),
    Export(transfer::Export),
    Check(check::Cmd),
    Diff(diff::Cmd),
    Restore(keep::Restore),
    Backup(keep::Backup),
    Verify(keep::Verify),
}

impl Cmd {
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        let registry = self.registry.open(context)?;
        match self.command {
            Command::List(cmd) => cmd.run(context, &registry, out),
            Command::Show(cmd) => cmd.run(context, &registry, out),
            Command::Add(cmd) => cmd.run(context, registry, out),
            Command::Edit(cmd) => cmd.run(context, registry, out),
            Command::Remove(cmd) => cmd.run(context, registry, out),
            Command::Import(cmd) => cmd.run(context, registry, out),
            Command::Export(cmd) => cmd.run(context, &registry, out),
            Command::Check(cmd) => cmd.run(context, &registry, out),
            Command::Diff(cmd) => cmd.run(context, &registry, out),
            Command::Restore(cmd) => cmd.run(context, registry, out),
            Command::Backup(cmd) => cmd.run(context, &registry, out),
            Command::Verify(cmd) => cmd.run(context, registry, out),
        }
    }
}
