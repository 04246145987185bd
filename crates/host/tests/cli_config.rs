//! The configuration file: a flag before the environment, the environment before the file, the file before the
//! default.
#![cfg(feature = "cli")]

mod support;

use support::{Run, User};

fn with_variable(user: &User, name: &str, value: &str, arguments: &[&str]) -> Run {
    let output = user.command(arguments).env(name, value).output().unwrap();
    Run {
        status: output.status.code().unwrap(),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

#[test]
fn each_value_comes_from_where_it_should() {
    let user = User::new();
    let show = ["config", "show", "--json"];
    let of = |run: &Run, key: &str| {
        let answer = run.json();
        (
            answer[key]["value"].as_str().unwrap().to_owned(),
            answer[key]["from"].as_str().unwrap().to_owned(),
        )
    };
    let pair = |value: &str, from: &str| (value.to_owned(), from.to_owned());
    let nothing = user.expect(0, &show);
    assert_eq!(of(&nothing, "link"), pair("auto", "the default"));
    user.expect(0, &["config", "init"]);
    user.expect(2, &["config", "init"]).told(&["there already"]);
    let path = user.expect(0, &["config", "path"]).stdout.trim().to_owned();
    assert_eq!(of(&user.expect(0, &show), "baud"), pair("57600", "the default"));
    std::fs::write(&path, "link = \"virtual\"\nbaud = 19200\nregistry = \"mine.sqlite\"\n")
        .unwrap();
    let of_file = user.expect(0, &show);
    assert_eq!(of(&of_file, "link"), pair("virtual", "the file"));
    assert_eq!(of(&of_file, "baud"), pair("19200", "the file"));
    let of_variable = with_variable(&user, "RSAPIEN_LINK", "/dev/robot", &show);
    assert_eq!(of(&of_variable, "link"), pair("/dev/robot", "RSAPIEN_LINK"));
    let flag = ["config", "show", "--json", "--link", "tcp://robot:1"];
    let of_flag = with_variable(&user, "RSAPIEN_LINK", "/dev/robot", &flag);
    assert_eq!(of(&of_flag, "link"), pair("tcp://robot:1", "--link"));

    // And they are used.
    user.expect(0, &["play", "grip-right", "--fast"]);
    user.expect(0, &["actions", "add", "nod", "tilt-left:600"]);
    let registry = std::path::Path::new(&path).with_file_name("mine.sqlite");
    assert!(registry.is_file(), "{registry:?}");
    user.expect(2, &["actions", "--registry", "other.sqlite", "show", "nod"]);
}

#[test]
fn a_mistake_in_the_file_is_told_and_stop_goes_on_without_it() {
    let user = User::new();
    std::fs::write(user.path("bad.toml"), "link = \"virtual\"\nlinc = 1\n").unwrap();
    let told = user.expect(2, &["actions", "list", "--config", "bad.toml"]);
    told.told(&["bad.toml, line 2", "linc", "the keys are link, baud, registry"]);
    user.expect(2, &["actions", "list", "--config", "missing.toml"]).told(&["missing.toml"]);
    // It looks for a robot, which is not there; but it is not the file that keeps it from it.
    let stopped = user.expect(2, &["stop", "--link", "/no/such/port", "--config", "bad.toml"]);
    stopped.told(&["line 2", "/no/such/port"]);
}
