//! The bumpers, hold, the dead-man, the watchdog and brown-out.

mod common;

use common::{Motion, SESSION, pause, step};
use rsapien_firmware_model::{Controller, MotorOutput, ResetCause};
use rsapien_protocol::{
    ActionPackage, Address, BumperMask, Joint, Mode, Parameter, Pose, Position, Request, Status,
    Step, StopCause,
};

const TILT_LEFT: Step = Step::new(Pose::EMPTY.with(Joint::Tilt, Some(Position::First)), 1000);

fn step_ended_by(mask: u8, duration_ms: u16) -> Step {
    let ending_bumpers = BumperMask::from_bits(mask).unwrap();
    Step { ending_bumpers, ..step(Joint::Tilt, Position::First, duration_ms) }
}

// Bumpers

#[test]
fn a_bumper_is_believed_at_the_fifth_test() {
    let mut motion = Motion::fresh();
    for bumper in 0..6 {
        motion.inputs.bumpers = BumperMask::from_bits(1 << bumper).unwrap();
        motion.wait(4);
        assert!(motion.controller.report().bumpers.is_empty());
        motion.inputs.bumpers = BumperMask::NONE;
        motion.wait(1);
        motion.inputs.bumpers = BumperMask::from_bits(1 << bumper).unwrap();
        motion.wait(4);
        assert!(motion.controller.report().bumpers.is_empty());
        motion.wait(1);
        let report = motion.controller.report();
        assert_eq!(report.bumpers.bits(), 1 << bumper);
        assert_eq!(report.presses[bumper], 1);
        motion.inputs.bumpers = BumperMask::NONE;
        motion.wait(5);
        assert!(motion.controller.report().bumpers.is_empty());
    }
    assert_eq!(motion.controller.report().presses, [1; 6]);
}

#[test]
fn many_passes_in_one_tick_are_one_test() {
    let mut motion = Motion::fresh();
    motion.inputs.bumpers = BumperMask::ALL;
    motion.wait(1);
    for _ in 0..10 {
        motion.controller.main_routine(motion.inputs);
    }
    assert!(motion.controller.report().bumpers.is_empty());
}

#[test]
fn presses_are_counted_modulo_16() {
    let mut motion = Motion::fresh();
    for press in 1..=33u8 {
        motion.inputs.bumpers = BumperMask::from_bits(0b10_0001).unwrap();
        motion.wait(5);
        motion.inputs.bumpers = BumperMask::NONE;
        motion.wait(5);
        assert_eq!(motion.controller.report().presses, [press % 16, 0, 0, 0, 0, press % 16]);
    }
}

#[test]
fn an_ending_bumper_holds_and_another_one_does_not() {
    let mut motion = Motion::initialised();
    motion.accepts(Request::Step(step_ended_by(0b00_0100, 300)));
    motion.accepts(Request::Step(pause(100)));
    motion.inputs.bumpers = BumperMask::from_bits(0b00_1000).unwrap();
    assert_eq!(motion.at(100).controller.mode(), Mode::Executing);
    motion.inputs.bumpers = BumperMask::from_bits(0b00_0100).unwrap();
    assert_eq!(motion.at(104).controller.mode(), Mode::Executing);
    let report = motion.at(105).controller.report();
    assert_eq!((report.mode, report.cause), (Mode::Held, StopCause::Bumper));
    assert_eq!((report.queue_free, report.steps_ended), (32, 0));
    motion.all_off();
    motion.refuses(Request::Step(pause(10)), Status::Held);
}

#[test]
fn an_ending_bumper_of_a_waiting_step_does_not_end_the_running_one() {
    let mut motion = Motion::initialised();
    motion.inputs.bumpers = BumperMask::from_bits(1).unwrap();
    motion.at(10).accepts(Request::Step(step(Joint::RightLeg, Position::First, 100)));
    motion.accepts(Request::Step(step_ended_by(1, 100)));
    for ms in 10..110 {
        assert_eq!(motion.at(ms).controller.mode(), Mode::Executing);
        assert_eq!(motion.motor(Joint::Tilt), MotorOutput::Off);
    }
    // Already pressed when its step starts: held, and the tilt has never been switched on.
    let report = motion.at(110).controller.report();
    assert_eq!((report.mode, report.cause, report.steps_ended), (Mode::Held, StopCause::Bumper, 1));
    motion.all_off();
}

