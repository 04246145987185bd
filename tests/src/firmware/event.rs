//! What can happen to a controller in lock step, as the host program of the C core reads it and as a
//! kept failure tells it.

use rsapien_firmware_model::{Inputs, MiddleSwitches, ResetCause};
use rsapien_protocol::{BumperMask, LineError};
use std::fmt::Write as _;

/// One event. Each is answered with one record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Event {
    /// The receive interrupt with a byte.
    Byte(u8),
    /// The receive interrupt with a byte that could not be received.
    LineError(LineError),
    /// One millisecond: timer interrupt, input change interrupt, one pass of the main routine.
    Tick(Inputs),
    /// One pass of the main routine alone.
    MainRoutine(Inputs),
    /// The input change interrupt alone.
    InputChange(Inputs),
    /// The transmit interrupt so many times.
    Transmit(u8),
    /// A reset; the boot number goes on by one.
    Reset(ResetCause),
    /// From now on the main routine does not run, until a reset.
    Hang,
    /// As a new controller whose EEPROM holds this boot number, after power-on.
    Anew(u8),
    /// The timer interrupt alone.
    Timer,
}

/// How the host program is told to write out what it holds back.
pub const FLUSH: u8 = 0x00;

impl Event {
    /// How many sorts of events there are.
    pub const SORTS: usize = 10;
    /// The sorts' names, in the order of [`sort`](Event::sort).
    pub const NAMES: [&'static str; Event::SORTS] = [
        "byte",
        "line error",
        "tick",
        "main routine",
        "input change",
        "transmit",
        "reset",
        "hang",
        "anew",
        "timer",
    ];

    /// Which sort of event it is, 0 to 9.
    pub const fn sort(self) -> usize {
        match self {
            Event::Byte(_) => 0,
            Event::LineError(_) => 1,
            Event::Tick(_) => 2,
            Event::MainRoutine(_) => 3,
            Event::InputChange(_) => 4,
            Event::Transmit(_) => 5,
            Event::Reset(_) => 6,
            Event::Hang => 7,
            Event::Anew(_) => 8,
            Event::Timer => 9,
        }
    }

    /// Appends the bytes that tell the host program.
    pub fn encode(self, line: &mut Vec<u8>) {
        match self {
            Event::Byte(byte) => line.extend([0x01, byte]),
            Event::LineError(LineError::Framing) => line.extend([0x02, 0]),
            Event::LineError(LineError::Overrun) => line.extend([0x02, 1]),
            Event::Tick(inputs) => put_inputs(line, 0x03, inputs),
            Event::MainRoutine(inputs) => put_inputs(line, 0x04, inputs),
            Event::InputChange(inputs) => put_inputs(line, 0x05, inputs),
            Event::Transmit(count) => line.extend([0x06, count]),
            Event::Reset(cause) => line.extend([0x07, cause.stop_cause().byte()]),
            Event::Hang => line.push(0x08),
            Event::Anew(boot) => line.extend([0x09, boot]),
            Event::Timer => line.push(0x0A),
        }
    }

    /// The pins that the event brings, if it does.
    pub const fn inputs(self) -> Option<Inputs> {
        match self {
            Event::Tick(inputs) | Event::MainRoutine(inputs) | Event::InputChange(inputs) => {
                Some(inputs)
            }
            _ => None,
        }
    }

    /// The same event with other pins, if it brings any.
    #[must_use]
    pub const fn with_inputs(self, inputs: Inputs) -> Event {
        match self {
            Event::Tick(_) => Event::Tick(inputs),
            Event::MainRoutine(_) => Event::MainRoutine(inputs),
            Event::InputChange(_) => Event::InputChange(inputs),
            other => other,
        }
    }
}

fn put_inputs(line: &mut Vec<u8>, code: u8, inputs: Inputs) {
    let MiddleSwitches { left, right } = inputs.middle_switches;
    let switches = u8::from(left) | u8::from(right) << 1 | u8::from(inputs.supply_low) << 2;
    line.extend([code, inputs.bumpers.bits(), switches]);
}

