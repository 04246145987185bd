//! A serial line (a pseudo-terminal), and STOP from a program that does not hold it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use rsapien::protocol::Mode;
use rsapien::{Error, LinkAddress, Robot, RobotOptions, StopOptions, StopSeen, emergency_stop};
use serialport::{SerialPort, TTYPort};

use crate::common::{arms, motors_are_off, virtual_robot};
use crate::links::serve;

#[test]
fn a_serial_line_is_stopped_by_a_program_that_does_not_hold_it() {
    let shared = virtual_robot();
    let (mut master, mut slave) = TTYPort::pair().unwrap();
    master.set_timeout(Duration::from_millis(1)).unwrap();
    slave.set_exclusive(false).unwrap();
    let address = LinkAddress::Serial(slave.name().unwrap());
    let end = Arc::new(AtomicBool::new(false));
    let server = std::thread::spawn({
        let (shared, end) = (Arc::clone(&shared), Arc::clone(&end));
        move || serve(&shared, master, &end)
    });
    let folder = tempfile::tempdir().unwrap();
    let lock_folder = Some(folder.path().to_path_buf());

    // Nobody else has the line open: the robot's answer is seen.
    let options = StopOptions { lock_folder: lock_folder.clone(), ..StopOptions::default() };
    let reports = emergency_stop(&address, &options).unwrap();
    let [report] = reports.as_slice() else { panic!("{reports:?}") };
    assert!(report.is_confirmed() && report.holder.is_none(), "{report}");
    assert!(matches!(report.camera, StopSeen::Answered { mode: Mode::Stopped, .. }));

    let mut options_of_holder = RobotOptions::new("holder");
    options_of_holder.lock_folder.clone_from(&lock_folder);
    let robot = Robot::open(&address, options_of_holder).unwrap();
    let mut motion = robot.motion().unwrap();
    motion.init().unwrap();
    motion.step(arms(1, 60_000)[0]).unwrap();
    let mut second = RobotOptions::new("second");
    second.lock_folder = lock_folder;
    let refused = Robot::open(&address, second).unwrap_err();
    assert!(matches!(&refused, Error::Held { by, .. } if by.program == "holder"), "{refused}");

    let reports = emergency_stop(&address, &options).unwrap();
    let holder = reports[0].holder.as_ref().map(|holder| holder.program.as_str());
    assert_eq!(holder, Some("holder"), "{reports:?}");
    assert!(motors_are_off(&shared));
    let stopped = |state: &rsapien::RobotState| {
        state.motion_report().is_some_and(|report| report.mode == Mode::Stopped)
    };
    assert!(motion.wait_for(2_000, stopped).unwrap().is_some());
    drop((motion, robot));
    end.store(true, Ordering::SeqCst);
    server.join().unwrap();
}

#[test]
fn ports_that_are_missing_or_no_ports_are_told_so() {
    let gone = LinkAddress::Serial("/dev/no-such-port".to_owned());
    let error = Robot::open(&gone, RobotOptions::new("test")).unwrap_err();
    assert!(matches!(error, Error::LinkNotFound { .. }), "{error}");
    let file = LinkAddress::Serial(std::env::current_exe().unwrap().display().to_string());
    let error = Robot::open(&file, RobotOptions::new("test")).unwrap_err();
    assert!(matches!(error, Error::LinkOpen { .. }), "{error}");
}
