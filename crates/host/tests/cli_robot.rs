//! Moving and watching the virtual robot.
#![cfg(feature = "cli")]

mod support;

use std::io::{BufRead, BufReader};

use support::{Run, User};

#[test]
fn steps_that_cannot_be_are_refused_before_anything_moves() {
    let user = User::new();
    for (step, parts) in [
        ("right-arm-up+right-arm-down", ["right-arm-up", "right-arm-down"]),
        ("13+15:200", ["tilt-left", "tilt-right"]),
        ("right-arm-upp:100", ["right-arm-upp", "did you mean"]),
        ("tilt-left:0", ["0 ms", "1 to 65535"]),
        ("22:100", ["22", "no motion primitive"]),
        ("wave", ["no motion primitive", "rsapien play wave"]),
    ] {
        let run = user.expect(2, &["--link", "virtual", "do", "1:50", step]);
        run.told(&parts);
        run.told(&[&format!("step 2 ({step})")]);
        assert_eq!(run.stdout, "", "nothing was begun");
    }
}

#[test]
fn primitives_run_and_the_robot_says_where_its_joints_are() {
    let user = User::new();
    let run = user.expect(
        0,
        &[
            "do",
            "right-arm-up+left-arm-down:1500",
            "13",
            "pause:100*2",
            "--link",
            "virtual",
            "--fast",
            "--json",
        ],
    );
    let answer = run.json();
    assert_eq!(answer["outcome"], "done");
    assert_eq!((&answer["steps_ended"], &answer["steps_total"]), (&4.into(), &4.into()));
    let joints = &answer["motion"]["joints"];
    assert_eq!((&joints["right-arm"], &joints["left-arm"]), (&"up".into(), &"down".into()));
    assert_eq!(joints["tilt"], "left");
    let told = user.expect(0, &["do", "1", "--link", "virtual", "--fast"]).stdout;
    assert!(told.contains("initialised first") && told.contains("done (1 of 1 steps"), "{told}");
}

#[test]
fn an_action_is_played_as_often_and_as_fast_as_asked() {
    let user = User::new();
    let play = |more: &[&str]| {
        let mut arguments = vec!["--link", "virtual", "play", "bow", "--fast", "--json"];
        arguments.extend(more);
        let answer = user.expect(0, &arguments).json();
        assert_eq!(answer["outcome"], "done");
        (answer["steps_total"].as_u64().unwrap(), answer["elapsed_ms"].as_u64().unwrap())
    };
    let (steps, elapsed_ms) = play(&[]);
    assert_eq!(play(&["--times", "3"]).0, 3 * steps);
    let (_, slow_ms) = play(&["--speed", "0.5"]);
    assert!(slow_ms > elapsed_ms * 3 / 2, "{slow_ms} at half the speed, {elapsed_ms} at full");
    let refused = |arguments: &[&str], parts: &[&str]| {
        let mut all = vec!["--link", "virtual", "play"];
        all.extend(arguments);
        user.expect(2, &all).told(parts);
    };
    refused(&["bow", "--times", "0"], &["1 to 1000"]);
    refused(&["bow", "--speed", "11"], &["0.1 to 10"]);
    refused(&["bov"], &["did you mean \"bow\""]);
    refused(&["tilt-left"], &["rsapien do tilt-left"]);
}

#[test]
fn the_head_looks_and_the_state_tells() {
    let user = User::new();
    let look = user
        .expect(
            0,
            &["look", "--pan", "-33.25", "--tilt", "12", "--link", "virtual", "--fast", "--json"],
        )
        .json();
    assert_eq!((&look["pan_deg"], &look["tilt_deg"]), (&(-33.25).into(), &12.0.into()));
    assert_eq!(look["moving"], false);
    let state = user.expect(0, &["--link", "virtual", "state", "--json"]).json();
    assert_eq!(state["motion"]["mode"], "fresh");
    assert_eq!(state["motion_information"]["dead_man_ms"], 500);
    let text = user.expect(0, &["--link", "virtual", "state"]).stdout;
    for name in ["link ", "mode ", "joints ", "bumpers ", "supply ", "head "] {
        assert!(text.contains(&format!("\n{name}")) || text.starts_with(name), "{name}: {text}");
    }
    let init = user.expect(0, &["--link", "virtual", "init", "--fast", "--json"]).json();
    assert_eq!(
        (&init["motion"]["mode"], &init["camera"]["mode"]),
        (&"idle".into(), &"idle".into())
    );
}

#[test]
fn watching_ends_quietly_when_the_reader_goes_away() {
    let user = User::new();
    let mut child =
        user.start(&["--link", "virtual", "state", "--watch", "--period", "20", "--json"]);
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    for _ in 0..2 {
        let line = lines.next().unwrap().unwrap();
        let state: serde_json::Value = serde_json::from_str(&line).unwrap();
        assert_eq!(state["link_state"], "up");
    }
    drop(lines);
    let run = Run::of_child(child);
    assert_eq!((run.status, run.stderr.as_str()), (0, ""));
}

#[test]
fn a_link_without_a_robot_says_so_and_stop_needs_no_data_folder() {
    let user = User::new();
    let missing = user.path("no-such-port").to_string_lossy().into_owned();
    for command in [&["state"][..], &["init"], &["do", "1"], &["stop"]] {
        let mut arguments = vec!["--link", &missing];
        arguments.extend(command);
        user.expect(2, &arguments).told(&["no-such-port", "rsapien ports"]);
    }
    let port = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let link = format!("tcp://127.0.0.1:{port}");
    user.expect(2, &["--link", &link, "stop"]).told(&[&link, "refused"]);
    user.expect(2, &["--link", "virtual", "stop"]).told(&["virtual robot"]);
    // Opens no database and leaves no file behind.
    let user = User::new();
    user.expect(2, &["--link", "./robot", "stop"]);
    assert_eq!(std::fs::read_dir(user.path(".")).unwrap().count(), 0);
}

#[test]
fn the_latency_budget_is_told_share_by_share() {
    let user = User::new();
    let told =
        user.expect(0, &["--link", "virtual", "--json", "state", "--timing", "--requests", "9"]);
    let told = told.json();
    assert_eq!((&told["requests"], &told["line_ms"]), (&9.into(), &7.47.into()));
    assert_eq!(told["firmware_at_most_ms"], 0.53);
    let of = |share: &str, what: &str| told[share][what].as_f64().unwrap();
    for share in ["pc", "adapter_and_firmware", "total"] {
        assert!(of(share, "best_ms") <= of(share, "median_ms"), "{told}");
        assert!(of(share, "median_ms") <= of(share, "worst_ms"), "{told}");
    }
    assert!(of("total", "worst_ms") >= of("pc", "worst_ms"), "{told}");
}

#[test]
fn a_program_is_told_how_far_an_action_is() {
    let user = User::new();
    let play = ["--link", "virtual", "--json", "play", "wave", "--fast", "--progress"];
    let lines = user.expect(0, &play).json_lines();
    let (answer, told) = lines.split_last().unwrap();
    assert_eq!(answer["outcome"], "done");
    let steps: Vec<u64> = told.iter().map(|it| it["steps_ended"].as_u64().unwrap()).collect();
    assert!(steps.is_sorted() && steps[0] == 0 && steps.last() == Some(&6), "{steps:?}");
    assert!(told.iter().all(|it| it["progress"] == "playing" && it["action"] == "wave"));
}
