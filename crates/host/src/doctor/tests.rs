//! The steps against a virtual robot with faults, and against system files made for the test.

use std::fs;
use std::os::unix::fs::symlink;
use std::sync::{Arc, Mutex};

use rsapien_protocol::{
    ACTION_PACKAGE_LENGTH, ActionView, Address, Direction, Kind, Mode, Receiver,
};
use rsapien_sim::line::LineFaults;
use tempfile::TempDir;

use super::device::Device;
use super::machine::Machine;
use super::permission::{self, Access};
use super::{Connections, Diagnosis, DoctorOptions, Finding, LineQuality, Severity, examine_over};
use crate::link::virtual_robot::{Pace, SharedVirtualRobot, VirtualConnector, VirtualOptions};
use crate::link::{Connect, Link, RealClock};
use crate::lock::LineLock;
use crate::{Error, Holder, LinkAddress};

const PORT: &str = "/dev/ttyUSB0";

/// A computer with one FTDI adapter, in a folder of its own.
struct Computer {
    root: TempDir,
}

impl Computer {
    fn new() -> Computer {
        let computer = Computer { root: tempfile::tempdir().unwrap() };
        let port = "sys/devices/usb1/1-2/1-2:1.0/ttyUSB0";
        computer.write("sys/devices/usb1/1-2/idVendor", "0403\n");
        computer.write("sys/devices/usb1/1-2/idProduct", "6001\n");
        computer.write("sys/devices/usb1/1-2/product", "FT232R USB UART\n");
        computer.write(&format!("{port}/latency_timer"), "16\n");
        computer.write("sys/bus/usb-serial/drivers/ftdi_sio/uevent", "");
        computer.link("../../../../../bus/usb-serial/drivers/ftdi_sio", &format!("{port}/driver"));
        computer.link("../../../devices/usb1/1-2/1-2:1.0/ttyUSB0", "sys/class/tty/ttyUSB0/device");
        computer.link(
            "../../../devices/usb1/1-2/1-2:1.0/ttyUSB0",
            "sys/bus/usb-serial/devices/ttyUSB0",
        );
        // A port that the PC names, but does not have.
        computer.write("sys/class/tty/ttyS0/device/uevent", "");
        computer.write("sys/class/tty/ttyS0/type", "0\n");
        computer.write(&PORT[1..], "");
        computer
    }

    fn write(&self, path: &str, text: &str) {
        let path = self.root.path().join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }

    fn link(&self, target: &str, path: &str) {
        let path = self.root.path().join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        symlink(target, path).unwrap();
    }

    fn process(&self, pid: u32, name: &str, open: &str) {
        self.write(&format!("proc/{pid}/comm"), &format!("{name}\n"));
        self.link(open, &format!("proc/{pid}/fd/3"));
    }

    fn options(&self) -> DoctorOptions {
        let system_root = self.root.path().to_path_buf();
        DoctorOptions { system_root, measure_ms: 300, ..DoctorOptions::default() }
    }

    fn device(&self) -> Device {
        Device::at(PORT, &Machine::new(self.root.path()))
    }
}

/// The line to a virtual robot, with what was sent; a robot without a camera controller does not hear its packages.
struct Tapped {
    inner: VirtualConnector,
    sent: Arc<Mutex<Vec<u8>>>,
    has_camera: bool,
    hears: bool,
}

struct TappedLink {
    inner: Box<dyn Link>,
    sent: Arc<Mutex<Vec<u8>>>,
    has_camera: bool,
    hears: bool,
}

impl Connect for Tapped {
    fn name(&self) -> String {
        PORT.to_owned()
    }

    fn lock_key(&self) -> Option<String> {
        Some(PORT.to_owned())
    }

    fn connect(&mut self, clock: RealClock) -> Result<Box<dyn Link>, Error> {
        let inner = self.inner.connect(clock)?;
        let sent = Arc::clone(&self.sent);
        Ok(Box::new(TappedLink { inner, sent, has_camera: self.has_camera, hears: self.hears }))
    }
}

