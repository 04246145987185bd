//! Whatever came before, an intact package is accepted at its last byte.

use proptest::prelude::*;
use proptest::test_runner::FileFailurePersistence;
use rsapien_protocol::{
    ActionPackage, Address, Counts, Direction, Fed, HeaderByte, Mode, MotionReport, Receiver,
    ReceptionState, Report, Request, Status, StopCause, SynchronizationPackage,
};
use rsapien_protocol::{BumperMask, Joint, Pose, Position, Step, frame};

/// Representatives of every class and of every way in which a byte can matter to reception.
const CRITICAL: [u8; 16] = [
    0xC9, 0xD1, 0xE9, 0xF1, // the headers of either direction and address
    0xCA, 0xC1, 0xD9, 0xFF, // another version, reserved addresses
    0x80, 0xBF, 0x95, // synchronization bytes
    0x00, 0x7F, 0x03, 0x04, 0x49, // data; 3 and 4 on either side of what may end a check
];

fn action_line() -> Vec<u8> {
    let pose = Pose::MIDDLE.with(Joint::LeftLeg, Some(Position::Last));
    let step = Step { ending_bumpers: BumperMask::ALL, replace: true, ..Step::new(pose, 60_000) };
    let package = ActionPackage { session: 0xC9, sequence: 0xFF, request: Request::Step(step) };
    package.encode(Address::Motion).to_vec()
}

fn synchronization_line() -> Vec<u8> {
    let report = Report::Motion(MotionReport {
        mode: Mode::Executing,
        bumpers: BumperMask::FEET,
        middle_switches: [true, false],
        presses: [15, 0, 7, 8, 1, 2],
        motors: 0x55,
        supply_low: true,
        pose_reached: Pose::MIDDLE,
        queue_free: 0xE9,
        steps_ended: 0xBF80,
        boot: 0xC0,
        reception_errors: 0xFF,
        cause: StopCause::Bumper,
    });
    let kind_byte = 0x11;
    let package = SynchronizationPackage {
        session: 0xE9,
        sequence: 0x80,
        kind_byte,
        status: Status::Held,
        report,
    };
    package.encode(Address::Motion).to_vec()
}

fn ends() -> [(Receiver, Vec<u8>); 3] {
    [
        (Receiver::for_robot(Address::Motion), action_line()),
        (Receiver::for_pc(), synchronization_line()),
        (Receiver::listening(Direction::ToRobot), action_line()),
    ]
}

/// Feeds an intact package; the content has to come with its last byte and not before.
fn assert_accepted(receiver: &mut Receiver, line: &[u8], before: impl Fn() -> String) {
    let before_counts = receiver.counts();
    let (last, first) = line.split_last().expect("a package");
    for byte in first {
        let fed = receiver.feed(*byte, 0);
        assert_eq!(fed, Fed::More, "inside the package, after {}", before());
    }
    match receiver.feed(*last, 0) {
        Fed::Package(content) => {
            let header = HeaderByte { direction: content.direction(), address: content.address() };
            let again = match content.direction() {
                Direction::ToRobot => frame::encode::<12, 18>(header, content.action()).to_vec(),
                Direction::ToPc => {
                    frame::encode::<18, 25>(header, content.synchronization()).to_vec()
                }
            };
            assert_eq!(again, line, "after {}", before());
        }
        other => panic!("{other:?} at the last byte, after {}", before()),
    }
    assert_eq!(receiver.counts().accepted, before_counts.accepted.wrapping_add(1));
    assert_eq!(receiver.state(), ReceptionState::Hunting);
}

/// Goes through every prefix of up to `length` bytes of `alphabet`, sharing what they share.
fn every_prefix(
    receiver: &Receiver,
    line: &[u8],
    alphabet: &[u8],
    length: usize,
    prefix: &mut Vec<u8>,
) -> u64 {
    assert_accepted(&mut receiver.clone(), line, || format!("{prefix:02x?}"));
    if prefix.len() == length {
        return 1;
    }
    let mut prefixes = 1;
    for byte in alphabet {
        let mut next = receiver.clone();
        next.feed(*byte, 0);
        prefix.push(*byte);
        prefixes += every_prefix(&next, line, alphabet, length, prefix);
        prefix.pop();
    }
    prefixes
}

#[test]
fn every_prefix_of_up_to_five_critical_bytes() {
    for (receiver, line) in ends() {
        let prefixes = every_prefix(&receiver, &line, &CRITICAL, 5, &mut Vec::new());
        assert_eq!(prefixes, (0..=5).map(|length| 16u64.pow(length)).sum::<u64>());
        println!("{prefixes} prefixes of up to 5 of 16 critical bytes");
    }
}

#[test]
fn every_prefix_of_up_to_two_bytes() {
    let every_byte: Vec<u8> = (0..=255).collect();
    for (receiver, line) in ends() {
        let prefixes = every_prefix(&receiver, &line, &every_byte, 2, &mut Vec::new());
        assert_eq!(prefixes, 1 + 256 + 65_536);
    }
}

#[test]
fn every_truncated_package_and_three_critical_bytes_behind_it() {
    let mut prefixes = 0;
    for (receiver, line) in ends() {
        for truncated in [action_line(), synchronization_line()] {
            for length in 0..=truncated.len() {
                let mut receiver = receiver.clone();
                for byte in &truncated[..length] {
                    receiver.feed(*byte, 0);
                }
                let mut prefix = truncated[..length].to_vec();
                prefixes += every_prefix(&receiver, &line, &CRITICAL, length + 3, &mut prefix);
            }
        }
    }
    println!("{prefixes} prefixes: a package cut short, and up to 3 of 16 critical bytes");
}

