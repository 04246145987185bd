//! Every action of a new registry does on the virtual body what its name promises.

use rsapien::link::virtual_robot::{Pace, SharedVirtualRobot, VirtualOptions};
use rsapien::protocol::{Joint, Position};
use rsapien::sim::world::World;
use rsapien::{Outcome, PlayOptions, Robot, RobotOptions};
use rsapien_registry::{CompileOptions, Registry};
use rsapien_sim::robot::RobotReading;
use std::f64::consts::PI;
use std::sync::PoisonError;

/// Bodies that differ in the travel times of their joints.
const SEEDS: [u64; 3] = [1, 2, 3];

/// How far from its nominal position a joint that stands there may be, as a fraction of travel: the
/// body's deviation from the travel times the firmware reckons with.
const POSITION_TOLERANCE: f64 = 0.1;

/// What the robot was before and after.
struct Played {
    name: String,
    seed: u64,
    before: RobotReading,
    after: RobotReading,
    /// Where the joints were when each step had ended, or a poll later.
    on_the_way: Vec<[f64; Joint::COUNT]>,
}

impl Played {
    /// Where a joint is at the end, 0 to 1.
    fn position(&self, joint: Joint) -> f64 {
        self.after.joints[usize::from(joint.index())].position
    }

    #[track_caller]
    fn ends_at(&self, places: &[(Joint, Position)]) {
        for &(joint, position) in places {
            let wanted = match position {
                Position::First => 0.0,
                Position::Middle => 0.5,
                Position::Last => 1.0,
            };
            let there = self.position(joint);
            assert!(
                (there - wanted).abs() <= POSITION_TOLERANCE,
                "{} (seed {}): {} ends at {there}, not {wanted}",
                self.name,
                self.seed,
                joint.name()
            );
        }
    }

    /// At the end of how many steps a joint was within a quarter of its travel of its first position,
    /// and of its last.
    fn times_at_ends(&self, joint: Joint) -> (usize, usize) {
        let places = || self.on_the_way.iter().map(|joints| joints[usize::from(joint.index())]);
        (places().filter(|at| *at < 0.25).count(), places().filter(|at| *at > 0.75).count())
    }

    #[track_caller]
    fn ends_in_a_stable_stand(&self) {
        self.ends_at(&[
            (Joint::Tilt, Position::Middle),
            (Joint::RightLeg, Position::Middle),
            (Joint::LeftLeg, Position::Middle),
        ]);
    }

    /// Metres forward and to the left, and radians to the left, of where and how it stood.
    fn way(&self) -> (f64, f64, f64) {
        let (from, to) = (self.before.pose, self.after.pose);
        let (east_m, north_m) = (to.x_m - from.x_m, to.y_m - from.y_m);
        let (sin, cos) = from.heading_rad.sin_cos();
        let turned_rad = (to.heading_rad - from.heading_rad + PI).rem_euclid(2.0 * PI) - PI;
        (east_m * cos + north_m * sin, north_m * cos - east_m * sin, turned_rad)
    }
}

/// Plays `names` one after the other on a fresh robot, and tells about the last.
fn play(names: &[&str], seed: u64) -> Played {
    let registry = Registry::open_in_memory().unwrap();
    let mut options = RobotOptions::new("seed-actions");
    options.virtual_robot = VirtualOptions { pace: Pace::Fast, ..VirtualOptions::default() };
    options.virtual_robot.config.seed = seed;
    options.virtual_robot.config.world = World::empty();
    let shared: SharedVirtualRobot = options.virtual_robot.build().unwrap();
    let robot = Robot::virtual_with(shared.clone(), Pace::Fast, options).unwrap();
    let reading = || shared.lock().unwrap_or_else(PoisonError::into_inner).reading();
    let mut motion = robot.motion().unwrap();
    motion.init().unwrap();
    let mut before = reading();
    let mut on_the_way = Vec::new();
    for name in names {
        before = reading();
        on_the_way.clear();
        let action = registry.compile(name, &CompileOptions::default()).unwrap();
        // Not waiting for rest: the action itself has to last until every joint has arrived.
        let mut options = PlayOptions {
            wait_for_rest: false,
            on_progress: Some(Box::new(|progress| {
                if progress.steps_ended > 0 {
                    let robot = shared.lock().unwrap_or_else(PoisonError::into_inner);
                    on_the_way.push(robot.joints());
                }
            })),
            ..PlayOptions::default()
        };
        let report = motion.play(&action.steps, &mut options).unwrap();
        drop(options);
        assert_eq!(report.outcome, Outcome::Done, "{name} (seed {seed}): {report}");
        assert_eq!(report.pauses, 0, "{name} (seed {seed}): the queue ran dry");
        let evidence = report.evidence.unwrap();
        assert_eq!(evidence.motors, 0, "{name} (seed {seed}): joints still travel at the end");
        let late_ms = report.elapsed_ms.saturating_sub(action.duration_ms);
        assert!(late_ms <= 100, "{name} (seed {seed}): told {late_ms} ms after its end");
    }
    let name = (*names.last().unwrap()).to_owned();
    Played { name, seed, before, after: reading(), on_the_way }
}

