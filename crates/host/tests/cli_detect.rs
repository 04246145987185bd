//! Ellipses in pictures that the tests draw.
#![cfg(feature = "cli")]

mod support;

use std::path::Path;
use std::process::Stdio;

use rsapien_vision::Picture;
use support::{Run, User, is_png};

/// A bright ellipse of semi-axes 50 x 30 px on a dark ground, centred at (150, 110).
fn draw(path: &Path) {
    let mut rgb = vec![60; 320 * 240 * 3];
    for (index, pixel) in rgb.chunks_exact_mut(3).enumerate() {
        #[allow(clippy::cast_precision_loss)]
        let (x, y) = ((index % 320) as f64 - 150.0, (index / 320) as f64 - 110.0);
        if (x / 50.0).powi(2) + (y / 30.0).powi(2) < 1.0 {
            pixel.fill(210);
        }
    }
    Picture::new(rgb, 320, 240).unwrap().save_png(path).unwrap();
}

fn blank(path: &Path, width: usize, height: usize) {
    Picture::new(vec![7; width * height * 3], width, height).unwrap().save_png(path).unwrap();
}

#[test]
fn the_papers_detector_finds_an_ellipse_and_tells_it_in_every_form() {
    let user = User::new();
    draw(&user.path("one.png"));
    let run = user.expect(0, &["detect", "--preset", "paper", "--json", "one.png"]);
    assert!(run.stdout.starts_with("{\"image\":\"one.png\",\"width\":320,\"height\":240,\"ms\":"));
    let answer = run.json();
    let ellipses = answer["ellipses"].as_array().unwrap();
    assert_eq!(ellipses.len(), 1, "{answer}");
    let value = |index: usize| ellipses[0][index].as_f64().unwrap();
    for (index, (expected, tolerance)) in
        [(150.0, 3.0), (110.0, 3.0), (50.0, 3.0), (30.0, 3.0)].into_iter().enumerate()
    {
        assert!((value(index) - expected).abs() <= tolerance, "{index}: {answer}");
    }
    let angle = value(4);
    assert!((0.0..std::f64::consts::PI).contains(&angle), "{answer}");

    let text = user.expect(0, &["detect", "--preset", "paper", "one.png"]).stdout;
    assert!(text.starts_with("one.png (320 x 240): 1 ellipse in "), "{text}");
    let tables = user.expect(0, &["detect", "--table", "one.png"]).stdout;
    for words in ["Table 2", "Alfa (rad)", "Table 3", "Search Point Pairs"] {
        assert!(tables.contains(words), "{tables}");
    }
    let counted = user.expect(0, &["detect", "--table", "--json", "one.png"]).json();
    let statistics = &counted["statistics"];
    assert_eq!(statistics["real_ellipses"], 1);
    let (pairs, points) = (&statistics["search_point_pairs"], &statistics["total_edge_points"]);
    assert_eq!(pairs.as_u64().unwrap(), 2 * points.as_u64().unwrap(), "m = C n with C = 2");
}

#[test]
fn the_default_detector_finds_it_between_pixels_and_tells_what_speaks_for_it() {
    let user = User::new();
    draw(&user.path("one.png"));
    let run = user.expect(0, &["detect", "--json", "--points", "--covariance", "one.png"]);
    assert!(run.stdout.starts_with("{\"image\":\"one.png\",\"width\":320,\"height\":240,\"ms\":"));
    let answer = run.json();
    assert_eq!(answer["truncated"], false);
    let [ellipse] = answer["ellipses"].as_array().unwrap().as_slice() else {
        panic!("{answer}");
    };
    // The drawing is not anti-aliased, which alone shifts an edge by parts of a pixel.
    for (index, expected) in [150.0, 110.0, 50.0, 30.0].into_iter().enumerate() {
        let error = (ellipse[index].as_f64().unwrap() - expected).abs();
        assert!(error < 0.5, "{index}: {answer}");
    }
    let (score, details) = (answer["scores"][0].as_f64().unwrap(), &answer["details"][0]);
    assert!(score > 0.8 && score <= 1.0, "{answer}");
    for share in ["support_share", "gradient_agreement"] {
        assert!(
            details[share].as_f64().is_some_and(|share| share > 0.8 && share <= 1.0),
            "{answer}"
        );
    }
    assert!(details["log10_false_alarms"].as_f64().unwrap() < -10.0, "{answer}");
    assert!(details["points"].as_array().unwrap().len() > 100, "{answer}");
    let covariance = details["covariance"].as_array().unwrap();
    assert!(covariance.len() == 5 && covariance[0][0].as_f64().unwrap() > 0.0, "{answer}");

    let text = user.expect(0, &["detect", "one.png"]).stdout;
    assert!(
        text.starts_with("one.png (320 x 240): 1 ellipse in ") && text.contains("score"),
        "{text}"
    );
    let table = user.expect(0, &["detect", "--csv", "one.png"]).stdout;
    let lines: Vec<_> = table.lines().collect();
    assert!(lines.len() == 2 && lines[0].starts_with("image,center_x_px,"), "{table}");
    assert!(lines[1].starts_with("one.png,") && lines[1].ends_with(','), "{table}");
    assert_eq!(lines[0].split(',').count(), lines[1].split(',').count());
    for outside in [["--max-axis", "40"], ["--min-axis", "35"], ["--region", "200,0,120,240"]] {
        user.expect(1, &[&["detect", "one.png"][..], &outside].concat());
    }
}

