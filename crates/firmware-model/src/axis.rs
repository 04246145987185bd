//! The routine that positions one axis of the camera (paper, section 2: one routine for each
//! axis): every tick the commanded position goes on towards the target by what the speed allows.
//!
//! ```text
//!              sent elsewhere
//!   Arrived ───────────────────► Moving ──┐ tick: tenths += speed % 10; step = speed / 10,
//!      ▲                           ▲      │       one more when tenths >= 10 (less 10)
//!      │ distance <= step          └──────┤
//!      └──────────────────────────────────┘
//! ```
//!
//! One degree per second is a tenth of 0.01 degree a tick, so whole steps and tenths make any
//! speed exact without a division in the interrupt.

use rsapien_protocol::AimTarget;

/// As fast as the head can, in degrees per second: what speed 0 and any speed above it mean.
pub const AXIS_SPEED_MAX_DEG_PER_S: u16 = 180;

#[derive(Clone, Debug)]
pub(crate) struct Axis {
    limit_centideg: i16,
    pub(crate) position_centideg: i16,
    pub(crate) target_centideg: i16,
    step_centideg: u8,
    step_tenths: u8,
    tenths: u8,
}

impl Axis {
    pub(crate) const PAN: Axis = Axis::new(AimTarget::PAN_CENTIDEG_MAX);
    pub(crate) const TILT: Axis = Axis::new(AimTarget::TILT_CENTIDEG_MAX);

    const fn new(limit_centideg: i16) -> Axis {
        Axis {
            limit_centideg,
            position_centideg: 0,
            target_centideg: 0,
            step_centideg: 0,
            step_tenths: 0,
            tenths: 0,
        }
    }

    /// Sends the axis to `target_centideg`, which is in its range.
    pub(crate) fn send(&mut self, target_centideg: i16, speed_deg_per_s: u16) {
        let speed = match speed_deg_per_s {
            0 => AXIS_SPEED_MAX_DEG_PER_S,
            speed => speed.min(AXIS_SPEED_MAX_DEG_PER_S),
        };
        let [speed, _] = speed.to_le_bytes();
        self.target_centideg = target_centideg;
        self.step_centideg = speed / 10;
        self.step_tenths = speed % 10;
        self.tenths = 0;
    }

    /// Stops the axis where it is.
    pub(crate) fn stop(&mut self) {
        self.target_centideg = self.position_centideg;
    }

    /// Timer routine: one ms has passed.
    pub(crate) fn advance(&mut self) {
        if !self.is_moving() {
            return;
        }
        let mut step = self.step_centideg;
        self.tenths += self.step_tenths;
        if self.tenths >= 10 {
            self.tenths -= 10;
            step += 1;
        }
        if self.target_centideg.abs_diff(self.position_centideg) <= u16::from(step) {
            self.position_centideg = self.target_centideg;
        } else if self.target_centideg > self.position_centideg {
            self.position_centideg += i16::from(step);
        } else {
            self.position_centideg -= i16::from(step);
        }
    }

    pub(crate) const fn is_moving(&self) -> bool {
        self.position_centideg != self.target_centideg
    }

    pub(crate) const fn is_at_limit(&self) -> bool {
        self.position_centideg.unsigned_abs() >= self.limit_centideg.unsigned_abs()
    }
}
