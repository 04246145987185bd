//! The numbers of the C core are Rust's, and the wiring tables of the handbook are the pin map.

use model::JointState::{Homing, Searching, SearchingBack, Travelling};
use model::{Controller as _, Inputs, MiddleSwitches, MotionController, ResetCause};
use rsapien_firmware_model as model;
use rsapien_protocol::ReceptionState::{Check, Data, Hunting, Synchronization};
use rsapien_protocol::{
    ActionPackage, Address, AimTarget, BumperMask, Joint, Kind, LineError, Mode, Parameter, Pose,
    Position, Request, Status, Step, StopCause, crc, frame,
};
use rsapien_tests::firmware::constants::{Numbers, Pin, of_the_c_core, offsets, pins, wired_pins};
use rsapien_tests::{read, workspace};
use std::collections::BTreeSet;

/// Names of C that say how its own code is made, and stand in Rust in another form or not at all.
const OF_C_ALONE: [&str; 12] = [
    // Bits and masks of one byte, which Rust tells by types.
    "STEP_FLAG_REPLACE",
    "STEP_BUMPERS_MASK",
    "STEP_POSE_HIGH_MASK",
    "SWITCH_LEFT",
    "SWITCH_RIGHT",
    // "Nothing" of an enum that Rust has as an option.
    "POSITION_NONE",
    "STATUS_TO_BE_EXECUTED",
    // Each controller's own, under a condition; the default of the build.
    "CONTROLLER_ADDRESS",
    "RSAPIEN_CLOCK_MHZ",
    // Resting is a bit of its own there.
    "JOINT_STATE_RESTING",
    "ACTION_PACKAGE_LENGTH",
    "REPORT_COUNTERS",
];

/// `CheckError` and `left-arm` as C writes them.
fn upper(name: &str) -> String {
    let mut text = String::new();
    for letter in name.chars() {
        match letter {
            '-' | ' ' => text.push('_'),
            letter if letter.is_uppercase() && text.ends_with(char::is_alphabetic) => {
                if !text.ends_with(|last: char| last.is_uppercase())
                    || name.contains(char::is_lowercase)
                {
                    text.push('_');
                }
                text.push(letter);
            }
            letter => text.push(letter.to_ascii_uppercase()),
        }
    }
    text
}

