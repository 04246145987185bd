//! What stands in the messages.

use rsapien_protocol::{
    ActionPackage, BumperMask, CameraReport, Content, Direction, Joint, Kind, MotionReport,
    SynchronizationPackage,
};
use rsapien_vision::Ellipse;
use serde_json::{Map, Value, json};

use crate::{LinkState, PackageRecord, RobotState};

/// Bytes as hexadecimal digits.
pub(crate) fn hex(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    let mut text = String::with_capacity(2 * bytes.len());
    for byte in bytes {
        // Writing to a string does not fail.
        let _ = write!(text, "{byte:02x}");
    }
    text
}

/// The bytes of hexadecimal digits; none where it is something else.
pub(crate) fn from_hex(text: &str) -> Option<Vec<u8>> {
    let digits = text.as_bytes();
    if !digits.len().is_multiple_of(2) {
        return None;
    }
    let digit = |byte: u8| char::from(byte).to_digit(16).and_then(|it| u8::try_from(it).ok());
    digits.chunks_exact(2).map(|pair| Some(digit(pair[0])? << 4 | digit(pair[1])?)).collect()
}

/// `to-robot` or `to-pc`.
pub(crate) const fn direction_name(direction: Direction) -> &'static str {
    match direction {
        Direction::ToRobot => "to-robot",
        Direction::ToPc => "to-pc",
    }
}

pub(super) fn bytes(time_ms: u64, direction: Direction, bytes: &[u8]) -> Value {
    json!({"time_ms": time_ms, "direction": direction_name(direction), "hex": hex(bytes)})
}

/// What the header of a package tells: kind, session, sequence and, of an answer, its status.
pub(crate) fn package_head(content: &Content) -> Value {
    let (kind, session, sequence, status) = match content.direction() {
        Direction::ToRobot => match ActionPackage::parse(content.action()) {
            Ok(package) => (Some(package.request.kind()), package.session, package.sequence, None),
            Err(_) => return json!({}),
        },
        Direction::ToPc => match SynchronizationPackage::parse(content) {
            Ok(package) => {
                let kind = Kind::from_byte(package.kind_byte);
                (kind, package.session, package.sequence, Some(package.status.to_string()))
            }
            Err(_) => return json!({}),
        },
    };
    let mut head = json!({
        "kind": kind.map(Kind::name), "session": session, "sequence": sequence,
    });
    if let Some(status) = status {
        head["status"] = status.into();
    }
    head
}

pub(super) fn package(record: &PackageRecord, content: Option<&Content>) -> Value {
    let mut value = content.map_or_else(|| json!({}), package_head);
    value["time_ms"] = record.time_ms.into();
    value["direction"] = direction_name(record.direction).into();
    value["controller"] = record.address.name().into();
    value["words"] = record.meaning().into();
    value["hex"] = hex(&record.bytes).into();
    value
}

pub(super) fn state(state: &RobotState) -> Value {
    let link = match state.link {
        LinkState::Up => "up",
        LinkState::Silent { .. } => "silent",
        LinkState::Lost { .. } => "lost",
    };
    let counts = &state.counts;
    json!({
        "time_ms": state.time_ms,
        "version": state.version,
        "link": link,
        "motion": state.motion_report().map(|report| motion_report(&report)),
        "camera": state.camera_report().map(|report| camera_report(&report)),
        "counts": {
            "sent": counts.sent,
            "resent": counts.resent,
            "answered": counts.answered,
            "unanswered": counts.unanswered,
            "reception_errors": counts.reception_errors,
            "restarts": counts.restarts,
            "reconnects": counts.reconnects,
        },
    })
}

