//! `rsapien actions list`.

use std::io::Write;

use clap::Args;
use rsapien_protocol::Joint;
use rsapien_registry::language::{Value, parse_value};
use rsapien_registry::{Query, Registry};

use super::text::seconds;
use crate::cli::context::Context;
use crate::cli::diagnostics::Result;
use crate::cli::exit::Status;
use crate::cli::output::{Table, json_line};

/// List the actions, or search them; or list the 21 motion primitives they are made of
///
/// Words are looked for in names, descriptions, tags, labels, comments and the names of actions that are played; the
/// last one may be the beginning of a word. Everything given has to hold. The exit status is 1 when there is none.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien actions list
  rsapien actions list wave left
  rsapien actions list --tag walking --longest 5s
  rsapien actions list --joint right-hand --joint tilt
  rsapien actions list --primitives")]
pub(super) struct Cmd {
    /// Words to look for
    #[arg(value_name = "WORD")]
    words: Vec<String>,

    /// Only those with this tag; may be given several times
    #[arg(long = "tag", value_name = "TAG")]
    tags: Vec<String>,

    /// Only those that move this joint; may be given several times
    #[arg(long = "joint", value_name = "JOINT", value_parser = joint)]
    joints: Vec<Joint>,

    /// Only those that last at least so long, such as 800ms or 5s
    #[arg(long, value_name = "TIME", value_parser = time_ms)]
    shortest: Option<u64>,

    /// Only those that last at most so long
    #[arg(long, value_name = "TIME", value_parser = time_ms)]
    longest: Option<u64>,

    /// At most so many
    #[arg(long, value_name = "N", default_value_t = 1000)]
    limit: u32,

    /// The motion primitives (Table 1 of the paper) instead of the actions
    #[arg(long, conflicts_with_all = ["words", "tags", "joints", "shortest", "longest"])]
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
        let actions = registry.search(&Query {
            text: self.words.join(" "),
            tags: self.tags,
            joints: self.joints,
            duration_ms_min: self.shortest,
            duration_ms_max: self.longest,
            limit: self.limit,
            offset: 0,
        })?;
        if context.style.json {
            json_line(out, &actions)?;
        } else if actions.is_empty() {
            writeln!(out, "no action fits; rsapien actions list shows all")?;
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

fn joint(text: &str) -> std::result::Result<Joint, String> {
    Joint::ALL.into_iter().find(|joint| joint.name() == text).ok_or_else(|| {
        let names = Joint::ALL.map(Joint::name).join(", ");
        format!("the joints are {names}")
    })
}

fn time_ms(text: &str) -> std::result::Result<u64, String> {
    match parse_value(text) {
        Ok(Value::DurationMs(ms)) => Ok(u64::from(ms)),
        Ok(Value::Thousandths(_)) => {
            Err("write a time with its unit, such as 800ms or 5s".to_owned())
        }
        Err(finding) => Err(finding.in_words()),
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
