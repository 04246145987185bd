//! Reception and the meaning of contents, from any bytes. Used by the fuzz target and by the test
//! that replays its corpus.
//!
//! The first byte says how the rest is read: as line bytes, or as contents that are put on a line
//! with a right check, since a fuzzer guesses none.

use rsapien_protocol::{
    ActionPackage, ActionView, Address, Direction, Fed, HeaderByte, Kind, LineError, Receiver,
    SynchronizationPackage, frame,
};

pub(crate) fn drive(input: &[u8]) {
    let Some((how, input)) = input.split_first() else { return };
    if how & 1 == 0 {
        line_bytes(input);
    } else {
        contents(input);
    }
}

/// Each two bytes: a line byte, and how long it kept the line waiting or what the UART said of it.
fn line_bytes(input: &[u8]) {
    let mut receivers = [
        Receiver::for_robot(Address::Motion),
        Receiver::for_robot(Address::Camera),
        Receiver::for_pc(),
        Receiver::listening(Direction::ToRobot),
    ];
    let mut now_ms = 0;
    for event in input.chunks_exact(2) {
        for receiver in &mut receivers {
            match event[1] {
                0xFE => receiver.line_error(LineError::Framing),
                0xFF => receiver.line_error(LineError::Overrun),
                wait_ms => now_ms += u64::from(wait_ms),
            }
            let mut by_slice = receiver.clone();
            let fed = receiver.feed(event[0], now_ms);
            let (content, rest) = by_slice.feed_slice(&event[..1], now_ms);
            assert!(rest.is_empty());
            assert_eq!(content.is_some(), matches!(fed, Fed::Package(_)));
            assert_eq!(by_slice.counts(), receiver.counts());
        }
    }
}

/// Each 18 bytes: a content in either direction.
fn contents(input: &[u8]) {
    let mut to_robot = Receiver::listening(Direction::ToRobot);
    let mut to_pc = Receiver::for_pc();
    for bytes in input.as_chunks::<18>().0 {
        let address = Address::ALL[usize::from(bytes[0] & 1)];
        let header = HeaderByte { direction: Direction::ToPc, address };
        let line: [u8; 25] = frame::encode(header, bytes);
        let (Some(content), []) = to_pc.feed_slice(&line, 0) else { panic!("{line:02x?}") };
        assert_eq!(content.synchronization(), bytes);
        if let Ok(package) = SynchronizationPackage::parse(&content) {
            let (Some(again), []) = to_pc.feed_slice(&package.encode(address), 0) else {
                panic!("{package:?}")
            };
            assert_eq!(SynchronizationPackage::parse(&again), Ok(package));
        }

        let Some(bytes) = bytes.first_chunk::<12>() else { continue };
        let header = HeaderByte { direction: Direction::ToRobot, address };
        let line: [u8; 18] = frame::encode(header, bytes);
        let (Some(content), []) = to_robot.feed_slice(&line, 0) else { panic!("{line:02x?}") };
        assert_eq!(content.action(), bytes);
        if let Ok(package) = ActionPackage::parse(content.action()) {
            assert_eq!(package.content(), *bytes);
        }
        for kind in Kind::ALL {
            if let Ok(request) = ActionView::new(bytes).request(kind) {
                assert!(request.is_valid());
            }
        }
    }
}
