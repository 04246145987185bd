//! What a synchronization package reports.

use crate::{BumperMask, Joint, Kind, Pose, Position};

/// What a controller is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Mode {
    /// Not initialised since reset.
    Fresh = 0,
    /// INIT (motion) or HOME (camera) is under way.
    Initialising = 1,
    /// Initialised, nothing to do.
    Idle = 2,
    /// A queue is executing, or an axis moves to its target.
    Executing = 3,
    /// Stopped by STOP.
    Stopped = 4,
    /// Held by the dead-man or by a bumper that ends the action.
    Held = 5,
}

impl Mode {
    /// Every mode, in the order of its byte.
    pub const ALL: [Mode; 6] =
        [Mode::Fresh, Mode::Initialising, Mode::Idle, Mode::Executing, Mode::Stopped, Mode::Held];

    /// The mode of a byte; none above 5.
    pub const fn from_byte(byte: u8) -> Option<Mode> {
        if (byte as usize) < Mode::ALL.len() { Some(Mode::ALL[byte as usize]) } else { None }
    }

    /// The byte on the line.
    pub const fn byte(self) -> u8 {
        self as u8
    }

    /// The name as users read it.
    pub const fn name(self) -> &'static str {
        match self {
            Mode::Fresh => "fresh",
            Mode::Initialising => "initialising",
            Mode::Idle => "idle",
            Mode::Executing => "executing",
            Mode::Stopped => "stopped",
            Mode::Held => "held",
        }
    }
}

/// Why a controller was held or reset last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum StopCause {
    /// Nothing to tell.
    Nothing = 0,
    /// No valid package for the dead-man time.
    DeadMan = 1,
    /// A bumper that ends the action.
    Bumper = 2,
    /// Reset: the power came on.
    PowerOn = 3,
    /// Reset: the supply sagged.
    BrownOut = 4,
    /// Reset: the watchdog found the controller hung.
    Watchdog = 5,
}

impl StopCause {
    /// Every cause, in the order of its byte.
    pub const ALL: [StopCause; 6] = [
        StopCause::Nothing,
        StopCause::DeadMan,
        StopCause::Bumper,
        StopCause::PowerOn,
        StopCause::BrownOut,
        StopCause::Watchdog,
    ];

    /// The cause of a byte; none above 5.
    pub const fn from_byte(byte: u8) -> Option<StopCause> {
        if (byte as usize) < StopCause::ALL.len() {
            Some(StopCause::ALL[byte as usize])
        } else {
            None
        }
    }

    /// The byte on the line.
    pub const fn byte(self) -> u8 {
        self as u8
    }

    /// The name as users read it.
    pub const fn name(self) -> &'static str {
        match self {
            StopCause::Nothing => "nothing",
            StopCause::DeadMan => "dead-man",
            StopCause::Bumper => "bumper",
            StopCause::PowerOn => "power-on",
            StopCause::BrownOut => "brown-out",
            StopCause::Watchdog => "watchdog",
        }
    }
}

/// The motion controller's report, for every kind but HELLO and COUNTERS.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct MotionReport {
    /// What the controller is doing.
    pub mode: Mode,
    /// Bumpers pressed now.
    pub bumpers: BumperMask,
    /// Mid-arm switches closed: left, right.
    pub middle_switches: [bool; 2],
    /// Presses of each bumper since reset, modulo 16, in the order of the bumpers' bits.
    pub presses: [u8; BumperMask::COUNT],
    /// Motors running, bit `j` = joint `j`.
    pub motors: u8,
    /// Supply below 5 V.
    pub supply_low: bool,
    /// Where each joint is; a joint that travels or is unknown is left out.
    pub pose_reached: Pose,
    /// Free places in the queue.
    pub queue_free: u8,
    /// Steps ended since INIT, modulo 65536.
    pub steps_ended: u16,
    /// Boot number, one more at each reset, modulo 256.
    pub boot: u8,
    /// Reception errors since reset, modulo 256.
    pub reception_errors: u8,
    /// Why held or reset last.
    pub cause: StopCause,
}

impl MotionReport {
    /// Whether the motor of `joint` is running.
    pub const fn is_running(&self, joint: Joint) -> bool {
        self.motors & (1 << joint.index()) != 0
    }

    /// Where `joint` is, unless it travels or is unknown.
    pub const fn position(&self, joint: Joint) -> Option<Position> {
        self.pose_reached.get(joint)
    }
}

