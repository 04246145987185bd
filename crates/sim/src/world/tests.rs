use proptest::prelude::*;

use super::*;

fn box_world() -> World {
    let mut description = World::empty().description().clone();
    description.walls.push(Wall {
        name: "wall".to_owned(),
        from_m: [1.0, -0.5],
        to_m: [1.0, 0.5],
        thickness_m: 0.1,
        height_m: 0.2,
        colour: [200, 200, 200],
    });
    World::new(description).expect("a valid world")
}

#[test]
fn built_in_worlds_are_valid_and_come_back_from_json() {
    for name in World::names() {
        let world = World::named(name).expect("a built-in world");
        assert_eq!(World::from_json(&world.to_json().expect("json")).expect(name), world);
    }
    for seed in 0..200 {
        let world = World::random(seed);
        assert_eq!(world, World::random(seed), "seed {seed}");
        assert!(!world.description().balls.is_empty(), "seed {seed}");
    }
    assert_ne!(World::random(1), World::random(2));
}

#[test]
fn errors_name_the_object_the_value_and_the_way_out() {
    let text = |description: WorldDescription| {
        World::new(description).expect_err("a bad world").to_string()
    };
    let demo = || World::demo().description().clone();

    let mut small = demo();
    small.balls[0].radius_m = f64::NAN;
    assert_eq!(text(small), "ball: the radius (m) is NaN, allowed are 0.002 to 1");

    let mut inside_out = demo();
    inside_out.cups[0].inner_radius_m = 0.5;
    assert_eq!(text(inside_out), "cup: the inner radius (m) is 0.5, allowed are 0.001 to 0.055");

    let mut twice = demo();
    twice.cups[0].name = "ball".to_owned();
    assert_eq!(text(twice), "the name \"ball\" is used twice, give each object its own");

    let mut crowd = demo();
    let ball = crowd.balls[0].clone();
    crowd.balls = (0..300).map(|index| Ball { name: index.to_string(), ..ball.clone() }).collect();
    assert_eq!(text(crowd), "the world has 306 objects, allowed are at most 256");

    let unknown = World::named("moon").expect_err("no such world").to_string();
    assert_eq!(unknown, "there is no built-in world \"moon\", choose one of demo, empty, wall");

    let json = World::from_json("{\"floor\": 3}").expect_err("no world").to_string();
    assert!(
        json.starts_with("the text is no world description: ") && json.contains("line 1"),
        "{json}"
    );

    let mut flat_lamp = demo();
    flat_lamp.light.towards_lamp = [1.0, 0.0, 0.0];
    assert!(World::new(flat_lamp).is_err());
}

#[test]
fn a_bumper_touches_a_wall_only_where_the_wall_is() {
    let world = box_world();
    let contact = world.first_contact([0.945, 0.0, 0.01], 0.01).expect("contact");
    assert_eq!(contact.object, "wall");
    assert!((contact.depth_m - 0.005).abs() < 1e-12, "{contact:?}");
    assert_eq!(world.first_contact([0.935, 0.0, 0.01], 0.01), None, "in front of it");
    assert_eq!(world.first_contact([1.0, 0.0, 0.215], 0.01), None, "above it");
    assert!(world.first_contact([1.0, 0.0, 0.205], 0.01).is_some(), "on its upper edge");
    // The corner is round for a sphere: 8 mm away on both axes is 11.3 mm away.
    assert_eq!(world.first_contact([0.942, 0.508, 0.01], 0.01), None);
    assert!(world.first_contact([0.942, 0.508, 0.01], 0.012).is_some());
}

#[test]
fn a_ray_measures_the_distance_to_the_wall_at_its_height() {
    let world = box_world();
    let hit = world.distance_along_ray([0.0, 0.0], 0.0, 0.1, 5.0).expect("a hit");
    assert!((hit.distance_m - 0.95).abs() < 1e-12);
    let slanted = world.distance_along_ray([0.0, 0.0], 0.3, 0.1, 5.0).expect("a hit");
    assert!((slanted.distance_m - 0.95 / 0.3_f64.cos()).abs() < 1e-12);
    assert_eq!(world.distance_along_ray([0.0, 0.0], 0.0, 0.1, 0.9), None, "out of range");
    assert_eq!(world.distance_along_ray([0.0, 0.0], 0.0, 0.3, 5.0), None, "over it");
    assert_eq!(world.distance_along_ray([0.0, 0.0], 3.0, 0.1, 5.0), None, "away from it");
    assert_eq!(
        world.distance_along_ray([1.0, 0.0], 0.0, 0.1, 5.0).map(|hit| hit.distance_m),
        Some(0.0),
        "inside it"
    );
}

#[test]
fn a_footprint_stops_at_the_wall_and_gets_away_again() {
    let world = box_world();
    let stopped = world.blocked_motion([0.5, 0.0], [1.5, 0.0], 0.1);
    assert_eq!(stopped.blocked_by, Some("wall"));
    assert!((stopped.position_m[0] - 0.85).abs() < 1e-5, "{stopped:?}");
    let pushed = world.blocked_motion(stopped.position_m, [1.5, 0.0], 0.1);
    assert!((pushed.position_m[0] - stopped.position_m[0]).abs() < 1e-9);
    let back = world.blocked_motion(pushed.position_m, [0.2, 0.0], 0.1);
    assert_eq!((back.position_m, back.blocked_by), ([0.2, 0.0], None));
    // Put inside the wall by hand it may leave, but not go deeper.
    assert_eq!(world.blocked_motion([0.9, 0.0], [0.8, 0.0], 0.1).blocked_by, None);
    let deeper = Motion { position_m: [0.9, 0.0], blocked_by: Some("wall") };
    assert_eq!(world.blocked_motion([0.9, 0.0], [0.92, 0.0], 0.1), deeper);
    // Past the end of the wall.
    assert_eq!(world.blocked_motion([0.5, 0.61], [1.5, 0.61], 0.1).blocked_by, None);
}

proptest! {
    #[test]
    fn motion_never_ends_inside_anything_and_stops_only_at_something(
        from_x in 0.0..0.4f64, from_y in -1.0..1.0f64, to_x in -1.0..3.0f64, to_y in -2.0..2.0f64,
        radius in 0.01..0.1f64, turn in -1.5..1.5f64,
    ) {
        let mut description = World::demo().description().clone();
        let (sin, cos) = turn.sin_cos();
        let (from_m, to_m) = ([-0.6 - 0.5 * cos, -0.5 * sin], [-0.6 + 0.5 * cos, 0.5 * sin]);
        description.walls[0] = Wall { from_m, to_m, ..description.walls[0].clone() };
        let world = World::new(description).expect("a valid world");
        let free = |[x, y]: [f64; 2], margin: f64| world.solids().iter().all(|solid| solid.distance_m([x, y]) >= radius + margin);
        prop_assume!(free([from_x, from_y], 0.0));
        let motion = world.blocked_motion([from_x, from_y], [to_x, to_y], radius);
        prop_assert!(free(motion.position_m, 0.0), "{motion:?} ends inside");
        if motion.blocked_by.is_some() {
            prop_assert!(!free(motion.position_m, 1e-4) , "{motion:?} stops at nothing");
        } else {
            // Slow and obvious: no place on the way is inside anything.
            for step in 0..=200 {
                let share = f64::from(step) / 200.0;
                let place = [from_x + share * (to_x - from_x), from_y + share * (to_y - from_y)];
                prop_assert!(free(place, -1e-9), "{motion:?} went through at {place:?}");
            }
        }
    }
}
