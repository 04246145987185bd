//! The firmware itself as the robot's controllers: two simulated chips that run the hex files that are flashed.
//!
//! The simulator of a chip is a program of its own, `rsapien-gpsim` (`firmware-pic/sim`), a process for each chip. It
//! runs in lock step: its time stands still but for the cycles that it is told to run. For every virtual millisecond
//! both are given the bytes of the PC that begin in it, with the cycles of their start bits, and the levels of the
//! inputs where they have changed; then both run a millisecond of cycles, side by side, and tell every byte that the
//! chip sent and every edge on its outputs with the cycle. So the pins move the body as they would on the robot, the
//! switches, bumpers and the supply are levels of pins, and a run is the same each time.
//!
//! What differs from the model:
//!
//! * The answer begins when the firmware's main loop has come round, not in the instant of the last byte.
//! * Every byte arrives at the PC within the millisecond in which its stop bit is sampled.
//! * Where both chips send at once the PC hears the logical and of the bytes that overlap; of two that overlap across
//!   the border of a millisecond only the later one is damaged.
//! * The head turns by the servos' pulses, which come every 20 ms; where none comes for 60 ms a servo is limp.
//! * Nobody sees into the chips. What [`VirtualRobot::motion_report`](crate::VirtualRobot::motion_report) tells is
//!   what they last told on the line, and they cannot be hung.
//!
//! Where the simulator ends or falls silent the robot goes on as one with dead controllers, and
//! [`VirtualRobot::failure`](crate::VirtualRobot::failure) tells why. The processes end with the robot.

mod bridge;
mod chip;
mod error;
#[cfg(test)]
mod fake;
mod image;
mod servo;
#[cfg(test)]
mod tests;
mod told;

pub use error::FirmwareError;
pub use image::{FirmwareConfig, FirmwareImage};

use rsapien_firmware_model::{CameraOutputs, Inputs, ResetCause};
use rsapien_protocol::{Address, CameraReport, Joint, MotionReport};

use crate::body::MotorPins;
use crate::electronics::{CAMERA, Electronics, MOTION, NotWithFirmware};
use crate::line::{BYTE_UNITS, Heard, Line};
use chip::{Chip, Happened};
use servo::Servo;
use told::Told;

/// Pins that drive the motors towards their first positions, in the order of the joints (`docs/firmware.md`).
const TOWARDS_FIRST: [&str; Joint::COUNT] = ["rd0", "rd1", "rd2", "rd3", "rd4", "rd5", "rd6"];
/// Pins that drive the motors towards their last positions.
const TOWARDS_LAST: [&str; Joint::COUNT] = ["rc0", "rc1", "rc2", "rc3", "rc4", "rc5", "re0"];
/// Inputs of the motion controller, all to ground when closed: six bumpers, both mid-arm switches, and the supply
/// detector, which pulls low below 5 V.
const INPUTS: [&str; 9] = ["rb0", "rb1", "rb2", "rb3", "ra0", "ra1", "rb4", "rb5", "ra2"];
/// The servos' pulses: pan, tilt.
const SERVOS: [&str; 2] = ["rc2", "rc1"];

/// A robot with a firmware has been on for so long when it is made, in ms, so that its controllers answer as at once as
/// their model does: they have written their boot number and switched their interrupts on by then.
const START_MS: u64 = 20;
/// After a byte either way the line counts as busy for this long, in ms: time for the firmware to begin its answer.
const BUSY_MS: u64 = 2;
/// Bytes of the two controllers overlap on the wire when they end within nine and a half bits of each other.
const OVERLAP_UNITS: u64 = BYTE_UNITS * 95 / 100;

/// A byte that one of the chips has sent.
#[derive(Debug, Clone, Copy)]
struct Sent {
    /// When its stop bit was sampled, in line units.
    at: u64,
    controller: usize,
    heard: Heard,
}

