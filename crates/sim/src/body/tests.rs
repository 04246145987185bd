use super::*;

fn body_in(world: &World) -> Body {
    let config = BodyConfig { travel_deviation: 0.0, ..BodyConfig::default() };
    let mut body = Body::new(config, 1, world);
    for joint in Joint::ALL {
        body.move_joint(joint, 0.5);
    }
    body
}

fn pins(first: &[Joint], last: &[Joint]) -> MotorPins {
    let bits = |joints: &[Joint]| joints.iter().fold(0, |bits, joint| bits | 1 << joint.index());
    MotorPins { towards_first: bits(first), towards_last: bits(last) }
}

fn run(body: &mut Body, world: &World, pins: MotorPins, duration_ms: u32) {
    for _ in 0..duration_ms {
        body.step(pins, world);
    }
}

/// One cycle of the paper's walk: the free leg swings to one side, the loaded one to the other.
fn walk_cycle(body: &mut Body, world: &World, backward: bool) {
    use Joint::{LeftLeg, RightLeg, Tilt};
    let swing = |front: Joint, back: Joint, body: &mut Body| {
        let (front, back) = if backward { (back, front) } else { (front, back) };
        run(body, world, pins(&[front], &[back]), 600);
    };
    run(body, world, pins(&[Tilt], &[]), 500);
    swing(RightLeg, LeftLeg, body);
    run(body, world, pins(&[], &[Tilt]), 500);
    swing(LeftLeg, RightLeg, body);
}

#[test]
fn a_joint_takes_its_travel_time_and_stalls_at_the_end_stop() {
    let world = World::empty();
    for joint in Joint::ALL {
        let mut body = body_in(&world);
        body.move_joint(joint, 0.0);
        let travel_ms = u32::from(nominal_travel_ms(joint));
        run(&mut body, &world, pins(&[], &[joint]), travel_ms / 2);
        assert!((body.position(joint) - 0.5).abs() < 1e-3, "{joint}");
        assert_eq!(body.stalled(), 0);
        run(&mut body, &world, pins(&[], &[joint]), travel_ms / 2 + 2);
        assert!((body.position(joint) - 1.0).abs() < f64::EPSILON, "{joint}");
        assert_eq!(body.stalled(), 1 << joint.index());
        run(&mut body, &world, pins(&[joint], &[joint]), 10);
        assert!((body.position(joint) - 1.0).abs() < f64::EPSILON, "both pins brake");
    }
}

#[test]
fn seeded_bodies_differ_a_little_and_one_seed_is_one_body() {
    let world = World::empty();
    let travel = |seed| {
        let body = Body::new(BodyConfig::default(), seed, &world);
        Joint::ALL.map(|joint| body.travel_ms(joint).to_bits())
    };
    assert_eq!(travel(7), travel(7));
    assert_ne!(travel(7), travel(8));
    let body = Body::new(BodyConfig::default(), 7, &world);
    for joint in Joint::ALL {
        let ratio = body.travel_ms(joint) / f64::from(nominal_travel_ms(joint));
        assert!((0.97..=1.03).contains(&ratio), "{joint}: {ratio}");
    }
}

#[test]
fn a_sagging_motor_supply_slows_every_joint() {
    let world = World::empty();
    let mut body = body_in(&world);
    body.set_motor_supply_mv(NOMINAL_MOTOR_MV / 2);
    body.move_joint(Joint::LeftArm, 0.0);
    run(&mut body, &world, pins(&[], &[Joint::LeftArm]), 1000);
    assert!((body.position(Joint::LeftArm) - 0.5).abs() < 1e-3);
}

#[test]
fn batteries_drain_by_time_and_by_running_motors() {
    let world = World::empty();
    let mut body = body_in(&world);
    body.set_drain(Drain { controller_uv_per_s: 500_000, motor_uv_per_s: 100_000 });
    run(&mut body, &world, pins(&[Joint::LeftArm], &[Joint::RightArm]), 2000);
    assert_eq!(body.supply_mv(), FRESH_CONTROLLER_MV - 1000);
    assert_eq!(body.motor_supply_mv(), NOMINAL_MOTOR_MV - 400);
    run(&mut body, &world, MotorPins::default(), 60_000);
    assert_eq!((body.supply_mv(), body.motor_supply_mv()), (0, NOMINAL_MOTOR_MV - 400));
}

#[test]
fn mid_arm_switches_close_in_their_window_alone_unless_broken() {
    let world = World::empty();
    let mut body = body_in(&world);
    for (position, closed) in
        [(0.0, false), (0.46, false), (0.48, true), (0.52, true), (0.54, false)]
    {
        body.move_joint(Joint::LeftArm, position);
        body.move_joint(Joint::RightArm, 1.0);
        assert_eq!(body.middle_switches(), [closed, false], "at {position}");
    }
    body.set_switch(Joint::LeftArm, Contact::StuckClosed);
    body.set_switch(Joint::RightArm, Contact::StuckOpen);
    body.move_joint(Joint::RightArm, 0.5);
    assert_eq!(body.middle_switches(), [true, false]);
}

