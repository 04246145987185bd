//! INIT, steps, the queue, joints and arms.

mod common;

use common::{Body, Motion, Switch, pause, step};
use rsapien_firmware_model::{Controller, MotorOutput, QUEUE_LENGTH};
use rsapien_protocol::{Joint, Mode, Parameter, Pose, Position, Request, Status, Step};

const TILT_LEFT: Step = Step::new(Pose::EMPTY.with(Joint::Tilt, Some(Position::First)), 1000);

fn replacing(step: Step) -> Step {
    Step { replace: true, ..step }
}

// INIT

#[test]
fn init_brings_every_joint_to_its_middle_from_wherever_it_is() {
    for start in 0..=10 {
        for speed_permille in [950, 1000, 1050] {
            let mut motion = Motion::in_session();
            motion.body.speed_permille = [speed_permille; 7];
            for joint in 0..7 {
                motion.body.position_us[joint] = Body::travel_us(joint) * start / 10;
            }
            motion.accepts(Request::Init);
            motion.finish_initialising();
            let report = motion.controller.report();
            assert_eq!((report.mode, report.pose_reached), (Mode::Idle, Pose::MIDDLE));
            motion.all_off();
            for joint in 0..7 {
                // Speed off by 5 % is 2.5 % on half the way; the window of the arms is 3.2 %.
                assert!(motion.body.off_middle_permille(joint) <= 33, "joint {joint}");
            }
        }
    }
}

#[test]
fn init_takes_as_long_as_the_slowest_joint() {
    let mut motion = Motion::in_session();
    motion.body.switch = Switch::StuckClosed;
    let report = motion.accepts(Request::Init);
    assert_eq!((report.mode, report.motors), (Mode::Initialising, 0x7F));
    assert_eq!(motion.controller.motors(), [MotorOutput::TowardsFirst; 7]);
    // Arms: 1000 and 125 to the end stop, 1 of dead time, 500 to the middle.
    for ms in (0..=1600).step_by(400) {
        motion.at(ms).sends(Request::State);
    }
    assert_eq!(motion.at(1625).controller.mode(), Mode::Initialising);
    assert_eq!(motion.at(1626).controller.mode(), Mode::Idle);
}

#[test]
fn an_arm_whose_switch_never_closes_searches_and_does_not_claim_the_middle() {
    let mut motion = Motion::in_session();
    motion.body.switch = Switch::StuckOpen;
    motion.accepts(Request::Init);
    motion.finish_initialising();
    let report = motion.controller.report();
    assert_eq!(report.mode, Mode::Idle);
    let arms_out = Pose::MIDDLE.with(Joint::RightArm, None).with(Joint::LeftArm, None);
    assert_eq!(report.pose_reached, arms_out);
    // T / 8 on and T / 4 back.
    assert_eq!(motion.controller.joint_position_ms(Joint::LeftArm), 375);
    assert_eq!(motion.body.position_us[1], 375_000);
}

#[test]
fn an_arm_whose_switch_is_stuck_closed_stops_at_its_reckoned_middle() {
    let mut motion = Motion::in_session();
    motion.body.switch = Switch::StuckClosed;
    motion.accepts(Request::Init);
    motion.finish_initialising();
    assert_eq!(motion.controller.report().pose_reached, Pose::MIDDLE);
    assert_eq!(motion.body.off_middle_permille(0), 0);
}

#[test]
fn steps_queued_during_init_start_when_it_has_ended() {
    let mut motion = Motion::in_session();
    motion.body.switch = Switch::StuckClosed;
    motion.accepts(Request::Init);
    motion.accepts(Request::Step(pause(100)));
    let report = motion.accepts(Request::Step(TILT_LEFT));
    assert_eq!((report.mode, report.queue_free), (Mode::Initialising, 30));
    for ms in (0..=1600).step_by(400) {
        motion.at(ms).sends(Request::State);
    }
    assert_eq!(motion.at(1625).controller.mode(), Mode::Initialising);
    assert_eq!(motion.at(1626).controller.mode(), Mode::Executing);
    assert_eq!(motion.at(1725).motor(Joint::Tilt), MotorOutput::Off);
    assert_eq!(motion.at(1726).motor(Joint::Tilt), MotorOutput::TowardsFirst);
    assert_eq!(motion.controller.report().steps_ended, 1);
}

