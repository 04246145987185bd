//! Actions in a registry of one's own.
#![cfg(feature = "cli")]

mod support;

use std::io::Write;
use std::process::Stdio;

use support::{Run, User};

/// `rsapien actions --registry actions.sqlite ...`.
fn actions(user: &User, status: i32, arguments: &[&str]) -> Run {
    let mut all = vec!["actions", "--registry", "actions.sqlite"];
    all.extend(arguments);
    user.expect(status, &all)
}

fn with_editor(user: &User, status: i32, editor: &str) -> Run {
    let mut command = user.command(&["actions", "--registry", "actions.sqlite", "edit", "greet"]);
    let child = command
        .env("EDITOR", editor)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let run = Run::of_child(child);
    assert_eq!(run.status, status, "{editor}: {}{}", run.stdout, run.stderr);
    run
}

#[test]
fn a_new_registry_knows_what_an_owner_expects() {
    let user = User::new();
    let list = actions(&user, 0, &["list", "--json"]).json();
    let names: Vec<&str> =
        list.as_array().unwrap().iter().map(|action| action["name"].as_str().unwrap()).collect();
    for name in [
        "stand",
        "walk-forward",
        "walk-backward",
        "turn-left",
        "turn-right",
        "wave",
        "bow",
        "dance",
    ] {
        assert!(names.contains(&name), "{name}");
    }
    let text = actions(&user, 0, &["list", "--tag", "walking"]).stdout;
    assert!(text.contains("walk-forward") && !text.contains("bow"), "{text}");
    actions(&user, 1, &["list", "--tag", "nosuch"]);
    let primitives = actions(&user, 0, &["list", "--primitives", "--json"]).json();
    assert_eq!(primitives.as_array().unwrap().len(), 21);
    assert_eq!(primitives[12]["name"], "tilt-left");
}

#[test]
fn an_action_is_added_shown_edited_exported_and_removed() {
    let user = User::new();
    let add =
        ["add", "greet", "right-arm-up+tilt-left:600", "pause:200", "wave*2", "--tag", "show"];
    assert_eq!(actions(&user, 0, &add).stdout, "added greet\n");
    actions(&user, 2, &add).told(&["greet", "already", "edit greet"]);
    let shown = actions(&user, 0, &["show", "greet", "--json"]).json();
    assert_eq!(shown["version"], 1);
    assert!(shown["text"].as_str().unwrap().contains("wait 200ms"), "{shown}");

    let saved = with_editor(&user, 0, "sed -i s/600/700/").stdout;
    assert_eq!(saved, "saved version 2 of greet\n");
    assert_eq!(with_editor(&user, 0, "true").stdout, "greet is unchanged\n");
    with_editor(&user, 2, "false").told(&["nothing was saved"]);
    with_editor(&user, 2, "/no/such/editor").told(&["cannot start", "EDITOR"]);
    let refused = with_editor(&user, 2, "sed -i s/700/0/");
    refused.told(&["error[out-of-range]", "`0ms`", "kept in"]);
    let kept = refused.stderr.split("kept in ").nth(1).unwrap().split(": ").next().unwrap();
    let broken = actions(&user, 1, &["check", kept]).stdout;
    assert!(broken.contains(":3:") && broken.contains("^^^"), "{broken}");
    std::fs::remove_file(kept).unwrap();
    with_editor(&user, 2, "sed -i s/greet/hello/").told(&["\"hello\"", "\"greet\""]);

    let text = actions(&user, 0, &["export", "greet"]).stdout;
    assert!(text.contains("for 700ms"), "{text}");
    actions(&user, 0, &["remove", "greet"]);
    actions(&user, 2, &["show", "greet"]).told(&["no action \"greet\""]);
    assert!(actions(&user, 0, &["show", "greet", "--version", "1"]).stdout.contains("for 600ms"));
    let changes = actions(&user, 1, &["diff", "greet@1", "greet@2"]).stdout;
    assert!(changes.contains("lasts 600 ms -> 700 ms"), "{changes}");
    actions(&user, 2, &["diff", "greet@x", "wave"]).told(&["NAME@VERSION"]);
    assert!(actions(&user, 0, &["restore", "greet", "1"]).stdout.contains("as version 3"));
    actions(&user, 0, &["remove", "greet"]);

    // Back again, through the standard input.
    let mut command = user.command(&["actions", "--registry", "actions.sqlite", "add", "-f", "-"]);
    let mut child = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
    assert_eq!(Run::of_child(child).stdout, "added greet\n");
    let history = actions(&user, 0, &["show", "greet", "--history", "--json"]).json();
    assert_eq!(history.as_array().unwrap().len(), 4);
}

