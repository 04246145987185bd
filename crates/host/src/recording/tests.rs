//! Recordings written and read again.

use rsapien_protocol::{
    ActionPackage, Address, AxisFlags, CameraReport, Direction, Mode, Report, Request, Session,
    SessionConfig, Status, StopCause, SynchronizationPackage,
};

use super::*;

fn request(session: &mut Session, request: Request) -> Vec<u8> {
    session.request(Address::Motion, request).unwrap();
    session.poll_transmit(0).unwrap().to_vec()
}

fn message(time_ms: u64, direction: Direction, bytes: &[u8]) -> BytesMessage {
    BytesMessage { time_ms, direction, bytes: bytes.to_vec() }
}

fn state_request() -> Vec<u8> {
    request(&mut Session::new(SessionConfig::default()), Request::State)
}

#[test]
fn damage_on_the_line_is_told_as_what_it_is() {
    let to = Direction::ToRobot;
    let good = state_request();
    let mut changed = good.clone();
    changed[4] ^= 1;
    let mut decoder = LineDecoder::new();
    let mut what = |time_ms, bytes: &[u8]| -> Vec<What> {
        decoder.feed(&message(time_ms, to, bytes)).into_iter().map(|entry| entry.what).collect()
    };
    assert!(matches!(what(0, &good)[..], [What::Package(_)]));
    assert_eq!(what(10, &changed), [What::CrcError]);
    // Half of one, then a whole one.
    assert_eq!(what(20, &good[..9]), []);
    assert!(matches!(what(25, &good)[..], [What::BrokenOff, What::Package(_)]));
    // Half of one, and the rest too late.
    assert_eq!(what(30, &good[..9]), []);
    assert_eq!(what(60, &good[9..]), [What::Gap]);
    // A byte of a class that has no place there.
    assert_eq!(what(70, &good[..1]), [What::Stray]);
    assert_eq!(what(71, &[0x01]), [What::BrokenOff]);
    assert!(matches!(
        what(80, &[&[0x55], &good[..]].concat())[..],
        [What::Stray, What::Package(_)]
    ));
    // Stray bytes that follow each other are told together.
    assert_eq!(what(82, &[0x55; 3]), []);
    assert_eq!(what(84, &[0x56; 3]), []);
    assert_eq!(what(90, &good[..3]), [What::Stray]);
    assert_eq!(decoder.finish(95).len(), 1);
}

#[test]
fn every_recorded_byte_stands_in_one_entry() {
    let good = state_request();
    let bytes = [&[0x12, 0x34][..], &good, &good[..7], &good, &[0xFF], &good[3..]].concat();
    let mut decoder = LineDecoder::new();
    let mut seen = Vec::new();
    for (index, part) in bytes.chunks(5).enumerate() {
        for entry in decoder.feed(&message(index as u64, Direction::ToRobot, part)) {
            seen.extend(entry.bytes);
        }
    }
    seen.extend(decoder.finish(99).into_iter().flat_map(|entry| entry.bytes));
    assert_eq!(seen, bytes);
}

#[test]
fn packages_sent_again_and_left_unanswered_are_marked() {
    let mut session = Session::new(SessionConfig::default());
    let first = request(&mut session, Request::State);
    let mut second = Session::new(SessionConfig::default());
    let second = request(&mut second, Request::Stop);
    let mut decoder = LineDecoder::new();
    let mut marks = |bytes: &[u8]| {
        let entries = decoder.feed(&message(0, Direction::ToRobot, bytes));
        entries.into_iter().flat_map(|entry| entry.marks).collect::<Vec<_>>()
    };
    assert_eq!(marks(&first), []);
    assert_eq!(marks(&first), [LineMark::Resent { try_number: 2 }]);
    assert_eq!(marks(&first), [LineMark::Resent { try_number: 3 }]);
    assert_eq!(marks(&second), [LineMark::LeftUnanswered]);
}