fn of_rust() -> Numbers {
    let mut numbers = Numbers::new();
    let mut put = |name: &str, value: i64| {
        assert_eq!(numbers.insert(name.to_owned(), value), None, "{name} twice");
    };
    let word = |value: u64| i64::try_from(value).unwrap();
    let length = |value: usize| i64::try_from(value).unwrap();
    for (name, value) in ["MAJOR", "MINOR", "PATCH"].into_iter().zip(model::FIRMWARE_VERSION) {
        put(&format!("FIRMWARE_VERSION_{name}"), i64::from(value));
    }
    put("PROTOCOL_VERSION", i64::from(rsapien_protocol::PROTOCOL_VERSION));
    put("ACTION_CONTENT_LENGTH", length(frame::ACTION_CONTENT_LENGTH));
    put("SYNCHRONIZATION_CONTENT_LENGTH", length(frame::SYNCHRONIZATION_CONTENT_LENGTH));
    put("SYNCHRONIZATION_PACKAGE_LENGTH", length(frame::SYNCHRONIZATION_PACKAGE_LENGTH));
    put("GROUP_DATA_LENGTH", length(frame::GROUP_DATA_LENGTH));
    put("CHECK_LENGTH", length(frame::CHECK_LENGTH));
    put("LAST_CHECK_BYTE_MAX", i64::from(frame::LAST_CHECK_BYTE_MAX));
    put("CRC_POLYNOMIAL_REVERSED", i64::from(crc::POLYNOMIAL_REVERSED));
    put("CRC_INITIAL", i64::from(crc::INITIAL));
    put("GAP_MS_ROBOT", word(rsapien_protocol::GAP_MS_ROBOT));
    put("RECEIVE_RING_LENGTH", i64::from(model::RECEIVE_RING_LENGTH));
    put("DEAD_MAN_MS_DEFAULT", i64::from(Parameter::DEAD_MAN_MS_DEFAULT));
    put("DEAD_MAN_MS_MIN", i64::from(*Parameter::DEAD_MAN_MS.start()));
    put("DEAD_MAN_MS_MAX", i64::from(*Parameter::DEAD_MAN_MS.end()));
    put("TRAVEL_MS_MIN", i64::from(*Parameter::TRAVEL_MS.start()));
    put("TRAVEL_MS_MAX", i64::from(*Parameter::TRAVEL_MS.end()));
    put("JOINT_COUNT", length(Joint::COUNT));
    put("BUMPER_COUNT", length(BumperMask::COUNT));
    put("QUEUE_LENGTH", i64::from(model::QUEUE_LENGTH));
    put("DEAD_TIME_MS", i64::from(model::DEAD_TIME_MS));
    put("BUMPER_DEBOUNCE_TESTS", i64::from(model::BUMPER_DEBOUNCE_TESTS));
    for (joint, travel_ms) in Joint::ALL.into_iter().zip(model::FULL_TRAVEL_MS_DEFAULT) {
        put(&format!("FULL_TRAVEL_MS_{}", upper(joint.name())), i64::from(travel_ms));
        put(&format!("JOINT_{}", upper(joint.name())), i64::from(joint.index()));
    }
    // Shares of a travel time, as powers of two.
    let shift = |share_of: fn(u16) -> u16| i64::from((1u16 << 15) / share_of(1 << 15)).ilog2();
    put("OVERRUN_SHIFT", i64::from(shift(model::overrun_ms)));
    put("SWITCH_HALF_WINDOW_SHIFT", i64::from(shift(model::switch_half_window_ms)));
    put("BELIEVED_SHIFT", i64::from(shift(believed_ms)));
    put("MOTION_WATCHDOG_MS", i64::from(model::MOTION_WATCHDOG_MS));
    put("CAMERA_WATCHDOG_MS", i64::from(model::CAMERA_WATCHDOG_MS));
    put("PAN_CENTIDEG_MAX", i64::from(AimTarget::PAN_CENTIDEG_MAX));
    put("TILT_CENTIDEG_MAX", i64::from(AimTarget::TILT_CENTIDEG_MAX));
    put("AXIS_SPEED_MAX_DEG_PER_S", i64::from(model::AXIS_SPEED_MAX_DEG_PER_S));
    put("HOME_SETTLE_MS", i64::from(model::HOME_SETTLE_MS));
    for kind in Kind::ALL {
        put(&format!("KIND_{}", kind.name()), i64::from(kind.byte()));
    }
    let numbered = Kind::ALL.into_iter().filter(|kind| kind.is_numbered()).map(Kind::byte).min();
    put("KIND_NUMBERED_FIRST", i64::from(numbered.unwrap()));
    for status in Status::ALL {
        put(&format!("STATUS_{}", upper(&format!("{status:?}"))), i64::from(status.byte()));
    }
    for mode in Mode::ALL {
        put(&format!("MODE_{}", upper(mode.name())), i64::from(mode.byte()));
    }
    for cause in StopCause::ALL {
        put(&format!("STOP_CAUSE_{}", upper(cause.name())), i64::from(cause.byte()));
    }
    for position in Position::ALL {
        let name = upper(&format!("{position:?}"));
        put(&format!("POSITION_{name}"), i64::from(position.number()));
    }
    for state in [Homing, Travelling, Searching, SearchingBack] {
        put(&format!("JOINT_STATE_{}", upper(&format!("{state:?}"))), state as i64);
    }
    for state in [Hunting, Synchronization, Data, Check] {
        put(&format!("RECEPTION_{}", upper(&format!("{state:?}"))), state as i64);
    }
    put("LINE_ERROR_FRAMING", LineError::Framing as i64);
    put("LINE_ERROR_OVERRUN", LineError::Overrun as i64);
    let content = length(frame::SYNCHRONIZATION_CONTENT_LENGTH);
    let synchronization = offsets("synchronization");
    let report = synchronization["MODE"];
    put("REPORT_LENGTH", content - report);
    for (name, offset) in synchronization {
        if offset >= report && name != "COUNTERS" {
            put(&format!("REPORT_{name}"), offset - report);
        }
    }
    for (name, offset) in offsets("action") {
        let is_common = ["SESSION", "SEQUENCE", "KIND", "ARGUMENTS"].contains(&name.as_str());
        put(&if is_common { format!("ACTION_{name}") } else { name }, offset);
    }
    numbers
}

