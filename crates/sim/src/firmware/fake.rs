//! A stand-in for the simulator of a chip: it speaks the same language and has the reference model in it, so that the
//! client can be tested where no simulator is built.

use std::collections::VecDeque;
use std::fmt::Write as _;
use std::io::{BufRead, BufReader, Write as _};
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

use rsapien_firmware_model::{
    CameraController, Controller, Inputs, MiddleSwitches, MotionController, MotorOutput, ResetCause,
};
use rsapien_protocol::{Address, BumperMask, LineError};

use super::bridge::Bridge;
use super::chip::Chip;
use super::{INPUTS, SERVOS, TOWARDS_FIRST, TOWARDS_LAST};

/// Microseconds of a bit at 57600 baud, times ten.
const BIT_TENTHS_US: u64 = 174;
/// When in a millisecond the timer's interrupt comes, in us.
const TICK_AT_US: u64 = 500;

/// What the fake was told, for the tests to look at.
pub(super) type Commands = Arc<Mutex<Vec<String>>>;

enum Model {
    Motion(Box<MotionController>),
    Camera(Box<CameraController>),
}

struct Fake {
    model: Model,
    clock_mhz: u8,
    now_us: u64,
    levels: Vec<(&'static str, bool)>,
    inputs: Vec<(String, bool)>,
    /// Bytes to hear; none: one without a stop bit.
    queue: VecDeque<(u64, Option<u8>)>,
    hearing: Option<(u64, Option<u8>)>,
    /// What is being sent, when it began, and whether it was told.
    sending: Option<(u8, u64, bool)>,
    /// When the pulses of this frame end.
    pulses: [u64; 2],
}

/// A chip of a controller with a fake in place of its simulator, which falls silent when it has advanced so often.
pub(super) fn chip(controller: Address, clock_mhz: u8, silent_after: u64) -> (Chip, Commands) {
    let (ours, theirs) = UnixStream::pair().expect("a pair of sockets");
    let commands = Commands::default();
    let heard = Arc::clone(&commands);
    thread::spawn(move || Fake::new(controller, clock_mhz).serve(&theirs, &heard, silent_after));
    let from = OwnedFd::from(ours.try_clone().expect("a second handle"));
    let bridge = Bridge::with(controller.name(), ours.into(), from, Duration::from_millis(300));
    (Chip::of(bridge, clock_mhz), commands)
}

/// Adds a line.
fn tell(answer: &mut String, line: std::fmt::Arguments<'_>) {
    writeln!(answer, "{line}").expect("a string takes everything");
}

impl Fake {
    fn new(controller: Address, clock_mhz: u8) -> Self {
        let outputs = match controller {
            Address::Motion => [TOWARDS_FIRST, TOWARDS_LAST].concat(),
            Address::Camera => SERVOS.to_vec(),
        };
        let cause = ResetCause::PowerOn;
        Self {
            model: match controller {
                Address::Motion => Model::Motion(Box::new(MotionController::new(cause, 0))),
                Address::Camera => Model::Camera(Box::new(CameraController::new(cause, 0))),
            },
            clock_mhz,
            now_us: 0,
            levels: outputs.into_iter().map(|pin| (pin, false)).collect(),
            inputs: Vec::new(),
            queue: VecDeque::new(),
            hearing: None,
            sending: None,
            pulses: [0; 2],
        }
    }

    fn serve(mut self, stream: &UnixStream, commands: &Commands, silent_after: u64) {
        let mut to = stream.try_clone().expect("a second handle");
        let mut advanced = 0;
        for line in BufReader::new(stream).lines() {
            let Ok(line) = line else { return };
            advanced += u64::from(line.starts_with("advance"));
            let mut answer = String::new();
            // A fake that has had enough keeps listening and says nothing.
            if advanced <= silent_after {
                self.obey(&line, &mut answer);
            }
            commands.lock().expect("the list").push(line);
            if to.write_all(answer.as_bytes()).is_err() {
                return;
            }
        }
    }

    fn obey(&mut self, line: &str, answer: &mut String) {
        let words: Vec<&str> = line.split(' ').collect();
        let cycles_per_us = u64::from(self.clock_mhz) / 4;
        let number = |index: usize| words[index].parse::<u64>().expect("a number");
        let last = match words[0] {
            "pins" => format!("ok {} rc6 rc7 rb7", self.names().join(" ")),
            "get" => {
                let level = self.levels.iter().find(|(pin, _)| *pin == words[1]).expect("a pin").1;
                format!("ok {}", u8::from(level))
            }
            "set" => {
                self.inputs.retain(|(pin, _)| pin != words[1]);
                self.inputs.push((words[1].to_owned(), words[2] == "1"));
                "ok".to_owned()
            }
            "send" => {
                let byte = u8::from_str_radix(words[1], 16).expect("a byte");
                self.queue.push_back((number(2) / cycles_per_us, Some(byte)));
                "ok".to_owned()
            }
            "send-framing" => {
                self.queue.push_back((number(2) / cycles_per_us, None));
                "ok".to_owned()
            }
            "reset" => {
                self.controller().reset(ResetCause::PowerOn);
                (self.queue, self.hearing, self.sending) = (VecDeque::new(), None, None);
                self.drive(&mut String::new());
                "ok".to_owned()
            }
            "advance" => {
                let end_us = self.now_us + number(1) / cycles_per_us;
                while self.now_us < end_us {
                    self.run_us(answer);
                }
                format!("ok {}", self.now_us * cycles_per_us)
            }
            "cycles" => format!("ok {}", self.now_us * cycles_per_us),
            "watch" => "ok".to_owned(),
            "register" => format!("ok {}", words[2]),
            _ => "error unknown".to_owned(),
        };
        tell(answer, format_args!("{last}"));
    }

