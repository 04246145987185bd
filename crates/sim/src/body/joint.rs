//! One joint: a DC motor that drives it between two end stops.

use rand::RngExt;
use rand_pcg::Pcg64;
use rsapien_protocol::Joint;

use super::Contact;

/// The nominal full travel time of a joint at the nominal voltage, in ms: arms 1000, hands 400, tilt 500, legs 600.
pub const fn nominal_travel_ms(joint: Joint) -> u16 {
    match joint {
        Joint::RightArm | Joint::LeftArm => 1000,
        Joint::RightHand | Joint::LeftHand => 400,
        Joint::Tilt => 500,
        Joint::RightLeg | Joint::LeftLeg => 600,
    }
}

/// Half the width of the window in which a mid-arm switch is closed, as a fraction of full travel.
pub const SWITCH_HALF_WINDOW: f64 = 1.0 / 32.0;

/// What a motor's two direction pins ask for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Drive {
    /// Neither pin, or both, which brakes.
    Off,
    /// Towards the first position: arm up, hand in, tilt left, leg front.
    TowardsFirst,
    /// Towards the last position: arm down, hand open, tilt right, leg back.
    TowardsLast,
}

/// A joint as it truly is.
#[derive(Debug, Clone)]
pub(super) struct BodyJoint {
    /// Fraction of full travel at the nominal voltage in one ms.
    speed_per_ms: f64,
    /// Fraction of full travel, 0 at the first end stop, 1 at the last.
    position: f64,
    /// Where the middle switch stands, for arms; a little off the true middle as on any toy.
    switch_at: f64,
    stalled: bool,
    pub(super) stuck: bool,
    pub(super) switch: Contact,
}

impl BodyJoint {
    /// A joint of a travel time drawn within `deviation` (a fraction) of the nominal one, at rest where `position` is.
    pub(super) fn new(joint: Joint, position: f64, deviation: f64, random: &mut Pcg64) -> Self {
        let factor = 1.0 + deviation * random.random_range(-1.0..=1.0);
        let switch_at = 0.5 + 0.1 * deviation * random.random_range(-1.0..=1.0);
        Self {
            speed_per_ms: 1.0 / (f64::from(nominal_travel_ms(joint)) * factor),
            position,
            switch_at,
            stalled: false,
            stuck: false,
            switch: Contact::Working,
        }
    }

    /// Moves for one ms and returns by how much, in fractions of full travel. `vigour` is 1 at the nominal voltage.
    pub(super) fn step(&mut self, drive: Drive, vigour: f64) -> f64 {
        let wanted = match drive {
            Drive::Off => {
                self.stalled = false;
                return 0.0;
            }
            Drive::TowardsFirst => -self.speed_per_ms * vigour,
            Drive::TowardsLast => self.speed_per_ms * vigour,
        };
        let before = self.position;
        if !self.stuck {
            self.position = (before + wanted).clamp(0.0, 1.0);
        }
        let moved = self.position - before;
        self.stalled = moved == 0.0;
        moved
    }

    pub(super) fn position(&self) -> f64 {
        self.position
    }

    pub(super) fn set_position(&mut self, position: f64) {
        self.position = position.clamp(0.0, 1.0);
    }

    /// Full travel time at the nominal voltage in ms.
    pub(super) fn travel_ms(&self) -> f64 {
        1.0 / self.speed_per_ms
    }

    /// Whether the motor ran against an end stop or a jam in the last ms.
    pub(super) fn is_stalled(&self) -> bool {
        self.stalled
    }

    pub(super) fn is_switch_closed(&self) -> bool {
        self.switch.apply((self.position - self.switch_at).abs() <= SWITCH_HALF_WINDOW)
    }
}