/// How far from the reckoned middle a switch's change is believed: found out from the model.
fn believed_ms(full_travel_ms: u16) -> u16 {
    let travel_ms = full_travel_ms >> 2;
    let mut motion = MotionController::new(ResetCause::PowerOn, 0);
    let mut inputs = Inputs::default();
    let mut sequence = 0;
    let mut send = |motion: &mut MotionController, request: Request| {
        let package = ActionPackage { session: 1, sequence, request };
        sequence += 1;
        package.encode(Address::Motion).into_iter().for_each(|byte| motion.receive_interrupt(byte));
        motion.main_routine(Inputs::default());
    };
    let joint = Joint::LeftArm;
    send(&mut motion, Request::Hello { lowest_version: 1, highest_version: 1, session: 1 });
    send(&mut motion, Request::Configure(Parameter::DeadMan { timeout_ms: 0 }));
    let travel = Parameter::TravelTime { joint, full_travel_ms: travel_ms };
    send(&mut motion, Request::Configure(travel));
    send(&mut motion, Request::Init);
    while motion.mode() == Mode::Initialising {
        motion.tick(inputs);
    }
    let pose = |position| Pose::EMPTY.with(joint, Some(position));
    send(&mut motion, Request::Step(Step::new(pose(Position::First), 20_000)));
    while motion.joint_state(joint) != model::JointState::Resting {
        motion.tick(inputs);
    }
    let mut replacing = Step::new(pose(Position::Middle), 20_000);
    replacing.replace = true;
    send(&mut motion, Request::Step(replacing));
    // On its way to the middle the switch closes again and again, until it is believed.
    while motion.joint_state(joint) == model::JointState::Travelling {
        motion.timer_interrupt();
        motion.main_routine(inputs);
        let before_ms = motion.joint_position_ms(joint);
        for left in [true, false] {
            inputs.middle_switches = MiddleSwitches { left, right: false };
            motion.input_change_interrupt(inputs);
            if motion.joint_state(joint) == model::JointState::Resting {
                // The divisor of a travel time stands for that of 1 << 15.
                return (travel_ms / 2 - before_ms) << 2;
            }
        }
    }
    panic!("the switch is never believed");
}

#[test]
fn the_numbers_of_the_c_core_are_those_of_rust() {
    let (c, rust) = (of_the_c_core(), of_rust());
    assert!(c.len() > 100 && rust.len() > 100, "{} in C, {} in Rust", c.len(), rust.len());
    let mut wrong = Vec::new();
    for (name, value) in &rust {
        match c.get(name) {
            None => wrong.push(format!("{name} is {value} in Rust and missing in C")),
            Some(other) if other != value => {
                wrong.push(format!("{name} is {value} in Rust and {other} in C"));
            }
            Some(_) => {}
        }
    }
    for (name, value) in &c {
        if !rust.contains_key(name) && !OF_C_ALONE.contains(&name.as_str()) {
            wrong.push(format!("{name} is {value} in C and missing in Rust"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    println!("{} numbers are the same in C and in Rust", rust.len());
}

#[test]
fn the_c_core_knows_the_addresses() {
    let text = read(&workspace().join("firmware-pic/core/controller.h"));
    let addresses: Vec<&str> =
        text.lines().filter_map(|line| line.strip_prefix("#define CONTROLLER_ADDRESS ")).collect();
    // Under RSAPIEN_MOTION, and else.
    assert_eq!(addresses, [Address::Motion, Address::Camera].map(|of| format!("{}u", of as u8)));
}

#[test]
fn the_wiring_tables_are_the_pin_map() {
    for (list, heading) in [("MOTION_PINS", "\n### Motion:"), ("CAMERA_PINS", "\n### Camera:")] {
        let by_name = |mut pins: Vec<Pin>| {
            pins.sort_by(|one, other| one.name.cmp(&other.name));
            pins
        };
        let (wired, unused) = wired_pins(heading);
        let (wired, pins) = (by_name(wired), by_name(pins(list)));
        assert!(pins.len() >= 8, "{list} is not where it was");
        assert_eq!(wired, pins, "docs/firmware.md and pins.h, {list}");
        let named: BTreeSet<&str> = pins.iter().map(|pin| pin.name.as_str()).collect();
        for pin in unused {
            assert!(!named.contains(pin.name.as_str()) && !pin.is_input, "{pin:?} in {list}");
        }
    }
}
