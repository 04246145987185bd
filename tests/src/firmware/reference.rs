//! The reference model behind one face for both controllers, and its record in the host program's form.

use super::event::Event;
use super::record::{BODY_LENGTH, SERVOS_LENGTH};
use rsapien_firmware_model::{
    CameraController, Controller, Inputs, MotionController, MotorOutput, ResetCause,
};
use rsapien_protocol::{
    Address, CountersReport, Mode, Report, Status, StopCause, SynchronizationPackage,
};

/// Either controller of the reference model.
#[derive(Clone, Debug)]
pub enum Reference {
    /// The motion controller.
    Motion(Box<MotionController>),
    /// The camera controller.
    Camera(Box<CameraController>),
}

impl Reference {
    /// As after power-on, with `eeprom_boot` in the EEPROM.
    pub fn new(address: Address, eeprom_boot: u8) -> Reference {
        let cause = ResetCause::PowerOn;
        match address {
            Address::Motion => {
                Reference::Motion(Box::new(MotionController::new(cause, eeprom_boot)))
            }
            Address::Camera => {
                Reference::Camera(Box::new(CameraController::new(cause, eeprom_boot)))
            }
        }
    }

    /// The same, built for another clock.
    #[must_use]
    pub fn with_clock_mhz(self, clock_mhz: u8) -> Reference {
        match self {
            Reference::Motion(motion) => {
                Reference::Motion(Box::new(motion.with_clock_mhz(clock_mhz)))
            }
            Reference::Camera(camera) => {
                Reference::Camera(Box::new(camera.with_clock_mhz(clock_mhz)))
            }
        }
    }

    /// What both controllers are, to whoever simulates them.
    pub fn controller(&mut self) -> &mut dyn Controller {
        match self {
            Reference::Motion(motion) => &mut **motion,
            Reference::Camera(camera) => &mut **camera,
        }
    }

    fn shared(&self) -> &dyn Controller {
        match self {
            Reference::Motion(motion) => &**motion,
            Reference::Camera(camera) => &**camera,
        }
    }

    /// The motion controller, if it is that.
    pub fn motion(&self) -> Option<&MotionController> {
        match self {
            Reference::Motion(motion) => Some(motion),
            Reference::Camera(_) => None,
        }
    }

    /// The camera controller, if it is that.
    pub fn camera(&self) -> Option<&CameraController> {
        match self {
            Reference::Motion(_) => None,
            Reference::Camera(camera) => Some(camera),
        }
    }

    /// Its address.
    pub fn address(&self) -> Address {
        self.shared().address()
    }

    /// What it is doing.
    pub fn mode(&self) -> Mode {
        self.shared().mode()
    }

    /// Whether bytes of a response wait.
    pub fn is_transmitting(&self) -> bool {
        self.shared().is_transmitting()
    }

    /// The boot number.
    pub fn boot(&self) -> u8 {
        self.shared().eeprom_boot()
    }

    /// The number of the open session.
    pub fn session(&self) -> u8 {
        match self {
            Reference::Motion(motion) => motion.session(),
            Reference::Camera(camera) => camera.session(),
        }
    }

    /// The last sequence number executed.
    pub fn last_sequence(&self) -> u8 {
        match self {
            Reference::Motion(motion) => motion.last_sequence(),
            Reference::Camera(camera) => camera.last_sequence(),
        }
    }

    /// The counts that COUNTERS tells.
    pub fn counters(&self) -> CountersReport {
        match self {
            Reference::Motion(motion) => motion.counters(),
            Reference::Camera(camera) => camera.counters(),
        }
    }

    /// The controller's own report, as of now.
    pub fn report(&self) -> Report {
        match self {
            Reference::Motion(motion) => Report::Motion(motion.report()),
            Reference::Camera(camera) => Report::Camera(camera.report()),
        }
    }

    /// Why it was held or reset last.
    pub fn cause(&self) -> StopCause {
        match self {
            Reference::Motion(motion) => motion.report().cause,
            Reference::Camera(camera) => camera.report().cause,
        }
    }

