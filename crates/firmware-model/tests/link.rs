//! Sessions, numbers, refusals, reception and answers.

mod common;

use common::{Motion, SESSION, pause, step};
use rsapien_firmware_model::{Controller, Inputs, MotionController, MotorOutput, ResetCause};
use rsapien_protocol::{
    ActionPackage, Address, CountersReport, Joint, Kind, LineError, Mode, Parameter, Position,
    Report, Request, Status, StopCause,
};

const HELLO: Request = Request::Hello { lowest_version: 1, highest_version: 1, session: SESSION };

fn bytes_of(request: Request) -> [u8; 18] {
    ActionPackage { session: SESSION, sequence: 1, request }.encode(Address::Motion)
}

#[test]
fn every_reset_leaves_the_motors_off_and_tells_its_cause() {
    let causes = [
        (ResetCause::PowerOn, StopCause::PowerOn),
        (ResetCause::BrownOut, StopCause::BrownOut),
        (ResetCause::Watchdog, StopCause::Watchdog),
    ];
    for (reset, told) in causes {
        let controller = MotionController::new(reset, 255).with_clock_mhz(20);
        let report = controller.report();
        assert_eq!((report.mode, report.cause, report.boot), (Mode::Fresh, told, 0));
        assert_eq!((report.motors, report.queue_free, report.pose_reached.word()), (0, 32, 0));
        assert_eq!(controller.motors(), [MotorOutput::Off; 7]);
        assert_eq!(controller.session(), 0);
        assert!(!controller.is_transmitting());
    }
}

#[test]
fn hello_opens_a_session_and_repeated_changes_nothing() {
    let mut motion = Motion::fresh();
    let report = motion.hello(SESSION);
    assert_eq!((report.version, report.firmware, report.clock_mhz), (1, [0, 1, 0], 40));
    assert_eq!((report.queue_length, report.dead_man_ms, report.last_sequence), (32, 500, 0));
    assert_eq!((report.boot, report.reception_errors), (1, 0));
    assert_eq!(report.cause, StopCause::PowerOn);

    let dead_man = Request::Configure(Parameter::DeadMan { timeout_ms: 700 });
    motion.accepts(dead_man);
    motion.accepts(dead_man);
    let report = motion.hello(SESSION);
    assert_eq!((report.last_sequence, report.dead_man_ms), (2, 700));
    assert_eq!(motion.hello(SESSION + 1).last_sequence, 0);
    assert_eq!(motion.sends_numbered(3, dead_man).0, Status::NoSession);
    assert_eq!(motion.hello(SESSION).last_sequence, 0);
    assert_eq!(motion.sends_numbered(0, dead_man).0, Status::OutOfSequence);
    assert_eq!(motion.sends_numbered(1, dead_man).0, Status::Accepted);
}

#[test]
fn a_refused_hello_leaves_the_session_as_it_was() {
    let mut motion = Motion::in_session();
    for (versions, proposed, status) in [
        ([2, 9], SESSION + 1, Status::VersionNotSpoken),
        ([0, 0], SESSION + 1, Status::VersionNotSpoken),
        ([2, 9], 0, Status::BadArgument),
        ([2, 1], SESSION + 1, Status::BadArgument),
    ] {
        let content = [0, 9, 1, versions[0], versions[1], proposed, 0, 0, 0, 0, 0, 0];
        let answer = motion.sends_content(content);
        assert_eq!(answer.status, status);
        let Report::Hello(report) = answer.report else { panic!("HELLO has its own report") };
        assert_eq!(report.version, 0);
        assert_eq!(motion.controller.session(), SESSION);
    }
}

#[test]
fn unnumbered_kinds_are_answered_in_any_session_and_echo_it() {
    let mut motion = Motion::fresh();
    for kind in [Kind::State, Kind::Stop, Kind::Counters] {
        for (session, sequence) in [(0, 0), (SESSION, 200), (99, 1)] {
            let content = [session, sequence, kind.byte(), 0, 0, 0, 0, 0, 0, 0, 0, 0];
            assert_eq!(motion.sends_content(content).status, Status::Accepted);
        }
    }
}