/// Both chips.
#[derive(Debug)]
pub(crate) struct Firmware {
    /// Motion and camera; none after a failure, which ends their processes.
    chips: Option<[Chip; 2]>,
    failure: Option<FirmwareError>,
    servos: [Servo; 2],
    told: Told,
    /// The last byte of each controller, for what overlaps the next.
    last_sent: [Option<Sent>; 2],
    /// The first ms in which the line may be idle.
    idle_ms: u64,
    is_busy: bool,
}

impl Firmware {
    /// Starts both simulators; the chips were switched on a moment ago.
    pub(crate) fn start(config: &FirmwareConfig) -> Result<Self, FirmwareError> {
        let motion = Chip::start(&config.simulator, &config.motion)?;
        let camera = Chip::start(&config.simulator, &config.camera)?;
        let mut firmware = Self::with_chips([motion, camera])?;
        for chip in firmware.chips.iter_mut().flatten() {
            chip.set(&levels(Inputs::default()));
        }
        for _ in 0..START_MS {
            for chip in firmware.chips.iter_mut().flatten() {
                chip.begin_ms()?;
            }
            for chip in firmware.chips.iter_mut().flatten() {
                chip.end_ms()?;
            }
        }
        Ok(firmware)
    }

    fn with_chips(chips: [Chip; 2]) -> Result<Self, FirmwareError> {
        let [mut motion, mut camera] = chips;
        motion.wire(&INPUTS, &[TOWARDS_FIRST, TOWARDS_LAST].concat())?;
        camera.wire(&[], &SERVOS)?;
        let clock_mhz = camera.clock_mhz();
        Ok(Self {
            servos: SERVOS.map(|_| Servo::new(clock_mhz)),
            chips: Some([motion, camera]),
            failure: None,
            told: Told::new(ResetCause::PowerOn),
            last_sent: [None; 2],
            idle_ms: 0,
            is_busy: false,
        })
    }

    fn fail(&mut self, error: FirmwareError) {
        self.failure = Some(error);
        self.chips = None;
        self.is_busy = false;
        self.servos.iter_mut().for_each(Servo::release);
    }

    /// Lets both chips live through one ms, side by side.
    fn run_chips(
        &mut self,
        line: &mut Line,
        start_ms: u64,
        inputs: Inputs,
    ) -> Result<(), FirmwareError> {
        let Some([motion, camera]) = &mut self.chips else { return Ok(()) };
        let (start, units_per_ms) = (line.units(start_ms), line.units(1));
        while let Some((at, heard)) = line.next_begun(start + units_per_ms) {
            self.idle_ms = start_ms + BUSY_MS;
            for heard in heard.into_iter().flatten() {
                for chip in [&mut *motion, &mut *camera] {
                    chip.send(heard, at.saturating_sub(start), units_per_ms);
                }
            }
        }
        motion.set(&levels(inputs));
        motion.begin_ms()?;
        camera.begin_ms()?;
        let mut sent = Vec::new();
        let told = &mut self.told;
        let mut take = |controller, ended_at, cycles_per_ms, happened| {
            let (cycle, heard) = match happened {
                Happened::Sent { cycle, byte } => (cycle, Heard::Byte(byte)),
                Happened::Framing { cycle } => (cycle, Heard::FramingError),
                Happened::Reset { cause } => return told.restart(controller, cause),
                Happened::Edge { .. } | Happened::Other => return,
            };
            let units_ago = u64::saturating_sub(ended_at, cycle) * units_per_ms / cycles_per_ms;
            sent.push(Sent { at: start + units_per_ms - units_ago, controller, heard });
        };
        let cycles_per_ms = motion.cycles_per_ms();
        for happened in motion.end_ms()? {
            take(MOTION, motion.cycle(), cycles_per_ms, happened);
        }
        let cycles_per_ms = camera.cycles_per_ms();
        for happened in camera.end_ms()? {
            if let Happened::Edge { cycle, pin, level } = happened
                && let Some(servo) = self.servos.get_mut(pin)
            {
                servo.edge(cycle, level);
            }
            take(CAMERA, camera.cycle(), cycles_per_ms, happened);
        }
        for servo in &mut self.servos {
            servo.pass(camera.cycle());
        }
        if !sent.is_empty() {
            self.idle_ms = start_ms + BUSY_MS;
            self.deliver(line, sent);
        }
        Ok(())
    }

