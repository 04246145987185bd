//! What is wrong between this computer and the robot, and what to do about it, step by step.
//!
//! Nothing is moved: HELLO, STATE and COUNTERS are all that is ever sent. A line that another program of this library
//! holds is left alone, since HELLO would end that program's session.
//!
//! Each step is a file with one function, named in `CHECKS` in the order in which they run: from the computer (ports,
//! permission, adapter, other programs) over the line (speed, who answers) to the robot (firmware, resets, supply,
//! switches) and how well packages go to and fro; last the webcam and the file of the actions, which need no robot. A
//! step that needs what an earlier one did not get is told as not reached. Files of the system are read below [`DoctorOptions::system_root`], so that a test brings its own.

mod controllers;
mod device;
mod finding;
mod holders;
mod latency;
mod line;
mod machine;
mod modem_manager;
mod opening;
mod permission;
mod ports;
mod quality;
#[cfg(feature = "registry")]
mod registry;
mod resets;
mod sensors;
mod speed;
#[cfg(unix)]
#[cfg(unix)]
mod webcam;

use std::path::PathBuf;

use rsapien_protocol::HelloReport;

pub use finding::{Diagnosis, Finding, Severity, Verdict};
pub use quality::LineQuality;
pub use resets::cause_in_words;

use self::device::Device;
use self::line::ProbeLine;
use self::machine::Machine;
use crate::link::Connect;
use crate::robot::connector;
use crate::{Error, LinkAddress};

/// How the robot is examined.
#[derive(Clone, Debug)]
pub struct DoctorOptions {
    /// The speed that a serial line is expected to have, in bit/s: 19200, 38400, 57600 or 115200.
    pub baud: u32,
    /// Where the locks between programs stand; none to take none.
    pub lock_folder: Option<PathBuf>,
    /// Below which `/sys`, `/proc` and `/etc` are read: `/` but in tests.
    pub system_root: PathBuf,
    /// The firmware that this program was written for: major, minor, patch; none to accept any.
    pub firmware_expected: Option<[u8; 3]>,
    /// The file of the actions that is looked at, read only; none to look at none. It is never made. Looked at by the
    /// feature `registry` only.
    pub registry_file: Option<PathBuf>,
    /// How long the line is measured, in ms of its clock.
    pub measure_ms: u64,
}

impl Default for DoctorOptions {
    /// 57600 baud, no lock, this computer's files, any firmware, no registry, a second on the line.
    fn default() -> DoctorOptions {
        DoctorOptions {
            baud: 57_600,
            lock_folder: None,
            system_root: PathBuf::from("/"),
            firmware_expected: None,
            registry_file: None,
            measure_ms: 1000,
        }
    }
}

/// Makes what opens a link at a speed in bit/s.
pub type Connections<'a> = dyn FnMut(&LinkAddress, u32) -> Result<Box<dyn Connect>, Error> + 'a;

/// What a step needs before it can run.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Needs {
    Nothing,
    /// A link that may lead to the robot.
    Link,
    /// The motion controller's answer to HELLO.
    Robot,
}

/// One step of the examination.
struct Check {
    name: &'static str,
    needs: Needs,
    run: fn(&mut Case<'_>),
}

/// The steps in their order.
const CHECKS: &[Check] = &[
    Check { name: ports::NAME, needs: Needs::Nothing, run: ports::check },
    Check { name: permission::NAME, needs: Needs::Link, run: permission::check },
    Check { name: latency::NAME, needs: Needs::Link, run: latency::check },
    Check { name: holders::NAME, needs: Needs::Link, run: holders::check },
    Check { name: modem_manager::NAME, needs: Needs::Link, run: modem_manager::check },
    Check { name: opening::NAME, needs: Needs::Link, run: opening::check },
    Check { name: speed::NAME, needs: Needs::Link, run: speed::check },
    Check { name: controllers::NAME, needs: Needs::Robot, run: controllers::check },
    Check { name: resets::NAME, needs: Needs::Robot, run: resets::check },
    Check { name: sensors::NAME, needs: Needs::Robot, run: sensors::check },
    Check { name: quality::NAME, needs: Needs::Robot, run: quality::check },
    #[cfg(unix)]
    #[cfg(unix)]
    Check { name: webcam::NAME, needs: Needs::Nothing, run: webcam::check },
    #[cfg(feature = "registry")]
    Check { name: registry::NAME, needs: Needs::Nothing, run: registry::check },
];

/// What the steps hand on to each other.
struct Case<'a> {
    options: &'a DoctorOptions,
    address: &'a LinkAddress,
    connections: &'a mut Connections<'a>,
    machine: Machine<'a>,
    /// The serial ports that the address may mean.
    devices: Vec<Device>,
    /// The links that may lead to the robot, as far as no step has ruled them out.
    candidates: Vec<LinkAddress>,
    /// Those that are open, until one is chosen.
    open: Vec<ProbeLine>,
    /// The line to the robot.
    line: Option<ProbeLine>,
    motion: Option<HelloReport>,
    camera: Option<HelloReport>,
    quality: Option<LineQuality>,
    findings: Vec<Finding>,
    on_finding: &'a mut dyn FnMut(&Finding),
}

