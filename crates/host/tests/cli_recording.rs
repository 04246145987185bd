//! Recording, log and replay, as a user runs them.
#![cfg(feature = "cli")]

mod support;

use std::collections::BTreeMap;
use std::path::Path;

use rsapien_protocol::{Direction, Fed, HeaderByte, Receiver, frame};
use serde_json::Value;
use support::{Run, User, interrupt, wait_until};

/// Records a wave on the virtual robot.
fn wave(user: &User, file: &str) -> Run {
    user.expect(0, &["record", file, "play", "wave", "--link", "virtual", "--fast"])
}

/// Writes a recording anew, with each message as `change` leaves it.
fn rewrite(from: &Path, to: &Path, mut change: impl FnMut(&str, &mut Value)) {
    let bytes = std::fs::read(from).unwrap();
    let mut writer = mcap::Writer::new(std::fs::File::create(to).unwrap()).unwrap();
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    for index in &summary.metadata_indexes {
        writer.write_metadata(&mcap::read::metadata(&bytes, index).unwrap()).unwrap();
    }
    let mut channels = BTreeMap::new();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let topic = message.channel.topic.clone();
        let channel_id = *channels
            .entry(topic.clone())
            .or_insert_with(|| writer.add_channel(0, &topic, "json", &BTreeMap::new()).unwrap());
        let mut value = serde_json::from_slice(&message.data).unwrap();
        change(&topic, &mut value);
        let header = mcap::records::MessageHeader {
            channel_id,
            sequence: message.sequence,
            log_time: message.log_time,
            publish_time: message.publish_time,
        };
        writer.write_to_known_channel(&header, value.to_string().as_bytes()).unwrap();
    }
    writer.finish().unwrap();
}

fn from_hex(text: &str) -> Vec<u8> {
    let pair = |at| u8::from_str_radix(&text[at..at + 2], 16).unwrap();
    (0..text.len()).step_by(2).map(pair).collect()
}

fn hex(bytes: &[u8]) -> String {
    let digit = |value: u8| char::from_digit(value.into(), 16).unwrap();
    bytes.iter().flat_map(|byte| [digit(byte >> 4), digit(byte & 15)]).collect()
}

/// Writes a recording anew, with the bytes to the PC as `change` leaves them; each stays in its message.
fn rewrite_bytes(from: &Path, to: &Path, change: impl FnOnce(&mut Vec<u8>)) {
    let is_to_pc =
        |topic: &str, value: &Value| topic == "/rsapien/bytes" && value["direction"] == "to-pc";
    let mut bytes = Vec::new();
    rewrite(from, to, |topic, value| {
        if is_to_pc(topic, value) {
            bytes.extend(from_hex(value["hex"].as_str().unwrap()));
        }
    });
    change(&mut bytes);
    let mut rest = &bytes[..];
    rewrite(from, to, |topic, value| {
        if is_to_pc(topic, value) {
            let (first, behind) = rest.split_at(value["hex"].as_str().unwrap().len() / 2);
            value["hex"] = hex(first).into();
            rest = behind;
        }
    });
}

/// Changes one content byte of the `number`th answer, and makes its checksum fit again.
fn tamper(bytes: &mut [u8], number: usize, place: usize, mask: u8) {
    let mut receiver = Receiver::listening(Direction::ToPc);
    let mut seen = 0;
    for end in 1..=bytes.len() {
        let Fed::Package(content) = receiver.feed(bytes[end - 1], 0) else { continue };
        seen += 1;
        if seen == number {
            let mut changed = *content.synchronization();
            changed[place] ^= mask;
            let header = HeaderByte { direction: Direction::ToPc, address: content.address() };
            let package: rsapien_protocol::SynchronizationBytes = frame::encode(header, &changed);
            bytes[end - package.len()..end].copy_from_slice(&package);
            return;
        }
    }
    panic!("no answer {number}");
}

