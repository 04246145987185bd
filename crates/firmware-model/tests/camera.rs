//! HOME, AIM, STOP and the dead-man of the camera controller.

mod common;

use common::{Camera, SESSION};
use rsapien_firmware_model::{CameraOutputs, Controller};
use rsapien_protocol::{
    AimTarget, HelloReport, Joint, Kind, Mode, Parameter, Report, Request, Status, StopCause,
};

fn aim(pan_centideg: i16, tilt_centideg: i16, speed_deg_per_s: u16) -> Request {
    Request::Aim(AimTarget { pan_centideg, tilt_centideg, speed_deg_per_s })
}

fn commanded(pan_centideg: i16, tilt_centideg: i16) -> CameraOutputs {
    CameraOutputs { pan_centideg: Some(pan_centideg), tilt_centideg: Some(tilt_centideg) }
}

#[test]
fn nothing_is_driven_before_home() {
    let mut camera = Camera::in_session();
    assert_eq!(camera.controller.outputs(), CameraOutputs::default());
    camera.refuses(aim(0, 0, 0), Status::NotInitialised);
    let report = camera.accepts(Request::State);
    assert_eq!((report.mode, report.cause, report.boot), (Mode::Fresh, StopCause::PowerOn, 42));
}

#[test]
fn the_first_home_gives_the_servos_time() {
    let mut camera = Camera::in_session();
    let report = camera.accepts(Request::Home);
    assert_eq!((report.mode, report.axes.bits()), (Mode::Initialising, 0b0011));
    assert_eq!(camera.controller.outputs(), commanded(0, 0));
    camera.at(400).accepts(Request::State);
    assert_eq!(camera.at(749).controller.mode(), Mode::Initialising);
    assert_eq!(camera.at(750).controller.mode(), Mode::Idle);
    assert_eq!(camera.accepts(Request::State).axes.bits(), 0);
}

#[test]
fn a_home_that_was_stopped_lets_go_of_the_servos() {
    let mut camera = Camera::in_session();
    camera.accepts(Request::Home);
    assert_eq!(camera.at(10).accepts(Request::Stop).mode, Mode::Stopped);
    assert_eq!(camera.controller.outputs(), CameraOutputs::default());
    camera.refuses(aim(0, 0, 0), Status::NotInitialised);
}

#[test]
fn aim_moves_both_axes_at_its_speed() {
    let mut camera = Camera::homed();
    // 15 degrees per second are 1.5 hundredths of a degree a tick.
    let report = camera.accepts(aim(300, -150, 15));
    assert_eq!((report.mode, report.axes.bits()), (Mode::Executing, 0b0011));
    assert_eq!((report.pan_target_centideg, report.tilt_target_centideg), (300, -150));
    assert_eq!(camera.at(1).controller.outputs(), commanded(1, -1));
    assert_eq!(camera.at(2).controller.outputs(), commanded(3, -3));
    let report = camera.at(100).accepts(Request::State);
    assert_eq!((report.pan_centideg, report.axes.bits()), (150, 0b0001));
    assert_eq!(camera.at(199).controller.mode(), Mode::Executing);
    assert_eq!(camera.at(200).controller.mode(), Mode::Idle);
    assert_eq!(camera.controller.outputs(), commanded(300, -150));
}

#[test]
fn every_speed_is_exact_and_0_and_large_ones_are_the_largest() {
    for speed in (0..=200).chain([65_535]) {
        let mut camera = Camera::homed();
        camera.accepts(aim(9000, 0, speed));
        let per_100_ms = if speed == 0 { 180 } else { speed.min(180) } * 10;
        let expected = i16::try_from(per_100_ms).unwrap();
        assert_eq!(camera.at(100).controller.report().pan_centideg, expected);
    }
}

#[test]
fn limits_are_told_and_what_lies_beyond_is_a_bad_argument() {
    for (pan, tilt, bits) in [(9000, 4500, 0b1100), (-9000, -4500, 0b1100), (8999, 4499, 0)] {
        let mut camera = Camera::homed();
        camera.accepts(aim(pan, tilt, 0));
        camera.at(300).accepts(Request::State);
        let report = camera.at(600).accepts(Request::State);
        assert_eq!((report.mode, report.axes.bits()), (Mode::Idle, bits));
        assert_eq!((report.pan_centideg, report.tilt_centideg), (pan, tilt));
    }
    let mut camera = Camera::homed();
    for (pan, tilt) in [(9001, 0), (-9001, 0), (0, 4501), (0, -4501), (i16::MIN, i16::MIN)] {
        camera.refuses(aim(pan, tilt, 0), Status::BadArgument);
    }
}