impl Case<'_> {
    fn tell(&mut self, finding: Finding) {
        (self.on_finding)(&finding);
        self.findings.push(finding);
    }

    /// Takes a link out of those that may lead to the robot.
    fn rule_out(&mut self, path: &str) {
        self.candidates
            .retain(|link| !matches!(link, LinkAddress::Serial(candidate) if candidate == path));
    }

    /// Gives the line up, which broke during the step `name`.
    fn lose_line(&mut self, name: &'static str, error: &Error) {
        self.line = None;
        self.tell(Finding::problem(name, "link-lost", error.to_string()).remedy(
            "look at the plug and the cable; a controller that resets its adapter shows this, too",
        ));
    }
}

/// Examines the robot at `address`, and this computer as far as the link depends on it. Each finding is handed to
/// `on_finding` as it comes.
///
/// [`LinkAddress::Auto`] looks behind every serial port; [`LinkAddress::Virtual`] examines a virtual robot made for it.
/// Nothing is an error here: what fails is a finding.
pub fn examine(
    address: &LinkAddress,
    options: &DoctorOptions,
    on_finding: &mut dyn FnMut(&Finding),
) -> Diagnosis {
    #[cfg(feature = "virtual")]
    if *address == LinkAddress::Virtual {
        use crate::link::virtual_robot::{Pace, VirtualConnector, VirtualOptions};
        let robot = VirtualOptions::default().build();
        let mut connections = move |_: &LinkAddress, _| -> Result<Box<dyn Connect>, Error> {
            let robot = match &robot {
                Ok(robot) => std::sync::Arc::clone(robot),
                Err(error) => {
                    let source = std::io::Error::other(error.to_string());
                    return Err(Error::LinkOpen { link: "virtual".to_owned(), source });
                }
            };
            Ok(Box::new(VirtualConnector::new(robot, Pace::Fast)))
        };
        return examine_over(address, &mut connections, options, on_finding);
    }
    examine_over(address, &mut |link, baud| connector(link, baud), options, on_finding)
}

/// As [`examine`], over links of one's own: `address` tells which files of the system are looked at, `connections` makes
/// what opens them.
pub fn examine_over(
    address: &LinkAddress,
    connections: &mut Connections<'_>,
    options: &DoctorOptions,
    on_finding: &mut dyn FnMut(&Finding),
) -> Diagnosis {
    let mut connections = |link: &LinkAddress, baud| connections(link, baud);
    let mut case = Case {
        options,
        address,
        connections: &mut connections,
        machine: Machine::new(&options.system_root),
        devices: Vec::new(),
        candidates: Vec::new(),
        open: Vec::new(),
        line: None,
        motion: None,
        camera: None,
        quality: None,
        findings: Vec::new(),
        on_finding,
    };
    for check in CHECKS {
        let is_reached = match check.needs {
            Needs::Nothing => true,
            Needs::Link => !case.candidates.is_empty(),
            Needs::Robot => case.line.is_some() && case.motion.is_some(),
        };
        if is_reached {
            (check.run)(&mut case);
        } else {
            case.tell(Finding::not_reached(check.name));
        }
    }
    let link = case.line.as_ref().map(|line| line.name().to_owned());
    Diagnosis {
        link,
        motion: case.motion,
        camera: case.camera,
        line: case.quality,
        findings: case.findings,
    }
}

#[cfg(all(test, feature = "virtual", unix))]
mod tests;