    fn names(&self) -> Vec<&'static str> {
        self.levels.iter().map(|(pin, _)| *pin).chain(INPUTS).collect()
    }

    fn controller(&mut self) -> &mut dyn Controller {
        match &mut self.model {
            Model::Motion(motion) => motion.as_mut(),
            Model::Camera(camera) => camera.as_mut(),
        }
    }

    fn main_routine(&mut self) {
        let inputs = self.inputs();
        match &mut self.model {
            Model::Motion(motion) => motion.main_routine(inputs),
            Model::Camera(camera) => camera.main_routine(),
        }
    }

    fn inputs(&self) -> Inputs {
        let closed = |wanted: &str| self.inputs.iter().any(|(pin, level)| pin == wanted && !*level);
        let bumpers = ["rb0", "rb1", "rb2", "rb3", "ra0", "ra1"].iter().rev();
        Inputs {
            bumpers: BumperMask::from_low_bits(
                bumpers.fold(0, |bits, pin| bits << 1 | u8::from(closed(pin))),
            ),
            middle_switches: MiddleSwitches { left: closed("rb4"), right: closed("rb5") },
            supply_low: closed("ra2"),
        }
    }

    fn run_us(&mut self, answer: &mut String) {
        let (now_us, cycle) = (self.now_us, self.now_us * u64::from(self.clock_mhz) / 4);
        if let Some((begun_us, heard)) = self.hearing
            && (now_us - begun_us) * 10 >= BIT_TENTHS_US * 19 / 2
        {
            self.hearing = None;
            tell(answer, format_args!("heard {cycle}"));
            match heard {
                Some(byte) => self.controller().receive_interrupt(byte),
                None => self.controller().receive_error(LineError::Framing),
            }
            self.main_routine();
        }
        if self.hearing.is_none()
            && let Some((_, heard)) = self.queue.pop_front_if(|(at_us, _)| *at_us <= now_us)
        {
            self.hearing = Some((now_us, heard));
        }
        if let Some((byte, begun_us, is_told)) = self.sending {
            let tenths_us = (now_us - begun_us) * 10;
            if tenths_us >= BIT_TENTHS_US * 19 / 2 && !is_told {
                tell(answer, format_args!("byte {cycle} {byte:02x}"));
                self.sending = Some((byte, begun_us, true));
            }
            if tenths_us >= BIT_TENTHS_US * 10 {
                self.sending = None;
            }
        }
        if self.sending.is_none() {
            let next = self.controller().transmit_interrupt();
            self.sending = next.map(|byte| (byte, now_us, false));
        }
        if now_us % 1000 == TICK_AT_US {
            let inputs = self.inputs();
            self.controller().tick(inputs);
        }
        self.drive(answer);
        self.now_us += 1;
    }

    /// Drives the outputs and tells what changed.
    fn drive(&mut self, answer: &mut String) {
        let (now_us, cycle) = (self.now_us, self.now_us * u64::from(self.clock_mhz) / 4);
        let levels: Vec<bool> = match &self.model {
            Model::Motion(motion) => {
                let motors = motion.motors();
                let driven = |wanted| motors.map(|output| output == wanted);
                [driven(MotorOutput::TowardsFirst), driven(MotorOutput::TowardsLast)].concat()
            }
            Model::Camera(camera) => {
                let outputs = camera.outputs();
                if now_us % 20_000 == 0 {
                    self.pulses = [outputs.pan_centideg, outputs.tilt_centideg].map(|angle| {
                        // A whole degree is 10 us; the tests ask for no less than a tenth of it.
                        let width_us = angle.map_or(0, |centideg| 1500 + i64::from(centideg) / 10);
                        now_us + u64::try_from(width_us).expect("a width")
                    });
                }
                self.pulses.map(|end_us| now_us < end_us).to_vec()
            }
        };
        for ((pin, level), now) in self.levels.iter_mut().zip(levels) {
            if *level != now {
                *level = now;
                tell(answer, format_args!("edge {cycle} {pin} {}", u8::from(now)));
            }
        }
    }
}