#[test]
fn a_recording_keeps_line_motion_pictures_and_ellipses() {
    let user = User::new();
    let arguments =
        "record all.mcap --camera --detect look --pan 40 --tilt -20 --link virtual --fast";
    let told = user.expect(0, &arguments.split(' ').collect::<Vec<_>>()).stdout;
    assert!(told.contains("recorded all.mcap") && told.contains("detections"), "{told}");
    let bytes = std::fs::read(user.path("all.mcap")).unwrap();
    let summary = mcap::Summary::read(&bytes).unwrap().expect("an index");
    let schema = |topic: &str| {
        let channel = summary.channels.values().find(|it| it.topic == topic).unwrap();
        let schema = channel.schema.as_ref().unwrap();
        let _: Value = serde_json::from_slice(&schema.data).expect("a JSON schema");
        (channel.message_encoding.clone(), schema.encoding.clone(), schema.name.clone())
    };
    let json = |name: &str| ("json".to_owned(), "jsonschema".to_owned(), name.to_owned());
    assert_eq!(schema("/rsapien/camera"), json("foxglove.CompressedImage"));
    assert_eq!(schema("/rsapien/annotations"), json("foxglove.ImageAnnotations"));
    assert_eq!(schema("/rsapien/state"), json("rsapien.State"));
    let mut has_ball = false;
    let mut has_picture = false;
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let value: Value = serde_json::from_slice(&message.data).unwrap();
        match message.channel.topic.as_str() {
            "/rsapien/detections" => has_ball |= !value["ellipses"].as_array().unwrap().is_empty(),
            // A JPEG file begins with ff d8 ff.
            "/rsapien/camera" => has_picture |= value["data"].as_str().unwrap().starts_with("/9j/"),
            _ => {}
        }
    }
    assert!(has_ball && has_picture);
    wave(&user, "wave.mcap");
    let log = user.expect(0, &["log", "wave.mcap", "--motion"]).stdout;
    assert!(log.contains("== wave: begins, 6 steps") && log.contains("== wave: done"), "{log}");
}

#[test]
fn a_file_that_is_there_is_kept_unless_it_is_said_otherwise() {
    let user = User::new();
    std::fs::write(user.path("kept.mcap"), "mine").unwrap();
    user.expect(2, &["record", "kept.mcap", "init", "--link", "virtual", "--fast"])
        .told(&["kept.mcap is there already", "--force"]);
    assert_eq!(std::fs::read(user.path("kept.mcap")).unwrap(), b"mine");
    user.expect(0, &["record", "--force", "kept.mcap", "init", "--link", "virtual", "--fast"]);
    user.expect(0, &["replay", "kept.mcap"]);
    // What could not begin leaves nothing behind.
    user.expect(2, &["record", "none.mcap", "play", "nosuch", "--link", "virtual"]);
    assert!(!user.path("none.mcap").exists());
    user.expect(2, &["record", "none.mcap", "--for", "5s", "init"]).told(&["--for"]);
    user.expect(2, &["record", "none.mcap", "--for", "5"]).told(&["10s"]);
    user.expect(2, &["record", "none.mcap", "--min-axis", "5", "init"]).told(&["--detect"]);
}

#[test]
fn a_recording_of_the_virtual_robot_replays_the_same_from_everywhere() {
    let user = User::new();
    let told = wave(&user, "wave.mcap").stdout;
    assert!(told.contains("wave: done"), "{told}");
    let whole = user.expect(0, &["replay", "wave.mcap", "--json"]).json();
    assert_eq!((&whole["same"], &whole["tolerance_ms"]), (&true.into(), &0.into()), "{whole}");
    assert!(whole["compared"].as_u64().unwrap() > 100, "{whole}");
    let part = user.expect(0, &["replay", "wave.mcap", "--from", "3s", "--json"]).json();
    let (part, whole) = (part["compared"].as_u64().unwrap(), whole["compared"].as_u64().unwrap());
    assert!(0 < part && part < whole, "{part} of {whole}");
    user.expect(0, &["replay", "wave.mcap", "--tolerance", "20"]);
    user.expect(2, &["replay", "wave.mcap", "--from", "9h"]).told(&["2.5s"]);
    user.expect(2, &["replay", "wave.mcap", "--from", "9min"]).told(&["ends before"]);
}

#[test]
fn a_tampered_answer_is_found_at_its_place() {
    let user = User::new();
    wave(&user, "wave.mcap");
    let log = user.expect(0, &["log", "wave.mcap", "--json"]).json_lines();
    let answers: Vec<&Value> = log.iter().filter(|line| line["direction"] == "to-pc").collect();
    let is_motion = |line: &Value| line["controller"] == "motion" && line["kind"] == "STATE";
    let number = (60..answers.len()).find(|index| is_motion(answers[*index])).unwrap() + 1;
    let time_ms = answers[number - 1]["time_ms"].clone();
    // The motors, the pose, the queue and the bumpers stand at these places of the content.
    for (place, mask, field) in [
        (9, 0x40, "motor left-leg"),
        (10, 0x03, "pose of right-arm"),
        (12, 0x01, "queue_free"),
        (5, 0x10, "bumper left-hand"),
        (4, 0x07, "mode"),
    ] {
        rewrite_bytes(&user.path("wave.mcap"), &user.path("bad.mcap"), |bytes| {
            tamper(bytes, number, place, mask);
        });
        for tolerance in ["0", "20"] {
            let arguments = ["replay", "bad.mcap", "--json", "--tolerance", tolerance];
            let told = user.expect(1, &arguments).json();
            let difference = &told["difference"];
            assert_eq!(difference["time_ms"], time_ms, "{told}");
            assert_eq!(difference["package"], number, "{told}");
            assert_eq!(difference["fields"][0]["name"], field, "{told}");
        }
    }
    let text = user.expect(1, &["replay", "bad.mcap"]).stdout;
    assert!(text.contains("differ first at") && text.contains("mode: recorded"), "{text}");
}