#[test]
fn a_replacing_step_during_init_replaces_what_waits() {
    let mut motion = Motion::in_session();
    motion.accepts(Request::Init);
    motion.accepts(Request::Step(pause(100)));
    let report = motion.accepts(Request::Step(replacing(TILT_LEFT)));
    assert_eq!((report.mode, report.queue_free), (Mode::Initialising, 31));
}

#[test]
fn init_begins_anew_empties_the_queue_and_counts_steps_from_0() {
    let mut motion = Motion::initialised();
    motion.accepts(Request::Step(pause(10)));
    motion.accepts(Request::Step(pause(1000)));
    motion.accepts(Request::Step(pause(1000)));
    assert_eq!(motion.at(20).accepts(Request::State).steps_ended, 1);
    let report = motion.accepts(Request::Init);
    assert_eq!((report.mode, report.queue_free, report.steps_ended), (Mode::Initialising, 32, 0));
    motion.at(300).accepts(Request::Init);
    motion.finish_initialising();
    assert_eq!(motion.controller.report().mode, Mode::Idle);
    assert_eq!(motion.controller.report().pose_reached, Pose::MIDDLE);
}

#[test]
fn an_init_that_was_stopped_has_not_initialised() {
    let mut motion = Motion::initialised();
    motion.accepts(Request::Init);
    motion.at(100).accepts(Request::Stop);
    motion.all_off();
    assert_eq!(motion.controller.report().pose_reached, Pose::EMPTY);
    motion.refuses(Request::Step(TILT_LEFT), Status::NotInitialised);
}

#[test]
fn stop_of_a_fresh_robot_leads_to_stopped_and_a_step_still_needs_init() {
    let mut motion = Motion::in_session();
    assert_eq!(motion.accepts(Request::Stop).mode, Mode::Stopped);
    motion.refuses(Request::Step(TILT_LEFT), Status::NotInitialised);
}

// Steps and the queue

#[test]
fn a_step_to_an_idle_robot_switches_its_motors_in_the_same_pass() {
    let mut motion = Motion::initialised();
    let report = motion.accepts(Request::Step(TILT_LEFT));
    assert_eq!(motion.motor(Joint::Tilt), MotorOutput::TowardsFirst);
    assert_eq!((report.mode, report.motors, report.queue_free), (Mode::Executing, 1 << 4, 32));
    assert_eq!(report.pose_reached.get(Joint::Tilt), None);
}

#[test]
fn steps_follow_each_other_without_a_gap() {
    let mut motion = Motion::initialised();
    motion.accepts(Request::Step(step(Joint::RightLeg, Position::First, 100)));
    motion.accepts(Request::Step(step(Joint::LeftLeg, Position::Last, 1)));
    motion.accepts(Request::Step(step(Joint::Tilt, Position::Last, 50)));
    assert_eq!(motion.at(99).motor(Joint::LeftLeg), MotorOutput::Off);
    assert_eq!(motion.at(100).motor(Joint::LeftLeg), MotorOutput::TowardsLast);
    assert_eq!(motion.motor(Joint::Tilt), MotorOutput::Off);
    assert_eq!(motion.at(101).motor(Joint::Tilt), MotorOutput::TowardsLast);
    // Joints that the later steps do not name go on.
    assert_eq!(motion.motor(Joint::RightLeg), MotorOutput::TowardsFirst);
    assert_eq!(motion.at(150).controller.report().mode, Mode::Executing);
    let report = motion.at(151).controller.report();
    assert_eq!((report.mode, report.steps_ended), (Mode::Idle, 3));
    // Idle, and yet the joints arrive: 300 ms of way and 75 of overrun, begun at 0, 100 and 101.
    assert_eq!(report.motors, 0b111_0000);
    assert_eq!(motion.at(374).motor(Joint::RightLeg), MotorOutput::TowardsFirst);
    assert_eq!(motion.at(375).motor(Joint::RightLeg), MotorOutput::Off);
    assert_eq!(motion.at(475).motor(Joint::LeftLeg), MotorOutput::Off);
    let pose = motion.controller.report().pose_reached;
    assert_eq!(pose.get(Joint::RightLeg), Some(Position::First));
    assert_eq!(pose.get(Joint::LeftLeg), Some(Position::Last));
    assert_eq!(pose.get(Joint::Tilt), Some(Position::Last));
    assert_eq!((motion.body.position_us[5], motion.body.position_us[6]), (0, 600_000));
}

