//! `rsapien doctor` and `rsapien state` on a simulated robot with faults.
#![cfg(feature = "cli")]

mod support;

use std::io::{BufRead, BufReader};
use std::process::Child;

use rsapien_sim::control::{ControlClient, ControlRequest};
use serde_json::Value;
use support::User;

/// A running `rsapien sim`, ended with the test.
struct Simulator {
    child: Child,
    link: String,
    tcp: String,
}

impl Simulator {
    fn start(user: &User) -> Simulator {
        let link = user.path("robot").to_string_lossy().into_owned();
        let mut child = user.start(&["sim", "--pty", &link, "--tcp", "0", "--json"]);
        let mut text = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut text).unwrap();
        let answer: Value = serde_json::from_str(&text).unwrap();
        let tcp = answer["links"][1].as_str().unwrap().to_owned();
        Simulator { child, link, tcp }
    }

    fn fault(&self, json: &str) {
        let request = ControlRequest::parse(json.as_bytes()).unwrap();
        let path = format!("{}.control", self.link);
        ControlClient::connect(path).unwrap().request(&request).unwrap();
    }
}

impl Drop for Simulator {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The codes of the problems.
fn problems(answer: &Value) -> Vec<&str> {
    let findings = answer["findings"].as_array().unwrap().iter();
    findings
        .filter(|finding| finding["severity"] == "problem")
        .map(|finding| finding["code"].as_str().unwrap())
        .collect()
}

#[test]
fn a_simulated_robot_is_examined_and_its_faults_are_found() {
    let user = User::new();
    let simulator = Simulator::start(&user);
    let doctor =
        |status, link: &str| user.expect(status, &["--link", link, "doctor", "--json"]).json();
    for link in [&simulator.link, &simulator.tcp] {
        let answer = doctor(0, link);
        assert_eq!((&answer["healthy"], problems(&answer).len()), (&true.into(), 0), "{answer}");
        assert_eq!(answer["motion_information"]["reset_cause"], "power-on");
        assert!(answer["line"]["requests"].as_u64().unwrap() > 20, "{answer}");
    }
    let text = user.expect(0, &["--link", &simulator.link, "doctor"]).stdout;
    for part in ["nothing is moved", "ok      ports", "\nverdict  ", "\nnext     "] {
        assert!(text.contains(part), "{part:?}:\n{text}");
    }

    simulator.fault(r#"{"supply_mv": 4700}"#);
    simulator.fault(r#"{"line": "both", "faults": {"bit_error_ppm": 2000}}"#);
    let answer = doctor(1, &simulator.link);
    assert_eq!(problems(&answer), ["supply-low", "line-bad"], "{answer}");
    assert!(answer["next"].as_str().unwrap().contains("batteries"), "{answer}");

    simulator.fault(r#"{"cable": "pulled"}"#);
    let answer = doctor(1, &simulator.tcp);
    assert_eq!(problems(&answer), ["silent"], "{answer}");
}

#[test]
fn a_line_in_use_and_a_port_that_is_missing_are_findings() {
    let user = User::new();
    let simulator = Simulator::start(&user);
    let mut watcher =
        user.start(&["--link", &simulator.link, "state", "--watch", "--period", "20", "--json"]);
    let mut lines = BufReader::new(watcher.stdout.take().unwrap()).lines();
    lines.next().unwrap().unwrap();
    let run = user.expect(1, &["--link", &simulator.link, "doctor"]);
    assert!(run.stdout.contains("(rsapien state)"), "{}", run.stdout);
    let state: Value = serde_json::from_str(&lines.next().unwrap().unwrap()).unwrap();
    assert_eq!(state["link_state"], "up", "the one that holds the line is not disturbed");
    watcher.kill().unwrap();
    watcher.wait().unwrap();

    let answer = user.expect(1, &["--link", "./no-such-port", "doctor", "--json"]).json();
    assert_eq!(problems(&answer), ["no-device"], "{answer}");
}

#[test]
fn the_state_tells_boot_number_and_cause_of_a_reset() {
    let user = User::new();
    let simulator = Simulator::start(&user);
    let state = || user.expect(0, &["--link", &simulator.link, "state"]).stdout;
    assert!(state().contains("at 40 MHz, dead-man 500 ms, boot 1, started by power-on"));
    simulator.fault(r#"{"power": "brown-out"}"#);
    std::thread::sleep(std::time::Duration::from_millis(300));
    let text = state();
    let restarted = "boot 2, restarted by a brown-out: its supply sagged";
    assert_eq!(text.matches(restarted).count(), 2, "both controllers:\n{text}");
}
