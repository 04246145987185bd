//! A simple body: joints that move by the motors' outputs between end stops, and mid-arm switches.

use rsapien_firmware_model::{MiddleSwitches, switch_half_window_ms};
use rsapien_protocol::Joint;

/// What the mid-arm switches of a body do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SwitchBehaviour {
    /// Closed while the arm stands at its middle.
    #[default]
    Works,
    /// Never closed.
    StuckOpen,
    /// Always closed.
    StuckClosed,
}

/// The joints as they truly stand.
#[derive(Clone, Debug)]
pub struct Body {
    /// From the first end stop, in thousandths of a ms of travel.
    position_us: [u32; Joint::COUNT],
    /// From end stop to end stop, in ms.
    full_travel_ms: [u16; Joint::COUNT],
    /// What the switches do.
    pub switches: SwitchBehaviour,
}

impl Body {
    /// A body whose joints take `full_travel_ms` and stand at `place_permille` of their travel.
    pub fn new(full_travel_ms: [u16; Joint::COUNT], place_permille: u16) -> Body {
        let place = u32::from(place_permille.min(1000));
        Body {
            position_us: full_travel_ms.map(|travel_ms| u32::from(travel_ms) * place),
            full_travel_ms,
            switches: SwitchBehaviour::Works,
        }
    }

    /// One ms under the outputs `[towards_first, towards_last]`, bit *j* for joint *j*.
    pub fn advance(&mut self, [towards_first, towards_last]: [u8; 2]) {
        for (index, position_us) in self.position_us.iter_mut().enumerate() {
            let bit = 1 << index;
            if towards_first & bit != 0 {
                *position_us = position_us.saturating_sub(1000);
            }
            if towards_last & bit != 0 {
                let end_us = u32::from(self.full_travel_ms[index]) * 1000;
                *position_us = (*position_us + 1000).min(end_us);
            }
        }
    }

    /// The switches as they stand.
    pub fn middle_switches(&self) -> MiddleSwitches {
        let closed = |joint: Joint| match self.switches {
            SwitchBehaviour::Works => {
                let index = usize::from(joint.index());
                let travel_ms = self.full_travel_ms[index];
                let window_us = u32::from(switch_half_window_ms(travel_ms)) * 1000;
                self.position_us[index].abs_diff(u32::from(travel_ms) * 500) <= window_us
            }
            SwitchBehaviour::StuckOpen => false,
            SwitchBehaviour::StuckClosed => true,
        };
        MiddleSwitches { left: closed(Joint::LeftArm), right: closed(Joint::RightArm) }
    }
}
