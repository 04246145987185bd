//! `rsapien actions list`.

use std::io::Write;

use clap::Args;
use rsapien_registry::Registry;

use super::text::seconds;
use crate::cli::context::Context;
use crate::cli::diagnostics::Result;
use crate::cli::exit::Status;
use crate::cli::output::{Table, json_line};

/// List the actions, or the 21 motion primitives they are made of
///
/// The exit status is 1 when there is none.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien actions list
  rsapien actions list --tag walking
  rsapien actions list --primitives")]
pub(super) struct Cmd {
    /// Only those with this tag
    #[arg(long, value_name = "TAG")]
    tag: Option<String>,

    /// The motion primitives (Table 1 of the paper) instead of the actions
    #[arg(long, conflicts_with = "tag")]
    primitives: bool,
}

impl Cmd {
    pub(super) fn run(
        self,
        context: &Context,
        registry: &Registry,
        out: &mut impl Write,
    ) -> Result<Status> {
        if self.primitives {
            return list_primitives(context, registry, out);
        }
        let mut actions = registry.list()?;
        if let Some(tag) = &self.tag {
            actions.retain(|action| action.tags.contains(tag));
        }
        if context.style.json {
            json_line(out, &actions)?;
        } else if actions.is_empty() {
            writeln!(
                out,
                "no action{}",
                self.tag.map_or(String::new(), |tag| format!(" has the tag {tag}"))
            )?;
        } else {
            let mut table = Table::new(&["name", "version", "  lasts", "tags", "description"]);
            for action in &actions {
                table.row([
                    action.name.clone(),
                    action.version.to_string(),
                    format!("{:>7}", seconds(action.duration_ms)),
                    action.tags.join(" "),
                    first_line(&action.description),
                ]);
            }
            writeln!(out, "{table}")?;
        }
        Ok(if actions.is_empty() { Status::Refused } else { Status::Done })
    }
}

fn list_primitives(context: &Context, registry: &Registry, out: &mut impl Write) -> Result<Status> {
    let primitives = registry.primitives()?;
    if context.style.json {
        let answer: Vec<_> = primitives
            .iter()
            .map(|primitive| {
                serde_json::json!({
                    "number": primitive.number(),
                    "name": primitive.to_string(),
                    "joint": primitive.joint().name(),
                    "position": primitive.position_name(),
                })
            })
            .collect();
        json_line(out, &answer)?;
    } else {
        let mut table = Table::new(&["no.", "motion primitive"]);
        for primitive in &primitives {
            table.row([primitive.number().to_string(), primitive.to_string()]);
        }
        writeln!(out, "{table}")?;
    }
    Ok(Status::Done)
}

/// What fits a table of a description.
fn first_line(description: &str) -> String {
    const LONGEST: usize = 60;
    let line = description.lines().next().unwrap_or_default();
    if line.chars().count() <= LONGEST {
        return line.to_owned();
    }
    let cut: String = line.chars().take(LONGEST - 1).collect();
    format!("{}…", cut.trim_end())
}
