//! `top` and `teach` on a terminal, with a robot behind a simulated serial port.
#![cfg(all(feature = "cli", unix))]

mod support;

use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::num::NonZero;
use std::process::Child;
use std::sync::{Arc, Mutex};

use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{Winsize, tcsetwinsize};
use support::simulator::Simulator;
use support::{Run, User, wait_until};

const LEFT: &[u8] = b"\x1b[D";
const RIGHT: &[u8] = b"\x1b[C";
const DOWN: &[u8] = b"\x1b[B";
const CTRL_C: &[u8] = b"\x03";

fn size(cells: u16) -> NonZero<u16> {
    NonZero::new(cells).unwrap()
}

/// A command on a terminal of 80 columns and 24 lines.
struct OnTerminal {
    child: Child,
    keys: File,
    screen: Arc<Mutex<vt100::Parser>>,
}

impl OnTerminal {
    fn start(user: &User, arguments: &[&str]) -> OnTerminal {
        let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
        grantpt(&master).unwrap();
        unlockpt(&master).unwrap();
        let winsize = Winsize { ws_row: 24, ws_col: 80, ws_xpixel: 0, ws_ypixel: 0 };
        tcsetwinsize(&master, winsize).unwrap();
        let name = ptsname(&master, Vec::new()).unwrap();
        let open =
            || OpenOptions::new().read(true).write(true).open(name.to_str().unwrap()).unwrap();
        let mut command = user.command(arguments);
        command.stdin(open()).stdout(open()).stderr(open()).env("TERM", "xterm");
        let child = command.spawn().unwrap();
        let keys = File::from(master);
        let mut output = keys.try_clone().unwrap();
        let screen = Arc::new(Mutex::new(vt100::Parser::new(size(24), size(80), 0)));
        let into = Arc::clone(&screen);
        std::thread::spawn(move || {
            let mut buffer = [0; 4096];
            // A terminal whose last program has gone gives an error.
            while let Ok(count @ 1..) = output.read(&mut buffer) {
                into.lock().unwrap().process(&buffer[..count]);
            }
        });
        OnTerminal { child, keys, screen }
    }

    fn press(&mut self, keys: &[u8]) {
        self.keys.write_all(keys).unwrap();
    }

    fn wait_for(&self, text: &str) {
        wait_until(text, || self.screen.lock().unwrap().screen().contents().contains(text));
    }

    /// Waits for its end, with the terminal as it was.
    fn ends(self, status: i32) {
        let run = Run::of_child(self.child);
        let parser = self.screen.lock().unwrap();
        assert_eq!(run.status, status, "{}", parser.screen().contents());
        assert!(!parser.screen().alternate_screen() && !parser.screen().hide_cursor());
    }
}

fn start() -> (User, Simulator) {
    let user = User::new();
    let simulator = Simulator::start(&user);
    user.expect(0, &["--link", &simulator.link, "init"]);
    (user, simulator)
}

fn mode(simulator: &Simulator) -> String {
    simulator.control().state().unwrap().motion_mode
}

#[test]
fn top_plays_by_keys_space_stops_and_other_programs_play_through_it() {
    let (user, simulator) = start();
    let mut top = OnTerminal::start(&user, &["--link", &simulator.link, "top"]);
    top.wait_for("idle");
    top.press(b"pwave\r");
    simulator.wait_until_executing();
    top.press(b" ");
    wait_until("it stops", || mode(&simulator) == "stopped");
    top.wait_for("wave: interrupted by STOP");
    let lean = user.expect(0, &["--link", &simulator.link, "do", "tilt-left:300", "tilt-mid:300"]);
    assert!(lean.stdout.contains("rsapien top"), "{}", lean.stdout);
    // The hand: one joint further.
    top.press(DOWN);
    top.press(DOWN);
    top.press(RIGHT);
    let hand = || simulator.control().state().unwrap().joints[2].position;
    wait_until("the hand is open", || hand() > 0.99);
    top.press(b"q");
    top.ends(0);
}

#[test]
fn ctrl_c_leaves_top_with_the_motors_off() {
    let (user, simulator) = start();
    let mut top = OnTerminal::start(&user, &["--link", &simulator.link, "top"]);
    top.wait_for("idle");
    top.press(b"pdance\r");
    simulator.wait_until_executing();
    top.press(CTRL_C);
    top.ends(130);
    let state = simulator.control().state().unwrap();
    assert!(state.joints.iter().all(|joint| joint.motor == "off"), "{state:?}");
}

#[test]
fn an_action_is_taught_by_keys_and_bumpers_and_saved() {
    let (user, simulator) = start();
    let mut teach = OnTerminal::start(&user, &["--link", &simulator.link, "teach", "greet"]);
    teach.wait_for("not marked yet");
    teach.press(LEFT);
    let arm = || simulator.control().state().unwrap().joints[0].position;
    wait_until("the arm is up", || arm() < 0.01);
    teach.press(b"\r");
    teach.wait_for("step 1 is marked");
    for key in [DOWN, DOWN, DOWN, DOWN, LEFT] {
        teach.press(key);
    }
    teach.wait_for("tilt-left");
    let press = rsapien_sim::control::BumperName::new(4).unwrap();
    let press = rsapien_sim::control::ControlRequest::Press { press, held: true };
    simulator.control().request(&press).unwrap();
    teach.wait_for("step 2 is marked");
    teach.press(b"w");
    teach.ends(0);
    let text = user.expect(0, &["actions", "show", "greet", "--text"]).stdout;
    assert!(text.contains("do right-arm-up for") && text.contains("do tilt-left for"), "{text}");
    user.expect(2, &["actions", "check", "greet.rsa"]).told(&["greet.rsa"]);
}

#[test]
fn what_is_taught_and_not_saved_is_kept_in_a_file() {
    let (user, simulator) = start();
    let mut teach = OnTerminal::start(&user, &["--link", &simulator.link, "teach", "greet"]);
    teach.wait_for("not marked yet");
    teach.press(LEFT);
    teach.press(b"\r");
    teach.wait_for("step 1 is marked");
    teach.press(CTRL_C);
    teach.wait_for("actions add --file greet.rsa");
    teach.ends(130);
    user.expect(0, &["actions", "add", "--file", "greet.rsa"]);
    // Now the name is taken.
    let refused = OnTerminal::start(&user, &["--link", &simulator.link, "teach", "greet"]);
    refused.wait_for("--replace");
    assert_eq!(Run::of_child(refused.child).status, 2);
}

#[test]
fn what_is_no_terminal_gets_no_screen() {
    let user = User::new();
    user.expect(2, &["top"]).told(&["this is none", "rsapien state --watch"]);
    user.expect(2, &["teach", "greet"]).told(&["this is none", "actions edit"]);
}
