//! Scores and times of the detectors, on pictures that the tests draw.
#![cfg(feature = "cli")]

mod support;

use std::fs;
use std::path::Path;

use rsapien_vision::Picture;
use support::{User, is_png};

/// A bright disc of 45 px radius at (`x`, 110) on a dark ground.
fn draw(path: &Path, x: f64) {
    let mut rgb = vec![60; 320 * 240 * 3];
    for (index, pixel) in rgb.chunks_exact_mut(3).enumerate() {
        #[allow(clippy::cast_precision_loss)]
        let (dx, dy) = ((index % 320) as f64 - x, (index / 320) as f64 - 110.0);
        if dx.hypot(dy) < 45.0 {
            pixel.fill(210);
        }
    }
    Picture::new(rgb, 320, 240).unwrap().save_png(path).unwrap();
}

/// Two sets: `one` with a disc that is there and one that is not, `two` with a disc that need not be found and a picture
/// that is missing.
fn sets(user: &User) {
    for folder in ["data/one/images", "data/one/gt", "data/two/images", "data/two/gt"] {
        fs::create_dir_all(user.path(folder)).unwrap();
    }
    draw(&user.path("data/one/images/a.png"), 150.0);
    draw(&user.path("data/two/images/b.png"), 160.0);
    let truth = |name: &str, text: &str| fs::write(user.path(name), text).unwrap();
    truth(
        "data/one/gt/a.json",
        r#"{"image": "a.png", "width": 320, "height": 240, "meta": {},
            "ellipses": [[150, 110, 45, 45, 0], [250, 60, 20, 10, 1]]}"#,
    );
    truth(
        "data/two/gt/b.json",
        r#"{"image": "b.png", "ellipses": [], "ignore": [[160, 110, 45, 45, 0]]}"#,
    );
    truth("data/two/gt/c.json", r#"{"image": "c.png", "ellipses": [[9, 9, 5, 5, 0]]}"#);
}

#[test]
fn sets_are_scored_beside_the_answers_of_others() {
    let user = User::new();
    sets(&user);
    fs::create_dir(user.path("peer")).unwrap();
    let answers = r#"{"image": "a.png", "ms": 1e6, "ellipses": [[150, 110, 45, 45, 0], [250, 60, 10, 20, -0.5707963]]}"#;
    fs::write(user.path("peer/one.jsonl"), format!("{answers}\n\n{answers}\n")).unwrap();
    let options = ["--data", "data", "--preset", "paper", "--quality", "150", "--repeat", "1"];
    let compared = ["--compare", "peer", "--failures", "failures"];
    let run = user.expect(2, &[&["eval", "--json"], &options[..], &compared].concat());
    run.told(&["c.png"]);
    let rows = run.json_lines();
    let row = |set: &str, detector: &str| {
        let is_it = |row: &&serde_json::Value| row["set"] == set && row["detector"] == detector;
        rows.iter().find(is_it).unwrap_or_else(|| panic!("{set} {detector}: {rows:?}")).clone()
    };
    assert_eq!(rows.len(), 6);
    let ours = row("one", "paper");
    assert_eq!((&ours["precision"], &ours["recall"]), (&1.0.into(), &0.5.into()), "{ours}");
    assert!(ours["overlap_mean"].as_f64().unwrap() > 0.9, "{ours}");
    let theirs = row("one", "peer");
    assert_eq!((&theirs["f"], &theirs["matched"]), (&1.0.into(), &2.into()), "{theirs}");
    assert!(theirs["ms_ratio"].as_f64().unwrap() < 0.01, "{theirs}");
    let ours = row("two", "paper");
    assert_eq!((&ours["detections"], &ours["truths"]), (&0.into(), &1.into()), "{ours}");
    assert_eq!((&ours["pictures"], &ours["missing"]), (&1.into(), &1.into()), "{ours}");
    assert_eq!(row("two", "peer")["missing"], 2);
    assert_eq!(row("all", "paper")["truths"], 3);
    for name in ["failures/one/a.png", "failures/two/b.png"] {
        assert!(is_png(&user.path(name)), "{name}");
    }
    let one = [&["eval", "--data", "data/one"][..], &options[2..]].concat();
    let table = user.expect(0, &one).stdout;
    assert_eq!(table.lines().count(), 2, "{table}");
    assert!(table.starts_with("set  detector  pictures"), "{table}");
}

#[test]
fn what_cannot_be_scored_says_what_is_wanted() {
    let user = User::new();
    sets(&user);
    user.expect(2, &["eval", "--data", "data/one/gt"]).told(&["data/one/gt", "images/ and gt/"]);
    user.expect(2, &["eval", "--data", "data", "--overlap", "0"]).told(&["0.8"]);
    fs::write(user.path("bad.jsonl"), "{\"image\": \"a.png\", \"ellipses\": [[1, 2]]}").unwrap();
    let compared = ["eval", "--data", "data", "--compare", "bad.jsonl"];
    user.expect(2, &compared).told(&["bad.jsonl, line 1", "five numbers"]);
    fs::write(user.path("data/one/gt/a.json"), "{}").unwrap();
    user.expect(2, &["eval", "--data", "data"]).told(&["data/one/gt/a.json", "image"]);
}

#[test]
fn costs_are_told_for_every_preset_and_size() {
    let user = User::new();
    let common = ["bench-detect", "--sizes", "64x48,128x96", "--repeat", "1"];
    let run = user.expect(0, &[&common[..], &["--csv", "--plot", "cost.svg"]].concat());
    let lines: Vec<_> = run.stdout.lines().collect();
    assert_eq!(lines.len(), 5, "{}", run.stdout);
    assert!(lines[0].starts_with("preset,width,height,ms,"), "{}", lines[0]);
    assert!(lines[1].starts_with("default,64,48,") && lines[4].starts_with("paper,128,96,"));
    let svg = fs::read_to_string(user.path("cost.svg")).unwrap();
    assert!(svg.starts_with("<svg ") && svg.contains(">paper</text>"), "{svg}");
    user.expect(0, &[&common[..], &["--presets", "paper", "--scenes", "scenes"]].concat());
    assert!(is_png(&user.path("scenes/scene-128x96-2.png")));
    user.expect(2, &["bench-detect", "--sizes", "640"]).told(&["640x480"]);
}