#[test]
fn an_aim_during_home_waits_for_its_end_and_the_newest_wins() {
    let mut camera = Camera::homed();
    camera.accepts(aim(1800, 0, 0));
    camera.at(100).accepts(Request::Home);
    camera.accepts(aim(-900, 0, 0));
    let report = camera.accepts(aim(900, 90, 0));
    assert_eq!((report.mode, report.pan_target_centideg), (Mode::Initialising, 0));
    assert_eq!(camera.at(199).controller.mode(), Mode::Initialising);
    assert_eq!(camera.at(200).controller.mode(), Mode::Executing);
    assert_eq!(camera.controller.outputs(), commanded(0, 0));
    assert_eq!(camera.at(250).controller.mode(), Mode::Idle);
    assert_eq!(camera.controller.outputs(), commanded(900, 90));
}

#[test]
fn stop_leaves_the_axes_where_they_are() {
    let mut camera = Camera::homed();
    camera.accepts(aim(9000, 4500, 100));
    let report = camera.at(50).accepts(Request::Stop);
    assert_eq!((report.mode, report.axes.bits()), (Mode::Stopped, 0));
    assert_eq!((report.pan_centideg, report.pan_target_centideg), (500, 500));
    assert_eq!(camera.at(100).controller.outputs(), commanded(500, 500));
    assert_eq!(camera.accepts(aim(0, 0, 0)).mode, Mode::Executing);
}

#[test]
fn the_dead_man_holds_moving_axes_and_home_or_stop_releases_them() {
    for (request, mode) in [(Request::Stop, Mode::Stopped), (Request::Home, Mode::Initialising)] {
        let mut camera = Camera::homed();
        camera.accepts(aim(9000, 0, 10));
        assert_eq!(camera.at(499).controller.mode(), Mode::Executing);
        let report = camera.at(500).controller.report();
        assert_eq!((report.mode, report.cause), (Mode::Held, StopCause::DeadMan));
        assert_eq!(camera.at(600).controller.outputs(), commanded(500, 0));
        camera.refuses(aim(0, 0, 0), Status::Held);
        assert_eq!(camera.accepts(request).mode, mode);
        assert_eq!(camera.controller.counters().dead_man_trips, 1);
    }
}

#[test]
fn the_camera_configures_its_dead_man_and_no_travel_time() {
    let mut camera = Camera::homed();
    camera.accepts(Request::Configure(Parameter::DeadMan { timeout_ms: 100 }));
    for joint in Joint::ALL {
        let parameter = Parameter::TravelTime { joint, full_travel_ms: 500 };
        camera.refuses(Request::Configure(parameter), Status::BadArgument);
        // Before the session is looked at.
        let answer = camera.answer_to(200, Request::Configure(parameter));
        assert_eq!(answer.status, Status::BadArgument);
    }
    camera.refuses(Request::Init, Status::NotThisControllers);
    camera.accepts(aim(9000, 0, 10));
    assert_eq!(camera.at(100).controller.mode(), Mode::Held);
}

#[test]
fn the_watchdog_resets_a_hung_camera() {
    let mut camera = Camera::homed();
    camera.controller.hang();
    assert_eq!(camera.at(127).controller.mode(), Mode::Idle);
    assert_eq!(camera.at(128).controller.mode(), Mode::Fresh);
    assert_eq!(camera.controller.outputs(), CameraOutputs::default());
    assert_eq!(camera.controller.report().cause, StopCause::Watchdog);
    assert_eq!(camera.controller.eeprom_boot(), 43);
}

#[test]
fn stop_and_home_forget_the_aim_that_waits() {
    let mut camera = Camera::homed();
    camera.accepts(Request::Home);
    camera.accepts(aim(9000, 0, 0));
    camera.accepts(Request::Stop);
    camera.accepts(aim(180, 0, 0));
    assert_eq!(camera.at(20).controller.mode(), Mode::Idle);
    assert_eq!(camera.controller.outputs(), commanded(180, 0));
    camera.accepts(Request::Home);
    camera.accepts(aim(9000, 0, 0));
    camera.accepts(Request::Home);
    assert_eq!(camera.at(40).controller.mode(), Mode::Idle);
    assert_eq!(camera.controller.outputs(), commanded(0, 0));
}