#[test]
fn each_option_is_heard_by_its_own_detector_or_refused() {
    let user = User::new();
    draw(&user.path("one.png"));
    let refused = |options: &[&str], told: &[&str]| {
        user.expect(2, &[&["detect", "one.png"], options].concat()).told(told);
    };
    refused(&["--preset", "default", "--quality", "90"], &["--quality", "--preset paper"]);
    refused(&["--preset", "paper", "--min-axis", "9"], &["--min-axis", "--semi-minor"]);
    refused(&["--table", "--min-score", "0.5"], &["--table", "--min-score"]);
    refused(&["--min-axis", "1"], &["semi_axis_min_px is 1", "--min-axis"]);
    refused(&["--min-score", "2"], &["score_min is 2", "0 to 1"]);
    refused(&["--region", "1,2,3"], &["100,50,320,240"]);
    refused(&["--points"], &["--json"]);
    refused(&["--csv", "--json"], &["--csv"]);
    // An option of the paper alone asks for its detector, which writes no scores.
    let answer = user.expect(0, &["detect", "--json", "--quality", "200", "one.png"]).json();
    assert!(answer["scores"].is_null() && answer["ellipses"].as_array().unwrap().len() == 1);
}

#[test]
fn folders_and_patterns_are_looked_at_by_name() {
    let user = User::new();
    std::fs::create_dir(user.path("cups")).unwrap();
    for name in ["cups/two.png", "cups/one.png"] {
        draw(&user.path(name));
    }
    std::fs::write(user.path("cups/notes.txt"), "no picture").unwrap();
    let names = |given: &str| {
        let run = user.expect(0, &["detect", "--preset", "paper", "--json", given]);
        let name = |line: &serde_json::Value| line["image"].as_str().unwrap().to_owned();
        run.json_lines().iter().map(name).collect::<Vec<_>>()
    };
    assert_eq!(names("cups"), ["one.png", "two.png"]);
    assert_eq!(names("c*/t*.png"), ["two.png"]);
    user.expect(2, &["detect", "c*/z*.png"]).told(&["c*/z*.png"]);
}

#[test]
fn one_seed_gives_the_same_ellipses_on_any_number_of_threads() {
    let user = User::new();
    draw(&user.path("one.png"));
    for preset in ["default", "paper"] {
        let ellipses = |threads: &str| {
            let options = ["--preset", preset, "--threads", threads, "--seed", "5"];
            let run = user.expect(0, &[&["detect", "--json", "one.png"][..], &options].concat());
            run.json()["ellipses"].clone()
        };
        assert_eq!(ellipses("1"), ellipses("2"), "{preset}");
        assert_eq!(ellipses("1"), ellipses("8"), "{preset}");
    }
}

#[test]
fn pictures_go_where_they_are_wanted() {
    let user = User::new();
    draw(&user.path("one.png"));
    draw(&user.path("two.png"));
    user.expect(0, &["detect", "one.png", "--annotate", "deep/found.png"]);
    assert!(is_png(&user.path("deep/found.png")));
    user.expect(0, &["detect", "one.png", "two.png", "--annotate", "folder"]);
    for name in ["folder/one-ellipses.png", "folder/two-ellipses.png"] {
        assert!(is_png(&user.path(name)), "{name}");
    }
    user.expect(2, &["detect", "one.png", "two.png", "--annotate", "out.png"]).told(&[
        "out.png",
        "2 pictures",
        "{}",
    ]);
    user.expect(2, &["detect", "one.png", "--annotate", "/proc/no/out.png"]).told(&["/proc/no"]);
}

