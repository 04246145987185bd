//! Communication synchronization packages: what a controller answers.

use crate::frame::{
    self, SYNCHRONIZATION_CONTENT_LENGTH, SynchronizationBytes, synchronization as at,
};
use crate::{
    Address, AxisFlags, BumperMask, CameraReport, Content, CountersReport, Direction, HeaderByte,
    HelloReport, Kind, Mode, MotionReport, Pose, Report, Status, StopCause,
};

type Bytes = [u8; SYNCHRONIZATION_CONTENT_LENGTH];

/// A synchronization package, fully understood.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SynchronizationPackage {
    /// The session of the package it answers.
    pub session: u8,
    /// The sequence number of the package it answers.
    pub sequence: u8,
    /// The byte of the kind of the package it answers, known or not.
    pub kind_byte: u8,
    /// What the controller did with that package.
    pub status: Status,
    /// What the controller reports.
    pub report: Report,
}

/// An intact package whose content means nothing in this version.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BadReport {
    /// The status byte is above 9.
    #[error("status byte {byte} is above 9: the firmware is newer than this program")]
    Status {
        /// The byte.
        byte: u8,
    },
    /// The mode byte is above 5.
    #[error("mode byte {byte} is above 5: the firmware is newer than this program")]
    Mode {
        /// The byte.
        byte: u8,
    },
    /// The cause byte is above 5.
    #[error("cause byte {byte} is above 5: the firmware is newer than this program")]
    Cause {
        /// The byte.
        byte: u8,
    },
    /// The pose word has bits 14 or 15 set.
    #[error("pose word {word:#06x} has bits above the seven joints set")]
    Pose {
        /// The word.
        word: u16,
    },
}

impl SynchronizationPackage {
    /// The line bytes of the package, from the controller at `address`.
    pub fn encode(&self, address: Address) -> SynchronizationBytes {
        let header = HeaderByte { direction: Direction::ToPc, address };
        frame::encode(header, &self.content())
    }

    /// The content of the package.
    pub fn content(&self) -> Bytes {
        let mut content = [0; SYNCHRONIZATION_CONTENT_LENGTH];
        content[at::SESSION] = self.session;
        content[at::SEQUENCE] = self.sequence;
        content[at::KIND] = self.kind_byte;
        content[at::STATUS] = self.status.byte();
        match &self.report {
            Report::Motion(report) => put_motion(&mut content, report),
            Report::Camera(report) => put_camera(&mut content, report),
            Report::Hello(report) => put_hello(&mut content, report),
            Report::Counters(report) => put_counters(&mut content, report),
        }
        content
    }

    /// The package of a checked content. Its address and the kind it echoes say which report
    /// it carries.
    ///
    /// # Errors
    /// [`BadReport`] when a byte means nothing in this version.
    pub fn parse(content: &Content) -> Result<SynchronizationPackage, BadReport> {
        let bytes = content.synchronization();
        let kind_byte = bytes[at::KIND];
        let byte = bytes[at::STATUS];
        let status = Status::from_byte(byte).ok_or(BadReport::Status { byte })?;
        let report = match (Kind::from_byte(kind_byte), content.address()) {
            (Some(Kind::Hello), _) => Report::Hello(hello(bytes)?),
            (Some(Kind::Counters), _) => Report::Counters(counters(bytes)),
            (_, Address::Motion) => Report::Motion(motion(bytes)?),
            (_, Address::Camera) => Report::Camera(camera(bytes)?),
        };
        Ok(SynchronizationPackage {
            session: bytes[at::SESSION],
            sequence: bytes[at::SEQUENCE],
            kind_byte,
            status,
            report,
        })
    }
}

fn put_motion(content: &mut Bytes, report: &MotionReport) {
    let [left, right] = report.middle_switches;
    content[at::MODE] = report.mode.byte();
    content[at::INPUTS] = report.bumpers.bits() | u8::from(left) << 6 | u8::from(right) << 7;
    for (pair, place) in report.presses.chunks_exact(2).zip(&mut content[at::PRESSES..]) {
        *place = pair[0] & 0x0F | pair[1] << 4;
    }
    content[at::MOTORS] = report.motors & 0x7F | u8::from(report.supply_low) << 7;
    frame::put_word(content, at::POSE_REACHED, report.pose_reached.word());
    content[at::QUEUE_FREE] = report.queue_free;
    frame::put_word(content, at::STEPS_ENDED, report.steps_ended);
    put_tail(content, report.boot, report.reception_errors, report.cause);
}

