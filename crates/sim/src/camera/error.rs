//! What may be wrong with a camera's settings or a direction.

use thiserror::Error;

/// Why a camera setting or a direction was refused.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum CameraError {
    /// A setting lies outside its limits or is not finite.
    #[error("{quantity} is {value}, allowed are {least} to {most}")]
    OutOfRange {
        /// The setting, with its unit.
        quantity: &'static str,
        /// What was given.
        value: f64,
        /// Least value allowed.
        least: f64,
        /// Greatest value allowed.
        most: f64,
    },
    /// The head cannot turn that far.
    #[error(
        "pan {pan_degrees:.2} and tilt {tilt_degrees:.2} degrees are out of the head's reach of -90 to 90 and -45 to 45"
    )]
    OutOfReach {
        /// Pan in degrees, right positive.
        pan_degrees: f64,
        /// Tilt in degrees, up positive.
        tilt_degrees: f64,
    },
}

pub(super) fn within(
    quantity: &'static str,
    value: f64,
    least: f64,
    most: f64,
) -> Result<(), CameraError> {
    // Written so that a value that is no number is refused too.
    if value >= least && value <= most {
        Ok(())
    } else {
        Err(CameraError::OutOfRange { quantity, value, least, most })
    }
}
