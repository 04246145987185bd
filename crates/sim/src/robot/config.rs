//! How a virtual robot is made.

use crate::body::BodyConfig;
use crate::camera::{CameraError, CameraSettings};
use crate::firmware::{FirmwareConfig, FirmwareError};
use crate::line::BAUD;
use crate::world::World;

/// Clocks the firmware may be built for, in MHz.
const CLOCKS_MHZ: [u8; 4] = [4, 10, 20, 40];

/// What runs in place of the two chips.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Controllers {
    /// The firmware's reference model.
    #[default]
    Model,
    /// The firmware itself, as it is flashed, in a simulator of the chips.
    Firmware(FirmwareConfig),
}

/// Everything that makes one virtual robot differ from another.
#[derive(Debug, Clone)]
pub struct VirtualRobotConfig {
    /// Seed of everything random: deviations of the body, damage on the line, noise of the camera.
    pub seed: u64,
    /// Where it stands.
    pub world: World,
    /// Speed of the line in bit/s, within [`BAUD`].
    pub baud: u32,
    /// Clock of both controllers in MHz: 4, 10, 20 or 40. A firmware has the one it was built for instead.
    pub clock_mhz: u8,
    /// What runs in place of the two chips.
    pub controllers: Controllers,
    /// Size, blur and noise of pictures. Its own seed is combined with `seed`.
    pub camera: CameraSettings,
    /// The body and where it starts.
    pub body: BodyConfig,
}

impl Default for VirtualRobotConfig {
    /// Seed 1, the demo world, 57600 baud, 40 MHz, the model, a webcam's pictures.
    fn default() -> Self {
        Self {
            seed: 1,
            world: World::demo(),
            baud: 57_600,
            clock_mhz: 40,
            controllers: Controllers::default(),
            camera: CameraSettings::default(),
            body: BodyConfig::default(),
        }
    }
}

impl VirtualRobotConfig {
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        if !BAUD.contains(&self.baud) {
            return Err(ConfigError::Baud { baud: self.baud });
        }
        if !CLOCKS_MHZ.contains(&self.clock_mhz) {
            return Err(ConfigError::Clock { clock_mhz: self.clock_mhz });
        }
        if let Controllers::Firmware(firmware) = &self.controllers {
            firmware.check(self.baud)?;
        }
        Ok(())
    }

    pub(super) fn camera_settings(&self) -> CameraSettings {
        CameraSettings { seed: self.camera.seed ^ self.seed.rotate_left(32), ..self.camera.clone() }
    }
}

/// Why no robot was made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConfigError {
    /// A line speed out of range.
    #[error("a line of {baud} baud is not simulated, allowed are {} to {}", BAUD.start(), BAUD.end())]
    Baud {
        /// What was asked for, in bit/s.
        baud: u32,
    },
    /// A clock the firmware is not built for.
    #[error("a clock of {clock_mhz} MHz is not simulated, allowed are 4, 10, 20 and 40")]
    Clock {
        /// What was asked for, in MHz.
        clock_mhz: u8,
    },
    /// A camera setting out of range.
    #[error("the camera: {0}")]
    Camera(#[from] CameraError),
    /// The firmware does not run.
    #[error(transparent)]
    Firmware(#[from] FirmwareError),
}