fn motion(bytes: &Bytes) -> Result<MotionReport, BadReport> {
    let inputs = bytes[at::INPUTS];
    let mut presses = [0; BumperMask::COUNT];
    for (pair, byte) in presses.chunks_exact_mut(2).zip(&bytes[at::PRESSES..]) {
        pair[0] = byte & 0x0F;
        pair[1] = byte >> 4;
    }
    let word = frame::word(bytes, at::POSE_REACHED);
    Ok(MotionReport {
        mode: mode(bytes)?,
        bumpers: BumperMask::from_low_bits(inputs),
        middle_switches: [inputs & 0x40 != 0, inputs & 0x80 != 0],
        presses,
        motors: bytes[at::MOTORS] & 0x7F,
        supply_low: bytes[at::MOTORS] & 0x80 != 0,
        pose_reached: Pose::from_word(word).map_err(|_| BadReport::Pose { word })?,
        queue_free: bytes[at::QUEUE_FREE],
        steps_ended: frame::word(bytes, at::STEPS_ENDED),
        boot: bytes[at::BOOT],
        reception_errors: bytes[at::ERRORS],
        cause: cause(bytes)?,
    })
}

fn put_camera(content: &mut Bytes, report: &CameraReport) {
    content[at::MODE] = report.mode.byte();
    frame::put_word(content, at::PAN, report.pan_centideg.cast_unsigned());
    frame::put_word(content, at::TILT, report.tilt_centideg.cast_unsigned());
    frame::put_word(content, at::PAN_TARGET, report.pan_target_centideg.cast_unsigned());
    frame::put_word(content, at::TILT_TARGET, report.tilt_target_centideg.cast_unsigned());
    content[at::AXES] = report.axes.bits();
    put_tail(content, report.boot, report.reception_errors, report.cause);
}

fn camera(bytes: &Bytes) -> Result<CameraReport, BadReport> {
    Ok(CameraReport {
        mode: mode(bytes)?,
        pan_centideg: frame::word(bytes, at::PAN).cast_signed(),
        tilt_centideg: frame::word(bytes, at::TILT).cast_signed(),
        pan_target_centideg: frame::word(bytes, at::PAN_TARGET).cast_signed(),
        tilt_target_centideg: frame::word(bytes, at::TILT_TARGET).cast_signed(),
        axes: AxisFlags::from_bits(bytes[at::AXES]),
        boot: bytes[at::BOOT],
        reception_errors: bytes[at::ERRORS],
        cause: cause(bytes)?,
    })
}

fn put_hello(content: &mut Bytes, report: &HelloReport) {
    content[at::HELLO_VERSION] = report.version;
    content[at::HELLO_FIRMWARE..at::HELLO_CLOCK].copy_from_slice(&report.firmware);
    content[at::HELLO_CLOCK] = report.clock_mhz;
    content[at::HELLO_QUEUE] = report.queue_length;
    frame::put_word(content, at::HELLO_DEAD_MAN, report.dead_man_ms);
    content[at::HELLO_LAST_SEQUENCE] = report.last_sequence;
    put_tail(content, report.boot, report.reception_errors, report.cause);
}

fn hello(bytes: &Bytes) -> Result<HelloReport, BadReport> {
    let firmware = at::HELLO_FIRMWARE;
    Ok(HelloReport {
        version: bytes[at::HELLO_VERSION],
        firmware: [bytes[firmware], bytes[firmware + 1], bytes[firmware + 2]],
        clock_mhz: bytes[at::HELLO_CLOCK],
        queue_length: bytes[at::HELLO_QUEUE],
        dead_man_ms: frame::word(bytes, at::HELLO_DEAD_MAN),
        last_sequence: bytes[at::HELLO_LAST_SEQUENCE],
        boot: bytes[at::BOOT],
        reception_errors: bytes[at::ERRORS],
        cause: cause(bytes)?,
    })
}

fn put_counters(content: &mut Bytes, report: &CountersReport) {
    let counts = [
        report.accepted,
        report.resets,
        report.crc_errors,
        report.framing_errors,
        report.overruns,
        report.duplicates,
        report.dead_man_trips,
    ];
    for (index, count) in counts.into_iter().enumerate() {
        frame::put_word(content, at::COUNTERS + 2 * index, count);
    }
}

fn counters(bytes: &Bytes) -> CountersReport {
    let count = |index: usize| frame::word(bytes, at::COUNTERS + 2 * index);
    CountersReport {
        accepted: count(0),
        resets: count(1),
        crc_errors: count(2),
        framing_errors: count(3),
        overruns: count(4),
        duplicates: count(5),
        dead_man_trips: count(6),
    }
}

fn put_tail(content: &mut Bytes, boot: u8, reception_errors: u8, cause: StopCause) {
    content[at::BOOT] = boot;
    content[at::ERRORS] = reception_errors;
    content[at::CAUSE] = cause.byte();
}

fn mode(bytes: &Bytes) -> Result<Mode, BadReport> {
    let byte = bytes[at::MODE];
    Mode::from_byte(byte).ok_or(BadReport::Mode { byte })
}

fn cause(bytes: &Bytes) -> Result<StopCause, BadReport> {
    let byte = bytes[at::CAUSE];
    StopCause::from_byte(byte).ok_or(BadReport::Cause { byte })
}
