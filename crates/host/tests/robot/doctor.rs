//! The doctor on a pseudo-terminal whose robot understands one speed only.

use std::io::{self, Read, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use rsapien::LinkAddress;
use rsapien::doctor::{DoctorOptions, Severity, examine};
use serialport::{SerialPort, TTYPort};

use crate::common::virtual_robot;
use crate::links::serve;

/// The robot's end of a line, which hears rubbish while the port is set to another speed than `baud`.
struct AtBaud {
    master: TTYPort,
    baud: u32,
}

impl Read for AtBaud {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.master.read(buffer)?;
        // The master end of a pseudo-terminal tells the speed that the other end was set to.
        if self.master.baud_rate()? != self.baud {
            buffer[..count].fill(0);
        }
        Ok(count)
    }
}

impl Write for AtBaud {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.master.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.master.flush()
    }
}

#[test]
fn the_speed_of_a_robot_on_a_serial_line_is_found() {
    let shared = virtual_robot();
    let (mut master, mut slave) = TTYPort::pair().unwrap();
    master.set_timeout(Duration::from_millis(1)).unwrap();
    slave.set_exclusive(false).unwrap();
    let address = LinkAddress::Serial(slave.name().unwrap());
    let end = Arc::new(AtomicBool::new(false));
    let server = std::thread::spawn({
        let (shared, end) = (Arc::clone(&shared), Arc::clone(&end));
        move || serve(&shared, AtBaud { master, baud: 38_400 }, &end)
    });
    let options = DoctorOptions { measure_ms: 200, ..DoctorOptions::default() };
    let examined = |baud| {
        let options = DoctorOptions { baud, ..options.clone() };
        let diagnosis = examine(&address, &options, &mut |_| {});
        let problems: Vec<_> = diagnosis
            .findings
            .iter()
            .filter(|finding| finding.severity == Severity::Problem)
            .map(|finding| (finding.code, finding.found.clone()))
            .collect();
        (diagnosis.motion.is_some(), problems)
    };
    let (is_found, problems) = examined(57_600);
    assert!(is_found, "{problems:?}");
    let [("other-speed", found)] = problems.as_slice() else { panic!("{problems:?}") };
    assert!(found.contains("38400 baud, not at 57600"), "{found}");
    assert_eq!(examined(38_400), (true, Vec::new()));
    end.store(true, Ordering::SeqCst);
    server.join().unwrap();
}