#[test]
fn a_joint_where_it_is_sent_stays_there() {
    let mut motion = Motion::initialised();
    let middle = Step::new(Pose::MIDDLE, 100);
    let report = motion.accepts(Request::Step(middle));
    assert_eq!((report.motors, report.pose_reached), (0, Pose::MIDDLE));
    motion.all_off();
    assert_eq!(motion.at(100).controller.report().steps_ended, 1);
}

#[test]
fn a_joint_sent_again_where_it_goes_just_goes_on() {
    let mut motion = Motion::initialised();
    motion.accepts(Request::Step(step(Joint::Tilt, Position::First, 300)));
    motion.accepts(Request::Step(step(Joint::Tilt, Position::First, 300)));
    // 250 of way and 62 of overrun; the second step begins during the overrun.
    assert_eq!(motion.at(311).motor(Joint::Tilt), MotorOutput::TowardsFirst);
    assert_eq!(motion.at(312).motor(Joint::Tilt), MotorOutput::Off);
}

#[test]
fn both_outputs_are_off_for_a_tick_when_the_sense_turns() {
    let mut motion = Motion::initialised();
    motion.accepts(Request::Step(step(Joint::Tilt, Position::First, 100)));
    motion.accepts(Request::Step(step(Joint::Tilt, Position::Last, 100)));
    assert_eq!(motion.at(99).motor(Joint::Tilt), MotorOutput::TowardsFirst);
    assert_eq!(motion.at(100).motor(Joint::Tilt), MotorOutput::Off);
    assert_eq!(motion.controller.report().motors, 1 << 4);
    assert_eq!(motion.at(101).motor(Joint::Tilt), MotorOutput::TowardsLast);
    assert_eq!(motion.at(111).controller.joint_position_ms(Joint::Tilt), 160);
    assert_eq!(motion.body.position_us[4], 160_000);
}

#[test]
fn the_queue_takes_32_steps_behind_the_running_one() {
    let mut motion = Motion::initialised();
    for free in (0..=QUEUE_LENGTH).rev() {
        assert_eq!(motion.accepts(Request::Step(pause(2))).queue_free, free);
    }
    let report = motion.refuses(Request::Step(pause(2)), Status::QueueFull);
    assert_eq!(report.queue_free, 0);
    let report = motion.at(2).accepts(Request::Step(pause(2)));
    assert_eq!((report.queue_free, report.steps_ended), (0, 1));
    assert_eq!(motion.at(67).controller.mode(), Mode::Executing);
    let report = motion.at(68).controller.report();
    assert_eq!((report.mode, report.steps_ended, report.queue_free), (Mode::Idle, 34, 32));
}

#[test]
fn steps_run_in_the_order_in_which_they_came() {
    let mut motion = Motion::initialised();
    let mut now_ms = 0;
    let mut ends_ms = vec![0];
    for number in 1..=100u16 {
        while motion.controller.report().queue_free == 0 {
            now_ms += 1;
            motion.at(now_ms);
        }
        motion.accepts(Request::Step(pause(number)));
        ends_ms.push(ends_ms[ends_ms.len() - 1] + u64::from(number));
        let ended = ends_ms.iter().filter(|end_ms| **end_ms <= now_ms).count() - 1;
        assert_eq!(usize::from(motion.controller.report().steps_ended), ended);
    }
}

