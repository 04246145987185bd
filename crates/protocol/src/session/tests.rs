//! The session against a line whose every package the test answers by hand.

use super::*;
use crate::{
    CameraReport, Fed, HelloReport, Mode, MotionReport, Pose, Report, Status, Step, StopCause,
};

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
        if !status.is_accepted() {
            let question = sent(&mut session, 111);
            answer(&mut session, question, Status::Accepted, hello_report(1, 0), 120);
        }
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
fn a_refusal_for_a_reason_that_passes_is_told_when_the_robot_confirms_it() {
    let refused = |tries| {
        let mut session = opened();
        session.request(Address::Motion, STEP).unwrap();
        let package = sent(&mut session, 0);
        for try_number in 1..tries {
            session.handle_timeout(try_number * ANSWER_TIME_MS);
            assert_eq!(sent(&mut session, try_number * ANSWER_TIME_MS), package);
        }
        answer(&mut session, package, Status::QueueFull, motion_report(1), 300);
        assert_eq!(session.poll_event(), None);
        let question = sent(&mut session, 301);
        let hello = Request::Hello { lowest_version: 1, highest_version: 1, session: 9 };
        assert_eq!((question.session, question.request), (9, hello));
        (session, package, question)
    };
    let told = |mut session: Session| match session.poll_event() {
        Some(SessionEvent::Answered { package, tries, round_trip_ms: 300, .. }) => {
            Ok((package.status, tries))
        }
        Some(SessionEvent::Failed { failure, .. }) => Err(failure),
        other => panic!("{other:?}"),
    };

    let (mut session, _, question) = refused(1);
    answer(&mut session, question, Status::Accepted, hello_report(1, 0), 310);
    assert_eq!(told(session), Ok((Status::QueueFull, 1)));

    // The second copy was executed, and its answer lost.
    let (mut session, _, question) = refused(2);
    answer(&mut session, question, Status::Accepted, hello_report(1, 1), 310);
    assert_eq!(session.peer(Address::Motion).last_sequence, 1);
    assert_eq!(told(session), Ok((Status::Accepted, 2)));

    // The robot was reset in between.
    let (mut session, _, question) = refused(2);
    answer(&mut session, question, Status::Accepted, hello_report(2, 0), 310);
    assert!(matches!(session.poll_event(), Some(SessionEvent::Restarted { .. })));
    assert!(matches!(told(session), Err(Failure::OutcomeUnknown { .. })));

    // The robot falls silent, before or after the second copy's acceptance was heard.
    for accepted in [false, true] {
        let (mut session, package, _) = refused(2);
        if accepted {
            answer(&mut session, package, Status::Accepted, motion_report(1), 300);
        }
        for try_number in 1..=6 {
            session.handle_timeout(301 + try_number * ANSWER_TIME_MS);
            assert_eq!(
                session.poll_transmit(301 + try_number * ANSWER_TIME_MS).is_some(),
                try_number < 6
            );
        }
        assert_eq!(session.open_session(Address::Motion), None);
        assert_eq!(told(session).is_ok(), accepted);
    }
}

#[test]
fn only_a_refusal_for_a_reason_that_passes_is_asked_about() {
    for status in Status::ALL {
        let mut session = opened();
        session.request(Address::Motion, STEP).unwrap();
        let package = sent(&mut session, 0);
        answer(&mut session, package, status, motion_report(1), 10);
        let passes = [Status::QueueFull, Status::Held, Status::NotInitialised].contains(&status);
        assert_eq!(session.poll_event().is_none(), passes, "{status:?}");
    }
}

#[test]
fn stop_does_not_wait_for_a_refusal_to_be_confirmed() {
    let mut session = opened();
    session.request(Address::Motion, STEP).unwrap();
    let package = sent(&mut session, 0);
    answer(&mut session, package, Status::QueueFull, motion_report(1), 10);
    session.stop(Address::Motion).unwrap();
    assert_eq!(sent(&mut session, 11).request, Request::Stop);
    let Some(SessionEvent::Failed { failure, .. }) = session.poll_event() else { panic!() };
    assert!(matches!(failure, Failure::OutcomeUnknown { .. }));
    assert_eq!(session.open_session(Address::Motion), None, "a copy may run under its number");
}

#[test]
fn rubbish_never_takes_the_place_of_an_outcome() {
    let mut session = opened();
    let ticket = session.request(Address::Motion, Request::State).unwrap();
    let package = sent(&mut session, 0);
    let header = crate::HeaderByte { direction: crate::Direction::ToPc, address: Address::Camera };
    let rubbish: crate::SynchronizationBytes = crate::frame::encode(header, &[0xFF; 18]);
    for _ in 0..20 {
        session.handle_bytes(&rubbish, 5);
    }
    for boot in 2..20 {
        answer(
            &mut session,
            ActionPackage { session: 0, ..package },
            Status::Accepted,
            motion_report(boot),
            6,
        );
    }
    answer(&mut session, package, Status::Accepted, motion_report(20), 7);
    let events = std::iter::from_fn(|| session.poll_event());
    let ends = events.filter(
        |event| matches!(event, SessionEvent::Answered { ticket: of, .. } if *of == ticket),
    );
    assert_eq!(ends.count(), 1);
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
