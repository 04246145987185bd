//! The two batteries: one for the controllers, one for the motors (paper, section 2).

use serde::{Deserialize, Serialize};

/// How fast the batteries drain, in microvolts per second.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Drain {
    /// Drop of the controllers' voltage, always.
    pub controller_uv_per_s: u32,
    /// Drop of the motors' voltage for each motor that runs.
    pub motor_uv_per_s: u32,
}

impl Default for Drain {
    /// Batteries that last an afternoon: 28 µV/s (0.1 V an hour), and 20 µV/s for each running motor.
    fn default() -> Self {
        Self { controller_uv_per_s: 28, motor_uv_per_s: 20 }
    }
}

/// Voltage of fresh batteries of the controllers in mV.
pub const FRESH_CONTROLLER_MV: u32 = 5500;
/// Voltage at which motors take their nominal travel times, in mV; also that of fresh batteries.
pub const NOMINAL_MOTOR_MV: u32 = 6000;
/// Below this the controllers can no longer run at 40 MHz and tell that the supply is low, in mV (paper, section 2).
pub const LOW_MV: u32 = 5000;
/// Below this the controllers are held in reset, in mV: the brown-out threshold that the firmware configures.
pub const BROWN_OUT_MV: u32 = 4200;
/// The highest voltage that may be set, in mV.
pub const HIGHEST_MV: u32 = 9000;

/// Both batteries.
#[derive(Debug, Clone)]
pub(super) struct Supply {
    controller_uv: u64,
    motor_uv: u64,
    /// Microvolts times ms that are not yet a microvolt.
    controller_rest: u64,
    motor_rest: u64,
    vigour: f64,
    pub(super) drain: Drain,
}

impl Supply {
    pub(super) fn new(drain: Drain) -> Self {
        let mut supply = Self {
            controller_uv: 0,
            motor_uv: 0,
            controller_rest: 0,
            motor_rest: 0,
            vigour: 1.0,
            drain,
        };
        supply.set_controller_mv(FRESH_CONTROLLER_MV);
        supply.set_motor_mv(NOMINAL_MOTOR_MV);
        supply
    }

    /// One ms with `running` motors on.
    pub(super) fn step(&mut self, running: u32) {
        self.controller_rest += u64::from(self.drain.controller_uv_per_s);
        if self.controller_rest >= 1000 {
            self.controller_uv = self.controller_uv.saturating_sub(self.controller_rest / 1000);
            self.controller_rest %= 1000;
        }
        self.motor_rest += u64::from(self.drain.motor_uv_per_s) * u64::from(running);
        if self.motor_rest >= 1000 {
            self.motor_uv = self.motor_uv.saturating_sub(self.motor_rest / 1000);
            self.motor_rest %= 1000;
            self.update_vigour();
        }
    }

    pub(super) fn controller_mv(&self) -> u32 {
        u32::try_from(self.controller_uv / 1000).unwrap_or(u32::MAX)
    }

    pub(super) fn set_controller_mv(&mut self, millivolts: u32) {
        self.controller_uv = u64::from(millivolts.min(HIGHEST_MV)) * 1000;
    }

    pub(super) fn motor_mv(&self) -> u32 {
        u32::try_from(self.motor_uv / 1000).unwrap_or(u32::MAX)
    }

    pub(super) fn set_motor_mv(&mut self, millivolts: u32) {
        self.motor_uv = u64::from(millivolts.min(HIGHEST_MV)) * 1000;
        self.update_vigour();
    }

    /// Speed of the motors as a fraction of the nominal one: in proportion to the voltage, as of any DC motor.
    pub(super) fn vigour(&self) -> f64 {
        self.vigour
    }

    fn update_vigour(&mut self) {
        self.vigour = f64::from(self.motor_mv()) / f64::from(NOMINAL_MOTOR_MV);
    }
}