#[test]
fn a_replacing_step_pre_empts_even_a_full_queue() {
    let mut motion = Motion::initialised();
    motion.accepts(Request::Step(step(Joint::RightLeg, Position::First, 1000)));
    for _ in 0..QUEUE_LENGTH {
        motion.accepts(Request::Step(pause(1000)));
    }
    let report =
        motion.at(50).accepts(Request::Step(replacing(step(Joint::LeftLeg, Position::Last, 100))));
    assert_eq!((report.mode, report.queue_free, report.steps_ended), (Mode::Executing, 32, 0));
    // Both legs travel: the new step does not name the right one.
    assert_eq!(report.motors, 0b110_0000);
    assert_eq!(motion.at(149).controller.mode(), Mode::Executing);
    let report = motion.at(150).controller.report();
    assert_eq!((report.mode, report.steps_ended), (Mode::Idle, 1));
}

#[test]
fn stop_empties_the_queue_and_a_step_may_follow_at_once() {
    let mut motion = Motion::initialised();
    motion.accepts(Request::Step(TILT_LEFT));
    motion.accepts(Request::Step(pause(1000)));
    let report = motion.at(100).accepts(Request::Stop);
    assert_eq!((report.mode, report.motors, report.queue_free), (Mode::Stopped, 0, 32));
    motion.all_off();
    assert_eq!(motion.controller.joint_position_ms(Joint::Tilt), 150);
    let report = motion.accepts(Request::Step(step(Joint::Tilt, Position::Middle, 200)));
    assert_eq!(report.mode, Mode::Executing);
    motion.all_off();
    // A tick of dead time, since the sense turns though the motor was off for a moment.
    assert_eq!(motion.at(200).motor(Joint::Tilt), MotorOutput::TowardsLast);
    assert_eq!(motion.at(201).motor(Joint::Tilt), MotorOutput::Off);
    assert_eq!(motion.body.off_middle_permille(4), 0);
}

// Joints and arms

#[test]
fn end_stops_make_a_position_true_again() {
    let mut motion = Motion::initialised();
    motion.body.speed_permille[5] = 900;
    motion.accepts(Request::Step(step(Joint::RightLeg, Position::Last, 600)));
    motion.at(400);
    assert_eq!(motion.body.position_us[5], 600_000, "the overrun makes up for a slow motor");
    assert_eq!(motion.controller.joint_position_ms(Joint::RightLeg), 600);
}

#[test]
fn a_mid_arm_switch_corrects_an_arm_that_passes_it() {
    let mut motion = Motion::initialised();
    motion.accepts(Request::Step(step(Joint::LeftArm, Position::First, 700)));
    for ms in (0..=800).step_by(200) {
        motion.at(ms).accepts(Request::State);
    }
    motion.body.speed_permille[1] = 800;
    motion.accepts(Request::Step(step(Joint::LeftArm, Position::Last, 3000)));
    // The window truly begins at 469 ms of way, which takes 586 ms at this speed.
    motion.at(1200).accepts(Request::State);
    motion.at(800 + 585).accepts(Request::State);
    assert_eq!(motion.controller.joint_position_ms(Joint::LeftArm), 585);
    motion.wait(3);
    let reckoned = motion.controller.joint_position_ms(Joint::LeftArm);
    assert!((469..=472).contains(&reckoned), "{reckoned}");
    for ms in (1400..=2400).step_by(200) {
        motion.at(ms).accepts(Request::State);
    }
    assert_eq!(motion.body.position_us[1], 1_000_000);
}

#[test]
fn an_arm_finds_its_middle_though_it_is_reckoned_on_the_wrong_side() {
    let mut motion = Motion::initialised();
    motion.accepts(Request::Step(step(Joint::RightArm, Position::First, 60)));
    motion.at(60).accepts(Request::Stop);
    // Something pushed the arm through its middle while it rested.
    motion.body.position_us[0] += 150_000;
    motion.accepts(Request::Step(step(Joint::RightArm, Position::Middle, 1000)));
    motion.at(460).accepts(Request::State);
    motion.at(860).accepts(Request::State);
    let report = motion.controller.report();
    assert_eq!(report.pose_reached.get(Joint::RightArm), Some(Position::Middle));
    assert!(motion.body.off_middle_permille(0) <= 32);
}

