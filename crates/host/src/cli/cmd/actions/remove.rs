//! `rsapien actions remove`.

use std::io::Write;

use clap::Args;
use rsapien_registry::Registry;

use crate::cli::context::Context;
use crate::cli::diagnostics::Result;
use crate::cli::exit::Status;

/// Remove actions; their versions are kept
///
/// An action that others play is not removed. `show NAME --version N` still shows a removed one, and
/// `show NAME --version N | rsapien actions add --file -` brings it back.
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  rsapien actions remove greet")]
pub(super) struct Cmd {
    /// Names of the actions
    #[arg(value_name = "ACTION", required = true)]
    names: Vec<String>,
}

impl Cmd {
    pub(super) fn run(
        self,
        context: &Context,
        mut registry: Registry,
        out: &mut impl Write,
    ) -> Result<Status> {
        for name in &self.names {
            registry.remove(name)?;
            context.style.answer(
                out,
                &serde_json::json!({"removed": name}),
                format_args!("removed {name}"),
            )?;
        }
        Ok(Status::Done)
    }
}