    /// The two bytes of outputs: motors towards first and towards last, bit *j* for joint *j*; or
    /// whether the servos get pulses, and 0.
    pub fn outputs(&self) -> [u8; 2] {
        match self {
            Reference::Motion(motion) => {
                let mut outputs = [0, 0];
                for (index, motor) in motion.motors().into_iter().enumerate() {
                    outputs[0] |= u8::from(motor == MotorOutput::TowardsFirst) << index;
                    outputs[1] |= u8::from(motor == MotorOutput::TowardsLast) << index;
                }
                outputs
            }
            Reference::Camera(camera) => [u8::from(camera.outputs().pan_centideg.is_some()), 0],
        }
    }

    /// One pass of the main routine.
    pub fn main_routine(&mut self, inputs: Inputs) {
        match self {
            Reference::Motion(motion) => motion.main_routine(inputs),
            Reference::Camera(camera) => camera.main_routine(),
        }
    }

    /// The timer interrupt.
    pub fn timer_interrupt(&mut self) {
        match self {
            Reference::Motion(motion) => motion.timer_interrupt(),
            Reference::Camera(camera) => camera.timer_interrupt(),
        }
    }

    /// The input change interrupt, which the camera controller does not have.
    pub fn input_change_interrupt(&mut self, inputs: Inputs) {
        if let Reference::Motion(motion) = self {
            motion.input_change_interrupt(inputs);
        }
    }

    /// Lets an event happen and appends the record after it. Gives the bytes transmitted by it.
    pub fn apply(&mut self, event: Event, record: &mut Vec<u8>) -> Vec<u8> {
        let mut transmitted = Vec::new();
        match event {
            Event::Byte(byte) => self.controller().receive_interrupt(byte),
            Event::LineError(error) => self.controller().receive_error(error),
            Event::Tick(inputs) => self.controller().tick(inputs),
            Event::MainRoutine(inputs) => self.main_routine(inputs),
            Event::InputChange(inputs) => self.input_change_interrupt(inputs),
            Event::Transmit(count) => {
                let controller = self.controller();
                transmitted.extend((0..count).map_while(|_| controller.transmit_interrupt()));
            }
            Event::Reset(cause) => self.controller().reset(cause),
            Event::Hang => self.controller().hang(),
            Event::Anew(boot) => *self = Reference::new(self.address(), boot),
            Event::Timer => self.timer_interrupt(),
        }
        self.record(&transmitted, record);
        transmitted
    }

    /// Appends the record of this moment.
    pub fn record(&self, transmitted: &[u8], record: &mut Vec<u8>) {
        record.extend(self.outputs());
        record.extend([self.session(), u8::from(self.is_transmitting()), self.boot()]);
        record.extend(report_bytes(self.report()));
        record.extend(report_bytes(Report::Counters(self.counters())));
        if let Reference::Camera(camera) = self {
            let report = camera.report();
            let servos: [u8; SERVOS_LENGTH] = {
                let [pan_low, pan_high] = report.pan_centideg.to_le_bytes();
                let [tilt_low, tilt_high] = report.tilt_centideg.to_le_bytes();
                [pan_low, pan_high, tilt_low, tilt_high]
            };
            record.extend(servos);
        }
        // No event hands out more than 255 bytes.
        record.push(u8::try_from(transmitted.len()).unwrap_or(u8::MAX));
        record.extend(transmitted);
    }
}

/// A report as its bytes stand in the content of a synchronization package.
fn report_bytes(report: Report) -> [u8; BODY_LENGTH] {
    let kind_byte = match report {
        Report::Counters(_) => rsapien_protocol::Kind::Counters.byte(),
        _ => rsapien_protocol::Kind::State.byte(),
    };
    let package = SynchronizationPackage {
        session: 0,
        sequence: 0,
        kind_byte,
        status: Status::Accepted,
        report,
    };
    let content = package.content();
    let (_, body) = content.split_last_chunk().expect("a content is longer than its report");
    *body
}