/// The word of a line error in a scenario.
pub const fn line_error_name(error: LineError) -> &'static str {
    match error {
        LineError::Framing => "framing",
        LineError::Overrun => "overrun",
    }
}

/// Events as a scenario that replays just these.
pub fn to_scenario(events: &[Event]) -> String {
    const BYTES_A_LINE: usize = 18;
    let mut text = String::from("line 0\n");
    let mut inputs = Inputs::default();
    let mut rest = events;
    while let Some(event) = rest.first() {
        if let Some(new) = event.inputs() {
            change_inputs(&mut text, inputs, new);
            inputs = new;
        }
        let is_byte = matches!(event, Event::Byte(_));
        let run = rest
            .iter()
            .take_while(
                |other| if is_byte { matches!(other, Event::Byte(_)) } else { *other == event },
            )
            .count();
        let run = if is_byte { run.min(BYTES_A_LINE) } else { run };
        let (these, others) = rest.split_at(run);
        rest = others;
        let line = match *event {
            Event::Byte(_) => {
                let mut line = String::from("bytes");
                for event in these {
                    if let Event::Byte(byte) = event {
                        let _ = write!(line, " {byte:02x}");
                    }
                }
                line
            }
            Event::LineError(error) => repeated(run, &format!("error {}", line_error_name(error))),
            Event::Tick(_) => format!("tick {run}"),
            Event::MainRoutine(_) => repeated(run, "main"),
            Event::InputChange(_) => repeated(run, "input-change"),
            Event::Transmit(count) => repeated(run, &format!("transmit {count}")),
            Event::Reset(cause) => repeated(run, &format!("reset {}", cause.stop_cause().name())),
            Event::Hang => "hang".to_owned(),
            Event::Anew(boot) => format!("anew {boot}"),
            Event::Timer => format!("timer {run}"),
        };
        text.push_str(&line);
        text.push('\n');
    }
    text
}

fn repeated(count: usize, line: &str) -> String {
    vec![line; count].join("\n")
}

fn change_inputs(text: &mut String, old: Inputs, new: Inputs) {
    for (index, name) in BumperMask::NAMES.into_iter().enumerate() {
        if old.bumpers.contains(index) != new.bumpers.contains(index) {
            let verb = if new.bumpers.contains(index) { "press" } else { "release" };
            let _ = writeln!(text, "{verb} {name}");
        }
    }
    let switches = [
        ("left", old.middle_switches.left, new.middle_switches.left),
        ("right", old.middle_switches.right, new.middle_switches.right),
    ];
    for (name, old, new) in switches {
        if old != new {
            let state = if new { "closed" } else { "open" };
            let _ = writeln!(text, "switch {name} {state}");
        }
    }
    if old.supply_low != new.supply_low {
        let _ = writeln!(text, "supply {}", if new.supply_low { "low" } else { "good" });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::firmware::bench::LockstepBench;
    use crate::firmware::random::session;
    use crate::firmware::scenario::Scenario;
    use rsapien_protocol::Address;

    /// What is kept of a session must bring about the very same events again.
    #[test]
    fn a_kept_session_replays_event_for_event() {
        for address in Address::ALL {
            for index in 0..20 {
                let played = session(11, address, index, 3000);
                let text =
                    format!("controller {}\n{}", address.name(), to_scenario(&played.events));
                let scenario = Scenario::parse("kept", &text).unwrap();
                let mut bench = LockstepBench::new(address, 0);
                scenario.play(&mut bench).unwrap();
                // The bench begins anew by itself.
                assert_eq!(bench.events[1..], played.events, "{} {index}", address.name());
                assert!(bench.records.ends_with(&played.records), "{} {index}", address.name());
            }
        }
    }
}
