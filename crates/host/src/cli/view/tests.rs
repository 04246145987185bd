use rsapien_protocol::{AxisFlags, BumperMask, Mode};

use super::*;
use crate::Stamped;

fn hello() -> HelloReport {
    HelloReport {
        version: 1,
        firmware: [0, 1, 0],
        clock_mhz: 40,
        queue_length: 32,
        dead_man_ms: 500,
        last_sequence: 0,
        boot: 3,
        reception_errors: 0,
        cause: StopCause::PowerOn,
    }
}

fn state_of(mode: Mode, boot: u8, cause: StopCause) -> RobotState {
    let report = MotionReport {
        mode,
        bumpers: BumperMask::default(),
        middle_switches: [false; 2],
        presses: [0; BumperMask::COUNT],
        motors: 0,
        supply_low: false,
        pose_reached: Pose::EMPTY,
        queue_free: 32,
        steps_ended: 0,
        boot,
        reception_errors: 0,
        cause,
    };
    RobotState {
        motion: Some(Stamped { time_ms: 0, report }),
        motion_information: Some(hello()),
        ..RobotState::default()
    }
}

#[test]
fn the_start_of_both_controllers_is_told() {
    let mut state = state_of(Mode::Fresh, 3, StopCause::PowerOn);
    state.camera_information = Some(HelloReport { clock_mhz: 20, boot: 9, ..hello() });
    let report = CameraReport {
        mode: Mode::Fresh,
        pan_centideg: 0,
        tilt_centideg: 0,
        pan_target_centideg: 0,
        tilt_target_centideg: 0,
        axes: AxisFlags::default(),
        boot: 10,
        reception_errors: 0,
        cause: StopCause::Watchdog,
    };
    state.camera = Some(Stamped { time_ms: 0, report });
    let text = state_text("x", &state);
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(
        lines[1],
        "motion    firmware 0.1.0 at 40 MHz, dead-man 500 ms, boot 3, started by power-on"
    );
    // The report is newer than HELLO.
    assert_eq!(
        lines[2],
        "camera    firmware 0.1.0 at 20 MHz, dead-man 500 ms, boot 10, restarted by the watchdog: its program hung"
    );
    let json = super::state("x", &state);
    assert_eq!(json["motion_information"]["reset_cause"], "power-on");
    assert_eq!(json["camera_information"]["boot"], 10);
    assert_eq!(json["camera_information"]["reset_cause"], "watchdog");
}

#[test]
fn a_robot_without_a_camera_controller_says_so_once() {
    let text = state_text("x", &state_of(Mode::Idle, 3, StopCause::PowerOn));
    assert_eq!(text.matches("camera").count(), 1, "{text}");
    assert!(text.ends_with("head      no camera controller answers"), "{text}");
}

#[test]
fn resets_and_holds_are_told_in_words() {
    let told = |mode, cause| state_text("x", &state_of(mode, 4, cause));
    assert!(
        told(Mode::Fresh, StopCause::BrownOut)
            .contains("boot 4, restarted by a brown-out: its supply sagged")
    );
    let held = told(Mode::Held, StopCause::DeadMan);
    assert!(held.contains("held last by the dead-man"), "{held}");
    assert!(held.contains("mode      held (dead-man); rsapien init or rsapien stop releases it"));
    let released = told(Mode::Idle, StopCause::Bumper);
    assert!(released.contains("mode      idle\n") && released.contains("held last by a bumper"));
    let json = state("x", &state_of(Mode::Held, 4, StopCause::DeadMan));
    assert_eq!(json["motion_information"]["reset_cause"], Value::Null);
    assert_eq!(json["motion"]["cause"], "dead-man");
}
