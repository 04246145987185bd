//! Endpoints, spoken to with bytes worked out by hand from the specification of the link.

use std::fs::{self, File, OpenOptions};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::time::{Duration, Instant};

use super::*;
use crate::control::{CableEnd, ControlClient, ControlRequest};
use crate::world::World;

/// HELLO to the motion controller: versions 1 to 1, session and tag 0x2a and 1.
const HELLO: [u8; 18] = [
    0xC9, 0x80, 0x2A, 0x01, 0x01, 0x01, 0x01, 0x2A, 0x80, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x1C,
    0x3D, 0x02,
];
/// Its answer by a robot just switched on: version 1, firmware 0.1.0, 40 MHz, 32 places, dead-man 500 ms, nothing
/// executed, boot 1, no errors, power-on.
const HELLO_ANSWER: [u8; 25] = [
    0xE9, 0x80, 0x2A, 0x01, 0x01, 0x00, 0x01, 0x00, 0x90, 0x01, 0x00, 0x28, 0x20, 0x74, 0x01, 0x80,
    0x00, 0x00, 0x00, 0x01, 0x00, 0x03, 0x74, 0x4E, 0x03,
];
/// STATE to the camera controller, and the header and echo of its answer.
const CAMERA_STATE: [u8; 18] = [
    0xD1, 0x80, 0x2A, 0x01, 0x02, 0x00, 0x00, 0x00, 0x80, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x0B,
    0x6F, 0x03,
];
const CAMERA_STATE_ANSWER_START: [u8; 5] = [0xF1, 0x80, 0x2A, 0x01, 0x02];

fn config() -> SimulatorConfig {
    let robot = VirtualRobotConfig { world: World::empty(), ..VirtualRobotConfig::default() };
    SimulatorConfig { robot, ..SimulatorConfig::default() }
}

fn on_terminal(folder: &Path) -> SimulatorConfig {
    SimulatorConfig { pty: Some(folder.join("robot")), ..config() }
}

fn open(link: &Path) -> File {
    OpenOptions::new().read(true).write(true).open(link).expect("the terminal opens")
}

/// Reads exactly as many bytes as an answer has, in a thread, so that silence fails and does not hang.
fn read_answer(mut from: impl Read + Send + 'static) -> [u8; 25] {
    let (sender, receiver) = std::sync::mpsc::channel();
    thread::spawn(move || {
        let mut answer = [0; 25];
        // When the test has given up nobody listens any more.
        let _ = sender.send(from.read_exact(&mut answer).map(|()| answer));
    });
    let answer = receiver.recv_timeout(Duration::from_secs(5)).expect("an answer in time");
    answer.expect("an answer")
}

#[test]
fn a_terminal_answers_any_program_and_survives_its_closing() {
    let folder = tempfile::tempdir().expect("a folder");
    let simulator = Simulator::start(on_terminal(folder.path())).expect("starts");
    let link = simulator.link().expect("a link").to_owned();
    assert_eq!(fs::read_link(&link).ok().as_deref(), simulator.terminal());
    for _ in 0..3 {
        let mut terminal = open(&link);
        terminal.write_all(&HELLO).expect("written");
        assert_eq!(read_answer(terminal), HELLO_ANSWER);
    }
    let mut terminal = open(&link);
    terminal.write_all(&CAMERA_STATE).expect("written");
    assert_eq!(read_answer(terminal)[..5], CAMERA_STATE_ANSWER_START);
    simulator.stop();
    assert!(fs::symlink_metadata(&link).is_err(), "the link is removed");
    assert!(fs::read_dir(folder.path()).expect("a folder").next().is_none(), "nothing is left");
}