#[test]
fn what_is_no_recording_is_refused_and_a_cut_one_is_read_to_its_end() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file.mcap");
    let open = || RecordingReader::open(&path);
    assert!(matches!(open(), Err(RecordingError::File { .. })));
    for rubbish in [&b""[..], b"no recording", &[0; 5000]] {
        std::fs::write(&path, rubbish).unwrap();
        assert!(matches!(open(), Err(RecordingError::NotMcap { .. })), "{rubbish:?}");
    }
    std::fs::remove_file(&path).unwrap();
    let mut other = mcap::Writer::new(std::fs::File::create(&path).unwrap()).unwrap();
    other.add_channel(0, "/other", "json", &std::collections::BTreeMap::new()).unwrap();
    other.finish().unwrap();
    assert!(matches!(open(), Err(RecordingError::NoChannels { .. })));

    assert!(matches!(Recorder::create(&path, false), Err(RecordingError::Exists { .. })));
    let recorder = Recorder::create(&path, true).unwrap();
    let about = About { program: "test".to_owned(), seed: Some(7), ..About::default() };
    recorder.describe(&about);
    let mut sink = recorder.line_sink();
    for time_ms in 0..400_u64 {
        let bytes = [u8::try_from(time_ms % 251).unwrap(); 40];
        sink(&crate::LineEvent::Received { time_ms, bytes: &bytes });
    }
    assert_eq!(recorder.finish().unwrap().messages, [(Topic::Bytes, 400)]);
    let reader = open().unwrap();
    assert_eq!(reader.about().seed, Some(7));
    let times: Vec<u64> = reader.map(|entry| entry.unwrap().bytes().unwrap().time_ms).collect();
    assert_eq!(times, (0..400).collect::<Vec<_>>());

    // Wherever it is cut, what is left is told as such; never is it a panic, or an endless file.
    let whole = std::fs::read(&path).unwrap();
    for length in (0..whole.len()).step_by(97) {
        std::fs::write(&path, &whole[..length]).unwrap();
        let Ok(mut reader) = open() else { continue };
        let count = reader.by_ref().map_while(Result::ok).count();
        assert!(count <= 400 && reader.is_cut(), "{length} of {}: {count}", whole.len());
    }
}

/// Compares runs of which each answer, every 100 ms, tells of a mode.
fn compare(tolerance_ms: Option<u64>, recorded: &[Mode], now: &[Mode]) -> Option<(u64, String)> {
    let package = |mode| SynchronizationPackage {
        session: 1,
        sequence: 1,
        kind_byte: Request::State.kind().byte(),
        status: Status::Accepted,
        report: Report::Camera(CameraReport {
            mode,
            pan_centideg: 0,
            tilt_centideg: 0,
            pan_target_centideg: 0,
            tilt_target_centideg: 0,
            axes: AxisFlags::default(),
            boot: 1,
            reception_errors: 0,
            cause: StopCause::Nothing,
        }),
    };
    let mut comparer = compare::Comparer::new(tolerance_ms);
    for (number, (recorded, now)) in (1..).zip(recorded.iter().zip(now)) {
        let exchange = exchange::Exchange {
            number,
            time_ms: 100 * number,
            address: Address::Camera,
            package: ActionPackage { session: 1, sequence: 1, request: Request::State },
            words: "STATE".to_owned(),
            answer: Some((100 * number, package(*recorded))),
        };
        comparer.push(&exchange, Some(&package(*now)), true);
    }
    let difference = comparer.finish().0?;
    let field = difference.fields.into_iter().next()?;
    Some((difference.package, format!("{} {} {}", field.name, field.recorded, field.now)))
}

#[test]
fn with_a_tolerance_a_change_may_fall_on_the_other_side_of_a_question() {
    use Mode::{Executing as E, Held as H, Idle as I};
    let recorded = [I, I, E, E, E, I, I];
    let near = Some(20);
    assert_eq!(compare(None, &recorded, &recorded), None);
    assert_eq!(compare(near, &recorded, &recorded), None);
    let early = [I, E, E, E, I, I, I];
    let late = [I, I, I, E, E, E, I];
    for other in [early, late] {
        assert_eq!(compare(near, &recorded, &other), None);
        assert!(compare(None, &recorded, &other).is_some());
    }
    let found = |package, field: &str| Some((package, field.to_owned()));
    // Two questions late, a mode that only one of them has, and one that never came.
    let too_late = [I, I, I, I, E, I, I];
    assert_eq!(compare(near, &recorded, &too_late), found(3, "mode executing idle"));
    let held = [I, I, E, H, E, I, I];
    assert_eq!(compare(near, &recorded, &held), found(4, "mode executing held"));
    assert_eq!(compare(near, &held, &recorded), found(4, "mode held executing"));
    assert_eq!(compare(near, &recorded, &[I; 7]), found(3, "mode executing idle"));
}
