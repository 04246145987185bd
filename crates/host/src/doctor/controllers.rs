//! Who is behind the line: both controllers, their firmware, clock and protocol.

use rsapien_protocol::{Address, HelloReport, PROTOCOL_VERSION};

use super::{Case, Finding};

pub(super) const NAME: &str = "firmware";

pub(super) fn check(case: &mut Case<'_>) {
    let Some(line) = case.line.as_mut() else { return };
    let camera = match line.hello(Address::Camera) {
        Ok(answer) => answer.map(|(_, report)| report),
        Err(error) => return case.lose_line(NAME, &error),
    };
    case.camera = camera;
    let expected = case.options.firmware_expected;
    if let Some(report) = case.motion {
        case.tell(judge(Address::Motion, &report, expected));
    }
    case.tell(match camera {
        Some(report) => judge(Address::Camera, &report, expected),
        None => Finding::advice(NAME, "no-camera", "no camera controller answers")
            .remedy("nothing, if the robot has none; else look at its supply, its LED and its place on the line"),
    });
    if let (Some(motion), Some(camera)) = (case.motion, camera)
        && motion.firmware != camera.firmware
    {
        let found = "the two controllers have different firmware";
        case.tell(
            Finding::advice(NAME, "firmware-mixed", found)
                .remedy("flash both from the same hex folder"),
        );
    }
}

fn version([major, minor, patch]: [u8; 3]) -> String {
    format!("{major}.{minor}.{patch}")
}

fn judge(address: Address, report: &HelloReport, expected: Option<[u8; 3]>) -> Finding {
    // A HELLO that is refused for its version is answered with version 0.
    if report.version != PROTOCOL_VERSION {
        let found = format!(
            "the {address} controller has no protocol version in common (this program speaks {PROTOCOL_VERSION})"
        );
        return Finding::problem(NAME, "protocol", found).remedy(
            "update this program and flash the firmware that comes with it (docs/firmware.md)",
        );
    }
    let found = format!(
        "the {address} controller: firmware {} at {} MHz, protocol {}",
        version(report.firmware),
        report.clock_mhz,
        report.version
    );
    let Some(expected) = expected.filter(|expected| *expected != report.firmware) else {
        return Finding::good(NAME, "firmware", found);
    };
    let found = format!("{found}; this program was written for {}", version(expected));
    let remedy = if expected > report.firmware {
        "flash the firmware that comes with this program (docs/firmware.md)"
    } else {
        "update this program"
    };
    // A patch changes nothing that a program sees.
    if expected[..2] == report.firmware[..2] {
        Finding::advice(NAME, "firmware-patch", found).remedy(remedy)
    } else {
        Finding::problem(NAME, "firmware-version", found).remedy(remedy)
    }
}
