//! Links in real time: TCP, the virtual robot's own pace, and locks between processes.

use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::net::TcpListener;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use rsapien::link::virtual_robot::{Pace, SharedVirtualRobot};
use rsapien::protocol::Mode;
use rsapien::{
    Error, Holder, LineLock, LinkAddress, LinkState, Robot, RobotOptions, StopOptions,
    emergency_stop,
};

use crate::common::{lock, virtual_robot};

/// Passes a virtual robot's line on, in real time, until it is told to end or the other side goes.
pub(crate) fn serve(robot: &SharedVirtualRobot, mut stream: impl Read + Write, end: &AtomicBool) {
    let origin = Instant::now();
    let origin_ms = lock(robot).now_ms();
    while !end.load(Ordering::SeqCst) {
        let mut buffer = [0; 64];
        match stream.read(&mut buffer) {
            Ok(0) => return,
            Ok(count) => lock(robot).send(&buffer[..count]),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
            Err(_) => return,
        }
        let elapsed_ms = u64::try_from(origin.elapsed().as_millis()).unwrap();
        let mut answer = Vec::new();
        let mut robot = lock(robot);
        robot.advance_to(origin_ms + elapsed_ms);
        robot.receive(&mut answer);
        drop(robot);
        if stream.write_all(&answer).is_err() {
            return;
        }
    }
}

struct Server {
    address: LinkAddress,
    end: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Server {
    /// A TCP server for one robot, one connection after the other.
    fn start(robot: &SharedVirtualRobot, listener: TcpListener) -> Server {
        let target = listener.local_addr().unwrap().to_string();
        let end = Arc::new(AtomicBool::new(false));
        listener.set_nonblocking(true).unwrap();
        let thread = std::thread::spawn({
            let (end, robot) = (Arc::clone(&end), Arc::clone(robot));
            move || {
                while !end.load(Ordering::SeqCst) {
                    match listener.accept() {
                        Ok((stream, _)) => {
                            stream.set_nonblocking(false).unwrap();
                            stream.set_read_timeout(Some(Duration::from_millis(1))).unwrap();
                            serve(&robot, stream, &end);
                        }
                        Err(_) => std::thread::sleep(Duration::from_millis(1)),
                    }
                }
            }
        });
        Server { address: LinkAddress::Tcp(target), end, thread: Some(thread) }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.end.store(true, Ordering::SeqCst);
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

#[test]
fn a_tcp_line_is_used_lost_and_opened_again() {
    let shared = virtual_robot();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let again = listener.try_clone().unwrap();
    let server = Server::start(&shared, listener);
    let robot = Robot::open(&server.address, RobotOptions::new("test")).unwrap();
    let motion = robot.motion().unwrap();
    assert_eq!(motion.state().motion_report().unwrap().mode, Mode::Fresh);
    assert_eq!(robot.link_name(), server.address.to_string());

    drop(server);
    let lost = |state: &rsapien::RobotState| matches!(state.link, LinkState::Lost { .. });
    assert!(motion.wait_for(2_000, lost).unwrap().is_some());
    let _server = Server::start(&shared, again);
    let up = |state: &rsapien::RobotState| state.link == LinkState::Up;
    let state = motion.wait_for(3_000, up).unwrap().expect("the link comes back");
    assert_eq!(state.counts.reconnects, 1);
}

#[test]
fn a_target_where_nobody_listens_is_told_so() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let target = listener.local_addr().unwrap().to_string();
    drop(listener);
    let address = LinkAddress::Tcp(target);
    let error = Robot::open(&address, RobotOptions::new("test")).unwrap_err();
    assert!(matches!(error, Error::LinkOpen { .. }), "{error}");
    assert!(error.to_string().contains(&address.to_string()));
}

#[test]
fn a_stop_on_a_link_that_breaks_is_told_as_unknown() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = LinkAddress::Tcp(listener.local_addr().unwrap().to_string());
    let closer = std::thread::spawn(move || drop(listener.accept().unwrap()));
    let error = emergency_stop(&address, &StopOptions::default()).unwrap_err();
    closer.join().unwrap();
    assert!(matches!(error, Error::OutcomeUnknown { .. }), "{error}");
    assert!(error.to_string().contains(&address.to_string()), "{error}");
}

#[test]
fn a_virtual_robot_in_real_time_is_kept_alive_and_stops_at_once() {
    let shared = virtual_robot();
    let robot =
        Robot::virtual_with(Arc::clone(&shared), Pace::Real, RobotOptions::new("test")).unwrap();
    let motion = robot.motion().unwrap();
    let before = motion.state().counts;
    let begun = Instant::now();
    robot.sleep_ms(450).unwrap();
    let elapsed_ms = begun.elapsed().as_millis();
    assert!((440..1_000).contains(&elapsed_ms), "{elapsed_ms} ms");
    // Both controllers, every 100 ms.
    let asked = motion.state().counts.sent - before.sent;
    assert!((6..=12).contains(&asked), "asked {asked} times");
    let begun = Instant::now();
    robot.stop().unwrap();
    assert!(begun.elapsed() < Duration::from_millis(200));
    assert_eq!(lock(&shared).motion_report().mode, Mode::Stopped);
}

const FOLDER_VARIABLE: &str = "RSAPIEN_TEST_LOCK_FOLDER";

/// Not a test by itself: the other process of the test below.
#[test]
#[ignore = "is run by another test as a process of its own"]
fn holds_a_line_until_it_is_killed() {
    let Some(folder) = std::env::var_os(FOLDER_VARIABLE) else { return };
    let holder = Holder::this_process("the other program");
    let _lock = LineLock::take(folder.as_ref(), "/dev/robot", &holder).unwrap();
    println!("\nheld");
    std::thread::sleep(Duration::from_secs(20));
}

struct Killed(Child);

impl Drop for Killed {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn a_line_held_by_another_process_is_free_when_that_is_killed() {
    let folder = tempfile::tempdir().unwrap();
    let child = Command::new(std::env::current_exe().unwrap())
        .args(["--ignored", "--exact", "--nocapture", "links::holds_a_line_until_it_is_killed"])
        .env(FOLDER_VARIABLE, folder.path())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut other = Killed(child);
    let output = BufReader::new(other.0.stdout.take().unwrap());
    let held = output.lines().map_while(Result::ok).any(|line| line == "held");
    assert!(held, "the other process has ended");

    let us = Holder::this_process("test");
    let refused = LineLock::take(folder.path(), "/dev/robot", &us).unwrap_err();
    let Error::Held { by, .. } = &refused else { panic!("{refused}") };
    assert_eq!((by.pid, by.program.as_str()), (other.0.id(), "the other program"));
    assert!(refused.to_string().contains("(the other program)"), "{refused}");
    drop(other);
    LineLock::take(folder.path(), "/dev/robot", &us).unwrap();
}
