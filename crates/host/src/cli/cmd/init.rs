//! `rsapien init`: robot initialisation.

use std::io::Write;

use clap::Args;

use crate::cli::context::Context;
use crate::cli::diagnostics::Result;
use crate::cli::exit::Status;
use crate::cli::robot::{self, PaceOptions};
use crate::cli::view;

/// Initialise the robot: drive every joint to its middle position and the head straight ahead
///
/// The robot has to stand free. It is needed once after the power came on, and after a reset.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien init
  rsapien init --link /dev/ttyUSB0")]
pub(crate) struct Cmd {
    #[command(flatten)]
    pace: PaceOptions,

    /// Leave the head as it is, as on a robot without a camera controller
    #[arg(long)]
    no_head: bool,
}

impl Cmd {
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        let open = robot::open(context, "init", self.pace)?;
        let mut motion = open.motion()?;
        let start_ms = open.robot.now_ms();
        open.done(motion.init_unless(&open.cancel))?;
        if !self.no_head {
            let camera = open.done(open.robot.camera())?;
            open.done(camera.home())?;
        }
        let state = motion.state();
        let elapsed_ms = open.robot.now_ms().saturating_sub(start_ms);
        let answer = serde_json::json!({
            "link": open.robot.link_name(),
            "elapsed_ms": elapsed_ms,
            "motion": state.motion_report().map(|report| view::motion(&report)),
            "camera": state.camera_report().map(|report| view::camera(&report)),
        });
        let text =
            format!("{} is initialised ({})", open.robot.link_name(), view::seconds(elapsed_ms));
        context.style.answer(out, &answer, text)?;
        Ok(Status::Done)
    }
}