#[test]
fn what_is_wrong_is_told_with_its_place_and_nothing_is_stored() {
    let user = User::new();
    actions(&user, 2, &["add", "Bad Name", "1"]).told(&["Bad Name", "lower-case"]);
    actions(&user, 2, &["add", "tilt-left", "1"]).told(&["motion primitive"]);
    actions(&user, 2, &["add", "x", "1", "1+2"]).told(&["step 2 (1+2)", "right-arm-front"]);
    actions(&user, 2, &["add", "x", "nosuch"]).told(&["nosuch"]);
    actions(&user, 2, &["remove", "wave"]).told(&["wave", "dance"]);
    std::fs::write(user.path("circle.rsa"), "action one { play two }\n\naction two { play one }\n")
        .unwrap();
    let found = actions(&user, 1, &["check", "circle.rsa"]).stdout;
    assert!(found.contains("one -> two -> one") || found.contains("two -> one -> two"), "{found}");
    actions(&user, 2, &["import", "circle.rsa"]).told(&["circle"]);
    actions(&user, 2, &["show", "one"]);
    actions(&user, 2, &["import", "missing.rsa"]).told(&["missing.rsa"]);
    std::fs::write(user.path("no.sqlite"), "this is no database, only a text of some length")
        .unwrap();
    user.expect(2, &["actions", "--registry", "no.sqlite", "list"]).told(&["no.sqlite"]);
    user.expect(2, &["actions", "list", "--registry", "no.sqlite"]).told(&["no.sqlite"]);
}

#[test]
fn import_replaces_only_when_told_and_the_environment_names_a_registry() {
    let user = User::new();
    let wave = actions(&user, 0, &["export", "wave"]).stdout.replace("Waves", "Now waves");
    std::fs::write(user.path("wave.rsa"), wave).unwrap();
    actions(&user, 2, &["import", "wave.rsa"]).told(&["exist already", "--replace"]);
    let report = actions(&user, 0, &["import", "--replace", "wave.rsa", "--json"]).json();
    assert_eq!(report["replaced"][0], "wave");
    assert_eq!(actions(&user, 0, &["import", "wave.rsa"]).stdout, "unchanged wave\n");
    let through_environment = user
        .command(&["actions", "show", "wave"])
        .env("RSAPIEN_REGISTRY", user.path("actions.sqlite"))
        .output()
        .unwrap();
    assert!(String::from_utf8_lossy(&through_environment.stdout).contains("version 2"));
    // Without either it is the data folder's.
    assert!(user.expect(0, &["actions", "show", "wave"]).stdout.contains("version 1"));
    assert!(user.path("data/rsapien/registry.sqlite").is_file());
}

