//! The control channel, as text and through its client.

use std::io::{BufRead, BufReader, Write};
use std::os::unix::net::UnixStream;

use serde_json::Value;

use super::*;
use crate::body::{Contact, Drain};
use crate::camera::VisibleEllipse;
use crate::line::LineFaults;
use crate::pace::Clock;
use crate::robot::{Power, VirtualRobotConfig};
use crate::server::{Simulator, SimulatorConfig};
use crate::world::World;
use rsapien_protocol::{Address, Joint};

fn simulator(folder: &std::path::Path) -> Simulator {
    Simulator::start(SimulatorConfig {
        robot: VirtualRobotConfig { world: World::demo(), ..VirtualRobotConfig::default() },
        control: Some(folder.join("control")),
        control_tcp: Some("0".to_owned()),
        clock: Clock::Manual,
        ..SimulatorConfig::default()
    })
    .expect("starts")
}

fn every_request() -> Vec<ControlRequest> {
    let press = BumperName::new(4).expect("a bumper");
    let left_arm = ArmName::new(Joint::LeftArm).expect("an arm");
    let contact = Contact::StuckClosed;
    vec![
        ControlRequest::Press { press, held: true },
        ControlRequest::Bumper { bumper: press, contact },
        ControlRequest::Switch { switch: left_arm, contact },
        ControlRequest::Stick { stick: JointName(Joint::Tilt), stuck: false },
        ControlRequest::Move { r#move: JointName(Joint::LeftLeg), to: 0.25 },
        ControlRequest::Put { put: Place { x_m: 0.25, y_m: 0.5, heading_rad: 0.5 } },
        ControlRequest::Cable { cable: CableEnd::Pulled },
        ControlRequest::Line {
            line: LineDirection::Both,
            faults: LineFaults { lost_ppm: 5, ..LineFaults::NONE },
        },
        ControlRequest::Supply { supply_mv: 4900 },
        ControlRequest::MotorSupply { motor_supply_mv: 5000 },
        ControlRequest::Drain { drain: Drain::default() },
        ControlRequest::Hang { hang: ControllerName(Address::Camera) },
        ControlRequest::Power { power: PowerSwitch::Off },
        ControlRequest::Advance { advance_ms: 7 },
        ControlRequest::Get { get: Subject::State },
    ]
}

#[test]
fn every_request_reads_back_as_it_was_written() {
    for request in every_request() {
        let line = serde_json::to_vec(&request).expect("written");
        assert_eq!(ControlRequest::parse(&line).as_ref(), Ok(&request));
        let mut object: Value = serde_json::from_slice(&line).expect("JSON");
        object["surplus"] = Value::from(1);
        let refused = ControlRequest::parse(object.to_string().as_bytes());
        assert!(refused.is_err_and(|error| error.contains("\"surplus\"")), "{request:?}");
    }
    let short = ControlRequest::parse(br#"{"press":"left-hand"}"#);
    assert_eq!(short.as_ref(), Ok(&every_request()[0]), "held unless told otherwise");
}

#[test]
fn errors_name_what_is_wrong_and_what_is_allowed() {
    for (line, told) in [
        (r#"{"press":"nose"}"#, "left-foot-front, left-foot-back"),
        (r#"{"stick":"left-ear"}"#, "right-arm, left-arm"),
        (r#"{"switch":"tilt","contact":"working"}"#, "none of right-arm, left-arm"),
        (r#"{"bumper":"left-hand","contact":"loose"}"#, "`working`, `stuck-open`, `stuck-closed`"),
        (r#"{"bumper":"left-hand"}"#, "\"contact\" is missing"),
        (r#"{"cable":"cut"}"#, "`pulled` or `plugged`"),
        (r#"{"hang":"both"}"#, "motion, camera"),
        (r#"{"power":true}"#, "\"power\""),
        (r#"{"move":"tilt","to":2}"#, "0 to 1"),
        (r#"{"supply_mv":99999}"#, "0 to 9000"),
        (r#"{"supply_mv":-1}"#, "u32"),
        (r#"{"put":{"x_m":1e9,"y_m":0}}"#, "1000"),
        (r#"{"advance_ms":999999999}"#, "3600000"),
        (r#"{"line":"both","faults":{"eaten":1}}"#, "lost_ppm"),
        (r#"{"line":"both","faults":{"lost_ppm":1000001}}"#, "0 to 1000000"),
        (r#"{"get":"lost"}"#, "`state`, `picture`, `truth`"),
        ("{}", "press, bumper, switch"),
        ("[]", "JSON object"),
        ("{\"press\"", "JSON object"),
        ("\u{0}\u{7f}", "JSON object"),
    ] {
        let error = ControlRequest::parse(line.as_bytes()).expect_err(line);
        assert!(error.contains(told), "{line}: {error}");
    }
}

#[test]
fn text_is_answered_line_by_line_and_errors_leave_the_connection_open() {
    let folder = tempfile::tempdir().expect("a folder");
    let simulator = simulator(folder.path());
    let mut stream = UnixStream::connect(folder.path().join("control")).expect("connects");
    stream
        .write_all(b"{\"press\":\"left-hand\"}\n\n{\"dance\":1}\n{\"advance_ms\":5}\n{\"get\":\"state\"}\n")
        .expect("written");
    let mut answers = BufReader::new(stream).lines();
    let mut next = || answers.next().expect("an answer").expect("read");
    assert_eq!(next(), r#"{"done_at_ms":0}"#);
    assert!(next().starts_with(r#"{"error":"#));
    assert_eq!(next(), r#"{"done_at_ms":5}"#);
    let state: Value = serde_json::from_str(&next()).expect("JSON");
    assert_eq!(state["bumpers"], serde_json::json!(["left-hand"]));
    assert_eq!(state["joints"][4]["joint"], "tilt");
    simulator.stop();
    assert!(!folder.path().join("control").exists(), "the socket is removed");
}

#[test]
fn the_client_changes_and_reads_the_robot_on_both_sockets() {
    let folder = tempfile::tempdir().expect("a folder");
    let simulator = simulator(folder.path());
    let address = simulator.control_tcp_address().expect("an address").to_string();
    let unix = ControlClient::connect(folder.path().join("control")).expect("connects");
    let tcp = ControlClient::connect_tcp(&address).expect("connects");
    for mut client in [unix, tcp] {
        client.request(&ControlRequest::Power { power: PowerSwitch::Off }).expect("done");
        assert_eq!(client.state().expect("read").power, Power::Off);
        client.request(&ControlRequest::Power { power: PowerSwitch::On }).expect("done");
        for request in every_request() {
            if !matches!(request, ControlRequest::Get { .. } | ControlRequest::Power { .. }) {
                client.request(&request).expect("done");
            }
        }
        let state = client.state().expect("read");
        assert_eq!((state.power, state.cable_pulled), (Power::On, true));
        assert_eq!((state.supply_mv, state.motor_supply_mv), (4900, 5000));
        assert_eq!(state.bumpers, ["left-hand"]);
        assert_eq!(state.middle_switches, [true, false]);
        let (x_m, y_m) = (state.pose.x_m, state.pose.y_m);
        assert!((x_m - 0.25).abs() < 1e-9 && (y_m - 0.5).abs() < 1e-9, "{:?}", state.pose);
        assert!((state.joints[6].position - 0.25).abs() < 1e-9, "{:?}", state.joints);

        let put = Place { x_m: 0.3, y_m: -0.4, heading_rad: -0.2 };
        client.request(&ControlRequest::Put { put }).expect("done");
        let (_, picture) = client.picture().expect("read");
        let settings = client.camera().expect("read");
        let size = (settings.intrinsics.width, settings.intrinsics.height);
        assert_eq!((picture.width, picture.height), size);
        assert_eq!(picture.rgb.len() as u64, 3 * u64::from(size.0) * u64::from(size.1));
        let truth = client.truth().expect("read");
        let told = truth.into_iter().map(|seen| serde_json::from_value(seen).expect("an ellipse"));
        assert_eq!(told.collect::<Vec<VisibleEllipse>>(), simulator.robot().ground_truth());
        assert_eq!(client.world().expect("read"), World::demo());
        let too_far = ControlRequest::Advance { advance_ms: u64::MAX };
        let refused = client.request(&too_far).expect_err("refused");
        assert!(matches!(refused, ControlError::Refused { .. }), "{refused}");
    }
}

#[test]
fn an_endless_line_ends_the_connection_and_nothing_else() {
    let folder = tempfile::tempdir().expect("a folder");
    let simulator = simulator(folder.path());
    let mut stream = UnixStream::connect(folder.path().join("control")).expect("connects");
    // The simulator may hang up while the rest is on its way.
    let _ = stream.write_all(&vec![b'x'; 200_000]);
    let mut answer = String::new();
    let _ = BufReader::new(stream).read_line(&mut answer);
    assert!(answer.is_empty() || answer.contains("longer than"), "{answer}");
    let mut client = ControlClient::connect(folder.path().join("control")).expect("connects");
    client.state().expect("others are served");
    simulator.stop();
}

proptest::proptest! {
    #[test]
    fn no_line_panics(line in proptest::collection::vec(proptest::prelude::any::<u8>(), 0..80)) {
        let _ = ControlRequest::parse(&line);
    }

    #[test]
    fn no_value_panics(command in "press|bumper|switch|stick|move|put|cable|line|drain|hang|power|get",
                       value in "[0-9a-z{}\\[\\]\":,.-]{0,24}") {
        let _ = ControlRequest::parse(format!("{{\"{command}\":{value}}}").as_bytes());
        let _ = ControlRequest::parse(format!("{{\"{command}\":{value:?}}}").as_bytes());
    }
}