#[test]
fn damaged_bytes_show_as_what_they_are() {
    let user = User::new();
    wave(&user, "wave.mcap");
    rewrite_bytes(&user.path("wave.mcap"), &user.path("bad.mcap"), |bytes| {
        // In the tenth answer, of 25 bytes each.
        bytes[9 * 25 + 12] ^= 0x11;
    });
    let log = user.expect(0, &["log", "bad.mcap", "--errors"]).stdout;
    assert!(log.contains("CRC error"), "{log}");
    assert_eq!(user.expect(0, &["log", "wave.mcap", "--errors"]).stdout, "");
    // Nobody could read the answer, so that there is nothing to compare it with.
    let told = user.expect(0, &["replay", "bad.mcap", "--json"]).json();
    assert_eq!(told["unanswered"], 1, "{told}");
}

#[test]
fn a_killed_recording_is_read_as_far_as_it_goes() {
    let user = User::new();
    let mut child = user.start(&["record", "cut.mcap", "--link", "virtual"]);
    let lines = || user.run(&["log", "cut.mcap"]).stdout.lines().count();
    wait_until("packages are on the disk", || lines() > 10);
    child.kill().unwrap();
    child.wait().unwrap();
    let run = user.expect(0, &["log", "cut.mcap"]);
    run.told(&["the end of cut.mcap is missing"]);
    assert!(run.stdout.lines().count() > 10, "{}", run.stdout);
    user.expect(0, &["replay", "cut.mcap"]);
}

#[test]
fn ctrl_c_ends_a_recording_cleanly_and_motors_are_off_first() {
    let user = User::new();
    let child = user.start(&["record", "end.mcap", "--link", "virtual", "play", "dance"]);
    let path = user.path("end.mcap");
    let has_steps = || {
        let log = user.run(&["log", "end.mcap", "--no-state"]);
        path.exists() && log.stdout.contains("STEP")
    };
    wait_until("the dance has begun", has_steps);
    interrupt(&child);
    let run = Run::of_child(child);
    assert_eq!(run.status, 130, "{}", run.stderr);
    let log = user.expect(0, &["log", "end.mcap", "--json"]);
    // The file has its end.
    assert_eq!(log.stderr, "");
    let lines = log.json_lines();
    let stop = lines.iter().rfind(|line| line["kind"] == "STOP" && line["status"] == "accepted");
    let words = stop.expect("STOP")["words"].as_str().unwrap();
    assert!(words.contains("stopped") && !words.contains("motors"), "{words}");
}

#[test]
fn a_robot_behind_a_link_is_recorded_and_played_again() {
    let user = User::new();
    let simulator = user.start(&["sim", "--pty", "robot"]);
    wait_until("the simulator runs", || user.path("robot").exists());
    user.expect(0, &["--link", "./robot", "init"]);
    user.expect(0, &["record", "do.mcap", "do", "4:700", "6:900", "5:600", "--link", "./robot"]);
    // It begins with an initialised robot, and so do both that play it again.
    user.expect(0, &["replay", "do.mcap"]);
    let robot = ["replay", "do.mcap", "--against", "robot", "--link", "./robot", "--json"];
    let whole = user.expect(0, &robot).json();
    let part = user.expect(0, &[&robot[..], &["--from", "0.3s"]].concat()).json();
    let compared = |told: &Value| told["compared"].as_u64().unwrap();
    assert!(0 < compared(&part) && compared(&part) < compared(&whole), "{part} of {whole}");
    interrupt(&simulator);
    Run::of_child(simulator);
}

#[test]
fn what_is_no_recording_is_refused() {
    let user = User::new();
    std::fs::write(user.path("text.mcap"), "no recording").unwrap();
    let mut other =
        mcap::Writer::new(std::fs::File::create(user.path("other.mcap")).unwrap()).unwrap();
    other.add_channel(0, "/other", "json", &BTreeMap::new()).unwrap();
    other.finish().unwrap();
    for command in ["log", "replay"] {
        user.expect(2, &[command, "text.mcap"]).told(&["text.mcap is no MCAP file"]);
        user.expect(2, &[command, "other.mcap"]).told(&["no channel", "rsapien record"]);
        user.expect(2, &[command, "missing.mcap"]).told(&["cannot read missing.mcap"]);
    }
    user.expect(2, &["replay", "text.mcap", "--against", "robot", "--link", "virtual"]);
}

#[test]
fn a_reader_of_the_log_that_goes_away_is_no_error() {
    let user = User::new();
    user.expect(0, &["record", "long.mcap", "play", "dance", "--link", "virtual", "--fast"]);
    let mut child = user.start(&["log", "long.mcap"]);
    drop(child.stdout.take());
    let run = Run::of_child(child);
    assert_eq!((run.status, run.stderr.as_str()), (0, ""));
}