/// Which camera axes move and which are at a limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[allow(clippy::struct_excessive_bools)] // Four independent bits of one byte.
pub struct AxisFlags {
    /// The pan axis moves.
    pub pan_moving: bool,
    /// The tilt axis moves.
    pub tilt_moving: bool,
    /// The pan axis is at a limit.
    pub pan_at_limit: bool,
    /// The tilt axis is at a limit.
    pub tilt_at_limit: bool,
}

impl AxisFlags {
    /// The flags of a byte; its upper four bits are not looked at.
    pub const fn from_bits(bits: u8) -> AxisFlags {
        AxisFlags {
            pan_moving: bits & 1 != 0,
            tilt_moving: bits & 2 != 0,
            pan_at_limit: bits & 4 != 0,
            tilt_at_limit: bits & 8 != 0,
        }
    }

    /// The byte on the line.
    pub const fn bits(self) -> u8 {
        self.pan_moving as u8
            | (self.tilt_moving as u8) << 1
            | (self.pan_at_limit as u8) << 2
            | (self.tilt_at_limit as u8) << 3
    }
}

/// The camera controller's report, for every kind but HELLO and COUNTERS. Angles in 0.01 degree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CameraReport {
    /// What the controller is doing.
    pub mode: Mode,
    /// Pan now, right positive.
    pub pan_centideg: i16,
    /// Tilt now, up positive.
    pub tilt_centideg: i16,
    /// Where pan is sent.
    pub pan_target_centideg: i16,
    /// Where tilt is sent.
    pub tilt_target_centideg: i16,
    /// Which axes move or are at a limit.
    pub axes: AxisFlags,
    /// Boot number, one more at each reset, modulo 256.
    pub boot: u8,
    /// Reception errors since reset, modulo 256.
    pub reception_errors: u8,
    /// Why held or reset last.
    pub cause: StopCause,
}

/// The answer to HELLO.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct HelloReport {
    /// The version chosen; 0 when the HELLO was refused.
    pub version: u8,
    /// The firmware's version: major, minor, patch.
    pub firmware: [u8; 3],
    /// Clock in MHz.
    pub clock_mhz: u8,
    /// Places in the queue, free or not (camera: 0).
    pub queue_length: u8,
    /// Dead-man time in ms, 0 for off.
    pub dead_man_ms: u16,
    /// Last sequence number executed in this session.
    pub last_sequence: u8,
    /// Boot number.
    pub boot: u8,
    /// Reception errors since reset, modulo 256.
    pub reception_errors: u8,
    /// Why held or reset last.
    pub cause: StopCause,
}

/// The answer to COUNTERS: counts since reset, modulo 65536.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct CountersReport {
    /// Packages accepted.
    pub accepted: u16,
    /// Resets of reception.
    pub resets: u16,
    /// CRC errors.
    pub crc_errors: u16,
    /// Framing errors.
    pub framing_errors: u16,
    /// Overruns.
    pub overruns: u16,
    /// Duplicates answered.
    pub duplicates: u16,
    /// Trips of the dead-man.
    pub dead_man_trips: u16,
}

/// A report of any form.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Report {
    /// Of the motion controller.
    Motion(MotionReport),
    /// Of the camera controller.
    Camera(CameraReport),
    /// To HELLO.
    Hello(HelloReport),
    /// To COUNTERS.
    Counters(CountersReport),
}

impl Report {
    /// The boot number, which every report but that to COUNTERS carries.
    pub const fn boot(&self) -> Option<u8> {
        match self {
            Report::Motion(report) => Some(report.boot),
            Report::Camera(report) => Some(report.boot),
            Report::Hello(report) => Some(report.boot),
            Report::Counters(_) => None,
        }
    }

    /// Whether a package of `kind_byte` is answered with a report of this form.
    pub const fn answers(&self, kind_byte: u8) -> bool {
        match Kind::from_byte(kind_byte) {
            Some(Kind::Hello) => matches!(self, Report::Hello(_)),
            Some(Kind::Counters) => matches!(self, Report::Counters(_)),
            _ => matches!(self, Report::Motion(_) | Report::Camera(_)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_is_one_mode_cause_and_set_of_axis_flags() {
        for byte in 0..=255u8 {
            assert_eq!(Mode::from_byte(byte).map(Mode::byte), (byte < 6).then_some(byte));
            assert_eq!(StopCause::from_byte(byte).map(StopCause::byte), (byte < 6).then_some(byte));
            assert_eq!(AxisFlags::from_bits(byte).bits(), byte & 0x0F);
        }
    }
}
