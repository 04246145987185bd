//! The session against a line whose every package the test answers by hand.

use super::*;
use crate::{CameraReport, HelloReport, Mode, MotionReport, Pose, Step, StopCause};

const ANSWER_TIME_MS: u64 = 48;

fn motion_report(boot: u8) -> Report {
    Report::Motion(MotionReport {
        mode: Mode::Idle,
        bumpers: crate::BumperMask::NONE,
        middle_switches: [false; 2],
        presses: [0; 6],
        motors: 0,
        supply_low: false,
        pose_reached: Pose::MIDDLE,
        queue_free: 32,
        steps_ended: 0,
        boot,
        reception_errors: 0,
        cause: StopCause::Nothing,
    })
}

fn hello_report(boot: u8, last_sequence: u8) -> Report {
    Report::Hello(HelloReport {
        version: 1,
        firmware: [0, 1, 0],
        clock_mhz: 40,
        queue_length: 32,
        dead_man_ms: 500,
        last_sequence,
        boot,
        reception_errors: 0,
        cause: StopCause::PowerOn,
    })
}

/// Takes the one package that waits to be sent.
fn sent(session: &mut Session, now_ms: u64) -> ActionPackage {
    let bytes = session.poll_transmit(now_ms).expect("a package to send");
    assert_eq!(session.poll_transmit(now_ms), None, "one package outstanding on a line");
    let mut receiver = Receiver::listening(crate::Direction::ToRobot);
    let fed = bytes.map(|byte| receiver.feed(byte, 0));
    let Fed::Package(content) = fed[fed.len() - 1] else { panic!("not a package: {bytes:02x?}") };
    ActionPackage::parse(content.action()).unwrap()
}

fn answer(session: &mut Session, to: ActionPackage, status: Status, report: Report, now_ms: u64) {
    let address = match report {
        Report::Camera(_) => Address::Camera,
        _ => Address::Motion,
    };
    let package = SynchronizationPackage {
        session: to.session,
        sequence: to.sequence,
        kind_byte: to.request.kind().byte(),
        status,
        report,
    };
    session.handle_bytes(&package.encode(address), now_ms);
}

fn opened() -> Session {
    let mut session = Session::new(SessionConfig { first_session: 9, ..Default::default() });
    session.open(Address::Motion).unwrap();
    let hello = sent(&mut session, 0);
    answer(&mut session, hello, Status::Accepted, hello_report(1, 0), 10);
    assert!(matches!(session.poll_event(), Some(SessionEvent::Answered { .. })));
    assert_eq!(session.open_session(Address::Motion), Some(9));
    session
}

const STEP: Request = Request::Step(Step::new(Pose::MIDDLE, 100));

#[test]
fn numbers_go_up_by_one_and_wrap() {
    let mut session = opened();
    for turn in 1..=300u64 {
        session.request(Address::Motion, STEP).unwrap();
        let package = sent(&mut session, turn * 100);
        assert_eq!(u64::from(package.sequence), turn % 256);
        answer(&mut session, package, Status::Accepted, motion_report(1), turn * 100 + 9);
        let event = session.poll_event();
        assert!(matches!(event, Some(SessionEvent::Answered { round_trip_ms: 9, tries: 1, .. })));
    }
}

#[test]
fn a_refused_package_does_not_use_its_number_up() {
    let mut session = opened();
    for status in [Status::QueueFull, Status::Held, Status::Accepted] {
        session.request(Address::Motion, STEP).unwrap();
        let package = sent(&mut session, 100);
        assert_eq!(package.sequence, 1);
        answer(&mut session, package, status, motion_report(1), 110);
        session.poll_event().unwrap();
    }
}

#[test]
fn six_tries_of_the_same_bytes_then_a_typed_error() {
    for (request, is_numbered) in [(STEP, true), (Request::State, false)] {
        let mut session = opened();
        let ticket = session.request(Address::Motion, request).unwrap();
        let first = sent(&mut session, 1000);
        let mut now_ms = 1000;
        for _ in 1..6 {
            assert_eq!(session.poll_timeout(), Some(now_ms + ANSWER_TIME_MS));
            session.handle_timeout(now_ms + ANSWER_TIME_MS - 1);
            assert_eq!(session.poll_transmit(now_ms), None, "too early");
            now_ms += ANSWER_TIME_MS;
            session.handle_timeout(now_ms);
            assert_eq!(sent(&mut session, now_ms), first);
        }
        session.handle_timeout(now_ms + ANSWER_TIME_MS);
        let (address, kind, tries) = (Address::Motion, request.kind(), 6);
        let failure = if is_numbered {
            Failure::OutcomeUnknown { address, kind, tries, reason: UnknownReason::NoAnswer }
        } else {
            Failure::NoAnswer { address, kind, tries }
        };
        assert_eq!(session.poll_event(), Some(SessionEvent::Failed { ticket, address, failure }));
        assert_eq!(session.poll_timeout(), None);
        assert_eq!(session.open_session(Address::Motion).is_none(), is_numbered);
    }
}

