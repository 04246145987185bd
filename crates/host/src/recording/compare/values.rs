//! What of an answer is compared, value by value.

use rsapien_protocol::{
    BumperMask, CameraReport, HelloReport, Joint, Mode, MotionReport, Report, StopCause,
    SynchronizationPackage,
};

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Value {
    Text(String),
    Count(u64),
    Centideg(i64),
}

impl std::fmt::Display for Value {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Value::Text(text) => formatter.write_str(text),
            Value::Count(count) => count.fmt(formatter),
            Value::Centideg(_) => {
                #[allow(clippy::cast_precision_loss)] // at most some ten thousand
                let degrees = self.centideg().unwrap_or_default() as f64 / 100.0;
                write!(formatter, "{degrees:.2} degrees")
            }
        }
    }
}

impl Value {
    pub(super) fn centideg(&self) -> Option<i64> {
        match self {
            Value::Centideg(value) => Some(*value),
            _ => None,
        }
    }
}

pub(super) type Values = Vec<(String, Value)>;

/// Where one run's counts began.
#[derive(Clone, Copy, Default)]
pub(super) struct Origin {
    boot: Option<u8>,
    presses: Option<[u8; BumperMask::COUNT]>,
    /// INIT sets the count of steps to nothing; before that it is anybody's.
    pub(super) steps: Option<u16>,
}

/// What of an answer is compared.
pub(super) fn values(
    origin: &mut Origin,
    package: &SynchronizationPackage,
    is_exact: bool,
) -> Values {
    let mut values = vec![text("status", package.status.to_string())];
    match &package.report {
        Report::Motion(report) => motion(&mut values, origin, report, is_exact),
        Report::Camera(report) => camera(&mut values, origin, report, is_exact),
        Report::Hello(report) => hello(&mut values, origin, report, is_exact),
        Report::Counters(report) => {
            // They count what went wrong on another line.
            if is_exact {
                values.push(text("counters", format!("{report:?}")));
            }
        }
    }
    values
}

fn text(name: &str, value: impl Into<String>) -> (String, Value) {
    (name.to_owned(), Value::Text(value.into()))
}

fn count(name: &str, value: impl Into<u64>) -> (String, Value) {
    (name.to_owned(), Value::Count(value.into()))
}

fn on_off(name: &str, is_on: bool) -> (String, Value) {
    text(name, if is_on { "on" } else { "off" })
}

/// How many resets since the first answer.
fn boots(origin: &mut Origin, boot: u8) -> (String, Value) {
    count("resets", boot.wrapping_sub(*origin.boot.get_or_insert(boot)))
}

fn motion(values: &mut Values, origin: &mut Origin, report: &MotionReport, is_exact: bool) {
    values.push(text("mode", report.mode.name()));
    cause(values, report.mode, report.cause, is_exact);
    let bits = report.bumpers.bits();
    let first = *origin.presses.get_or_insert(if is_exact { [0; 6] } else { report.presses });
    for (index, name) in BumperMask::NAMES.into_iter().enumerate() {
        values.push(on_off(&format!("bumper {name}"), bits >> index & 1 == 1));
        let presses = report.presses[index].wrapping_sub(first[index]) & 0x0F;
        values.push(count(&format!("presses of {name}"), presses));
    }
    for joint in Joint::ALL {
        values.push(on_off(&format!("motor {}", joint.name()), report.is_running(joint)));
        let place = report.position(joint).map_or("on its way", |position| {
            joint.position_names()[usize::from(position.number() - 1)]
        });
        values.push(text(&format!("pose of {}", joint.name()), place));
    }
    for (name, is_closed) in ["left", "right"].into_iter().zip(report.middle_switches) {
        values.push(on_off(&format!("middle switch {name}"), is_closed));
    }
    values.push(on_off("supply low", report.supply_low));
    values.push(count("queue_free", report.queue_free));
    let first = *origin.steps.get_or_insert(if is_exact { 0 } else { report.steps_ended });
    values.push(count("steps_ended", report.steps_ended.wrapping_sub(first)));
    tail(values, origin, report.boot, report.reception_errors, is_exact);
}

fn camera(values: &mut Values, origin: &mut Origin, report: &CameraReport, is_exact: bool) {
    values.push(text("mode", report.mode.name()));
    cause(values, report.mode, report.cause, is_exact);
    for (name, centideg) in [
        ("pan", report.pan_centideg),
        ("tilt", report.tilt_centideg),
        ("pan target", report.pan_target_centideg),
        ("tilt target", report.tilt_target_centideg),
    ] {
        values.push((name.to_owned(), Value::Centideg(i64::from(centideg))));
    }
    let axes = report.axes;
    values.push(on_off("pan moving", axes.pan_moving));
    values.push(on_off("tilt moving", axes.tilt_moving));
    values.push(on_off("pan at limit", axes.pan_at_limit));
    values.push(on_off("tilt at limit", axes.tilt_at_limit));
    tail(values, origin, report.boot, report.reception_errors, is_exact);
}

fn hello(values: &mut Values, origin: &mut Origin, report: &HelloReport, is_exact: bool) {
    values.push(count("version", report.version));
    values.push(count("queue length", report.queue_length));
    values.push(count("dead-man ms", report.dead_man_ms));
    if is_exact {
        let [major, minor, patch] = report.firmware;
        values.push(text("firmware", format!("{major}.{minor}.{patch}")));
        values.push(count("clock MHz", report.clock_mhz));
        values.push(count("last sequence", report.last_sequence));
    }
    tail(values, origin, report.boot, report.reception_errors, is_exact);
}

/// Unless the robot is held by it, the cause of the last hold or reset is of a time before.
fn cause(values: &mut Values, mode: Mode, cause: StopCause, is_exact: bool) {
    if is_exact || mode == Mode::Held {
        values.push(text("cause", cause.name()));
    }
}

fn tail(values: &mut Values, origin: &mut Origin, boot: u8, errors: u8, is_exact: bool) {
    if is_exact {
        values.push(count("boot", boot));
        values.push(count("reception errors", errors));
    } else {
        values.push(boots(origin, boot));
    }
}
