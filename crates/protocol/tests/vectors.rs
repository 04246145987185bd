//! The worked packages and streams of `tests/vectors`, which programs in other languages read too.

use rsapien_protocol::{
    ActionPackage, Address, AimTarget, AxisFlags, BadReport, BumperMask, CameraReport, Content,
    CountersReport, Direction, Fed, HeaderByte, HelloReport, Joint, Kind, LineError, Mode,
    MotionReport, Parameter, Pose, Receiver, Report, Request, Status, Step, StopCause,
    SynchronizationPackage, frame,
};
use serde_json::Value;

fn read(name: &str, key: &str) -> Vec<Value> {
    let path = format!("{}/../../tests/vectors/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
    let value: Value = serde_json::from_str(&text).unwrap();
    value[key].as_array().unwrap().clone()
}

fn hex(value: &Value) -> Vec<u8> {
    let text = value.as_str().unwrap();
    text.split(' ').map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect()
}

/// A number of a vector, which has to fit what it is read as.
fn number<T: TryFrom<i64>>(value: &Value, key: &str) -> T {
    let number = value[key].as_i64().unwrap_or_else(|| panic!("{key} in {value}"));
    T::try_from(number).unwrap_or_else(|_| panic!("{key} in {value}"))
}

fn truth(value: &Value) -> bool {
    value.as_bool().unwrap()
}

fn address(value: &Value) -> Address {
    let name = value.as_str().unwrap();
    Address::ALL.into_iter().find(|address| address.name() == name).unwrap()
}

fn action(meaning: &Value) -> ActionPackage {
    let request = match meaning["kind"].as_str().unwrap() {
        "HELLO" => Request::Hello {
            lowest_version: number(meaning, "lowest_version"),
            highest_version: number(meaning, "highest_version"),
            session: number(meaning, "proposed_session"),
        },
        "STATE" => Request::State,
        "STOP" => Request::Stop,
        "COUNTERS" => Request::Counters,
        "INIT" => Request::Init,
        "HOME" => Request::Home,
        "STEP" => Request::Step(Step {
            pose: Pose::from_word(number(meaning, "pose")).unwrap(),
            duration_ms: number(meaning, "duration_ms"),
            replace: truth(&meaning["replace"]),
            ending_bumpers: BumperMask::from_bits(number(meaning, "ending_bumpers")).unwrap(),
        }),
        "CONFIGURE" => Request::Configure(match number(meaning, "parameter") {
            0 => Parameter::DeadMan { timeout_ms: number(meaning, "value") },
            parameter => Parameter::TravelTime {
                joint: Joint::from_index(parameter - 1).unwrap(),
                full_travel_ms: number(meaning, "value"),
            },
        }),
        "AIM" => Request::Aim(AimTarget {
            pan_centideg: number(meaning, "pan_centideg"),
            tilt_centideg: number(meaning, "tilt_centideg"),
            speed_deg_per_s: number(meaning, "speed_deg_per_s"),
        }),
        other => panic!("no such kind: {other}"),
    };
    ActionPackage {
        session: number(meaning, "session"),
        sequence: number(meaning, "sequence"),
        request,
    }
}

fn report(meaning: &Value) -> Report {
    let mode = || Mode::from_byte(number(meaning, "mode")).unwrap();
    let boot = || number(meaning, "boot");
    let reception_errors = || number(meaning, "reception_errors");
    let cause = || StopCause::from_byte(number(meaning, "cause")).unwrap();
    match meaning["report"].as_str().unwrap() {
        "motion" => Report::Motion(MotionReport {
            mode: mode(),
            bumpers: BumperMask::from_bits(number(meaning, "bumpers")).unwrap(),
            middle_switches: [0, 1].map(|side| truth(&meaning["middle_switches"][side])),
            presses: [0, 1, 2, 3, 4, 5]
                .map(|index| u8::try_from(meaning["presses"][index].as_u64().unwrap()).unwrap()),
            motors: number(meaning, "motors"),
            supply_low: truth(&meaning["supply_low"]),
            pose_reached: Pose::from_word(number(meaning, "pose_reached")).unwrap(),
            queue_free: number(meaning, "queue_free"),
            steps_ended: number(meaning, "steps_ended"),
            boot: boot(),
            reception_errors: reception_errors(),
            cause: cause(),
        }),
        "camera" => Report::Camera(CameraReport {
            mode: mode(),
            pan_centideg: number(meaning, "pan_centideg"),
            tilt_centideg: number(meaning, "tilt_centideg"),
            pan_target_centideg: number(meaning, "pan_target_centideg"),
            tilt_target_centideg: number(meaning, "tilt_target_centideg"),
            axes: AxisFlags::from_bits(number(meaning, "axes")),
            boot: boot(),
            reception_errors: reception_errors(),
            cause: cause(),
        }),
        "hello" => Report::Hello(HelloReport {
            version: number(meaning, "version"),
            firmware: [0, 1, 2]
                .map(|index| u8::try_from(meaning["firmware"][index].as_u64().unwrap()).unwrap()),
            clock_mhz: number(meaning, "clock_mhz"),
            queue_length: number(meaning, "queue_length"),
            dead_man_ms: number(meaning, "dead_man_ms"),
            last_sequence: number(meaning, "last_sequence"),
            boot: boot(),
            reception_errors: reception_errors(),
            cause: cause(),
        }),
        "counters" => Report::Counters(CountersReport {
            accepted: number(meaning, "accepted"),
            resets: number(meaning, "resets"),
            crc_errors: number(meaning, "crc_errors"),
            framing_errors: number(meaning, "framing_errors"),
            overruns: number(meaning, "overruns"),
            duplicates: number(meaning, "duplicates"),
            dead_man_trips: number(meaning, "dead_man_trips"),
        }),
        other => panic!("no such report: {other}"),
    }
}

fn received(mut receiver: Receiver, line: &[u8]) -> Content {
    let mut contents = line.iter().filter_map(|byte| match receiver.feed(*byte, 0) {
        Fed::Package(content) => Some(content),
        _ => None,
    });
    contents.next().expect("an intact package")
}

#[test]
fn action_packages() {
    let mut kinds = Vec::new();
    for vector in read("action_packages", "packages") {
        let address = address(&vector["address"]);
        assert_eq!(vector["direction"], "to-robot");
        let content: [u8; 12] = hex(&vector["content"]).try_into().unwrap();
        let line = hex(&vector["line"]);
        let header = HeaderByte { direction: Direction::ToRobot, address };
        assert_eq!(frame::encode::<12, 18>(header, &content).to_vec(), line, "{vector}");
        assert_eq!(received(Receiver::for_robot(address), &line).action(), &content, "{vector}");
        let parsed = ActionPackage::parse(&content);
        if let Some(status) = vector["refused_status"].as_u64() {
            let status = Status::from_byte(u8::try_from(status).unwrap()).unwrap();
            assert_eq!(parsed, Err(status), "{vector}");
        } else {
            let package = action(&vector["meaning"]);
            assert_eq!(package.encode(address).to_vec(), line, "{vector}");
            assert_eq!(parsed, Ok(package), "{vector}");
            assert!(package.request.kind().is_served_by(address), "{vector}");
            kinds.push(package.request.kind());
        }
    }
    assert!(Kind::ALL.iter().all(|kind| kinds.contains(kind)), "every kind is worked: {kinds:?}");
}

#[test]
fn synchronization_packages() {
    let mut statuses = Vec::new();
    for vector in read("synchronization_packages", "packages") {
        let address = address(&vector["address"]);
        assert_eq!(vector["direction"], "to-pc");
        let content: [u8; 18] = hex(&vector["content"]).try_into().unwrap();
        let line = hex(&vector["line"]);
        let header = HeaderByte { direction: Direction::ToPc, address };
        assert_eq!(frame::encode::<18, 25>(header, &content).to_vec(), line, "{vector}");
        let received = received(Receiver::for_pc(), &line);
        assert_eq!(received.synchronization(), &content, "{vector}");
        let parsed = SynchronizationPackage::parse(&received);
        if let Some(field) = vector["incomprehensible"].as_str() {
            let found = match parsed {
                Err(BadReport::Status { .. }) => "status",
                Err(BadReport::Mode { .. }) => "mode",
                Err(BadReport::Cause { .. }) => "cause",
                Err(BadReport::Pose { .. }) => "pose",
                Ok(package) => panic!("{package:?} from {vector}"),
            };
            assert_eq!(found, field);
        } else {
            let meaning = &vector["meaning"];
            let package = SynchronizationPackage {
                session: number(meaning, "session"),
                sequence: number(meaning, "sequence"),
                kind_byte: number(meaning, "kind"),
                status: Status::from_byte(number(meaning, "status")).unwrap(),
                report: report(meaning),
            };
            assert_eq!(package.encode(address).to_vec(), line, "{vector}");
            assert_eq!(parsed, Ok(package), "{vector}");
            statuses.push(package.status);
        }
    }
    assert!(statuses.len() >= 14);
}

#[test]
fn reception_of_streams() {
    for stream in read("reception", "streams") {
        let mut receiver = match stream["receiver"].as_str().unwrap() {
            "pc" => Receiver::for_pc(),
            _ => Receiver::for_robot(address(&stream["receiver"])),
        };
        let mut accepted = Vec::new();
        for event in stream["events"].as_array().unwrap() {
            match event["line_error"].as_str() {
                Some("framing") => receiver.line_error(LineError::Framing),
                Some("overrun") => receiver.line_error(LineError::Overrun),
                Some(other) => panic!("no such line error: {other}"),
                None => {
                    for byte in hex(&event["bytes"]) {
                        if let Fed::Package(content) = receiver.feed(byte, number(event, "at_ms")) {
                            accepted.push(content);
                        }
                    }
                }
            }
        }
        let contents: Vec<Vec<u8>> = accepted
            .iter()
            .map(|content| match content.direction() {
                Direction::ToRobot => content.action().to_vec(),
                Direction::ToPc => content.synchronization().to_vec(),
            })
            .collect();
        let expected: Vec<Vec<u8>> =
            stream["accepted"].as_array().unwrap().iter().map(hex).collect();
        assert_eq!(contents, expected, "{}", stream["name"]);
        let (counts, told) = (receiver.counts(), &stream["counts"]);
        let found = [
            ("accepted", counts.accepted),
            ("resets", counts.resets),
            ("crc_errors", counts.crc_errors),
            ("framing_errors", counts.framing_errors),
            ("overruns", counts.overruns),
            ("errors", counts.errors),
        ];
        for (name, count) in found {
            assert_eq!(count, number::<u16>(told, name), "{name} of {}", stream["name"]);
        }
    }
}