#[test]
fn every_kind_byte_has_one_answer() {
    for kind_byte in 0..=255u8 {
        let mut motion = Motion::fresh();
        let mut content = [3, 4, kind_byte, 0xFF, 0, 0, 0, 0, 0, 0, 0, 0];
        let expected = match Kind::from_byte(kind_byte) {
            None => Status::UnknownKind,
            Some(Kind::Aim | Kind::Home) => Status::NotThisControllers,
            Some(_) => Status::BadArgument,
        };
        assert_eq!(motion.sends_content(content).status, expected);
        // The last unused byte alone is enough.
        content[3] = 0;
        content[11] = 1;
        assert_eq!(motion.sends_content(content).status, expected);
    }
}

#[test]
fn the_first_refusal_of_the_order_is_told() {
    let step = Kind::Step.byte();
    // One content for each place in the order; each is refused for all the later reasons too.
    let wrong_session = [SESSION + 1, 9, step, 1, 0, 10, 0, 0, 0, 0, 0, 0];
    let wrong_sequence = [SESSION, 9, step, 1, 0, 10, 0, 0, 0, 0, 0, 0];
    let not_initialised = [SESSION, 2, step, 1, 0, 10, 0, 0, 0, 0, 0, 0];
    let mut bad_argument = wrong_session;
    bad_argument[7] = 2;
    let mut not_this_controllers = bad_argument;
    not_this_controllers[2] = Kind::Aim.byte();
    let mut unknown_kind = bad_argument;
    unknown_kind[2] = 0x7F;

    // Held, and not initialised, since the dead-man tripped during INIT.
    let mut motion = Motion::in_session();
    motion.accepts(Request::Init);
    assert_eq!(motion.at(500).controller.mode(), Mode::Held);
    for (content, status) in [
        (unknown_kind, Status::UnknownKind),
        (not_this_controllers, Status::NotThisControllers),
        (bad_argument, Status::BadArgument),
        (wrong_session, Status::NoSession),
        (wrong_sequence, Status::OutOfSequence),
        (not_initialised, Status::NotInitialised),
    ] {
        assert_eq!(motion.sends_content(content).status, status);
    }
    let mut held = Motion::initialised();
    held.accepts(Request::Step(pause(1000)));
    assert_eq!(held.at(500).controller.mode(), Mode::Held);
    let session_last = [SESSION + 1, 3, step, 1, 0, 10, 0, 0, 0, 0, 0, 0];
    assert_eq!(held.sends_content(session_last).status, Status::NoSession);
    held.refuses(Request::Step(pause(10)), Status::Held);
}

#[test]
fn no_session_is_open_under_number_0() {
    let mut motion = Motion::fresh();
    let content = [0, 1, Kind::Init.byte(), 0, 0, 0, 0, 0, 0, 0, 0, 0];
    assert_eq!(motion.sends_content(content).status, Status::NoSession);
    assert_eq!(motion.controller.mode(), Mode::Fresh);
}

#[test]
fn a_first_package_numbered_0_is_out_of_sequence() {
    let mut motion = Motion::in_session();
    assert_eq!(motion.sends_numbered(0, Request::Init).0, Status::OutOfSequence);
    assert_eq!(motion.sends_numbered(2, Request::Init).0, Status::OutOfSequence);
    assert_eq!(motion.sends_numbered(1, Request::Init).0, Status::Accepted);
    assert_eq!(motion.sends_numbered(0, Request::Init).0, Status::OutOfSequence);
}

#[test]
fn sequence_numbers_wrap_and_0_is_a_duplicate_then() {
    let mut motion = Motion::in_session();
    let request = Request::Configure(Parameter::DeadMan { timeout_ms: 600 });
    for number in 1..=256u16 {
        assert_eq!(motion.sends_numbered(number.to_le_bytes()[0], request).0, Status::Accepted);
    }
    assert_eq!(motion.controller.counters().duplicates, 0);
    assert_eq!(motion.sends_numbered(0, request).0, Status::Accepted);
    assert_eq!(motion.controller.counters().duplicates, 1);
    assert_eq!(motion.sends_numbered(255, request).0, Status::OutOfSequence);
    assert_eq!(motion.sends_numbered(1, request).0, Status::Accepted);
}

