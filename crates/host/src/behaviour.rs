//! Behaviours: from what the camera sees to what the head does (feature `vision`).
//!
//! A behaviour moves through [`Head`] only, so that it runs the same with a robot, a simulator or a test.

mod ball;
mod contour;
mod pinhole;

pub use ball::{BallFound, BallSearch, Sight};
pub use contour::contour_share;
pub use pinhole::{Direction, Pinhole};

use rsapien_vision::GrayImage;

/// What a behaviour needs of a head with a camera.
pub trait Head {
    /// Why it cannot look or see.
    type Error;

    /// Turns the head towards `to`, waits until it is there, and tells where it is.
    ///
    /// # Errors
    /// The head's, such as a lost link.
    fn look(&mut self, to: Direction) -> Result<Direction, Self::Error>;

    /// Takes a picture.
    ///
    /// # Errors
    /// The camera's, such as a file that is no picture.
    fn see(&mut self) -> Result<GrayImage, Self::Error>;
}
