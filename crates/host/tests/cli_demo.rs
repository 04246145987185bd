//! The demonstration on the virtual robot's own clock.
#![cfg(feature = "cli")]

mod support;

use support::{User, is_png};

#[test]
fn the_ball_is_found_and_centred_and_everything_is_told() {
    let user = User::new();
    let text = user.expect(0, &["demo", "--fast"]).stdout;
    for words in [
        "initialised",
        "walked",
        "looked",
        "ball",
        "truth",
        "packages",
        "The ball is found and centred.",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
    assert!(text.lines().count() <= 24, "one screen:\n{text}");
    assert!(is_png(&user.path("rsapien-demo/ball.png")));
    let log = std::fs::read_to_string(user.path("rsapien-demo/packages.txt")).unwrap();
    for words in ["-> motion INIT", "-> motion STEP", "<- camera AIM", "accepted"] {
        assert!(log.contains(words), "{words}");
    }
}

#[test]
fn a_seed_gives_the_same_run_and_every_seed_finds_the_ball() {
    let user = User::new();
    let run = |seed: &str| {
        let mut answer =
            user.expect(0, &["demo", "--fast", "--json", "--seed", seed, "--out", "out"]).json();
        for time in ["wall_ms", "detection_ms"] {
            answer.as_object_mut().unwrap().remove(time);
        }
        answer
    };
    assert_eq!(run("3"), run("3"));
    for seed in ["1", "2", "4", "5"] {
        let answer = run(seed);
        let (offset, deviation) = (&answer["ball"]["offset_px"], &answer["deviation"]["center_px"]);
        assert!(offset.as_f64().unwrap() <= 3.0, "seed {seed}: {answer}");
        assert!(deviation.as_f64().unwrap() <= 4.0, "seed {seed}: {answer}");
    }
}

#[test]
fn without_a_ball_it_says_so() {
    let user = User::new();
    let run = user.expect(1, &["demo", "--fast", "--world", "empty", "--walks", "0"]);
    assert!(run.stdout.contains("No ball was found."), "{}", run.stdout);
}