#[test]
fn a_new_travel_time_keeps_the_place_and_serves_the_next_movement() {
    let mut motion = Motion::initialised();
    let travel = Parameter::TravelTime { joint: Joint::Tilt, full_travel_ms: 1000 };
    motion.accepts(Request::Step(step(Joint::Tilt, Position::First, 100)));
    motion.at(50).accepts(Request::Configure(travel));
    assert_eq!(motion.controller.joint_position_ms(Joint::Tilt), 400);
    assert_eq!(motion.at(311).motor(Joint::Tilt), MotorOutput::TowardsFirst);
    assert_eq!(motion.at(312).motor(Joint::Tilt), MotorOutput::Off);
    motion.accepts(Request::Step(step(Joint::Tilt, Position::Middle, 100)));
    assert_eq!(motion.at(811).motor(Joint::Tilt), MotorOutput::TowardsLast);
    assert_eq!(motion.at(812).motor(Joint::Tilt), MotorOutput::Off);
}

#[test]
fn a_movement_under_way_ends_at_its_place_of_the_new_travel_time() {
    let travel = Parameter::TravelTime { joint: Joint::RightLeg, full_travel_ms: 2000 };
    for (first, then, expected_ms) in
        [(Position::First, Position::Last, 2000), (Position::First, Position::Middle, 1000)]
    {
        let mut motion = Motion::initialised();
        motion.accepts(Request::Step(step(Joint::RightLeg, first, 400)));
        motion.at(400).accepts(Request::Step(step(Joint::RightLeg, then, 1000)));
        motion.at(450).accepts(Request::Configure(travel));
        motion.at(900).accepts(Request::State);
        let arrived = motion.at(1100).controller.report().pose_reached.get(Joint::RightLeg);
        assert_eq!(arrived, Some(then));
        assert_eq!(motion.controller.joint_position_ms(Joint::RightLeg), expected_ms);
    }
}

#[test]
fn an_arm_that_stands_in_its_middle_is_not_moved_to_it() {
    let mut motion = Motion::initialised();
    motion.accepts(Request::Step(step(Joint::LeftArm, Position::Last, 100)));
    motion.at(20).accepts(Request::Stop);
    assert_eq!(motion.controller.report().pose_reached.get(Joint::LeftArm), None);
    let report = motion.accepts(Request::Step(step(Joint::LeftArm, Position::Middle, 100)));
    assert_eq!(report.pose_reached.get(Joint::LeftArm), Some(Position::Middle));
    assert_eq!(report.motors, 0);
}

#[test]
fn a_switch_that_changes_far_from_the_middle_is_not_believed() {
    let mut motion = Motion::initialised();
    motion.accepts(Request::Step(step(Joint::LeftArm, Position::First, 1000)));
    motion.at(400).accepts(Request::State);
    motion.at(800).accepts(Request::State);
    motion.accepts(Request::Step(Step {
        replace: true,
        ..step(Joint::LeftArm, Position::Middle, 1000)
    }));
    motion.at(1000);
    motion.body.switch = Switch::StuckClosed;
    motion.at(1100);
    assert_eq!(motion.controller.joint_position_ms(Joint::LeftArm), 300);
    // It opens again near enough to be believed, but only a closing switch is the middle.
    motion.body.switch = Switch::Works;
    motion.at(1110);
    assert_eq!(motion.motor(Joint::LeftArm), MotorOutput::TowardsLast);
    assert_eq!(motion.controller.joint_position_ms(Joint::LeftArm), 310);
}

#[test]
fn init_drives_an_arm_past_its_switch_to_the_end_stop() {
    let mut motion = Motion::initialised();
    motion.accepts(Request::Step(step(Joint::LeftArm, Position::Last, 100)));
    motion.at(400).accepts(Request::State);
    motion.at(800).accepts(Request::State);
    assert_eq!(motion.body.position_us[1], 1_000_000);
    motion.accepts(Request::Init);
    motion.at(1200).accepts(Request::State);
    motion.at(1600).accepts(Request::State);
    assert_eq!(motion.at(1800).body.position_us[1], 0);
}
