//! `rsapien demo`: the whole system, end to end.

mod log;
mod run;
mod summary;

use std::fs;
use std::io::Write;
use std::path::PathBuf;

use clap::Args;

use self::run::Settings;
use crate::LinkAddress;
use crate::cli::camera::CameraOptions;
use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::exit::Status;
use crate::cli::firmware::FirmwareOptions;
use crate::cli::robot;
use crate::cli::world;

/// See the whole system at work: the robot walks, looks for a ball on the table and turns its head to it
///
/// Without --link it is the virtual robot, which needs nothing plugged in. The robot is initialised, walks until a foot
/// meets something or the action ends, scans the table, detects the ball in the camera's picture with the paper's
/// detector, and turns the head until the ball is centred. It ends with a summary, and writes the annotated picture
/// (ball.png) and the log of packages (packages.txt) to a folder; files of these names there are replaced.
///
/// The exit status is 1 when the ball was not found or not centred.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien demo
  rsapien demo --fast --seed 7 --world random
  rsapien demo --firmware                 with the firmware itself, in a clone after make -C firmware-pic/sim
  rsapien demo --link /tmp/robot          a robot of rsapien sim --pty /tmp/robot")]
pub(crate) struct Cmd {
    /// With the virtual robot: let its time pass as fast as it goes
    #[arg(long)]
    fast: bool,

    /// Seed of the virtual robot and of the detector
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    #[arg(long, value_name = "NAME|FILE", default_value = "demo", help = world::HELP)]
    world: String,

    /// Folder for the picture and the log (made where missing)
    #[arg(short, long, value_name = "DIR", default_value = "rsapien-demo")]
    out: PathBuf,

    /// Range of the ball's radius in the picture, in pixels
    #[arg(long, value_name = "MIN..MAX", default_value = "14..60")]
    radius: super::detect::AxisRange,

    /// How often walk-forward is played, 0 to 100
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(0..=100))]
    walks: u16,

    /// Field of view across in degrees of a camera that is a file, 5 to 140
    #[arg(long, value_name = "DEG", default_value_t = 60.0, value_parser = field_of_view)]
    field_of_view: f64,

    #[command(flatten)]
    camera: CameraOptions,

    #[command(flatten)]
    firmware: FirmwareOptions,
}

impl Cmd {
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        let link = match context.link {
            None => LinkAddress::Virtual,
            Some(_) => robot::address(context)?,
        };
        if self.fast && link != LinkAddress::Virtual {
            return Err(robot::fast_needs_virtual());
        }
        if self.firmware.is_asked() && link != LinkAddress::Virtual {
            return Err(Failure::new("--firmware: only a virtual robot of this command can be made with it")
                .hint("leave --firmware away, or leave --link away; rsapien sim --firmware makes one for others"));
        }
        let source = self.camera.camera.resolve(&link)?;
        // Before anything moves, so that the work is not for nothing.
        fs::create_dir_all(&self.out).map_err(|error| Failure::file("make", &self.out, &error))?;
        let settings = Settings {
            link,
            fast: self.fast,
            seed: self.seed,
            world: world::named(&self.world, self.seed)?,
            controllers: self.firmware.controllers(context)?,
            radius_px: self.radius.limits(),
            walks: self.walks,
            field_of_view_deg: self.field_of_view,
            picture_file: self.out.join("ball.png"),
            log_file: self.out.join("packages.txt"),
        };
        let report = run::run(context, out, source, settings)?;
        let status = if report.is_success() { Status::Done } else { Status::Refused };
        context.style.answer(out, &report.json(), report.text())?;
        Ok(status)
    }
}

fn field_of_view(text: &str) -> std::result::Result<f64, String> {
    match text.parse() {
        Ok(degrees) if (5.0..=140.0).contains(&degrees) => Ok(degrees),
        _ => Err("expected 5 to 140 degrees".to_owned()),
    }
}
