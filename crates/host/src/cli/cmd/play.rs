//! `rsapien play`: an action from the registry.

use std::io::Write;

use clap::Args;
use rsapien_registry::CompileOptions;

use crate::cli::context::Context;
use crate::cli::diagnostics::Result;
use crate::cli::exit::Status;
use crate::cli::performance;
use crate::cli::registry::RegistryOptions;
use crate::cli::robot::{self, PaceOptions};

/// Play an action
///
/// Keeps the robot's queue filled until the action has ended, shows on a terminal how far it is, and tells how it ended:
/// done; refused, and why; interrupted, and by what (a bumper, STOP, the dead-man, a reset, the loss of the link); or
/// unknown. The exit status is 0 for done and 1 for the others.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien play wave
  rsapien play walk-forward --times 3 --speed 0.8
  rsapien play dance --link virtual
  rsapien actions list                    which actions there are")]
pub(crate) struct Cmd {
    /// Name of the action
    #[arg(value_name = "ACTION")]
    action: String,

    /// How often in a row, 1 to 1000
    #[arg(long, value_name = "N", default_value_t = 1)]
    times: u16,

    /// How fast, 0.1 to 10: durations are divided by it. Motors run no faster, so that joints may not arrive
    #[arg(long, value_name = "X", default_value_t = 1.0, allow_negative_numbers = true)]
    speed: f64,

    #[command(flatten)]
    pace: PaceOptions,

    #[command(flatten)]
    registry: RegistryOptions,
}

impl Cmd {
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        let options = CompileOptions { times: self.times, speed: self.speed };
        let compiled = self.registry.open()?.compile(&self.action, options)?;
        let open = robot::open(context, &format!("play {}", self.action), self.pace)?;
        let mut motion = open.ready_motion(context, out)?;
        performance::play(context, out, &open, &mut motion, Some(&self.action), &compiled.steps)
    }
}