#[test]
fn every_seeded_action_is_done_and_leaves_no_joint_travelling() {
    let names: Vec<String> = Registry::open_in_memory()
        .unwrap()
        .list()
        .unwrap()
        .into_iter()
        .map(|summary| summary.name)
        .collect();
    assert!(names.len() >= 14, "{names:?}");
    for seed in SEEDS {
        for name in &names {
            let played = play(&[name], seed);
            assert!(played.after.joints.iter().all(|joint| joint.motor == "off"), "{name}");
        }
        // And in a row, each from where the one before left the robot.
        let all: Vec<&str> = names.iter().map(String::as_str).collect();
        play(&all, seed);
    }
}

#[test]
fn walking_goes_straight_forward_and_backward() {
    for seed in SEEDS {
        for (name, sense) in [("walk-forward", 1.0), ("walk-backward", -1.0)] {
            let played = play(&[name], seed);
            let (forward_m, left_m, turned_rad) = played.way();
            println!("{name} (seed {seed}): {forward_m:.4} m, {left_m:.4} m, {turned_rad:.4} rad");
            assert!(sense * forward_m > 0.05, "{name} (seed {seed}): {forward_m} m forward");
            assert!(left_m.abs() < 0.1 * forward_m.abs(), "{name} (seed {seed}): {left_m} m left");
            assert!(turned_rad.abs() < 0.1, "{name} (seed {seed}): turns by {turned_rad} rad");
            played.ends_in_a_stable_stand();
        }
    }
}

#[test]
fn turning_left_and_right_turn_by_as_much() {
    for seed in SEEDS {
        let [left, right] = ["turn-left", "turn-right"].map(|name| play(&[name], seed));
        let (left_rad, right_rad) = (left.way().2, right.way().2);
        println!("seed {seed}: {left_rad:.4} rad to the left, {right_rad:.4} rad to the right");
        assert!(left_rad > 0.1 && right_rad < -0.1, "seed {seed}: {left_rad}, {right_rad}");
        let mean = (left_rad - right_rad) / 2.0;
        assert!((left_rad + right_rad).abs() < 0.1 * mean, "seed {seed}: {left_rad}, {right_rad}");
        left.ends_in_a_stable_stand();
        right.ends_in_a_stable_stand();
    }
}

#[test]
fn standing_ends_upright_whatever_came_before() {
    use Position::{Last, Middle};
    for seed in SEEDS {
        for before in ["dance", "stride-forward", "throw", "pick-up", "grip-left"] {
            let played = play(&[before, "stand"], seed);
            played.ends_in_a_stable_stand();
            played.ends_at(&[
                (Joint::RightArm, Last),
                (Joint::LeftArm, Last),
                (Joint::RightHand, Middle),
                (Joint::LeftHand, Middle),
            ]);
        }
    }
}

#[test]
fn hands_grip_and_release() {
    for seed in SEEDS {
        for (joint, grip, release) in [
            (Joint::RightHand, "grip-right", "release-right"),
            (Joint::LeftHand, "grip-left", "release-left"),
        ] {
            play(&[release, grip], seed).ends_at(&[(joint, Position::First)]);
            play(&[grip, release], seed).ends_at(&[(joint, Position::Last)]);
        }
    }
}

