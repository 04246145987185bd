//! Two programs that want one robot, each a process of its own; and keys while an action is played.
#![cfg(all(feature = "cli", unix))]

mod support;

use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, Stdio};

use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use support::simulator::Simulator;
use support::{Run, User, interrupt, wait_until};

const ARMS: &str = "action arms {
    repeat 4 { do right-arm-up + left-arm-up for 1s do right-arm-front + left-arm-front for 1s }
}";

/// A user whose registry has `arms`, and an initialised robot.
fn start() -> (User, Simulator) {
    let user = User::new();
    std::fs::write(user.path("arms.rsa"), ARMS).unwrap();
    user.expect(0, &["actions", "add", "--file", "arms.rsa"]);
    let simulator = Simulator::start(&user);
    user.expect(0, &["--link", &simulator.link, "init"]);
    (user, simulator)
}

/// A program that plays arms and holds the line.
fn hold(user: &User, simulator: &Simulator) -> Child {
    let holder = user.start(&["--link", &simulator.link, "--json", "play", "arms"]);
    simulator.wait_until_executing();
    holder
}

#[test]
fn a_second_program_is_refused_waits_or_plays_beside_the_first() {
    let (user, simulator) = start();
    let link = simulator.link.as_str();
    let holder = hold(&user, &simulator);
    let pid = holder.id().to_string();
    let refused = user.expect(1, &["--link", link, "play", "wave", "--policy", "merge"]);
    refused.told(&["wave was not played", "arms", &pid, "both need right-arm"]);
    user.expect(1, &["--link", link, "play", "wave"]).told(&["is in its way", "queue or replace"]);

    let lean =
        ["--link", link, "--json", "do", "tilt-left:400", "tilt-mid:400", "--policy", "merge"];
    let beside = user.expect(0, &lean).json_lines();
    assert_eq!(beside[0]["admission"], "beside");
    assert_eq!(beside[0]["claims"][0]["action"], "arms");
    assert_eq!((&beside[1]["outcome"], &beside[1]["steps_ended"]), (&"done".into(), &2.into()));
    assert_eq!(beside[1]["motion"]["mode"], "executing", "the arms go on");

    let wave = user.expect(0, &["--link", link, "--json", "play", "wave", "--policy", "queue"]);
    let told: Vec<_> = wave.json_lines().iter().map(|it| it["admission"].clone()).collect();
    assert_eq!(told, ["waits".into(), "begins".into(), serde_json::Value::Null]);
    let holder = Run::of_child(holder);
    assert_eq!(
        (holder.status, &holder.json()["outcome"]),
        (0, &"done".into()),
        "{}",
        holder.stderr
    );
    assert_eq!(holder.json()["steps_ended"], 8);
}

#[test]
fn a_program_that_replaces_ends_the_other_action_and_both_are_told() {
    let (user, simulator) = start();
    let holder = hold(&user, &simulator);
    let link = simulator.link.as_str();
    let other = user.expect(0, &["--link", link, "play", "bow", "--policy", "replace"]);
    assert!(other.stdout.contains("bow: replaces arms of rsapien play arms"), "{}", other.stdout);
    let holder = Run::of_child(holder);
    assert_eq!(holder.status, 1);
    assert_eq!(holder.json()["detail"], "by an action that replaced it");
}

#[test]
fn a_guest_that_dies_takes_its_action_with_it_and_the_holders_goes_on() {
    let (user, simulator) = start();
    let holder = hold(&user, &simulator);
    let lean = ["--link", &simulator.link, "do", "tilt-left:20000", "--policy", "merge"];
    let mut guest = user.start(&lean);
    let mut lines = BufReader::new(guest.stdout.take().unwrap()).lines();
    assert!(lines.any(|line| line.unwrap().contains("begins beside arms")));
    guest.kill().unwrap();
    guest.wait().unwrap();
    let holder = Run::of_child(holder);
    assert_eq!(
        (holder.status, &holder.json()["outcome"]),
        (0, &"done".into()),
        "{}",
        holder.stderr
    );
}

#[test]
fn a_holder_that_is_ended_tells_its_guest_and_the_motors_are_off() {
    let (user, simulator) = start();
    for dies in [false, true] {
        let mut holder = hold(&user, &simulator);
        let lean = ["--link", &simulator.link, "do", "tilt-left:20000", "--policy", "merge"];
        let guest = user.start(&lean);
        wait_until("the tilt motor runs, or has", || {
            simulator
                .control()
                .state()
                .unwrap()
                .joints
                .iter()
                .any(|joint| joint.joint == "tilt" && joint.motor != "off")
        });
        if dies {
            holder.kill().unwrap();
        } else {
            interrupt(&holder);
        }
        let guest = Run::of_child(guest);
        assert_eq!(guest.status, 1, "{}", guest.stderr);
        let told = if dies {
            "unknown (the program that held the line is gone"
        } else {
            "interrupted by STOP"
        };
        assert!(guest.stdout.contains(told), "{}", guest.stdout);
        let status = holder.wait().unwrap();
        assert_eq!(status.code(), if dies { None } else { Some(130) });
        wait_until("the motors are off", || {
            simulator.control().state().unwrap().joints.iter().all(|joint| joint.motor == "off")
        });
        user.expect(0, &["--link", &simulator.link, "init"]);
    }
}

/// A program whose standard input and error are a terminal.
fn start_on_terminal(user: &User, arguments: &[&str]) -> (Child, File) {
    let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    grantpt(&master).unwrap();
    unlockpt(&master).unwrap();
    let name = ptsname(&master, Vec::new()).unwrap();
    let open = || OpenOptions::new().read(true).write(true).open(name.to_str().unwrap()).unwrap();
    let mut command = user.command(arguments);
    command.stdin(open()).stderr(open()).stdout(Stdio::piped());
    (command.spawn().unwrap(), File::from(master))
}

#[test]
fn keys_pause_an_action_and_let_it_go_on_and_space_stops_it() {
    let (user, simulator) = start();
    let mode = || simulator.control().state().unwrap().motion_mode.clone();
    let play = ["--link", &simulator.link, "play", "arms", "--times", "5"];
    let (child, mut terminal) = start_on_terminal(&user, &play);
    simulator.wait_until_executing();
    terminal.write_all(b"p").unwrap();
    wait_until("it is paused", || mode() == "idle");
    terminal.write_all(b"p").unwrap();
    simulator.wait_until_executing();
    terminal.write_all(b" ").unwrap();
    wait_until("it is stopped", || mode() == "stopped");
    let run = Run::of_child(child);
    assert_eq!(run.status, 1);
    assert!(run.stdout.contains("arms: interrupted by STOP"), "{}", run.stdout);
}
