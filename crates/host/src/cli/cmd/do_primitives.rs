//! `rsapien do`: motion primitives.

use std::io::Write;

use clap::Args;
use rsapien_registry::language::StatementKind;
use rsapien_registry::{ActionDraft, CompileOptions, Finding, NoActions, Statement, compile};

use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::exit::Status;
use crate::cli::floor::{Floor, PolicyOptions};
use crate::cli::performance;
use crate::cli::robot::PaceOptions;

/// Run motion primitives, step after step
///
/// A step is PRIMITIVE[+PRIMITIVE...][:MS]: names or numbers of the paper's Table 1 that start together, and how long
/// the step lasts, 1 to 65535 ms; 1000 when not given, in which every joint travels from end to end. pause:MS waits;
/// *TIMES behind a step repeats it. Every step is checked before anything moves.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien do right-arm-up
  rsapien do right-arm-up+left-arm-up:800 pause:500 right-arm-down+left-arm-down
  rsapien do 13:500 15:500 14
  rsapien actions list --primitives       names and numbers")]
pub(crate) struct Cmd {
    /// Steps in their order
    #[arg(value_name = "STEP", required = true)]
    steps: Vec<String>,

    #[command(flatten)]
    policy: PolicyOptions,

    #[command(flatten)]
    pace: PaceOptions,
}

impl Cmd {
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        let steps = (1..)
            .zip(&self.steps)
            .map(|(number, text)| {
                step(text).map_err(|failure| failure.within(&format!("step {number} ({text})")))
            })
            .collect::<Result<Vec<Statement>>>()?;
        let draft = ActionDraft::new("steps", steps);
        let compiled = compile(&draft, &NoActions, &CompileOptions::default())
            .map_err(|finding| refused(&finding))?;
        let mut floor = Floor::take(context, out, "do", self.pace)?;
        performance::play_on(context, out, &mut floor, self.policy, None, &compiled, None)
    }
}

/// The step that a text means; the name of an action means none here.
fn step(text: &str) -> Result<Statement> {
    let step = Statement::parse_short(text).map_err(|finding| refused(&finding))?;
    let Some(name) = played(&step) else { return Ok(step) };
    // Read as a primitive, the word gets the advice that a primitive's name would.
    let failure = Statement::parse_short(&format!("{name}:1")).err().map_or_else(
        || Failure::new(format!("{name:?} is no motion primitive")),
        |finding| refused(&finding),
    );
    Err(failure.hint(format!(
        "rsapien actions list --primitives lists them; if it is an action: rsapien play {name}"
    )))
}

/// The action that a step plays, once or repeated.
fn played(step: &Statement) -> Option<&str> {
    match &step.kind {
        StatementKind::Play(play) => Some(&play.action.text),
        StatementKind::Repeat { body, .. } => body.iter().find_map(played),
        _ => None,
    }
}

/// The failure of something that the checker refuses.
fn refused(finding: &Finding) -> Failure {
    Failure::new(finding.in_words())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_step_is_refused_with_the_reason() {
        for (text, reason) in [
            ("wave", "no motion primitive"),
            ("right-arm-upp", "right-arm-up"),
            ("22", "22"),
            ("1+2", "right-arm-up and right-arm-front"),
            ("1+1", "twice"),
            ("right-arm-up:0", "0 ms"),
            ("right-arm-up:70000", "70000 ms"),
            ("", "\"\""),
        ] {
            let message = step(text).unwrap_err().to_string();
            assert!(message.contains(reason), "{text}: {message}");
        }
        assert!(step("1+16:250").is_ok() && step("pause:20").is_ok() && step("tilt-left").is_ok());
    }
}