impl Link for TappedLink {
    fn now_ms(&self) -> u64 {
        self.inner.now_ms()
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Error> {
        self.sent.lock().unwrap().extend(bytes);
        let is_to_camera = bytes.first() == Some(&0xd1);
        if !self.hears || (is_to_camera && !self.has_camera) {
            return Ok(());
        }
        self.inner.send(bytes)
    }

    fn receive(&mut self, buffer: &mut [u8], until_ms: u64) -> Result<usize, Error> {
        self.inner.receive(buffer, until_ms)
    }

    fn flush_input(&mut self) -> Result<(), Error> {
        self.inner.flush_input()
    }
}

/// A robot behind the adapter, and how it is examined.
struct Patient {
    computer: Computer,
    robot: SharedVirtualRobot,
    sent: Arc<Mutex<Vec<u8>>>,
    has_camera: bool,
    baud: u32,
}

impl Patient {
    fn new() -> Patient {
        let robot = VirtualOptions::default().build().unwrap();
        robot.lock().unwrap().advance_to(200);
        Patient {
            computer: Computer::new(),
            robot,
            sent: Arc::default(),
            has_camera: true,
            baud: 57_600,
        }
    }

    fn examine_with(&self, address: &LinkAddress, options: &DoctorOptions) -> Diagnosis {
        let connections: &mut Connections<'_> = &mut |link: &LinkAddress, baud| {
            assert_eq!(link, &LinkAddress::Serial(PORT.to_owned()));
            Ok(Box::new(Tapped {
                inner: VirtualConnector::new(Arc::clone(&self.robot), Pace::Fast),
                sent: Arc::clone(&self.sent),
                has_camera: self.has_camera,
                hears: baud == self.baud,
            }))
        };
        let mut told = Vec::new();
        let diagnosis = examine_over(address, connections, options, &mut |finding: &Finding| {
            told.push(finding.clone());
        });
        assert_eq!(told, diagnosis.findings, "each finding is told as it comes");
        diagnosis
    }

    fn examine(&self) -> Diagnosis {
        self.examine_with(&LinkAddress::Serial(PORT.to_owned()), &self.computer.options())
    }
}

#[track_caller]
fn finding<'a>(diagnosis: &'a Diagnosis, code: &str) -> &'a Finding {
    let found = diagnosis.findings.iter().find(|finding| finding.code == code);
    found.unwrap_or_else(|| panic!("{code} is not among {:#?}", diagnosis.findings))
}

/// The findings that are problems.
fn problems(diagnosis: &Diagnosis) -> Vec<&str> {
    let is_problem = |finding: &&Finding| finding.severity == Severity::Problem;
    diagnosis.findings.iter().filter(is_problem).map(|finding| finding.code).collect()
}

#[test]
fn a_healthy_robot_is_healthy_whichever_way_it_is_named() {
    let patient = Patient::new();
    for address in [LinkAddress::Serial(PORT.to_owned()), LinkAddress::Auto] {
        let mut options = patient.computer.options();
        options.firmware_expected = Some([0, 1, 0]);
        let diagnosis = patient.examine_with(&address, &options);
        assert!(diagnosis.is_healthy(), "{diagnosis:#?}");
        assert_eq!(diagnosis.link.as_deref(), Some(PORT));
        assert!(diagnosis.verdict().text.contains("healthy"));
        assert!(diagnosis.verdict().next.contains("rsapien init"));
        let port = &finding(&diagnosis, "port").found;
        assert_eq!(port, "/dev/ttyUSB0: FT232R USB UART (0403:6001), driver ftdi_sio");
        let latency = finding(&diagnosis, "latency-long");
        assert_eq!(latency.severity, Severity::Advice);
        assert!(latency.remedies[0].contains("/sys/bus/usb-serial/devices/ttyUSB0/latency_timer"));
        let quality = diagnosis.line.unwrap();
        assert!(quality.requests > 20 && quality.lost == 0 && quality.resent == 0, "{quality:?}");
        assert_eq!((quality.errors_here, quality.errors_there), (0, Some(0)));
        assert!((8..=12).contains(&quality.round_trip_median_ms), "{quality:?}");
        assert!(quality.round_trip_worst_ms >= quality.round_trip_median_ms);
    }
    patient.computer.write("sys/devices/usb1/1-2/1-2:1.0/ttyUSB0/latency_timer", "1\n");
    assert_eq!(finding(&patient.examine(), "latency-short").severity, Severity::Good);
}

