//! Help, completions and exit statuses that need no robot.
#![cfg(feature = "cli")]

mod support;

use support::User;

const COMMANDS: [&str; 24] = [
    "demo",
    "ports",
    "doctor",
    "state",
    "top",
    "init",
    "stop",
    "do",
    "play",
    "actions",
    "teach",
    "look",
    "snapshot",
    "detect",
    "eval",
    "bench-detect",
    "watch",
    "record",
    "log",
    "replay",
    "sim",
    "config",
    "completions",
    "man",
];

#[test]
fn every_command_has_help_with_an_example_and_a_section_in_the_documentation() {
    let user = User::new();
    let overview = user.expect(0, &["--help"]).stdout;
    let documentation = include_str!("../../../docs/cli.md");
    for command in COMMANDS {
        assert!(overview.contains(&format!("\n  {command} ")), "{command}:\n{overview}");
        let help = user.expect(0, &[command, "--help"]).stdout;
        assert!(help.contains(&format!("  rsapien {command}")), "{help}");
        let heading = format!("\n## `{command}`");
        assert!(documentation.contains(&heading), "docs/cli.md has no section {heading:?}");
    }
    for status in ["0 ", "1 ", "2 ", "130 "] {
        assert!(overview.contains(&format!("\n  {status}")), "status {status}:\n{overview}");
        assert!(documentation.contains(&format!("\n| {status}")), "docs/cli.md, status {status}");
    }
}

#[test]
fn usage_errors_end_with_status_2_and_say_what_is_expected() {
    let user = User::new();
    user.expect(2, &[]);
    user.expect(2, &["dance"]).told(&["unrecognized subcommand", "dance"]);
    user.expect(2, &["play"]).told(&["<ACTION>"]);
    user.expect(2, &["look", "--pan", "91", "--tilt", "0"]).told(&["-90 to 90 degrees"]);
    user.expect(2, &["look", "--pan", "NaN", "--tilt", "0"]).told(&["-90 to 90 degrees"]);
    user.expect(2, &["state", "--period", "5", "--watch"]).told(&["20..=60000"]);
    user.expect(2, &["state", "--baud", "1"]).told(&["57600"]);
    user.expect(2, &["play", "wave", "--speed", "-1"]).told(&["0.1 to 10"]);
    user.expect(2, &["detect", "a.png", "--pan", "5"]).told(&["--camera"]);
    std::fs::write(user.path("same.png"), "no picture").unwrap();
    user.expect(2, &["detect", "same.png", "--annotate", "same.png"]).told(&["picture itself"]);
    assert_eq!(std::fs::read(user.path("same.png")).unwrap(), b"no picture");
    user.expect(2, &["--link", "nonsense", "state"]).told(&["nonsense", "tcp://HOST:PORT"]);
    user.expect(2, &["init", "--fast", "--link", "/dev/null"]).told(&["--fast", "--link virtual"]);
    user.expect(2, &["sim"]).told(&["--pty LINK"]);
    user.expect(2, &["sim", "--tcp", "0.0.0.0:0"]).told(&["--allow-remote"]);
    user.expect(2, &["demo", "--world", "moon"]).told(&["moon", "demo, empty, wall"]);
    user.expect(2, &["snapshot"]).told(&["no camera", "--camera"]);
}

#[test]
fn completions_know_the_commands() {
    let user = User::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = user.expect(0, &["completions", shell]).stdout;
        assert!(script.contains("snapshot") && script.contains("annotate"), "{shell}");
    }
}

#[test]
fn completions_and_manual_pages_are_installed_where_they_are_looked_for() {
    let user = User::new();
    user.expect(0, &["completions", "bash", "--install"]);
    let script = user.path("data/bash-completion/completions/rsapien");
    assert!(std::fs::read_to_string(&script).unwrap().contains("complete"), "{script:?}");
    assert!(user.expect(0, &["completions", "zsh", "--install"]).stdout.contains("fpath"));
    user.expect(2, &["completions", "elvish", "--install"]).told(&["elvish", "> FILE"]);
    let told = user.expect(0, &["man", "--install"]).stdout;
    let page = std::fs::read_to_string(user.path("data/man/man1/rsapien-actions-show.1")).unwrap();
    assert!(page.contains("Examples") && page.contains("rsapien actions show wave"), "{page}");
    let documentation = include_str!("../../../docs/cli.md");
    let count = told.split_whitespace().nth(1).unwrap();
    assert!(documentation.contains(&format!("wrote {count} pages")), "{told}");
    assert!(user.expect(0, &["man"]).stdout.contains(".TH rsapien 1"));
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let user = User::new();
    // Longer than a pipe holds, to a reader that reads nothing.
    let mut child = user.start(&["completions", "zsh"]);
    drop(child.stdout.take());
    let run = support::Run::of_child(child);
    assert_eq!((run.status, run.stderr.as_str()), (0, ""));
}

#[test]
fn without_a_terminal_nothing_is_drawn() {
    let user = User::new();
    let run = user.expect(0, &["play", "wave", "--link", "virtual", "--fast"]);
    assert_eq!(run.stderr, "");
    assert!(!run.stdout.contains('\x1b') && !run.stdout.contains('\r'), "{:?}", run.stdout);
    let refused = user.expect(2, &["play", "nosuch", "--link", "virtual"]);
    assert!(
        !refused.stderr.contains('\x1b') && refused.stderr.starts_with("rsapien: "),
        "{}",
        refused.stderr
    );
}