#[test]
fn a_duplicate_is_answered_afresh_and_not_executed() {
    let mut motion = Motion::initialised();
    motion.accepts(Request::Step(pause(20)));
    let last = motion.sequence;
    let before = motion.at(5).accepts(Request::State);
    let (status, report) = motion.sends_numbered(last, Request::Step(pause(20)));
    assert_eq!((status, report), (Status::Accepted, before));
    motion.at(20);
    let (status, report) = motion.sends_numbered(last, Request::Step(pause(20)));
    assert_eq!((status, report.mode, report.steps_ended), (Status::Accepted, Mode::Idle, 1));
    assert_eq!(motion.controller.counters().duplicates, 2);
}

#[test]
fn a_duplicate_is_told_0_though_the_robot_is_held_by_now() {
    let mut motion = Motion::initialised();
    motion.accepts(Request::Step(pause(1000)));
    motion.at(500);
    let (status, report) = motion.sends_numbered(motion.sequence, Request::Step(pause(1000)));
    assert_eq!((status, report.mode), (Status::Accepted, Mode::Held));
}

#[test]
fn a_refused_package_does_not_use_its_number_up() {
    let mut motion = Motion::in_session();
    let number = motion.sequence + 1;
    let (status, _) = motion.sends_numbered(number, Request::Step(pause(10)));
    assert_eq!(status, Status::NotInitialised);
    assert_eq!(motion.sends_numbered(number, Request::Init).0, Status::Accepted);
}

#[test]
fn configure_takes_its_range_and_no_more() {
    let mut motion = Motion::in_session();
    for parameter in 0..=255u8 {
        for (value, in_range) in
            [(0, parameter == 0), (99, false), (100, true), (10_000, true), (10_001, false)]
        {
            let [low, high] = u16::to_le_bytes(value);
            let kind = Kind::Configure.byte();
            let number = motion.sequence.wrapping_add(1);
            let content = [SESSION, number, kind, parameter, low, high, 0, 0, 0, 0, 0, 0];
            let accepted = parameter <= 7 && in_range;
            let expected = if accepted { Status::Accepted } else { Status::BadArgument };
            assert_eq!(motion.sends_content(content).status, expected, "{parameter} = {value}");
            if accepted {
                motion.sequence = number;
            }
        }
    }
}

#[test]
fn a_gap_of_20_ms_is_a_pause_and_of_21_ms_the_end() {
    for (gap_ms, answers, resets) in [(20, 1, 0), (21, 0, 1)] {
        let mut motion = Motion::fresh();
        let bytes = bytes_of(Request::State);
        motion.line_brings(&bytes[..9]);
        motion.at(gap_ms).line_brings(&bytes[9..]);
        assert_eq!(motion.hears().len(), answers);
        let counts = motion.controller.counters();
        assert_eq!((counts.resets, usize::from(counts.accepted)), (resets, answers));
        assert_eq!(u16::from(motion.controller.report().reception_errors), resets);
    }
}

#[test]
fn a_package_that_does_not_go_on_is_counted_without_another_byte() {
    let mut motion = Motion::fresh();
    motion.line_brings(&bytes_of(Request::State)[..17]);
    assert_eq!(motion.at(20).controller.report().reception_errors, 0);
    assert_eq!(motion.at(21).controller.report().reception_errors, 1);
    assert_eq!(motion.at(100).controller.report().reception_errors, 1);
}

#[test]
fn line_errors_and_damage_are_counted_and_never_answered() {
    let mut motion = Motion::fresh();
    let bytes = bytes_of(Request::State);
    motion.line_brings(&bytes[..9]);
    motion.controller.receive_error(LineError::Framing);
    motion.line_brings(&bytes[9..]);
    motion.line_brings(&bytes[..5]);
    motion.controller.receive_error(LineError::Overrun);
    motion.line_brings(&[]);
    let mut damaged = bytes;
    damaged[3] ^= 1;
    motion.line_brings(&damaged);
    assert_eq!(motion.hears(), []);
    let expected = CountersReport {
        resets: 2,
        crc_errors: 1,
        framing_errors: 1,
        overruns: 1,
        ..CountersReport::default()
    };
    assert_eq!(motion.controller.counters(), expected);
    assert_eq!(motion.controller.report().reception_errors, 3);
    motion.line_brings(&bytes);
    assert_eq!(motion.hears().len(), 1);
}