#[test]
fn every_stage_of_either_detector_becomes_a_picture() {
    let user = User::new();
    draw(&user.path("one.png"));
    draw(&user.path("two.png"));
    for (preset, between) in [
        ("default", ["2-edge-points", "3-chains", "4-arcs", "5-candidates"]),
        ("paper", ["2-noise-reduced", "3-gradient", "4-edges", "5-virtual-ellipses"]),
    ] {
        let stages = ["--preset", preset, "--stages", preset];
        user.expect(0, &[&["detect", "one.png", "two.png"], &stages[..]].concat());
        for name in ["one", "two"] {
            for stage in ["1-grey"].iter().chain(&between).chain(&["6-ellipses"]) {
                assert!(is_png(&user.path(&format!("{preset}/{name}-{stage}.png"))), "{stage}");
            }
        }
        assert_eq!(std::fs::read_dir(user.path(preset)).unwrap().count(), 12);
    }
    // Between the grey picture and the ellipses of the default detector no two stages look alike.
    let of = |stage| std::fs::read(user.path(&format!("default/one-{stage}.png"))).unwrap();
    let drawn = ["2-edge-points", "3-chains", "4-arcs", "5-candidates"].map(of);
    for (at, one) in drawn.iter().enumerate() {
        assert!(!drawn[at + 1..].contains(one), "stage {at}");
    }
}

#[test]
fn bad_pictures_are_told_and_the_others_still_run() {
    let user = User::new();
    draw(&user.path("good.png"));
    let whole = std::fs::read(user.path("good.png")).unwrap();
    std::fs::write(user.path("cut.png"), &whole[..whole.len() / 2]).unwrap();
    std::fs::write(user.path("empty.png"), "").unwrap();
    std::fs::write(user.path("text.png"), "no picture at all").unwrap();
    // The head of a picture of 60000 x 60000 pixels, and no more.
    let mut huge = b"P5\n60000 60000\n255\n".to_vec();
    huge.extend([0; 1000]);
    std::fs::write(user.path("huge.pgm"), huge).unwrap();
    std::fs::create_dir(user.path("folder")).unwrap();
    blank(&user.path("pixel.png"), 1, 1);
    let run = user.expect(
        2,
        &[
            "detect",
            "--json",
            "missing.png",
            "cut.png",
            "empty.png",
            "text.png",
            "huge.pgm",
            "folder",
            "pixel.png",
            "good.png",
        ],
    );
    run.told(&[
        "missing.png",
        "cut.png",
        "empty.png is empty",
        "text.png",
        "huge.pgm",
        "folder is a folder without pictures",
    ]);
    let lines = run.json_lines();
    let found = |line: &serde_json::Value| {
        (line["image"].as_str().unwrap().to_owned(), line["ellipses"].as_array().unwrap().len())
    };
    let found: Vec<_> = lines.iter().map(found).collect();
    assert_eq!(found, [("pixel.png".to_owned(), 0), ("good.png".to_owned(), 1)]);
}

#[test]
fn nothing_found_is_status_1_and_bad_options_are_status_2() {
    let user = User::new();
    blank(&user.path("blank.png"), 64, 48);
    let run = user.expect(1, &["detect", "blank.png"]);
    assert!(run.stdout.contains("no ellipse"), "{}", run.stdout);
    user.expect(2, &["detect"]).told(&["<IMAGE>"]);
    user.expect(2, &["detect", "blank.png", "--semi-major", "90..30"]).told(&["--semi-major"]);
    user.expect(2, &["detect", "blank.png", "--semi-major", "ten"]).told(&["30..90"]);
    user.expect(2, &["detect", "blank.png", "--quality", "0"]).told(&["--quality"]);
    user.expect(2, &["detect", "blank.png", "--threads", "0"]).told(&["1..=256"]);
}

#[test]
fn pictures_come_from_the_standard_input_and_the_camera_too() {
    let user = User::new();
    draw(&user.path("one.png"));
    let file = std::fs::File::open(user.path("one.png")).unwrap();
    let mut command = user.command(&["detect", "--json", "-"]);
    let child = command.stdin(file).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let run = Run::of_child(child);
    assert_eq!(run.json()["ellipses"].as_array().unwrap().len(), 1, "{}", run.stderr);
    let run = user.run(&[
        "detect",
        "--camera",
        "virtual",
        "--pan",
        "45",
        "--tilt",
        "-20",
        "--json",
        "--semi-major",
        "20..60",
        "--semi-minor",
        "20..60",
    ]);
    let answer = run.json();
    assert_eq!((&answer["image"], &answer["width"]), (&"camera".into(), &320.into()));
    user.expect(0, &["snapshot", "--camera", "one.png", "--out", "copy.png"]);
    assert!(is_png(&user.path("copy.png")));
}
