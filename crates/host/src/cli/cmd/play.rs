//! `rsapien play`: an action from the registry.

use std::io::Write;

use clap::Args;
use rsapien_registry::CompileOptions;
use rsapien_registry::language::{Value, parse_value};

use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::exit::Status;
use crate::cli::floor::{Floor, PolicyOptions};
use crate::cli::performance;
use crate::cli::registry::RegistryOptions;
use crate::cli::robot::PaceOptions;

/// Play an action
///
/// Keeps the robot's queue filled until the action has ended, shows on a terminal how far it is, and tells how it ended:
/// done; refused, and why; interrupted, and by what (a bumper, STOP, the dead-man, a reset, the loss of the link); or
/// unknown. The exit status is 0 for done and 1 for the others.
///
/// On a terminal, p pauses it at the end of a step and lets it go on, and space stops the motors. Where another program
/// holds the robot's line, the action is handed to that program, which plays it.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien play wave
  rsapien play walk-forward --times 3 --speed 0.8
  rsapien play dance --link virtual
  rsapien play wave rounds=4 --mirrored
  rsapien play wave --policy merge        beside what another program plays
  rsapien actions list                    which actions there are")]
pub(crate) struct Cmd {
    /// Name of the action
    #[arg(value_name = "ACTION")]
    action: String,

    /// Values of its parameters; the others have their defaults. Times are written as 650ms, 1.5s or 2min
    #[arg(value_name = "PARAMETER=VALUE")]
    arguments: Vec<String>,

    /// How often in a row, 1 to 1000
    #[arg(long, value_name = "N", default_value_t = 1)]
    times: u16,

    /// How fast, 0.1 to 10: durations are divided by it. Motors run no faster, so that joints may not arrive
    #[arg(long, value_name = "X", default_value_t = 1.0, allow_negative_numbers = true)]
    speed: f64,

    /// Play from this label of the action on
    #[arg(long, value_name = "LABEL")]
    from: Option<String>,

    /// Left for right
    #[arg(long)]
    mirrored: bool,

    #[command(flatten)]
    policy: PolicyOptions,

    #[command(flatten)]
    pace: PaceOptions,

    #[command(flatten)]
    registry: RegistryOptions,
}

impl Cmd {
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        let arguments = self.arguments.iter().map(|text| argument(text)).collect::<Result<_>>()?;
        let options = CompileOptions {
            times: self.times,
            speed: self.speed,
            mirrored: self.mirrored,
            arguments,
        };
        let compiled = self.registry.open(context)?.compile(&self.action, &options);
        let compiled = compiled.map_err(|error| {
            let failure = Failure::from(error);
            if self.arguments.is_empty() {
                return failure;
            }
            // What is wrong may be what was given here, not what is written there.
            failure.hint(format!("its parameters were given: {}", self.arguments.join(" ")))
        })?;
        let mut floor = Floor::take(context, out, &format!("play {}", self.action), self.pace)?;
        let (policy, name) = (self.policy, Some(self.action.as_str()));
        let from = self.from.as_deref();
        performance::play_on(context, out, &mut floor, policy, name, &compiled, from)
    }
}

/// The parameter and the value of `rounds=3`.
pub(crate) fn argument(text: &str) -> Result<(String, Value)> {
    let Some((name, value)) = text.split_once('=') else {
        return Err(Failure::new(format!("{text:?} is no value of a parameter"))
            .hint("write PARAMETER=VALUE, as in rounds=3 or hold=650ms"));
    };
    let value = parse_value(value.trim()).map_err(|finding| {
        let help = finding.help.as_deref().unwrap_or_default();
        Failure::new(format!("{}: {}", name.trim(), finding.message)).hint(help)
    })?;
    Ok((name.trim().to_owned(), value))
}