#[test]
fn a_session_lost_between_two_tries_leaves_the_outcome_unknown() {
    let mut session = opened();
    session.request(Address::Motion, STEP).unwrap();
    let package = sent(&mut session, 0);
    session.handle_timeout(ANSWER_TIME_MS);
    assert_eq!(sent(&mut session, ANSWER_TIME_MS), package);
    answer(&mut session, package, Status::NoSession, motion_report(2), 60);
    let restarted = SessionEvent::Restarted { address: Address::Motion, boot: 2 };
    assert_eq!(session.poll_event(), Some(restarted));
    assert_eq!(session.poll_event(), None, "a copy may still be on the way");
    session.handle_timeout(2 * ANSWER_TIME_MS);
    let Some(SessionEvent::Failed { failure, .. }) = session.poll_event() else { panic!() };
    let reason = UnknownReason::SessionLost;
    assert!(
        matches!(failure, Failure::OutcomeUnknown { reason: found, tries: 2, .. } if found == reason)
    );
    assert_eq!(session.poll_transmit(100), None, "nothing is sent again");
    assert_eq!(
        session.request(Address::Motion, STEP),
        Err(RequestError::NoSession { address: Address::Motion })
    );
}

#[test]
fn a_session_lost_before_the_only_try_is_a_refusal() {
    let mut session = opened();
    session.request(Address::Motion, STEP).unwrap();
    let package = sent(&mut session, 0);
    answer(&mut session, package, Status::NoSession, motion_report(1), 10);
    let Some(SessionEvent::Answered { package, .. }) = session.poll_event() else { panic!() };
    assert_eq!(package.status, Status::NoSession);
    assert_eq!(session.open_session(Address::Motion), None);
}

#[test]
fn a_refusal_waits_for_the_copies_on_the_way() {
    let mut session = opened();
    session.request(Address::Motion, STEP).unwrap();
    let package = sent(&mut session, 0);
    session.handle_timeout(ANSWER_TIME_MS);
    sent(&mut session, ANSWER_TIME_MS);
    answer(&mut session, package, Status::QueueFull, motion_report(1), 50);
    assert_eq!(session.poll_event(), None);
    answer(&mut session, package, Status::Accepted, motion_report(1), 60);
    let Some(SessionEvent::Answered { package, tries: 2, .. }) = session.poll_event() else {
        panic!()
    };
    assert_eq!(package.status, Status::Accepted);
}

#[test]
fn stop_overtakes_and_tells_what_it_displaced() {
    let mut session = opened();
    let unsent = session.request(Address::Motion, STEP).unwrap();
    session.stop(Address::Motion).unwrap();
    assert_eq!(session.request(Address::Motion, STEP), Err(RequestError::Busy));
    assert_eq!(sent(&mut session, 0).request, Request::Stop);
    let Some(SessionEvent::Failed { ticket, failure, .. }) = session.poll_event() else { panic!() };
    assert_eq!((ticket, failure), (unsent, Failure::Displaced { kind: Kind::Step }));

    let mut session = opened();
    session.request(Address::Motion, STEP).unwrap();
    sent(&mut session, 0);
    session.stop(Address::Motion).unwrap();
    assert_eq!(session.poll_transmit(1), None, "one package outstanding on a line");
    session.handle_timeout(ANSWER_TIME_MS);
    let Some(SessionEvent::Failed { failure, .. }) = session.poll_event() else { panic!() };
    let reason = UnknownReason::Displaced;
    assert!(matches!(failure, Failure::OutcomeUnknown { reason: found, .. } if found == reason));
    assert_eq!(sent(&mut session, ANSWER_TIME_MS).request, Request::Stop);
}

#[test]
fn an_answer_to_something_else_is_no_answer() {
    let mut session = opened();
    session.request(Address::Motion, Request::State).unwrap();
    let package = sent(&mut session, 0);
    let mut other = package;
    other.sequence = package.sequence.wrapping_sub(1);
    answer(&mut session, other, Status::Accepted, motion_report(1), 5);
    other = ActionPackage { session: package.session ^ 1, ..package };
    answer(&mut session, other, Status::Accepted, motion_report(1), 5);
    other = ActionPackage { request: Request::Stop, ..package };
    answer(&mut session, other, Status::Accepted, motion_report(1), 5);
    let camera = Report::Camera(CameraReport {
        mode: Mode::Fresh,
        pan_centideg: 0,
        tilt_centideg: 0,
        pan_target_centideg: 0,
        tilt_target_centideg: 0,
        axes: crate::AxisFlags::default(),
        boot: 1,
        reception_errors: 0,
        cause: StopCause::Nothing,
    });
    answer(&mut session, package, Status::Accepted, camera, 5);
    assert_eq!(session.poll_event(), None);
    answer(&mut session, package, Status::Accepted, motion_report(1), 6);
    assert!(session.poll_event().is_some());
}

#[test]
fn a_reopened_session_goes_on_after_the_last_number_executed() {
    let mut session = Session::new(SessionConfig { first_session: 9, ..Default::default() });
    session.open(Address::Motion).unwrap();
    let hello = sent(&mut session, 0);
    answer(&mut session, hello, Status::Accepted, hello_report(1, 41), 10);
    session.poll_event().unwrap();
    session.request(Address::Motion, STEP).unwrap();
    assert_eq!(sent(&mut session, 20).sequence, 42);
}

#[test]
fn bad_requests_are_not_taken() {
    let mut session = opened();
    let bad = Request::Step(Step::new(Pose::MIDDLE, 0));
    let error = RequestError::BadArgument { kind: Kind::Step };
    assert_eq!(session.request(Address::Motion, bad), Err(error));
    let hello = Request::Hello { lowest_version: 1, highest_version: 1, session: 1 };
    assert_eq!(session.request(Address::Motion, hello), Err(RequestError::HelloByHand));
    let error = RequestError::NoSession { address: Address::Camera };
    assert_eq!(session.request(Address::Camera, Request::Home), Err(error));
    assert_eq!(session.poll_transmit(0), None);
}