#[test]
fn nothing_but_hello_state_and_counters_is_sent_and_nothing_moves() {
    let mut patient = Patient::new();
    for (baud, has_camera) in [(57_600, true), (38_400, false)] {
        (patient.baud, patient.has_camera) = (baud, has_camera);
        patient.examine();
    }
    let sent = patient.sent.lock().unwrap().clone();
    let mut kinds = Vec::new();
    for package in sent.chunks(ACTION_PACKAGE_LENGTH) {
        let address = if package[0] == 0xd1 { Address::Camera } else { Address::Motion };
        let mut receiver = Receiver::for_robot(address);
        let content = receiver.feed_slice(package, 0).0.expect("an intact package");
        kinds.push(ActionView::new(content.action()).kind().unwrap());
    }
    assert!(kinds.len() > 50, "{} packages", kinds.len());
    for kind in kinds {
        assert!(matches!(kind, Kind::Hello | Kind::State | Kind::Counters), "{kind}");
    }
    let robot = patient.robot.lock().unwrap();
    assert_eq!((robot.motors().running(), robot.motion_report().mode), (0, Mode::Fresh));
}

#[test]
fn a_robot_at_another_speed_is_found_and_its_speed_named() {
    let patient = Patient { baud: 19_200, ..Patient::new() };
    let diagnosis = patient.examine();
    assert_eq!(problems(&diagnosis), ["other-speed"]);
    let speed = finding(&diagnosis, "other-speed");
    assert!(speed.found.contains("speaks at 19200 baud, not at 57600"), "{}", speed.found);
    assert!(diagnosis.verdict().next.contains("--baud 19200"));
    assert!(diagnosis.motion.is_some() && diagnosis.camera.is_some(), "the other steps go on");
}

#[test]
fn silent_firmware_ends_the_examination_with_what_to_look_at() {
    let patient = Patient::new();
    patient.robot.lock().unwrap().power_off();
    let diagnosis = patient.examine();
    assert_eq!(problems(&diagnosis), ["silent"]);
    let next = diagnosis.verdict().next;
    assert!(next.contains("status LED"), "{next}");
    for step in ["firmware", "resets", "sensors", "line"] {
        let found = diagnosis.findings.iter().find(|finding| finding.check == step).unwrap();
        assert_eq!(found.severity, Severity::NotReached, "{step}");
    }
    assert!(!diagnosis.is_healthy() && diagnosis.link.is_none());
}

#[test]
fn answers_that_are_never_intact_are_told_from_silence() {
    let patient = Patient::new();
    let faults = LineFaults { lost_ppm: 300_000, ..LineFaults::NONE };
    patient.robot.lock().unwrap().set_line_faults(Direction::ToPc, faults);
    let diagnosis = patient.examine();
    assert_eq!(problems(&diagnosis), ["garbled"]);
    assert!(diagnosis.verdict().next.contains("diodes"));
}

#[test]
fn a_robot_without_a_camera_controller_is_healthy_with_advice() {
    let patient = Patient { has_camera: false, ..Patient::new() };
    let diagnosis = patient.examine();
    assert_eq!(finding(&diagnosis, "no-camera").severity, Severity::Advice);
    assert!(diagnosis.is_healthy() && diagnosis.camera.is_none());
}

#[test]
fn firmware_of_another_version_is_named_with_the_side_to_update() {
    let patient = Patient::new();
    let mut options = patient.computer.options();
    let address = LinkAddress::Serial(PORT.to_owned());
    for (expected, code, remedy) in [
        ([0, 2, 0], "firmware-version", "flash"),
        ([0, 0, 9], "firmware-version", "update this program"),
        ([0, 1, 1], "firmware-patch", "flash"),
    ] {
        options.firmware_expected = Some(expected);
        let diagnosis = patient.examine_with(&address, &options);
        let found = finding(&diagnosis, code);
        assert!(found.remedies[0].contains(remedy), "{found:?}");
        assert_eq!(diagnosis.is_healthy(), code == "firmware-patch");
    }
}

