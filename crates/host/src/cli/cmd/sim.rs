//! `rsapien sim`: the virtual robot for other programs.

use std::io::Write;
use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use rsapien_sim::VirtualRobotConfig;
use rsapien_sim::pace::Clock;
use rsapien_sim::server::{Simulator, SimulatorConfig, SimulatorError};

use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::exit::Status;
use crate::cli::firmware::{self, FirmwareOptions};
use crate::cli::signal::Interrupt;
use crate::cli::world;

/// Run the virtual robot for other programs, until Ctrl-C
///
/// Both controllers are on one line, as on the robot: on a pseudo-terminal (--pty), on TCP (--tcp), or both. The control
/// socket lets tests press bumpers, pull the cable, drain the battery, read motors and joints and fetch the picture;
/// it stands at LINK.control unless --control names another place. Same seed, same robot.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien sim --pty /tmp/robot            then, elsewhere: rsapien --link /tmp/robot state
  rsapien sim --tcp 7000                  then, elsewhere: rsapien --link tcp://127.0.0.1:7000 init
  rsapien sim --firmware --pty /tmp/robot in a clone, after make -C firmware-pic/sim
  echo '{\"press\":\"left-hand\"}' | nc -N -U /tmp/robot.control")]
pub(crate) struct Cmd {
    /// Make LINK a symbolic link to a pseudo-terminal that speaks as the robot's serial port does
    #[arg(long, value_name = "LINK")]
    pty: Option<PathBuf>,

    /// Listen on HOST:PORT or PORT; loopback unless told otherwise; port 0 takes a free one
    #[arg(long, value_name = "ADDRESS")]
    tcp: Option<String>,

    /// Where the control channel's Unix socket stands
    #[arg(long, value_name = "SOCKET")]
    control: Option<PathBuf>,

    /// Offer the control channel on TCP, too
    #[arg(long, value_name = "ADDRESS")]
    control_tcp: Option<String>,

    /// Allow addresses that other machines reach; nobody is asked for a password there
    #[arg(long)]
    allow_remote: bool,

    /// Seed of everything random
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    #[arg(long, value_name = "NAME|FILE", default_value = "demo", help = world::HELP)]
    world: String,

    /// Let the time of the line and 200 virtual ms after each answer pass at once; what is beyond takes real time.
    /// A program that looks at the robot often sees it move hundreds of times faster
    #[arg(long)]
    fast: bool,

    #[command(flatten)]
    firmware: FirmwareOptions,
}

/// How often the robot is looked at.
const LOOK: Duration = Duration::from_millis(50);
/// When so much virtual time could not be made up for, the simulation is called slow, in ms.
const SLOW_MS: u64 = 1000;

impl Cmd {
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        let interrupt = Interrupt::install()?;
        let controllers = self.firmware.controllers(context)?;
        let images = firmware::images(&controllers);
        let simulator = Simulator::start(SimulatorConfig {
            robot: VirtualRobotConfig {
                seed: self.seed,
                world: world::named(&self.world, self.seed)?,
                baud: context.baud,
                controllers,
                ..VirtualRobotConfig::default()
            },
            pty: self.pty,
            tcp: self.tcp,
            control: self.control,
            control_tcp: self.control_tcp,
            allow_remote: self.allow_remote,
            clock: if self.fast { Clock::Free } else { Clock::default() },
        })?;
        tell(context, out, &simulator, &images)?;
        watch(interrupt, &simulator)?;
        simulator.stop();
        Ok(Status::Done)
    }
}

/// Waits until the user wants the end, or the controllers are dead.
fn watch(interrupt: Interrupt, simulator: &Simulator) -> Result<()> {
    let mut is_told = false;
    while !interrupt.is_raised() {
        if let Some(failure) = simulator.robot().lock().failure() {
            return Err(failure.clone().into());
        }
        if !is_told && simulator.lost_ms() > SLOW_MS {
            tracing::warn!(
                "the simulation is slower than real time here; the robot's time passes more slowly, and all goes on"
            );
            is_told = true;
        }
        std::thread::sleep(LOOK);
    }
    Ok(())
}

fn tell(
    context: &Context,
    out: &mut impl Write,
    simulator: &Simulator,
    images: &[String],
) -> Result<()> {
    let links: Vec<String> = simulator
        .link()
        .map(|link| link.display().to_string())
        .into_iter()
        .chain(simulator.tcp_address().map(|address| format!("tcp://{address}")))
        .collect();
    let answer = serde_json::json!({
        "links": links,
        "terminal": simulator.terminal(),
        "control": simulator.control_path(),
        "control_tcp": simulator.control_tcp_address(),
        "firmware": images,
    });
    let mut text = vec!["the virtual robot runs until Ctrl-C".to_owned()];
    for image in images {
        text.push(format!("  firmware {image}"));
    }
    let width = links.iter().map(String::len).max().unwrap_or(0);
    for link in &links {
        text.push(format!("  link     {link:<width$}   try: rsapien --link {link} state"));
    }
    if let Some(path) = simulator.control_path() {
        text.push(format!("  control  {}", path.display()));
    }
    if let Some(address) = simulator.control_tcp_address() {
        text.push(format!("  control  tcp://{address}"));
    }
    context.style.answer(out, &answer, text.join("\n"))
}

impl From<SimulatorError> for Failure {
    fn from(error: SimulatorError) -> Self {
        let failure = Self::from_error(&error);
        match error {
            SimulatorError::NoEndpoint => {
                failure.hint("give --pty LINK or --tcp ADDRESS, as in rsapien sim --pty /tmp/robot")
            }
            SimulatorError::NotLoopback { .. } => failure.hint("--allow-remote allows it"),
            _ => failure,
        }
    }
}