#[test]
fn actions_are_searched_drawn_played_and_kept() {
    let user = User::new();
    let found = actions(&user, 0, &["list", "wave", "left", "--json"]).json();
    assert_eq!(found[0]["name"], "wave-left");
    let short = actions(&user, 0, &["list", "--tag", "hands", "--longest", "475ms"]).stdout;
    assert!(short.contains("grip-left") && !short.contains("pick-up"), "{short}");
    actions(&user, 1, &["list", "--joint", "tilt", "--shortest", "1min"]);
    actions(&user, 2, &["list", "--longest", "5"]).told(&["unit"]);
    actions(&user, 2, &["list", "--joint", "head"]).told(&["right-arm"]);

    let shown = actions(&user, 0, &["show", "shake-hands"]).stdout;
    for part in ["right-arm", "\u{25b2}", "waits for right-hand", "action shake-hands", "#"] {
        assert!(shown.contains(part), "{part}: {shown}");
    }
    actions(&user, 0, &["show", "wave", "--svg", "wave.svg"]);
    let svg = std::fs::read_to_string(user.path("wave.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("Waves with the right arm."), "{svg}");
    let by_hash = found[0]["content_hash"].as_str().unwrap();
    let name = format!("#{}", &by_hash[..12]);
    assert!(actions(&user, 0, &["show", &name, "--text"]).stdout.contains("action wave-left"));

    actions(&user, 0, &["add", "tried", "tilt-left:600", "tilt-mid:400"]);
    let shown = actions(&user, 0, &["show", "tried"]).stdout;
    assert!(shown.contains("tried on the virtual body: done in 1.0 s"), "{shown}");
    actions(&user, 0, &["backup", "copy.sqlite"]);
    actions(&user, 2, &["backup", "copy.sqlite"]).told(&["there already"]);
    actions(&user, 0, &["remove", "tried"]);
    actions(&user, 0, &["restore", "--from", "copy.sqlite"]);
    actions(&user, 0, &["show", "tried"]);
    assert!(actions(&user, 0, &["verify"]).stdout.contains("nothing wrong"));
}

#[test]
fn a_warning_is_told_at_the_save_and_can_be_silenced() {
    let user = User::new();
    let text = "action reach { do right-arm-down + right-hand-in do tilt-right }\n";
    std::fs::write(user.path("reach.rsa"), text).unwrap();
    let told = actions(&user, 0, &["check", "reach.rsa"]).stdout;
    assert!(told.contains("warning[arms-meet-trunk]") && told.contains("^^^"), "{told}");
    let saved = actions(&user, 0, &["import", "reach.rsa"]);
    assert_eq!(saved.stdout, "added reach\n");
    saved.told(&["warning[arms-meet-trunk]", "1 warning"]);
    let shown = actions(&user, 0, &["show", "reach"]).stdout;
    assert!(shown.contains("warning: arms-meet-trunk"), "{shown}");
    let silenced = text.replace("{ do", "{ allow arms-meet-trunk \"a soft toy\" do");
    std::fs::write(user.path("reach.rsa"), silenced).unwrap();
    let told = actions(&user, 0, &["check", "reach.rsa"]).stdout;
    assert!(told.contains("nothing wrong (1 warning is silenced"), "{told}");
}

#[test]
fn a_bundle_goes_from_one_registry_to_another() {
    let user = User::new();
    std::fs::write(user.path("nod.rsa"), "action nod { do tilt-left do tilt-mid for 300ms }\n")
        .unwrap();
    std::fs::write(user.path("hi.rsa"), "action hi { play nod play wave }\n").unwrap();
    actions(&user, 0, &["import", "nod.rsa", "hi.rsa"]);
    let wrote = actions(&user, 0, &["export", "hi", "--bundle", "hi.rsapien"]).stdout;
    assert_eq!(wrote, "wrote hi.rsapien with 3 actions\n");
    actions(&user, 2, &["export", "nosuch", "--bundle", "none.rsapien"]);
    assert!(!user.path("none.rsapien").exists());
    let other = |status: i32, arguments: &[&str]| {
        let mut all = vec!["actions", "--registry", "other.sqlite"];
        all.extend(arguments);
        user.expect(status, &all)
    };
    other(0, &["add", "nod", "tilt-right:700"]);
    let refused = other(2, &["import", "hi.rsapien"]);
    refused.told(&["do something else: nod", "nod: #", "in the bundle", "--on-conflict"]);
    other(2, &["show", "hi"]);
    let renamed = other(0, &["import", "hi.rsapien", "--on-conflict", "rename"]).stdout;
    assert!(
        renamed.contains("added hi") && renamed.contains("nod is called nod-2 here"),
        "{renamed}"
    );
    assert!(other(0, &["show", "hi"]).stdout.contains("play nod-2"));
    std::fs::write(user.path("half.rsapien"), "PK and nothing else").unwrap();
    other(2, &["import", "half.rsapien"]).told(&["no bundle"]);
}
