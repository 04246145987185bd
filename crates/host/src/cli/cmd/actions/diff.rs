//! `rsapien actions diff`.

use std::io::Write;

use clap::Args;
use rsapien_registry::timeline::Difference;
use rsapien_registry::{CompileOptions, CompiledAction, Registry};

use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::exit::Status;

/// Tell what differs between two actions, or two versions of one, by joint and time
///
/// NAME@VERSION names an older version. The exit status is 1 when they differ.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien actions diff wave wave-left
  rsapien actions diff wave@1 wave")]
pub(super) struct Cmd {
    /// The first action
    #[arg(value_name = "A")]
    first: String,

    /// The second action
    #[arg(value_name = "B")]
    second: String,
}

impl Cmd {
    pub(super) fn run(
        self,
        context: &Context,
        registry: &Registry,
        out: &mut impl Write,
    ) -> Result<Status> {
        let first = compiled(registry, &self.first)?;
        let second = compiled(registry, &self.second)?;
        let difference = Difference::between(&first, &second);
        let changes: Vec<String> = difference.changes.iter().map(ToString::to_string).collect();
        let answer = serde_json::json!({
            "first": self.first,
            "second": self.second,
            "durations_ms": difference.durations_ms,
            "step_counts": difference.step_counts,
            "changes": changes,
        });
        context.style.answer(out, &answer, &difference)?;
        Ok(if difference.is_empty() { Status::Done } else { Status::Refused })
    }
}

/// The action of `wave` or `wave@2`.
fn compiled(registry: &Registry, text: &str) -> Result<CompiledAction> {
    let options = CompileOptions::default();
    let Some((name, version)) = text.split_once('@') else {
        return Ok(registry.compile(text, &options)?);
    };
    let version = version.parse().map_err(|_| {
        Failure::new(format!("{text:?} names no version"))
            .hint(format!("write NAME@VERSION, as in {name}@1"))
    })?;
    let action = registry.get_version(name, version)?;
    let mut compiled = registry.compile_draft(&action.draft().unwrap_or_default(), &options)?;
    text.clone_into(&mut compiled.name);
    Ok(compiled)
}