#[test]
fn a_step_refused_by_a_pressed_bumper_is_accepted_and_held() {
    let mut motion = Motion::initialised();
    motion.inputs.bumpers = BumperMask::ALL;
    let report = motion.at(10).accepts(Request::Step(step_ended_by(1, 100)));
    assert_eq!((report.mode, report.cause, report.motors), (Mode::Held, StopCause::Bumper, 0));
}

// Hold, dead-man, reset

#[test]
fn init_and_stop_release_a_hold() {
    for (request, mode) in [(Request::Stop, Mode::Stopped), (Request::Init, Mode::Initialising)] {
        let mut motion = Motion::initialised();
        motion.accepts(Request::Step(TILT_LEFT));
        motion.at(500).refuses(Request::Step(TILT_LEFT), Status::Held);
        let report = motion.accepts(request);
        assert_eq!((report.mode, report.cause), (mode, StopCause::DeadMan));
        motion.accepts(Request::Step(TILT_LEFT));
    }
}

#[test]
fn the_dead_man_trips_at_its_time_and_not_before() {
    let dead_man_ms = |timeout_ms| Request::Configure(Parameter::DeadMan { timeout_ms });
    let executing = Request::Step(pause(60_000));
    let arriving = Request::Step(step(Joint::Tilt, Position::First, 1));
    let slow = Parameter::TravelTime { joint: Joint::Tilt, full_travel_ms: 10_000 };
    for (timeout_ms, request) in [
        (500, executing),
        (500, arriving),
        (500, Request::Init),
        (100, executing),
        (10_000, executing),
    ] {
        let mut motion = Motion::initialised();
        motion.accepts(Request::Configure(slow));
        motion.accepts(dead_man_ms(timeout_ms));
        motion.accepts(request);
        let time = u64::from(timeout_ms);
        let report = motion.at(time - 1).controller.report();
        assert!(!matches!(report.mode, Mode::Held), "{request:?}");
        assert_ne!(report.cause, StopCause::DeadMan);
        let report = motion.at(time).controller.report();
        assert_eq!((report.mode, report.cause), (Mode::Held, StopCause::DeadMan), "{request:?}");
        assert_eq!((report.motors, report.queue_free), (0, 32));
        motion.all_off();
        motion.at(3 * time);
        assert_eq!(motion.controller.counters().dead_man_trips, 1);
    }
}

#[test]
fn a_package_just_in_time_keeps_the_motors_on_and_one_too_late_does_not() {
    for (sent_at_ms, mode) in [(499, Mode::Executing), (500, Mode::Held), (501, Mode::Held)] {
        let mut motion = Motion::initialised();
        motion.accepts(Request::Step(pause(2000)));
        motion.at(sent_at_ms).sends(Request::State);
        assert_eq!(motion.at(501).controller.mode(), mode);
    }
    let mut motion = Motion::initialised();
    motion.accepts(Request::Step(pause(2000)));
    motion.at(499).sends(Request::State);
    assert_eq!(motion.at(998).controller.mode(), Mode::Executing);
    assert_eq!(motion.at(999).controller.mode(), Mode::Held);
}

#[test]
fn silence_is_no_matter_while_nothing_moves_or_the_dead_man_is_off() {
    let mut motion = Motion::initialised();
    assert_eq!(motion.at(100_000).controller.mode(), Mode::Idle);
    motion.accepts(Request::Step(pause(400)));
    assert_eq!(motion.at(100_400).controller.mode(), Mode::Idle);
    motion.accepts(Request::Configure(Parameter::DeadMan { timeout_ms: 0 }));
    motion.accepts(Request::Step(pause(65_535)));
    assert_eq!(motion.at(165_934).controller.mode(), Mode::Executing);
    assert_eq!(motion.at(165_935).controller.mode(), Mode::Idle);
}

#[test]
fn every_intact_package_to_this_controller_feeds_the_dead_man_and_no_other() {
    let package = |session| ActionPackage { session, sequence: 99, request: Request::Init };
    let mut damaged = package(SESSION).encode(Address::Motion);
    damaged[5] ^= 4;
    let refused = package(SESSION + 1).encode(Address::Motion);
    let to_camera = package(SESSION).encode(Address::Camera);
    for (bytes, mode) in
        [(refused, Mode::Executing), (damaged, Mode::Held), (to_camera, Mode::Held)]
    {
        let mut motion = Motion::initialised();
        motion.accepts(Request::Step(pause(2000)));
        motion.at(400).line_brings(&bytes);
        assert_eq!(motion.at(600).controller.mode(), mode);
    }
}