#[test]
fn links_left_behind_are_replaced_and_nothing_else_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let link = folder.path().join("robot");
    std::os::unix::fs::symlink("/dev/pts/99999", &link).expect("a stale link");
    let first = Simulator::start(on_terminal(folder.path())).expect("replaces a stale link");
    let second = Simulator::start(on_terminal(folder.path())).expect_err("in use");
    assert!(matches!(second, SimulatorError::InUse { .. }), "{second}");
    assert!(link.exists(), "the first one's link is untouched");
    first.stop();

    fs::write(&link, "a letter").expect("a file");
    let refused = Simulator::start(on_terminal(folder.path())).expect_err("a file");
    assert!(matches!(refused, SimulatorError::Taken { .. }), "{refused}");
    assert_eq!(fs::read_to_string(&link).expect("still there"), "a letter");
    fs::rename(&link, folder.path().join("letter")).expect("moved");
    std::os::unix::fs::symlink(folder.path().join("letter"), &link).expect("a link to it");
    let refused = Simulator::start(on_terminal(folder.path())).expect_err("somebody's link");
    assert!(matches!(refused, SimulatorError::Taken { .. }), "{refused}");
    let missing = SimulatorConfig { pty: Some("/nowhere/at/all".into()), ..config() };
    let refused = Simulator::start(missing).expect_err("no folder");
    assert!(matches!(refused, SimulatorError::Path { .. }), "{refused}");
    assert!(refused.to_string().contains("no such folder"), "{refused}");
    for (control, reason) in
        [("/nowhere/at/all".to_owned(), "no such folder"), ("x".repeat(200), "too long")]
    {
        let control = folder.path().join(control);
        let refused = Simulator::start(SimulatorConfig { control: Some(control), ..config() });
        let refused = refused.expect_err("no place for a socket").to_string();
        assert!(refused.contains(reason), "{refused}");
    }
    assert!(matches!(Simulator::start(config()), Err(SimulatorError::NoEndpoint)));
}

#[test]
fn every_tcp_client_hears_every_answer() {
    let config = SimulatorConfig { tcp: Some("0".to_owned()), ..config() };
    let simulator = Simulator::start(config).expect("starts");
    let address = simulator.tcp_address().expect("an address");
    assert!(address.ip().is_loopback() && address.port() != 0);
    let mut one = TcpStream::connect(address).expect("connects");
    let two = TcpStream::connect(address).expect("connects");
    let gone = TcpStream::connect(address).expect("connects");
    drop(gone);
    // The second one is an end of the line once its thread has taken it.
    thread::sleep(Duration::from_millis(50));
    one.write_all(&HELLO[..7]).expect("written");
    one.write_all(&HELLO[7..]).expect("written");
    assert_eq!(read_answer(one.try_clone().expect("a clone")), HELLO_ANSWER);
    assert_eq!(read_answer(two), HELLO_ANSWER);
    one.write_all(&vec![0x55; 100_000]).expect("rubbish is taken");
    drop(one);
    let begin = Instant::now();
    simulator.stop();
    assert!(begin.elapsed() < Duration::from_secs(2), "stops while rubbish waits");
    assert!(TcpStream::connect(address).is_err(), "nobody listens any more");
}

#[test]
fn other_machines_are_kept_out_unless_allowed() {
    let outside = SimulatorConfig { tcp: Some("0.0.0.0:0".to_owned()), ..config() };
    let refused = Simulator::start(outside.clone()).expect_err("refused");
    assert!(matches!(refused, SimulatorError::NotLoopback { .. }), "{refused}");
    let allowed = SimulatorConfig { allow_remote: true, ..outside };
    Simulator::start(allowed).expect("starts").stop();
}

#[test]
fn real_time_is_real_and_a_factor_speeds_it_up() {
    for factor in [1.0, 50.0] {
        let clock = Clock::Paced { factor };
        let config = SimulatorConfig { tcp: Some("0".to_owned()), clock, ..config() };
        let simulator = Simulator::start(config).expect("starts");
        let now_ms = || simulator.robot().lock().now_ms();
        let (begin, begin_ms) = (Instant::now(), now_ms());
        thread::sleep(Duration::from_millis(200));
        let virtual_ms = u32::try_from(now_ms() - begin_ms).expect("short");
        let ratio = f64::from(virtual_ms) / (begin.elapsed().as_secs_f64() * 1000.0 * factor);
        // A loaded machine may let the clock fall behind, and it never runs ahead.
        assert!((0.1..1.1).contains(&ratio), "{ratio} of the pace {factor}");
    }
    let clock = Clock::Paced { factor: f64::NAN };
    let refused =
        Simulator::start(SimulatorConfig { tcp: Some("0".to_owned()), clock, ..config() });
    assert!(matches!(refused, Err(SimulatorError::Factor { .. })));
}

