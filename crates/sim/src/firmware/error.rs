//! Why a firmware does not run.

use std::path::PathBuf;

use rsapien_protocol::Address;

/// How the simulator of the chips is built.
const BUILD: &str = "build it with: make -C firmware-pic/sim";

/// Why a firmware does not run in the simulator of its chips.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FirmwareError {
    /// The folder of the images is not there or cannot be read.
    #[error("no firmware in {}: {why}; name the folder of the hex files, in a clone firmware-pic/hex", folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// What the system says.
        why: String,
    },
    /// The folder has no image of a controller for this speed of the line.
    #[error(
        "no firmware of the {controller} controller for {baud} baud in {}: {found}",
        folder.display()
    )]
    NoImage {
        /// Whose image is missing.
        controller: Address,
        /// The speed asked for, in bit/s.
        baud: u32,
        /// The folder.
        folder: PathBuf,
        /// What is there instead, and what to do.
        found: String,
    },
    /// A file that is not named as images are.
    #[error(
        "{} is not named as firmware is: rsapien-motion-18f452-40mhz-57600.hex tells controller, chip, clock and baud",
        path.display()
    )]
    ImageName {
        /// The file.
        path: PathBuf,
    },
    /// An image that is not there.
    #[error("there is no firmware {}: build it with: make -C firmware-pic/port/pic18", path.display())]
    ImageMissing {
        /// The file.
        path: PathBuf,
    },
    /// The image was built for another line than the robot's.
    #[error(
        "{} was built for {image_baud} baud and the line has {baud}: give --baud {image_baud}, or build an image for {baud}",
        path.display()
    )]
    Baud {
        /// The image.
        path: PathBuf,
        /// What it was built for, in bit/s.
        image_baud: u32,
        /// What the line has, in bit/s.
        baud: u32,
    },
    /// The image belongs to the other controller.
    #[error("{} is not the firmware of the {expected} controller", path.display())]
    Controller {
        /// The image.
        path: PathBuf,
        /// Whose was wanted.
        expected: Address,
    },
    /// The simulator of the chips could not be started.
    #[error("the simulator of the chips, {}, does not start: {why}; {BUILD}", path.display())]
    NotStarted {
        /// The program.
        path: PathBuf,
        /// What the system says.
        why: String,
    },
    /// The simulator of a chip has ended.
    #[error("the simulator of the {chip} controller's chip has ended: {why}")]
    Ended {
        /// Which controller's.
        chip: &'static str,
        /// The last line that it wrote to its standard error, or what the system says.
        why: String,
    },
    /// The simulator of a chip does not answer.
    #[error(
        "the simulator of the {chip} controller's chip has not answered {asked:?} for {patience_s} s and was ended"
    )]
    Silent {
        /// Which controller's.
        chip: &'static str,
        /// What it was asked.
        asked: String,
        /// How long it was waited for, in s.
        patience_s: u64,
    },
    /// The simulator of a chip answered something else than was asked for.
    #[error(
        "the simulator of the {chip} controller's chip answered {asked:?} with {answer:?}; is it of this version? {BUILD}"
    )]
    Answer {
        /// Which controller's.
        chip: &'static str,
        /// What it was asked.
        asked: String,
        /// What it answered.
        answer: String,
    },
}