#[test]
fn supply_and_switches_at_rest_are_judged() {
    let patient = Patient::new();
    {
        let mut robot = patient.robot.lock().unwrap();
        robot.set_supply_mv(4_800);
        robot.press_bumper(4, true);
        robot.advance_to(400);
    }
    let diagnosis = patient.examine();
    assert_eq!(problems(&diagnosis), ["supply-low", "bumper-pressed"]);
    assert!(finding(&diagnosis, "bumper-pressed").found.contains("left-hand"));
    let verdict = diagnosis.verdict();
    assert!(verdict.text.starts_with("2 things") && verdict.text.contains("below 5 V"));
    assert!(verdict.next.contains("batteries"), "{verdict:?}");
}

#[test]
fn brown_out_and_watchdog_are_explained() {
    let patient = Patient::new();
    patient.robot.lock().unwrap().brown_out();
    patient.robot.lock().unwrap().advance_to(600);
    let diagnosis = patient.examine();
    assert_eq!(problems(&diagnosis), ["brown-out"; 2], "both controllers share the supply");
    patient.robot.lock().unwrap().hang(Address::Camera).unwrap();
    let now_ms = patient.robot.lock().unwrap().now_ms();
    patient.robot.lock().unwrap().advance_to(now_ms + 400);
    let diagnosis = patient.examine();
    let watchdog = finding(&diagnosis, "watchdog");
    assert!(watchdog.found.contains("camera controller: boot 3"), "{}", watchdog.found);
    assert_eq!(watchdog.severity, Severity::Problem);
}

#[test]
fn a_noisy_line_is_measured_at_both_ends() {
    let patient = Patient::new();
    let faults = LineFaults { bit_error_ppm: 1500, framing_ppm: 3000, ..LineFaults::NONE };
    for direction in [Direction::ToRobot, Direction::ToPc] {
        patient.robot.lock().unwrap().set_line_faults(direction, faults);
    }
    let mut options = patient.computer.options();
    options.measure_ms = 5000;
    let address = LinkAddress::Serial(PORT.to_owned());
    let diagnosis = patient.examine_with(&address, &options);
    let quality = diagnosis.line.expect("HELLO got through within its tries");
    assert!(quality.resent > 0 && quality.troubled_per_mille() >= 10, "{quality:?}");
    assert!(quality.errors_here > 0 && quality.errors_there.unwrap() > 0, "{quality:?}");
    assert!(quality.framing_errors > 0, "{quality:?}");
    assert_eq!(problems(&diagnosis), ["line-bad"]);
}

#[test]
fn a_spike_is_no_illness_and_lost_answers_are() {
    let quality = LineQuality { requests: 90, resent: 2, errors_here: 1, ..LineQuality::default() };
    assert_eq!(super::quality::errors(&quality).severity, Severity::Advice);
    for (resent, lost) in [(3, 0), (3, 1)] {
        let finding = super::quality::errors(&LineQuality { lost, resent, ..quality });
        assert_eq!((finding.code, finding.severity), ("line-bad", Severity::Problem));
    }
    let finding = super::quality::errors(&LineQuality { requests: 1000, resent: 9, ..quality });
    assert_eq!(finding.severity, Severity::Advice, "less than one of a hundred");
}

#[test]
fn what_is_no_serial_port_is_told_when_it_is_opened() {
    let options = DoctorOptions::default();
    let address = LinkAddress::Serial("/dev/null".to_owned());
    let diagnosis = super::examine(&address, &options, &mut |_| {});
    assert_eq!(problems(&diagnosis), ["cannot-open"], "{diagnosis:#?}");
    assert!(diagnosis.verdict().next.contains("rsapien ports"));
}