#[test]
fn bumpers_are_pressed_from_outside_and_break() {
    let world = World::empty();
    let mut body = body_in(&world);
    body.press_bumper(4, true);
    body.press_bumper(0, true);
    body.press_bumper(99, true);
    assert_eq!(body.bumpers().bits(), 0b01_0001);
    body.press_bumper(0, false);
    body.set_bumper(4, Contact::StuckOpen);
    body.set_bumper(5, Contact::StuckClosed);
    assert_eq!(body.bumpers().bits(), 0b10_0000);
}

#[test]
fn a_symmetric_gait_goes_straight_and_backward_takes_it_back() {
    let world = World::empty();
    let mut body = body_in(&world);
    walk_cycle(&mut body, &world, false);
    let (start, cycles) = (body.pose(), 5);
    for _ in 0..cycles {
        walk_cycle(&mut body, &world, false);
    }
    let pose = body.pose();
    let (forward, aside) = (pose.x_m - start.x_m, pose.y_m - start.y_m);
    let way = forward.hypot(aside);
    assert!((way - 2.0 * STRIDE_M * f64::from(cycles)).abs() < 0.01, "{way}");
    assert!((pose.heading_rad - start.heading_rad).abs() < 1e-6, "{pose:?}");
    for _ in 0..cycles {
        walk_cycle(&mut body, &world, true);
    }
    assert!((body.pose().x_m - start.x_m).hypot(body.pose().y_m - start.y_m) < 0.1);
}

#[test]
fn legs_against_each_other_turn_on_the_spot() {
    let world = World::empty();
    let mut body = body_in(&world);
    run(&mut body, &world, pins(&[Joint::LeftLeg], &[Joint::RightLeg]), 300);
    let pose = body.pose();
    assert!(pose.heading_rad > 0.1 && pose.x_m.hypot(pose.y_m) < 1e-9, "{pose:?}");
}

#[test]
fn a_free_leg_moves_nothing_but_itself() {
    let world = World::empty();
    let mut body = body_in(&world);
    body.move_joint(Joint::Tilt, 0.0);
    run(&mut body, &world, pins(&[Joint::RightLeg], &[]), 300);
    assert_eq!((body.pose().x_m, body.pose().heading_rad), (0.0, 0.0));
    assert!((body.pose().roll_rad + LEAN_MAX_RAD).abs() < 1e-12, "tilted left");
}

#[test]
fn a_wall_stops_the_robot_and_presses_front_bumpers() {
    let world = World::wall();
    let mut body = body_in(&world);
    let mut pressed = 0;
    for _ in 0..12 {
        walk_cycle(&mut body, &world, false);
        pressed |= body.bumpers().bits();
    }
    let pose = body.pose();
    assert!(pose.x_m > 0.3 && pose.x_m <= 0.5 - FOOTPRINT_RADIUS_M + 1e-6, "{pose:?}");
    assert!(pressed & 0b0101 != 0 && pressed & 0b1010 == 0, "{pressed:06b}");
    body.move_joint(Joint::LeftArm, 0.5);
    body.step(MotorPins::default(), &world);
    assert!(body.bumpers().contains(4), "the hand before it touches: {:?}", body.bumpers());
    body.put_at(0.0, 0.0, 0.0);
    body.step(MotorPins::default(), &world);
    assert!(body.bumpers().is_empty());
}

#[test]
fn walking_backward_into_a_wall_presses_back_bumpers() {
    let world = World::wall();
    let mut body = body_in(&world);
    body.put_at(0.3, 0.0, std::f64::consts::PI);
    let mut pressed = 0;
    for _ in 0..6 {
        walk_cycle(&mut body, &world, true);
        pressed |= body.bumpers().bits();
    }
    assert!(pressed & 0b1010 != 0 && pressed & 0b0101 == 0, "{pressed:06b}");
}

#[test]
fn a_stuck_joint_stalls_wherever_it_is() {
    let world = World::empty();
    let mut body = body_in(&world);
    body.stick_joint(Joint::Tilt, true);
    run(&mut body, &world, pins(&[], &[Joint::Tilt]), 100);
    assert!((body.position(Joint::Tilt) - 0.5).abs() < 1e-12);
    assert_eq!(body.stalled(), 1 << Joint::Tilt.index());
    body.stick_joint(Joint::Tilt, false);
    run(&mut body, &world, pins(&[], &[Joint::Tilt]), 1);
    assert_eq!(body.stalled(), 0);
}