    /// Puts what the chips have sent onto the wire that they share.
    fn deliver(&mut self, line: &mut Line, mut sent: Vec<Sent>) {
        sent.sort_by_key(|sent| (sent.at, sent.controller));
        for index in 0..sent.len() {
            let Some(&this) = sent.get(index) else { break };
            if let (Heard::Byte(byte), controller) = (this.heard, this.controller) {
                let of_other = |other: &&Sent| {
                    other.controller != controller && other.at.abs_diff(this.at) < OVERLAP_UNITS
                };
                let over = self.last_sent.iter().flatten().chain(&sent).filter(of_other);
                let heard = over.fold(byte, |heard, other| match other.heard {
                    Heard::Byte(other) => heard & other,
                    Heard::FramingError => 0,
                });
                self.told.take(this.controller, byte);
                line.arrive(Heard::Byte(heard));
            } else {
                line.arrive(this.heard);
            }
        }
        for sent in sent {
            if let Some(last) = self.last_sent.get_mut(sent.controller) {
                *last = Some(sent);
            }
        }
    }
}

/// The levels of [`INPUTS`]: everything is closed to ground.
fn levels(inputs: Inputs) -> [bool; INPUTS.len()] {
    let bumpers = inputs.bumpers.bits();
    let pressed = |index: u8| bumpers >> index & 1 != 0;
    let closed = [
        pressed(0),
        pressed(1),
        pressed(2),
        pressed(3),
        pressed(4),
        pressed(5),
        inputs.middle_switches.left,
        inputs.middle_switches.right,
        inputs.supply_low,
    ];
    closed.map(|closed| !closed)
}

impl Electronics for Firmware {
    fn run_ms(&mut self, line: &mut Line, start_ms: u64, inputs: Inputs, is_powered: bool) {
        if !is_powered || self.chips.is_none() {
            // Nobody hears what the PC sends.
            while line.next_begun(line.units(start_ms + 1)).is_some() {}
            return;
        }
        match self.run_chips(line, start_ms, inputs) {
            Ok(()) => self.is_busy = start_ms < self.idle_ms,
            Err(error) => self.fail(error),
        }
    }

    fn motors(&self) -> MotorPins {
        let Some([motion, _]) = &self.chips else { return MotorPins::default() };
        // The motors were wired in this order: first positions, then last ones.
        let bits = |from: usize| {
            (0..Joint::COUNT)
                .fold(0, |bits, index| bits | u8::from(motion.level(from + index)) << index)
        };
        MotorPins { towards_first: bits(0), towards_last: bits(Joint::COUNT) }
    }

    fn servos(&self) -> CameraOutputs {
        let [pan, tilt] = &self.servos;
        CameraOutputs { pan_centideg: pan.centideg(), tilt_centideg: tilt.centideg() }
    }

    fn reset(&mut self, _line: &mut Line, cause: ResetCause) {
        self.told = Told::new(cause);
        self.last_sent = [None; 2];
        self.servos.iter_mut().for_each(Servo::release);
        let reset = self.chips.iter_mut().flatten().try_for_each(|chip| chip.reset(cause));
        if let Err(error) = reset {
            self.fail(error);
        }
    }

    fn hang(&mut self, _controller: Address) -> Result<(), NotWithFirmware> {
        Err(NotWithFirmware { what: "hanging a controller" })
    }

    fn motion_report(&self) -> MotionReport {
        self.told.motion()
    }

    fn camera_report(&self) -> CameraReport {
        self.told.camera()
    }

    fn is_busy(&self) -> bool {
        self.is_busy
    }

    fn is_firmware(&self) -> bool {
        true
    }

    fn failure(&self) -> Option<&FirmwareError> {
        self.failure.as_ref()
    }

    fn try_clone(&self) -> Option<Box<dyn Electronics>> {
        None
    }
}