#[test]
fn a_line_that_is_held_is_left_alone() {
    let patient = Patient::new();
    let folder = tempfile::tempdir().unwrap();
    let mut options = patient.computer.options();
    options.lock_folder = Some(folder.path().to_path_buf());
    let holder = Holder::this_process("rsapien play dance");
    let lock = LineLock::take(folder.path(), PORT, &holder).unwrap();
    let address = LinkAddress::Serial(PORT.to_owned());
    let diagnosis = patient.examine_with(&address, &options);
    assert_eq!(problems(&diagnosis), ["held"]);
    assert!(finding(&diagnosis, "held").found.contains("rsapien play dance"));
    assert!(patient.sent.lock().unwrap().is_empty(), "not a byte is sent");
    drop(lock);
    assert!(patient.examine_with(&address, &options).is_healthy());
}

#[test]
fn programs_that_have_the_port_open_and_modem_manager_are_seen() {
    let patient = Patient::new();
    patient.computer.process(4711, "minicom", PORT);
    patient.computer.process(12, "cat", "/dev/ttyUSB1");
    patient.computer.process(99, "ModemManager", "/dev/null");
    let diagnosis = patient.examine();
    assert_eq!(problems(&diagnosis), ["open-elsewhere"]);
    let found = finding(&diagnosis, "open-elsewhere");
    assert!(found.found.contains("minicom (pid 4711)"), "{}", found.found);
    let modem = finding(&diagnosis, "running");
    assert!(
        modem.remedies[0].contains("ATTRS{idVendor}==\"0403\"")
            && modem.remedies[0].contains("ID_MM_DEVICE_IGNORE")
    );
}

#[test]
fn who_may_open_the_port_is_read_from_the_system_files() {
    use std::os::unix::fs::MetadataExt;
    let computer = Computer::new();
    let group = fs::metadata(computer.root.path().join(&PORT[1..])).unwrap().gid();
    computer.write("etc/group", &format!("root:x:77777:\ndialout:x:{group}:bob,alice\n"));
    computer.write("etc/passwd", "alice:x:4242:4242::/home/alice:/bin/sh\n");
    computer.write("proc/self/status", "Uid:\t1\t4242\t1\t1\nGroups:\t55555 66666\n");
    let device = computer.device();
    let machine = Machine::new(computer.root.path());
    let access = permission::access(&device, &machine);
    assert!(access.is_there && access.is_permitted && access.is_for_next_login, "{access:?}");
    let names = (access.user.as_deref(), access.group.as_deref());
    assert_eq!(names, (Some("alice"), Some("dialout")));

    let denied = Access { is_permitted: false, is_for_next_login: false, ..access.clone() };
    let found = permission::judge(&device, &denied);
    assert_eq!(found.code, "no-permission");
    assert_eq!(found.remedies[0], "sudo usermod -a -G dialout alice, then log out and in again");
    for part in ["ATTRS{idVendor}==\"0403\"", "ATTRS{idProduct}==\"6001\"", "/etc/udev/rules.d/"] {
        assert!(found.remedies[1].contains(part), "{}", found.remedies[1]);
    }
    let later = Access { is_permitted: false, ..access };
    assert!(permission::judge(&device, &later).remedies[0].starts_with("log out and in again"));
    let nobodys = Access { is_there: true, group: Some("root".to_owned()), ..Access::default() };
    assert!(permission::judge(&device, &nobodys).remedies[0].starts_with("give it to everyone"));
}

#[test]
fn a_computer_without_a_port_and_a_port_that_is_gone_are_told_apart() {
    let patient = Patient::new();
    let usb = patient.computer.root.path().join("sys/class/tty/ttyUSB0");
    fs::remove_dir_all(usb).unwrap();
    let diagnosis = patient.examine_with(&LinkAddress::Auto, &patient.computer.options());
    assert_eq!(problems(&diagnosis), ["no-port"]);
    fs::remove_file(patient.computer.root.path().join(&PORT[1..])).unwrap();
    assert_eq!(problems(&patient.examine()), ["no-device"]);
}