#[test]
fn a_pulled_cable_is_silent_and_the_control_channel_is_not() {
    let folder = tempfile::tempdir().expect("a folder");
    let config = SimulatorConfig { clock: Clock::Manual, ..on_terminal(folder.path()) };
    let simulator = Simulator::start(config).expect("starts");
    let mut control =
        ControlClient::connect(simulator.control_path().expect("a path")).expect("connects");
    let advance = ControlRequest::Advance { advance_ms: 20 };
    let mut terminal = open(simulator.link().expect("a link"));
    // The manual clock stands still until a package is on the line.
    let wait_for_package = || {
        let patience = Instant::now() + Duration::from_secs(5);
        while simulator.robot().lock().unsent() == 0 {
            assert!(Instant::now() < patience, "the terminal is not read");
            thread::sleep(Duration::from_millis(1));
        }
    };
    for cable in [CableEnd::Pulled, CableEnd::Plugged] {
        control.request(&ControlRequest::Cable { cable }).expect("done");
        terminal.write_all(&HELLO).expect("written");
        wait_for_package();
        let done_at_ms = control.request(&advance).expect("done");
        assert_eq!(done_at_ms % 20, 0);
    }
    // Were the first package answered too, two answers would stand here.
    assert_eq!(read_answer(terminal.try_clone().expect("a clone")), HELLO_ANSWER);
    terminal.write_all(&CAMERA_STATE).expect("written");
    wait_for_package();
    control.request(&advance).expect("done");
    assert_eq!(read_answer(terminal)[..5], CAMERA_STATE_ANSWER_START);
}

#[test]
fn a_free_clock_outruns_the_wall_clock_and_trips_no_dead_man() {
    use rsapien_protocol::{Address, Mode, Report, Request, Session, SessionConfig, SessionEvent};

    let config = SimulatorConfig { tcp: Some("0".to_owned()), clock: Clock::Free, ..config() };
    let simulator = Simulator::start(config).expect("starts");
    let mut stream =
        TcpStream::connect(simulator.tcp_address().expect("an address")).expect("connects");
    stream.set_read_timeout(Some(Duration::from_millis(5))).expect("set");
    let mut session = Session::new(SessionConfig::default());
    let (begin, begin_ms) = (Instant::now(), simulator.robot().lock().now_ms());
    let now_ms = || u64::try_from(begin.elapsed().as_millis()).expect("short");
    session.open(Address::Motion).expect("free");
    let (mut initialised, mut buffer) = (false, [0; 256]);
    while begin.elapsed() < Duration::from_secs(10) {
        while let Some(bytes) = session.poll_transmit(now_ms()) {
            stream.write_all(&bytes).expect("written");
        }
        if let Ok(count) = stream.read(&mut buffer) {
            session.handle_bytes(&buffer[..count], now_ms());
        }
        session.handle_timeout(now_ms());
        let Some(event) = session.poll_event() else { continue };
        let SessionEvent::Answered { package, .. } = event else { panic!("{event:?}") };
        if let Report::Motion(report) = package.report {
            assert_ne!(report.mode, Mode::Held, "{report:?}");
            if report.mode == Mode::Idle {
                let virtual_ms = simulator.robot().lock().now_ms() - begin_ms;
                assert!(virtual_ms > 2 * now_ms(), "{virtual_ms} ms in {} ms", now_ms());
                return;
            }
        }
        // A leisurely program: a look at the robot every 20 ms.
        thread::sleep(Duration::from_millis(20));
        let next = if initialised { Request::State } else { Request::Init };
        initialised = true;
        session.request(Address::Motion, next).expect("free");
    }
    panic!("not initialised in time");
}
