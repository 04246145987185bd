//! The firmware's reference model as the robot's electronics.

use rsapien_firmware_model::{
    CameraController, CameraOutputs, Controller, Inputs, MotionController, MotorOutput, ResetCause,
};
use rsapien_protocol::{Address, CameraReport, LineError, MotionReport};

use super::{CAMERA, Electronics, MOTION, NotWithFirmware};
use crate::body::MotorPins;
use crate::firmware::FirmwareError;
use crate::line::{Heard, Line, LineEvent};

/// Both controllers as the reference model: one tick a millisecond, and a pass of the main routine at every byte.
#[derive(Debug, Clone)]
pub(crate) struct Model {
    motion: MotionController,
    camera: CameraController,
}

impl Model {
    /// Both controllers just switched on, built for a clock of `clock_mhz`.
    pub(crate) fn new(clock_mhz: u8) -> Self {
        Self {
            motion: MotionController::new(ResetCause::PowerOn, 0).with_clock_mhz(clock_mhz),
            camera: CameraController::new(ResetCause::PowerOn, 0).with_clock_mhz(clock_mhz),
        }
    }

    fn carry_bytes(&mut self, line: &mut Line, end: u64, inputs: Inputs, is_powered: bool) {
        while let Some((now, event)) = line.next_event(end) {
            match event {
                LineEvent::ToRobot(heard) if is_powered => {
                    for heard in heard.into_iter().flatten() {
                        self.hear(heard);
                    }
                    self.motion.main_routine(inputs);
                    self.camera.main_routine();
                    self.start_transmitters(line, now);
                }
                LineEvent::ToRobot(_) => {}
                LineEvent::Sent(_) => self.start_transmitters(line, now),
            }
        }
    }

    fn hear(&mut self, heard: Heard) {
        match heard {
            Heard::Byte(byte) => {
                self.motion.receive_interrupt(byte);
                self.camera.receive_interrupt(byte);
            }
            Heard::FramingError => {
                self.motion.receive_error(LineError::Framing);
                self.camera.receive_error(LineError::Framing);
            }
        }
    }

    fn start_transmitters(&mut self, line: &mut Line, now: u64) {
        if self.motion.is_transmitting()
            && line.can_transmit(MOTION)
            && let Some(byte) = self.motion.transmit_interrupt()
        {
            line.transmit(MOTION, byte, now);
        }
        if self.camera.is_transmitting()
            && line.can_transmit(CAMERA)
            && let Some(byte) = self.camera.transmit_interrupt()
        {
            line.transmit(CAMERA, byte, now);
        }
    }
}

impl Electronics for Model {
    fn run_ms(&mut self, line: &mut Line, start_ms: u64, inputs: Inputs, is_powered: bool) {
        let end = line.units(start_ms + 1);
        if !line.is_idle() {
            self.carry_bytes(line, end, inputs, is_powered);
        }
        if is_powered {
            self.motion.tick(inputs);
            self.camera.tick(inputs);
            self.start_transmitters(line, end);
        }
    }

    fn motors(&self) -> MotorPins {
        let mut pins = MotorPins::default();
        for (index, output) in self.motion.motors().into_iter().enumerate() {
            match output {
                MotorOutput::Off => {}
                MotorOutput::TowardsFirst => pins.towards_first |= 1 << index,
                MotorOutput::TowardsLast => pins.towards_last |= 1 << index,
            }
        }
        pins
    }

    fn servos(&self) -> CameraOutputs {
        self.camera.outputs()
    }

    fn reset(&mut self, line: &mut Line, cause: ResetCause) {
        self.motion.reset(cause);
        self.camera.reset(cause);
        line.silence(MOTION);
        line.silence(CAMERA);
    }

    fn hang(&mut self, controller: Address) -> Result<(), NotWithFirmware> {
        match controller {
            Address::Motion => self.motion.hang(),
            Address::Camera => self.camera.hang(),
        }
        Ok(())
    }

    fn motion_report(&self) -> MotionReport {
        self.motion.report()
    }

    fn camera_report(&self) -> CameraReport {
        self.camera.report()
    }

    fn is_busy(&self) -> bool {
        false
    }

    fn is_firmware(&self) -> bool {
        false
    }

    fn failure(&self) -> Option<&FirmwareError> {
        None
    }

    fn try_clone(&self) -> Option<Box<dyn Electronics>> {
        Some(Box::new(self.clone()))
    }
}
