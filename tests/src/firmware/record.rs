//! The record that answers every event: cut out of a stream, and told by the names of its fields.

use rsapien_protocol::{
    Address, CountersReport, Direction, Fed, HeaderByte, Kind, Receiver, Report, Status,
    SynchronizationPackage, frame,
};
use std::fmt::Write as _;

/// Bytes of a report in a record.
pub const BODY_LENGTH: usize = 14;
/// Bytes of both servos' positions in the camera's record.
pub const SERVOS_LENGTH: usize = 4;
const OUTPUTS_LENGTH: usize = 5;

/// Bytes of a record before its count of transmitted bytes.
pub const fn fixed_length(address: Address) -> usize {
    let servos = match address {
        Address::Motion => 0,
        Address::Camera => SERVOS_LENGTH,
    };
    OUTPUTS_LENGTH + 2 * BODY_LENGTH + servos
}

/// The first record of a stream and what comes behind it; none when it is not complete.
pub fn split_first(address: Address, stream: &[u8]) -> Option<(&[u8], &[u8])> {
    let fixed = fixed_length(address);
    let count = usize::from(*stream.get(fixed)?);
    stream.split_at_checked(fixed + 1 + count)
}

/// What differs between two records, a line for each field, expected first.
pub fn differences(address: Address, expected: &[u8], found: &[u8]) -> String {
    let found = fields(address, found);
    let mut text = String::new();
    for (name, expected) in fields(address, expected) {
        // A report with a byte that means nothing is told by its bytes alone.
        let found = found.iter().find(|(other, _)| *other == name);
        let found = found.map_or("-", |(_, value)| value.as_str());
        let mark = if expected == found { ' ' } else { '!' };
        let _ = writeln!(text, "{mark} {name:22} {expected:44} {found}");
    }
    text
}

/// The fields of a record by name, in order.
pub fn fields(address: Address, record: &[u8]) -> Vec<(&'static str, String)> {
    let Some((record, _)) = split_first(address, record) else {
        return vec![("record", format!("incomplete: {record:02x?}"))];
    };
    let (fixed, transmitted) = record.split_at(fixed_length(address));
    let (outputs, rest) = fixed.split_at(OUTPUTS_LENGTH);
    let (report, rest) = rest.split_at(BODY_LENGTH);
    let (counters, servos) = rest.split_at(BODY_LENGTH);
    let mut fields = match address {
        Address::Motion => vec![
            ("motors towards first", format!("{:07b}", outputs[0])),
            ("motors towards last", format!("{:07b}", outputs[1])),
        ],
        Address::Camera => vec![
            ("servos driven", outputs[0].to_string()),
            ("second output byte", outputs[1].to_string()),
        ],
    };
    fields.push(("session", outputs[2].to_string()));
    fields.push(("transmitting", outputs[3].to_string()));
    fields.push(("eeprom boot", outputs[4].to_string()));
    match decode(address, Kind::State, report) {
        Some(Report::Motion(report)) => fields.extend([
            ("mode", report.mode.name().to_owned()),
            ("cause", report.cause.name().to_owned()),
            ("bumpers", format!("{:06b}", report.bumpers.bits())),
            ("middle switches", format!("{:?}", report.middle_switches)),
            ("presses", format!("{:?}", report.presses)),
            ("motors", format!("{:07b}", report.motors)),
            ("supply low", report.supply_low.to_string()),
            ("pose reached", format!("{:#06x}", report.pose_reached.word())),
            ("queue free", report.queue_free.to_string()),
            ("steps ended", report.steps_ended.to_string()),
            ("boot", report.boot.to_string()),
            ("reception errors", report.reception_errors.to_string()),
        ]),
        Some(Report::Camera(report)) => fields.extend([
            ("mode", report.mode.name().to_owned()),
            ("cause", report.cause.name().to_owned()),
            ("pan", report.pan_centideg.to_string()),
            ("tilt", report.tilt_centideg.to_string()),
            ("pan target", report.pan_target_centideg.to_string()),
            ("tilt target", report.tilt_target_centideg.to_string()),
            ("axes", format!("{:04b}", report.axes.bits())),
            ("boot", report.boot.to_string()),
            ("reception errors", report.reception_errors.to_string()),
        ]),
        _ => {}
    }
    fields.push(("report", hex(report)));
    if let Some(Report::Counters(counters)) = decode(address, Kind::Counters, counters) {
        fields.extend([
            ("accepted", counters.accepted.to_string()),
            ("resets of reception", counters.resets.to_string()),
            ("crc errors", counters.crc_errors.to_string()),
            ("framing errors", counters.framing_errors.to_string()),
            ("overruns", counters.overruns.to_string()),
            ("duplicates", counters.duplicates.to_string()),
            ("dead-man trips", counters.dead_man_trips.to_string()),
        ]);
    }
    fields.push(("counters", hex(counters)));
    if let [pan_low, pan_high, tilt_low, tilt_high] = *servos {
        fields.push(("pan pulse", i16::from_le_bytes([pan_low, pan_high]).to_string()));
        fields.push(("tilt pulse", i16::from_le_bytes([tilt_low, tilt_high]).to_string()));
    }
    fields.push(("transmitted", hex(transmitted.get(1..).unwrap_or_default())));
    fields
}

/// The report of a record, read by the protocol's own decoder from a package made around it.
fn decode(address: Address, kind: Kind, body: &[u8]) -> Option<Report> {
    let around = SynchronizationPackage {
        session: 0,
        sequence: 0,
        kind_byte: kind.byte(),
        status: Status::Accepted,
        report: Report::Counters(CountersReport::default()),
    };
    let mut content = around.content();
    content.last_chunk_mut::<BODY_LENGTH>()?.copy_from_slice(body);
    let header = HeaderByte { direction: Direction::ToPc, address };
    let line: [u8; frame::SYNCHRONIZATION_PACKAGE_LENGTH] = frame::encode(header, &content);
    let mut receiver = Receiver::for_pc();
    let content = line.into_iter().find_map(|byte| match receiver.feed(byte, 0) {
        Fed::Package(content) => Some(content),
        _ => None,
    })?;
    Some(SynchronizationPackage::parse(&content).ok()?.report)
}

/// Bytes in hexadecimal, with spaces.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect::<Vec<_>>().join(" ")
}