#[test]
fn gestures_end_in_a_stable_stand_where_they_began() {
    for seed in SEEDS {
        for name in ["wave", "bow", "pick-up", "throw", "dance"] {
            let played = play(&[name], seed);
            played.ends_in_a_stable_stand();
            let (forward_m, left_m, turned_rad) = played.way();
            println!("{name} (seed {seed}): {forward_m:.4} m, {left_m:.4} m, {turned_rad:.4} rad");
            assert!(forward_m.hypot(left_m) < 0.01, "{name} (seed {seed}): it walked away");
            assert!(turned_rad.abs() < 0.05, "{name} (seed {seed}): it turned");
        }
        // The arm goes up three times, and comes down to the front in between.
        assert_eq!(play(&["wave"], seed).times_at_ends(Joint::RightArm), (3, 1), "seed {seed}");
        let bow = play(&["bow"], seed);
        assert_eq!(bow.times_at_ends(Joint::RightLeg), (0, 2), "seed {seed}");
        assert_eq!(bow.times_at_ends(Joint::LeftLeg), (0, 2), "seed {seed}");
        assert_eq!(play(&["dance"], seed).times_at_ends(Joint::Tilt), (3, 3), "seed {seed}");
        // What was picked up is held, in front.
        let held = play(&["pick-up"], seed);
        held.ends_at(&[(Joint::RightHand, Position::First), (Joint::RightArm, Position::Middle)]);
        // It is held while the arm goes up, and leaves the hand on the way down.
        let throw = play(&["pick-up", "throw"], seed);
        assert_eq!(throw.times_at_ends(Joint::RightHand), (2, 1), "seed {seed}");
        assert_eq!(throw.times_at_ends(Joint::RightArm), (2, 1), "seed {seed}");
    }
}

#[test]
fn the_page_of_actions_shows_the_library() {
    let page = std::fs::read_to_string(rsapien_tests::workspace().join("docs/actions.md")).unwrap();
    let [begin, end] = rsapien_tests::library::MARKS;
    let (_, rest) = page.split_once(begin).unwrap();
    let (shown, _) = rest.split_once(end).unwrap();
    let is_same = shown == rsapien_tests::library::library();
    assert!(is_same, "cargo run -p rsapien-tests --example library-page writes it anew");
    let (name, path) = rsapien_tests::library::PICTURE;
    let picture = std::fs::read_to_string(rsapien_tests::workspace().join(path)).unwrap();
    assert_eq!(picture, rsapien_tests::library::picture(name));
}

#[test]
fn pivots_turn_on_the_spot_and_backing_off_goes_back() {
    for seed in SEEDS {
        let [left, right] = ["pivot-left", "pivot-right"].map(|name| play(&[name], seed));
        for (played, sense) in [(&left, 1.0), (&right, -1.0)] {
            let (forward_m, left_m, turned_rad) = played.way();
            println!("{} (seed {seed}): {turned_rad:.4} rad, {forward_m:.4} m", played.name);
            assert!(sense * turned_rad > 0.1, "{} (seed {seed}): {turned_rad} rad", played.name);
            assert!(
                forward_m.hypot(left_m) < 0.02,
                "{} (seed {seed}): it walked away",
                played.name
            );
            played.ends_in_a_stable_stand();
        }
        let back = play(&["back-off"], seed);
        assert!(back.way().0 < -0.05, "seed {seed}: {:?}", back.way());
        assert!(play(&["explore"], seed).way().0 > 0.3, "seed {seed}");
    }
}

#[test]
fn shows_and_greetings_stay_where_they_are_and_end_standing() {
    let names = [
        "ready",
        "stretch",
        "lean-left",
        "lean-right",
        "march",
        "wave-left",
        "wave-both",
        "sway",
        "salute",
        "hug",
        "cheer",
        "clap",
        "drum",
        "swim",
        "conduct",
        "shrug",
        "point-right",
        "point-left",
    ];
    for seed in SEEDS {
        for name in names {
            let played = play(&[name], seed);
            played.ends_in_a_stable_stand();
            let (forward_m, left_m, turned_rad) = played.way();
            assert!(forward_m.hypot(left_m) < 0.02, "{name} (seed {seed}): it walked away");
            assert!(turned_rad.abs() < 0.05, "{name} (seed {seed}): it turned");
        }
        let raised = |name: &str, joint| play(&[name], seed).times_at_ends(joint).0;
        assert_eq!(raised("wave-left", Joint::LeftArm), 3, "seed {seed}");
        assert_eq!(raised("wave-both", Joint::LeftArm), raised("wave-both", Joint::RightArm));
        assert_eq!(raised("cheer", Joint::LeftArm), 2, "seed {seed}");
    }
}

/// What the checker reckons with and cannot import.
#[test]
fn the_checker_reckons_with_the_virtual_body() {
    use rsapien_registry::check::{BATTERY_MOTOR_S, FREE_TILT};
    use rsapien_sim::body::{Drain, FREE_TILT as OF_THE_BODY};
    assert!((FREE_TILT - OF_THE_BODY).abs() < f64::EPSILON);
    let drop_uv = BATTERY_MOTOR_S * u64::from(Drain::default().motor_uv_per_s);
    assert_eq!(drop_uv, 1_500_000, "docs/rules.md says 1.5 V");
}