#[test]
fn a_ring_that_overflows_is_one_overrun_and_the_next_package_comes_through() {
    let mut motion = Motion::fresh();
    let bytes = bytes_of(Request::State);
    for byte in bytes.iter().chain(&bytes).chain(&bytes) {
        motion.controller.receive_interrupt(*byte);
    }
    // The first package is whole; of the second only 14 bytes had a place.
    for _ in 0..3 {
        motion.line_brings(&[]);
        motion.hears();
    }
    let counts = motion.controller.counters();
    assert_eq!((counts.accepted, counts.overruns, counts.resets), (1, 1, 1));
    motion.line_brings(&bytes);
    assert_eq!(motion.hears().len(), 1);
}

#[test]
fn the_ring_holds_32_bytes() {
    let bytes = bytes_of(Request::State);
    for (ahead, answers, overruns) in [(14, 1, 0), (15, 0, 1)] {
        let mut motion = Motion::fresh();
        let mut line = vec![0; ahead];
        line.extend(bytes);
        motion.line_brings(&line);
        assert_eq!(motion.hears().len(), answers);
        assert_eq!(motion.controller.counters().overruns, overruns);
    }
}

#[test]
fn what_comes_behind_a_lost_byte_is_lost_until_the_ring_is_empty() {
    let mut motion = Motion::fresh();
    let bytes = bytes_of(Request::State);
    for byte in bytes.iter().chain(&bytes) {
        motion.controller.receive_interrupt(*byte);
    }
    motion.line_brings(&[]);
    motion.line_brings(&bytes);
    motion.line_brings(&[]);
    let counts = motion.controller.counters();
    assert_eq!((counts.accepted, counts.overruns), (1, 1));
}

#[test]
fn the_other_controllers_packages_are_no_error() {
    let mut motion = Motion::fresh();
    motion.line_brings(
        &ActionPackage { session: 1, sequence: 0, request: HELLO }.encode(Address::Camera),
    );
    assert_eq!(motion.hears(), []);
    assert_eq!(motion.controller.counters(), CountersReport::default());
}

#[test]
fn stop_overtakes_an_answer_that_is_still_on_its_way() {
    let mut motion = Motion::initialised();
    motion.accepts(Request::Step(step(Joint::Tilt, Position::First, 1000)));
    motion.line_brings(&bytes_of(Request::State));
    let first: Vec<u8> = (0..10).filter_map(|_| motion.controller.transmit_interrupt()).collect();
    motion.line_brings(&bytes_of(Request::Counters));
    motion.line_brings(&bytes_of(Request::Stop));
    motion.all_off();
    assert_eq!(motion.controller.mode(), Mode::Stopped);
    // The answer under way is not cut off, and tells of the moment it began.
    let rest: Vec<u8> = core::iter::from_fn(|| motion.controller.transmit_interrupt()).collect();
    assert_eq!((first.len() + rest.len(), first[0]), (25, 0xE9));
    // Of the two that came meanwhile the newest is answered.
    motion.line_brings(&[]);
    let answers = motion.hears();
    assert_eq!(answers.len(), 1);
    assert_eq!(answers[0].kind_byte, Kind::Stop.byte());
    let Report::Motion(report) = answers[0].report else { panic!("the own report") };
    assert_eq!((report.mode, report.motors), (Mode::Stopped, 0));
}

#[test]
fn counters_tell_what_was_counted() {
    let mut motion = Motion::in_session();
    motion.accepts(Request::Init);
    motion.sends_numbered(motion.sequence, Request::Init);
    motion.at(500).line_brings(&bytes_of(Request::State)[..4]);
    motion.at(600);
    let counters = Request::Counters;
    let content = ActionPackage { session: 0, sequence: 0, request: counters }.content();
    let Report::Counters(counts) = motion.sends_content(content).report else {
        panic!("COUNTERS has its own report")
    };
    let expected = CountersReport {
        accepted: 5, // HELLO, STATE, INIT twice, and this one
        resets: 1,
        duplicates: 1,
        dead_man_trips: 1,
        ..CountersReport::default()
    };
    assert_eq!(counts, expected);
}

#[test]
fn nothing_is_transmitted_unasked() {
    let mut controller = MotionController::new(ResetCause::PowerOn, 0);
    for _ in 0..2000 {
        controller.tick(Inputs::default());
        assert_eq!(controller.transmit_interrupt(), None);
    }
}
