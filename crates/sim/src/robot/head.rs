//! The pan/tilt head: two hobby servos that follow their pulses.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rsapien_firmware_model::CameraOutputs;

use crate::camera::HeadAngles;

/// The fastest a servo turns, in 0.01 degree a ms: 200 degrees a second, a little more than the firmware ever asks for.
pub const HEAD_SPEED_CENTIDEG_PER_MS: i16 = 20;

/// Where somebody left the head, up to this far from zero, in 0.01 degree.
const LEFT_AT_CENTIDEG: i16 = 1_500;

/// The head as it truly points.
#[derive(Debug, Clone)]
pub(super) struct Head {
    angles: HeadAngles,
}

impl Head {
    pub(super) fn new(seed: u64) -> Self {
        // A stream of its own, so that the body's draws never move the head.
        let mut random = Pcg64::seed_from_u64(seed ^ 0x4EAD);
        let mut left = || random.random_range(-LEFT_AT_CENTIDEG..=LEFT_AT_CENTIDEG);
        Self { angles: HeadAngles { pan_centideg: left(), tilt_centideg: left() } }
    }

    pub(super) fn angles(&self) -> HeadAngles {
        self.angles
    }

    /// Follows the pulses for one ms; without pulses a servo stays where it is.
    pub(super) fn step(&mut self, outputs: CameraOutputs) {
        follow(&mut self.angles.pan_centideg, outputs.pan_centideg);
        follow(&mut self.angles.tilt_centideg, outputs.tilt_centideg);
    }
}

fn follow(angle: &mut i16, target: Option<i16>) {
    if let Some(target) = target {
        let way = target.saturating_sub(*angle);
        *angle += way.clamp(-HEAD_SPEED_CENTIDEG_PER_MS, HEAD_SPEED_CENTIDEG_PER_MS);
    }
}
