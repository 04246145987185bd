//! The simulator and its clients as processes of their own.
#![cfg(feature = "cli")]

mod support;

use support::simulator::Simulator;
use support::{Run, User, interrupt, is_png};

#[test]
fn a_session_of_commands_on_a_simulated_serial_port() {
    let user = User::new();
    let mut simulator = Simulator::start(&user);
    let link = simulator.link.clone();
    let robot = |status, arguments: &[&str]| {
        let mut all = vec!["--link", &link];
        all.extend(arguments);
        user.expect(status, &all)
    };

    robot(1, &["do", "1:300"]).told(&["not initialised", "rsapien init"]);
    robot(1, &["look", "--pan", "0", "--tilt", "0"]).told(&["not homed", "rsapien init"]);
    robot(0, &["init"]);
    robot(0, &["do", "1:100"]);
    robot(0, &["look", "--pan", "30", "--tilt", "-10"]);
    robot(0, &["snapshot", "--out", "seen.png"]);
    assert!(is_png(&user.path("seen.png")));

    // Another program's STOP ends an action at once.
    let playing = user.start(&["--link", &link, "play", "dance", "--json"]);
    simulator.wait_until_executing();
    let stopped = robot(0, &["stop"]).stdout;
    // The answer is left to the player, which holds the line.
    for part in ["STOP was sent", "(rsapien play dance)", "hears the answer"] {
        assert!(stopped.contains(part), "{stopped}");
    }
    let run = Run::of_child(playing);
    assert_eq!(run.status, 1, "{}", run.stderr);
    let answer = run.json();
    assert_eq!(answer["outcome"], "interrupted", "{answer}");
    assert_eq!(answer["detail"], "by STOP", "{answer}");
    assert_eq!(simulator.control().state().unwrap().motion_mode, "stopped");

    // A foot that meets something ends the walk.
    robot(0, &["init"]);
    let walking = user.start(&["--link", &link, "play", "walk-forward"]);
    simulator.wait_until_executing();
    simulator.press_left_foot(true);
    let run = Run::of_child(walking);
    assert_eq!(run.status, 1);
    assert!(run.stdout.contains("interrupted by bumper left-foot-front"), "{}", run.stdout);
    simulator.press_left_foot(false);
    let refused = robot(1, &["do", "1"]).stdout;
    assert!(refused.contains("refused (held") && refused.contains("INIT or STOP"), "{refused}");

    // Ctrl-C stops the motors first.
    robot(0, &["init"]);
    let playing = user.start(&["--link", &link, "play", "dance"]);
    simulator.wait_until_executing();
    interrupt(&playing);
    let run = Run::of_child(playing);
    assert_eq!(run.status, 130, "{}{}", run.stdout, run.stderr);
    run.told(&["interrupted"]);
    assert_eq!(simulator.control().state().unwrap().motion_mode, "stopped");

    // The simulator itself ends by Ctrl-C, which is its normal end, and leaves nothing behind.
    interrupt(&simulator.child);
    assert_eq!(simulator.child.wait().unwrap().code(), Some(0));
    assert!(!user.path("robot").exists() && !user.path("robot.control").exists());
}

#[test]
fn a_firmware_that_cannot_run_is_refused_with_what_to_do() {
    let user = User::new();
    let sim = |options: &[&str]| {
        let mut all = vec!["sim", "--tcp", "0"];
        all.extend(options);
        user.expect(2, &all)
    };
    // Nothing is there: a user outside a clone.
    sim(&["--firmware"]).told(&["no firmware in firmware-pic/hex", "name the folder"]);
    sim(&["--simulator", "x"]).told(&["--firmware"]);
    std::fs::create_dir(user.path("hex")).unwrap();
    sim(&["--firmware", "hex"]).told(&["motion controller for 57600 baud in hex", "rsapien-*.hex"]);
    for image in ["motion-18f452", "camera-18f2320"] {
        std::fs::write(user.path(&format!("hex/rsapien-{image}-40mhz-57600.hex")), "").unwrap();
    }
    sim(&["--firmware", "hex", "--baud", "115200"]).told(&["115200 baud", "--baud 57600"]);
    sim(&["--firmware", "hex", "--simulator", "./gone"]).told(&[
        "./gone",
        "does not start",
        "make -C firmware-pic/sim",
    ]);
    // The variable names the simulator, too.
    let mut command = user.command(&["demo", "--firmware", "hex", "--fast"]);
    let output = command.env("RSAPIEN_GPSIM", "/bin/false").output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{told}");
    assert!(told.contains("motion controller's chip has ended"), "{told}");
    user.expect(2, &["demo", "--firmware", "hex", "--link", "tcp://127.0.0.1:1"])
        .told(&["--firmware", "rsapien sim --firmware"]);
}

/// In place of the simulator of a chip: a chip without a firmware, which does nothing and ends after a while.
const DEAD_CHIP: &str = "#!/bin/sh
number=0
while read -r command rest; do
    case $command in
    pins) echo ok ra0 ra1 ra2 rb0 rb1 rb2 rb3 rb4 rb5 rc0 rc1 rc2 rc3 rc4 rc5 rd0 rd1 rd2 rd3 rd4 rd5 rd6 re0 ;;
    get | cycles) echo ok 0 ;;
    advance) number=$((number + 1)); [ $number -lt 50 ] || break; echo ok ${number}0000 ;;
    *) echo ok ;;
    esac
done
echo 'the chip went up in smoke' >&2
";

#[test]
#[cfg(unix)]
fn a_simulator_of_chips_that_ends_is_told_of() {
    use std::os::unix::fs::PermissionsExt;
    let user = User::new();
    for image in ["motion-18f452", "camera-18f2320"] {
        std::fs::write(user.path(&format!("rsapien-{image}-40mhz-57600.hex")), "").unwrap();
    }
    std::fs::write(user.path("chip"), DEAD_CHIP).unwrap();
    std::fs::set_permissions(user.path("chip"), std::fs::Permissions::from_mode(0o755)).unwrap();
    let smoke = ["motion controller's chip has ended: the chip went up in smoke"];
    for options in [["demo", "--fast"], ["sim", "--tcp=0"]] {
        let mut all = options.to_vec();
        all.extend(["--firmware", ".", "--simulator", "./chip"]);
        user.expect(2, &all).told(&smoke);
    }
}
