//! Which images run: hex files, whose names tell what they were built for.

use std::fs;
use std::path::{Path, PathBuf};

use rsapien_protocol::Address;

use super::FirmwareError;

/// A hex file of one controller.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FirmwareImage {
    path: PathBuf,
    controller: Address,
    chip: String,
    clock_mhz: u8,
    baud: u32,
}

/// What runs in the simulator of the chips.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FirmwareConfig {
    /// The simulator, `rsapien-gpsim`. A name without a slash is looked for as the system looks for programs.
    pub simulator: PathBuf,
    /// The motion controller's image.
    pub motion: FirmwareImage,
    /// The camera controller's image.
    pub camera: FirmwareImage,
}

impl FirmwareImage {
    /// The image at `path`, whose name tells what it is: `rsapien-CONTROLLER-CHIP-CLOCKmhz-BAUD.hex`, such as
    /// `rsapien-motion-18f452-40mhz-57600.hex`. The file is not opened.
    ///
    /// # Errors
    /// [`FirmwareError::ImageName`].
    pub fn at(path: impl Into<PathBuf>) -> Result<Self, FirmwareError> {
        let path = path.into();
        match Self::parse(&path) {
            Some((controller, chip, clock_mhz, baud)) => {
                Ok(Self { path, controller, chip, clock_mhz, baud })
            }
            None => Err(FirmwareError::ImageName { path }),
        }
    }

    fn parse(path: &Path) -> Option<(Address, String, u8, u32)> {
        let name = path.file_name()?.to_str()?.strip_suffix(".hex")?.strip_prefix("rsapien-")?;
        let mut parts = name.split('-');
        let controller = parts.next()?;
        let controller = Address::ALL.into_iter().find(|address| address.name() == controller)?;
        let chip = parts.next()?.to_owned();
        let clock_mhz = parts.next()?.strip_suffix("mhz")?.parse().ok()?;
        let baud = parts.next()?.parse().ok()?;
        let is_whole = parts.next().is_none() && [4, 10, 20, 40].contains(&clock_mhz) && baud > 0;
        is_whole.then_some((controller, chip, clock_mhz, baud))
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The controller it belongs to.
    pub fn controller(&self) -> Address {
        self.controller
    }

    /// The clock it was built for, in MHz: 4, 10, 20 or 40.
    pub fn clock_mhz(&self) -> u8 {
        self.clock_mhz
    }

    /// The speed of the line it was built for, in bit/s.
    pub fn baud(&self) -> u32 {
        self.baud
    }

    /// The chip as the simulator calls it. It does not know the 18F2320; the 18F2321 is the nearest that it knows, and
    /// runs the same hex.
    pub(super) fn processor(&self) -> String {
        match self.chip.as_str() {
            "18f2320" => "p18f2321".to_owned(),
            chip => format!("p{chip}"),
        }
    }

    fn check(&self, controller: Address, baud: u32) -> Result<(), FirmwareError> {
        let path = || self.path.clone();
        if self.controller != controller {
            return Err(FirmwareError::Controller { path: path(), expected: controller });
        }
        if self.baud != baud {
            return Err(FirmwareError::Baud { path: path(), image_baud: self.baud, baud });
        }
        if !self.path.is_file() {
            return Err(FirmwareError::ImageMissing { path: path() });
        }
        Ok(())
    }
}

impl FirmwareConfig {
    /// The images in `folder` that were built for a line of `baud` bit/s; of several the ones with the fastest clock.
    ///
    /// # Errors
    /// [`FirmwareError::Folder`], or [`FirmwareError::NoImage`], which tells what there is instead.
    pub fn find(
        folder: &Path,
        simulator: impl Into<PathBuf>,
        baud: u32,
    ) -> Result<Self, FirmwareError> {
        let unreadable = |error: std::io::Error| FirmwareError::Folder {
            folder: folder.to_owned(),
            why: error.to_string(),
        };
        let mut images = Vec::new();
        for entry in fs::read_dir(folder).map_err(unreadable)? {
            // Files of other names may lie beside them, such as their checksums.
            images.extend(FirmwareImage::at(entry.map_err(unreadable)?.path()).ok());
        }
        images.sort_by(|one, other| one.path.cmp(&other.path));
        let find = |controller| {
            let of_controller = images.iter().filter(|image| image.controller == controller);
            let fitting = of_controller.clone().filter(|image| image.baud == baud);
            fitting.max_by_key(|image| image.clock_mhz).cloned().ok_or_else(|| {
                let mut bauds: Vec<u32> = of_controller.map(|image| image.baud).collect();
                bauds.sort_unstable();
                bauds.dedup();
                let bauds: Vec<String> = bauds.iter().map(u32::to_string).collect();
                let found = match bauds.as_slice() {
                    [] => "its images are rsapien-*.hex, in a clone in firmware-pic/hex".to_owned(),
                    bauds => format!("there is one for --baud {}", bauds.join(" and ")),
                };
                FirmwareError::NoImage { controller, baud, folder: folder.to_owned(), found }
            })
        };
        Ok(Self {
            simulator: simulator.into(),
            motion: find(Address::Motion)?,
            camera: find(Address::Camera)?,
        })
    }

    /// Whether both images are there and were built for a line of `baud` bit/s.
    pub(crate) fn check(&self, baud: u32) -> Result<(), FirmwareError> {
        self.motion.check(Address::Motion, baud)?;
        self.camera.check(Address::Camera, baud)
    }
}