#[test]
fn an_abandoned_package_is_counted_once_and_another_controllers_is_no_error() {
    let mut receiver = Receiver::for_robot(Address::Motion);
    let line = action_line();
    for byte in &line[..5] {
        receiver.feed(*byte, 0);
    }
    assert_accepted(&mut receiver, &line, || "a package cut short".into());
    let abandoned = Counts { accepted: 1, resets: 1, errors: 1, ..Counts::default() };
    assert_eq!(receiver.counts(), abandoned);

    let to_camera = ActionPackage { session: 1, sequence: 1, request: Request::Home };
    for byte in to_camera.encode(Address::Camera).iter().chain(&synchronization_line()) {
        assert_eq!(receiver.feed(*byte, 0), Fed::Skipped);
    }
    assert_eq!(receiver.counts(), abandoned);
}

/// Bytes as a line full of packages, pieces of packages and noise has them.
fn garbage() -> impl Strategy<Value = Vec<u8>> {
    let piece = prop_oneof![
        4 => prop::collection::vec(any::<u8>(), 0..40),
        4 => prop::collection::vec(prop::sample::select(&CRITICAL), 0..40),
        1 => (0..=18usize).prop_map(|length| action_line()[..length].to_vec()),
        1 => (0..=25usize).prop_map(|length| synchronization_line()[..length].to_vec()),
        1 => Just(action_line()),
        1 => Just(synchronization_line()),
    ];
    prop::collection::vec(piece, 0..1000).prop_map(|pieces| {
        let mut bytes = pieces.concat();
        bytes.truncate(10_000);
        bytes
    })
}

fn config() -> ProptestConfig {
    let kept = FileFailurePersistence::Direct("tests/garbage.proptest-regressions");
    ProptestConfig { failure_persistence: Some(Box::new(kept)), ..ProptestConfig::with_cases(400) }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn long_garbage(bytes in garbage()) {
        for (mut receiver, line) in ends() {
            for byte in &bytes {
                receiver.feed(*byte, 0);
            }
            assert_accepted(&mut receiver, &line, || format!("{} bytes", bytes.len()));
            assert_accepted(&mut receiver, &line, || "an intact package".into());
        }
    }

    #[test]
    fn slices_do_what_their_bytes_do(
        bytes in garbage(),
        cuts in prop::collection::vec((0..200usize, 0..60u64), 1..100),
    ) {
        for (receiver, line) in ends() {
            let (mut by_slice, mut by_byte) = (receiver.clone(), receiver);
            let all = [&bytes[..], &line].concat();
            let (mut rest, mut now_ms) = (&all[..], 0);
            for (cut, wait_ms) in cuts.iter().cycle() {
                now_ms += wait_ms;
                let (slice, behind) = rest.split_at(rest.len().min(1 + cut));
                rest = behind;
                let mut from_slice = Vec::new();
                let mut left = slice;
                while let (Some(content), behind) = by_slice.feed_slice(left, now_ms) {
                    from_slice.push(content);
                    left = behind;
                }
                let from_bytes: Vec<_> = slice
                    .iter()
                    .filter_map(|byte| match by_byte.feed(*byte, now_ms) {
                        Fed::Package(content) => Some(content),
                        _ => None,
                    })
                    .collect();
                prop_assert_eq!(from_slice, from_bytes);
                prop_assert_eq!(by_slice.counts(), by_byte.counts());
                prop_assert_eq!(by_slice.state(), by_byte.state());
                prop_assert_eq!(by_slice.deadline_ms(), by_byte.deadline_ms());
                if rest.is_empty() {
                    break;
                }
            }
        }
    }

    #[test]
    fn gaps_and_line_errors_cost_no_package_behind_them(
        events in prop::collection::vec((any::<u8>(), 0..40u64, 0..10u8), 0..200)
    ) {
        use rsapien_protocol::LineError;
        for (mut receiver, line) in ends() {
            let mut now_ms = 0;
            for (byte, wait_ms, event) in &events {
                now_ms += wait_ms;
                match event {
                    0 => receiver.line_error(LineError::Framing),
                    1 => receiver.line_error(LineError::Overrun),
                    2 => drop(receiver.expire(now_ms)),
                    _ => drop(receiver.feed(*byte, now_ms)),
                }
            }
            let packages = line.iter().filter(|byte| {
                matches!(receiver.feed(**byte, now_ms), Fed::Package(_))
            });
            prop_assert_eq!(packages.count(), 1);
        }
    }
}

#[test]
fn a_gap_of_just_the_limit_is_none_and_a_longer_one_resets() {
    let gaps = [rsapien_protocol::GAP_MS_ROBOT, rsapien_protocol::GAP_MS_PC];
    for ((receiver, line), gap_ms) in ends().into_iter().zip(gaps) {
        for place in 1..line.len() {
            let feed = |pause_ms: u64| {
                let mut receiver = receiver.clone();
                let mut accepted = false;
                for (index, byte) in line.iter().enumerate() {
                    let now_ms = if index < place { 0 } else { pause_ms };
                    accepted |= matches!(receiver.feed(*byte, now_ms), Fed::Package(_));
                }
                (accepted, receiver.counts().resets)
            };
            assert_eq!(feed(gap_ms), (true, 0));
            assert_eq!(feed(gap_ms + 1), (false, 1));
        }
    }
}
