//! Whether the controllers run.

use rsapien_firmware_model::ResetCause;
use serde::{Deserialize, Serialize};

use crate::body::BROWN_OUT_MV;

/// Whether the controllers run, and if not why.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Power {
    /// They run.
    On,
    /// Held in reset until the supply is back above the brown-out threshold.
    BrownOut,
    /// Switched off.
    Off,
}

impl Power {
    /// Whether the controllers run.
    pub const fn is_on(self) -> bool {
        matches!(self, Power::On)
    }

    /// The change that the supply brings about, if any.
    pub(super) const fn after_ms(self, supply_mv: u32) -> Option<Power> {
        match self {
            Power::On if supply_mv < BROWN_OUT_MV => Some(Power::BrownOut),
            Power::BrownOut if supply_mv >= BROWN_OUT_MV => Some(Power::On),
            _ => None,
        }
    }

    /// What the controllers will tell when they run again.
    pub(super) const fn reset_cause(self) -> ResetCause {
        match self {
            Power::BrownOut => ResetCause::BrownOut,
            Power::On | Power::Off => ResetCause::PowerOn,
        }
    }
}