#[test]
fn an_aim_begins_with_no_tenths_from_the_one_before() {
    let mut camera = Camera::homed();
    camera.accepts(aim(100, 0, 5));
    camera.at(1).accepts(aim(100, 0, 5));
    assert_eq!(camera.at(2).controller.outputs(), commanded(0, 0));
    assert_eq!(camera.at(3).controller.outputs(), commanded(1, 0));
}

#[test]
fn every_kind_byte_has_one_answer_of_the_camera() {
    for kind_byte in 0..=255u8 {
        let mut camera = Camera::in_session();
        let mut content = [3, 4, kind_byte, 0, 0, 0, 0, 0, 0, 0, 0, 1];
        let expected = match Kind::from_byte(kind_byte) {
            None => Status::UnknownKind,
            Some(Kind::Init | Kind::Step) => Status::NotThisControllers,
            Some(_) => Status::BadArgument,
        };
        let answer = camera.sends_content(content);
        assert_eq!((answer.session, answer.sequence, answer.kind_byte), (3, 4, kind_byte));
        assert_eq!(answer.status, expected);
        assert!(answer.report.answers(kind_byte));
        content[11] = 0;
        let expected = match Kind::from_byte(kind_byte) {
            None => Status::UnknownKind,
            Some(Kind::Init | Kind::Step) => Status::NotThisControllers,
            Some(Kind::Hello) => Status::BadArgument,
            // All zeros switch the dead-man off.
            Some(Kind::Configure | Kind::Aim | Kind::Home) => Status::NoSession,
            Some(Kind::State | Kind::Stop | Kind::Counters) => Status::Accepted,
        };
        assert_eq!(camera.sends_content(content).status, expected);
    }
}

#[test]
fn the_camera_tells_the_first_refusal_of_the_order() {
    // Held, and not initialised, since the dead-man tripped during the first HOME.
    let mut camera = Camera::in_session();
    camera.accepts(Request::Home);
    assert_eq!(camera.at(500).controller.mode(), Mode::Held);
    for (session, sequence, status) in [
        (SESSION + 1, 9, Status::NoSession),
        (SESSION, 9, Status::OutOfSequence),
        (SESSION, 2, Status::NotInitialised),
    ] {
        let content = [session, sequence, Kind::Aim.byte(), 0, 0, 0, 0, 0, 0, 0, 0, 0];
        assert_eq!(camera.sends_content(content).status, status);
    }
}

#[test]
fn the_camera_numbers_and_counts_for_itself() {
    let mut camera = Camera::homed();
    camera.accepts(aim(900, 0, 0));
    // The number is used up: another target under it is not aimed at.
    let answer = camera.answer_to(camera.sequence, aim(-900, 0, 0));
    let Report::Camera(report) = answer.report else { panic!("the own report") };
    assert_eq!((answer.status, report.pan_target_centideg), (Status::Accepted, 900));
    let hello = Request::Hello { lowest_version: 0, highest_version: 9, session: SESSION };
    let Report::Hello(HelloReport { version, queue_length, last_sequence, boot, .. }) =
        camera.answer_to(0, hello).report
    else {
        panic!("HELLO has its own report")
    };
    assert_eq!((version, queue_length, last_sequence, boot), (1, 0, camera.sequence, 42));
    let Report::Counters(counts) = camera.answer_to(0, Request::Counters).report else {
        panic!("COUNTERS has its own report")
    };
    assert_eq!((counts.duplicates, counts.dead_man_trips, counts.resets), (1, 0, 0));
}

#[test]
fn a_later_home_that_is_stopped_has_lost_nothing() {
    let mut camera = Camera::homed();
    camera.accepts(aim(900, 0, 0));
    camera.at(100).accepts(Request::Home);
    camera.at(110).accepts(Request::Stop);
    let report = camera.accepts(aim(900, 0, 0));
    assert_eq!((report.mode, report.pan_centideg), (Mode::Executing, 720));
}