#[test]
fn the_watchdog_resets_a_hung_controller() {
    let mut motion = Motion::initialised();
    motion.accepts(Request::Step(TILT_LEFT));
    motion.controller.hang();
    assert_eq!(motion.at(143).motor(Joint::Tilt), MotorOutput::TowardsFirst);
    motion.at(144).all_off();
    let report = motion.controller.report();
    assert_eq!((report.mode, report.cause, report.boot), (Mode::Fresh, StopCause::Watchdog, 2));
    assert_eq!((motion.controller.session(), motion.controller.eeprom_boot()), (0, 2));
    motion.refuses(Request::Step(TILT_LEFT), Status::NoSession);
    assert_eq!(motion.at(1000).controller.report().boot, 2);
}

#[test]
fn the_dead_man_ends_motion_though_the_main_routine_hangs() {
    let mut motion = Motion::initialised();
    motion.accepts(Request::Configure(Parameter::DeadMan { timeout_ms: 100 }));
    motion.accepts(Request::Step(TILT_LEFT));
    motion.controller.hang();
    assert_eq!(motion.at(99).motor(Joint::Tilt), MotorOutput::TowardsFirst);
    motion.at(100).all_off();
}

#[test]
fn a_brown_out_resets_and_the_supply_is_told() {
    let mut motion = Motion::initialised();
    motion.inputs.supply_low = true;
    motion.at(1);
    assert!(motion.accepts(Request::State).supply_low);
    motion.accepts(Request::Step(TILT_LEFT));
    motion.controller.reset(ResetCause::BrownOut);
    motion.all_off();
    let report = motion.controller.report();
    assert_eq!((report.mode, report.cause, report.boot), (Mode::Fresh, StopCause::BrownOut, 2));
}

#[test]
fn an_ending_bumper_means_nothing_once_its_step_has_ended() {
    let mut motion = Motion::initialised();
    motion.accepts(Request::Step(step_ended_by(0b11_1111, 50)));
    motion.at(50);
    motion.inputs.bumpers = BumperMask::ALL;
    let report = motion.at(100).controller.report();
    assert_eq!((report.mode, report.motors), (Mode::Idle, 1 << 4));
}

#[test]
fn the_dead_man_watches_init_to_its_very_end() {
    // When the last arm has been stopped by its switch, INIT ends in the tick after.
    let mut motion = Motion::in_session();
    motion.accepts(Request::Configure(Parameter::DeadMan { timeout_ms: 10_000 }));
    motion.accepts(Request::Init);
    let mut at_rest_ms = 0;
    while motion.controller.report().motors != 0 {
        at_rest_ms += 1;
        motion.at(u64::from(at_rest_ms));
    }
    assert_eq!(motion.controller.mode(), Mode::Initialising);
    for (timeout_ms, mode) in [(at_rest_ms + 1, Mode::Held), (at_rest_ms + 2, Mode::Idle)] {
        let mut motion = Motion::in_session();
        motion.accepts(Request::Configure(Parameter::DeadMan { timeout_ms }));
        motion.accepts(Request::Init);
        assert_eq!(motion.at(u64::from(at_rest_ms) + 1).controller.mode(), mode);
    }
}

#[test]
fn a_reset_keeps_the_clock_and_forgets_what_was_configured() {
    let mut motion = Motion::in_session();
    motion.controller = motion.controller.with_clock_mhz(10);
    motion.accepts(Request::Configure(Parameter::DeadMan { timeout_ms: 900 }));
    motion.controller.reset(ResetCause::BrownOut);
    let report = motion.hello(SESSION);
    assert_eq!((report.clock_mhz, report.dead_man_ms, report.last_sequence), (10, 500, 0));
}

#[test]
fn a_hold_refuses_steps_alone() {
    let mut motion = Motion::initialised();
    motion.accepts(Request::Step(pause(2000)));
    assert_eq!(motion.at(500).controller.mode(), Mode::Held);
    motion.refuses(Request::Step(pause(10)), Status::Held);
    let report = motion.accepts(Request::Configure(Parameter::DeadMan { timeout_ms: 900 }));
    assert_eq!(report.mode, Mode::Held);
    assert_eq!(motion.hello(SESSION).dead_man_ms, 900);
}
