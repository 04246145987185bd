//! Recordings written and read again.

use rsapien_protocol::{Address, Direction, Request, Session, SessionConfig};

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
    assert_eq!(what(60, &good[9..]), [What::Gap, What::Stray]);
    // A byte of a class that has no place there.
    assert_eq!(what(70, &good[..1]), []);
    assert_eq!(what(71, &[0x01]), [What::BrokenOff]);
    assert!(matches!(
        what(80, &[&[0x55], &good[..]].concat())[..],
        [What::Stray, What::Package(_)]
    ));
    assert_eq!(what(90, &good[..3]), []);
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
