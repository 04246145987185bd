//! `rsapien top`: the robot on a screen.

mod draw;
mod model;

use std::io::Write;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use clap::Args;

use self::model::{Named, Top};
use crate::cli::context::Context;
use crate::cli::diagnostics::Result;
use crate::cli::exit::Status;
use crate::cli::output::Screen;
use crate::cli::registry::RegistryOptions;
use crate::cli::robot;
use crate::cli::screen::{self, parts::Palette};
use crate::record::LineEvent;
use crate::{LinkAddress, RobotOptions};

/// Watch the robot on a screen, and move it with keys
///
/// Robot, joints, bumpers, queue and the quality of the link, ten times a second. Keys play actions, pause and end them and
/// nudge joints; space is STOP, whatever the screen shows. Other programs can play on the robot meanwhile: they find the
/// line held, and hand their actions over.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien top --link virtual              a virtual robot to play with
  rsapien top                             the robot that is plugged in
  rsapien state --watch                   the same as lines of text")]
pub(crate) struct Cmd {
    #[command(flatten)]
    registry: RegistryOptions,
}

/// How many round trips are kept.
const TRIPS_KEPT: usize = 120;

impl Cmd {
    pub(crate) fn run(self, context: &Context, _out: &mut impl Write) -> Result<Status> {
        screen::check(context, "rsapien top", "rsapien state --watch tells the same as text")?;
        let registry = self.registry.open(context)?;
        let actions = registry.list()?.into_iter();
        let actions = actions
            .map(|it| Named {
                name: it.name,
                description: it.description,
                duration_ms: it.duration_ms,
            })
            .collect();
        let address = robot::address(context)?;
        let trips = Arc::new(Mutex::new(Vec::new()));
        let mut options = RobotOptions::for_user("rsapien top");
        options.on_line = Some(round_trips(Arc::clone(&trips)));
        let open = robot::open_with(context, &address, options)?;
        let palette = Palette { is_colored: context.style.output == Screen::Color };
        let mut top = Top::new(open.robot.link_name(), actions, trips, palette);
        if address == LinkAddress::Virtual {
            top.remark("i initialises the robot");
        }
        screen::run(&open, &registry, &mut top)?;
        Ok(Status::Done)
    }
}

/// Keeps how long each of the last packages waited for its answer, in µs.
fn round_trips(trips: Arc<Mutex<Vec<u64>>>) -> crate::LineSink {
    let mut sent = None;
    Box::new(move |event| match event {
        LineEvent::Sent { .. } => sent = Some(Instant::now()),
        LineEvent::Received { .. } => {
            let Some(sent) = sent.take() else { return };
            let us = u64::try_from(sent.elapsed().as_micros()).unwrap_or(u64::MAX);
            let mut trips = trips.lock().unwrap_or_else(PoisonError::into_inner);
            if trips.len() >= TRIPS_KEPT {
                trips.remove(0);
            }
            trips.push(us);
        }
        _ => {}
    })
}
