//! The secondary routine for the middle arm position (paper, section 2): it runs when a mid-arm
//! switch changes, at once and not at the next tick.
//!
//! ```text
//!   switch changes ─► motor off or homing ──────────────────────────────────► nothing
//!                  ─► more than T / 4 from the reckoned middle ─────────────► nothing (not believed)
//!                  ─► on the way to the middle, closes ─► position = edge, motor off, reached
//!                  ─► on the way to the middle, opens  ─────────────────────► nothing
//!                  ─► on the way to an end stop ─► position = edge, the rest of the way anew
//!
//!   edges:   First ──────────────[ T/2 - T/32      closed      T/2 + T/32 ]────────────── Last
//!                    towards last: closes here                  opens here
//!                    towards first: opens here                  closes here
//! ```

use rsapien_protocol::{Joint, Position};

use crate::joint::{JointDrive, JointState, MotorOutput};

/// Half the width of the window around the middle in which a mid-arm switch is closed, for a
/// full travel time of `full_travel_ms`.
pub const fn switch_half_window_ms(full_travel_ms: u16) -> u16 {
    full_travel_ms / 32
}

/// The mid-arm switches: closed while the arm stands at its middle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct MiddleSwitches {
    /// The left arm's.
    pub left: bool,
    /// The right arm's.
    pub right: bool,
}

impl MiddleSwitches {
    /// Whether the switch of `joint` is closed; none for a joint without one.
    pub const fn closed(self, joint: Joint) -> Option<bool> {
        match joint {
            Joint::LeftArm => Some(self.left),
            Joint::RightArm => Some(self.right),
            _ => None,
        }
    }
}

/// The switch of an arm has changed.
pub(crate) fn switch_changed(arm: &mut JointDrive, closed: bool) {
    if matches!(arm.state, JointState::Resting | JointState::Homing) {
        return;
    }
    let middle_ms = arm.middle_ms();
    if arm.position_ms.abs_diff(middle_ms) > arm.full_travel_ms / 4 {
        return;
    }
    let to_middle = matches!(arm.target, Position::Middle);
    if to_middle && !closed {
        return;
    }
    let half_window_ms = switch_half_window_ms(arm.full_travel_ms);
    let towards_last = arm.motor == MotorOutput::TowardsLast;
    arm.position_ms = if towards_last == closed {
        middle_ms - half_window_ms
    } else {
        middle_ms + half_window_ms
    };
    if to_middle {
        arm.arrive();
    } else {
        arm.reckon_way_to_end_stop();
    }
}
