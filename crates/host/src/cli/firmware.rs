//! The firmware itself in place of the virtual robot's model: `--firmware`.

use std::env;
use std::path::{Path, PathBuf};

use clap::Args;
use rsapien_sim::firmware::{FirmwareConfig, FirmwareError, FirmwareImage};
use rsapien_sim::robot::Controllers;

use super::context::Context;
use super::diagnostics::{Failure, Result};

/// The simulator of the chips, as it is built in a clone.
const BUILT: &str = "target/firmware/sim/rsapien-gpsim";
/// The images, as they are kept in a clone.
const FOLDER: &str = "firmware-pic/hex";
/// And as it is called where it is installed.
const NAME: &str = "rsapien-gpsim";
/// Names another one.
const VARIABLE: &str = "RSAPIEN_GPSIM";

/// Options of the commands that make a virtual robot with a firmware.
#[derive(Debug, Clone, Args)]
pub(crate) struct FirmwareOptions {
    /// Run the firmware itself, as it is flashed, in a simulator of both chips instead of its model; the hex files are in
    /// DIR. About as fast as a robot on an idle computer
    #[arg(
        long,
        value_name = "DIR",
        num_args = 0..=1,
        default_missing_value = FOLDER
    )]
    firmware: Option<PathBuf>,

    /// With --firmware: the simulator of the chips, if it is neither the variable's, nor built in the current
    /// folder (target/firmware/sim/rsapien-gpsim), nor installed
    #[arg(long, value_name = "PATH", requires = "firmware")]
    simulator: Option<PathBuf>,
}

impl FirmwareOptions {
    /// Whether a firmware is asked for.
    pub(crate) fn is_asked(&self) -> bool {
        self.firmware.is_some()
    }

    /// The controllers asked for.
    pub(crate) fn controllers(&self, context: &Context) -> Result<Controllers> {
        let Some(folder) = &self.firmware else { return Ok(Controllers::Model) };
        self.of(folder, context)
    }

    /// A firmware in any case: that of a clone where none is asked for.
    pub(crate) fn controllers_or_default(&self, context: &Context) -> Result<Controllers> {
        self.of(self.firmware.as_deref().unwrap_or(Path::new(FOLDER)), context)
    }

    fn of(&self, folder: &Path, context: &Context) -> Result<Controllers> {
        let simulator = self.simulator.clone().unwrap_or_else(|| {
            match env::var_os(VARIABLE).filter(|value| !value.is_empty()) {
                Some(path) => PathBuf::from(path),
                None if Path::new(BUILT).exists() => PathBuf::from(BUILT),
                None => PathBuf::from(NAME),
            }
        });
        Ok(Controllers::Firmware(FirmwareConfig::find(folder, simulator, context.baud)?))
    }
}

/// The images of these controllers, motion first; none with the model.
pub(crate) fn images(controllers: &Controllers) -> Vec<String> {
    let path = |image: &FirmwareImage| image.path().display().to_string();
    match controllers {
        Controllers::Model => Vec::new(),
        Controllers::Firmware(firmware) => vec![path(&firmware.motion), path(&firmware.camera)],
    }
}

impl From<FirmwareError> for Failure {
    fn from(error: FirmwareError) -> Self {
        Self::from_error(&error)
    }
}