/// A motion controller's report; numbers and truth values, which tools can plot.
pub(crate) fn motion_report(report: &MotionReport) -> Value {
    let by_joint = |value: &dyn Fn(Joint) -> Value| -> Map<String, Value> {
        Joint::ALL.into_iter().map(|joint| (joint.name().to_owned(), value(joint))).collect()
    };
    let bits = report.bumpers.bits();
    let bumpers: Map<String, Value> = (BumperMask::NAMES.into_iter().enumerate())
        .map(|(index, name)| (name.to_owned(), (bits >> index & 1 == 1).into()))
        .collect();
    let presses: Map<String, Value> = BumperMask::NAMES
        .into_iter()
        .zip(report.presses)
        .map(|(name, count)| (name.to_owned(), count.into()))
        .collect();
    let [left, right] = report.middle_switches;
    json!({
        "mode": report.mode.name(),
        "mode_number": report.mode.byte(),
        "cause": report.cause.name(),
        "bumpers": bumpers,
        "presses": presses,
        "middle_switches": {"left": left, "right": right},
        "motors": by_joint(&|joint| report.is_running(joint).into()),
        "pose": by_joint(&|joint| report.position(joint).map_or(0, rsapien_protocol::Position::number).into()),
        "supply_low": report.supply_low,
        "queue_free": report.queue_free,
        "steps_ended": report.steps_ended,
        "boot": report.boot,
        "reception_errors": report.reception_errors,
    })
}

/// A camera controller's report.
pub(crate) fn camera_report(report: &CameraReport) -> Value {
    let degrees = |centideg: i16| f64::from(centideg) / 100.0;
    json!({
        "mode": report.mode.name(),
        "mode_number": report.mode.byte(),
        "cause": report.cause.name(),
        "pan_deg": degrees(report.pan_centideg),
        "tilt_deg": degrees(report.tilt_centideg),
        "pan_target_deg": degrees(report.pan_target_centideg),
        "tilt_target_deg": degrees(report.tilt_target_centideg),
        "moving": report.axes.pan_moving || report.axes.tilt_moving,
        "boot": report.boot,
        "reception_errors": report.reception_errors,
    })
}

/// A time as Foxglove writes it.
fn foxglove_time(unix_ns: u64) -> Value {
    json!({"sec": unix_ns / 1_000_000_000, "nsec": unix_ns % 1_000_000_000})
}

pub(super) fn frame(unix_ns: u64, format: &str, data: &[u8]) -> Value {
    use base64::Engine as _;
    json!({
        "timestamp": foxglove_time(unix_ns),
        "frame_id": "camera",
        "data": base64::engine::general_purpose::STANDARD.encode(data),
        "format": format,
    })
}

pub(super) fn detections(time_ms: u64, found: &[(Ellipse, f64)]) -> Value {
    let ellipses: Vec<Value> = found
        .iter()
        .map(|(ellipse, score)| {
            json!({
                "center_x": ellipse.center_x_px,
                "center_y": ellipse.center_y_px,
                "semi_major": ellipse.semi_major_px,
                "semi_minor": ellipse.semi_minor_px,
                "theta": ellipse.theta_rad,
                "score": score,
            })
        })
        .collect();
    json!({"time_ms": time_ms, "ellipses": ellipses})
}

/// How many points a drawn ellipse has.
const POINTS: u8 = 48;

pub(super) fn annotations(unix_ns: u64, found: &[(Ellipse, f64)]) -> Value {
    let colour = |alpha: f64| json!({"r": 0.1, "g": 0.9, "b": 0.2, "a": alpha});
    let lines: Vec<Value> = found
        .iter()
        .map(|(ellipse, _)| {
            let points: Vec<Value> = (0..POINTS)
                .map(|index| {
                    let turn = std::f64::consts::TAU * f64::from(index) / f64::from(POINTS);
                    let (x, y) = ellipse.point_at(turn);
                    json!({"x": x, "y": y})
                })
                .collect();
            json!({
                "timestamp": foxglove_time(unix_ns),
                "type": 2,
                "points": points,
                "outline_color": colour(1.0),
                "outline_colors": [],
                "fill_color": colour(0.0),
                "thickness": 1.5,
            })
        })
        .collect();
    json!({"circles": [], "points": lines, "texts": []})
}
