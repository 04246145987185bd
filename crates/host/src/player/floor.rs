//! Where an action is performed: on a line that nothing else uses, or beside others.

use rsapien_protocol::Step;

use super::{PlayOptions, PlayReport, run};
use crate::line::Line;
use crate::{Error, Interruption};

/// What plays the steps of an action, and knows what else goes on on the robot.
pub(crate) trait Floor {
    /// The line to the robot.
    fn line(&self) -> &Line;
    /// Plays steps to their end; STOP since `stop_generation` ends them.
    fn play(
        &self,
        steps: &[Step],
        options: &mut PlayOptions<'_>,
        stop_generation: u64,
    ) -> Result<PlayReport, Error>;
    /// Counts the STOPs that end what is performed here.
    fn stop_generation(&self) -> u64;
    /// Releases a hold, unless STOP was asked for since `stop_generation`: whether motion may follow.
    fn release(&self, stop_generation: u64) -> bool;
    /// What ended the performance from outside its options.
    fn ended(&self) -> Option<Interruption> {
        None
    }
    /// Counts the STOPs that were for others and end nothing here.
    fn own_stops(&self) -> u64 {
        0
    }
}

impl Floor for Line {
    fn line(&self) -> &Line {
        self
    }

    fn play(
        &self,
        steps: &[Step],
        options: &mut PlayOptions<'_>,
        stop_generation: u64,
    ) -> Result<PlayReport, Error> {
        run::play(self, steps, options, stop_generation)
    }

    fn stop_generation(&self) -> u64 {
        Line::stop_generation(self)
    }

    fn release(&self, stop_generation: u64) -> bool {
        Line::stop_generation(self) == stop_generation
            && self.stop().is_ok()
            && Line::stop_generation(self) == stop_generation + 1
    }
}
