//! Where each byte stands: the form of a package on the line and of its content.
//!
//! This is the only place of the crate that knows a byte offset. A package is one header, then
//! groups of one synchronization byte and six data bytes, then three bytes of check.

use crate::{Direction, HeaderByte, crc};

/// Content bytes of an action package.
pub const ACTION_CONTENT_LENGTH: usize = 12;
/// Content bytes of a synchronization package.
pub const SYNCHRONIZATION_CONTENT_LENGTH: usize = 18;
/// Data bytes behind one synchronization byte.
pub const GROUP_DATA_LENGTH: usize = 6;
/// Bytes of check that end a package.
pub const CHECK_LENGTH: usize = 3;
/// Line bytes of an action package.
pub const ACTION_PACKAGE_LENGTH: usize = package_length(ACTION_CONTENT_LENGTH);
/// Line bytes of a synchronization package.
pub const SYNCHRONIZATION_PACKAGE_LENGTH: usize = package_length(SYNCHRONIZATION_CONTENT_LENGTH);
/// The largest value of the last byte of check, which carries two bits.
pub const LAST_CHECK_BYTE_MAX: u8 = 3;

/// An action package as it stands on the line.
pub type ActionBytes = [u8; ACTION_PACKAGE_LENGTH];
/// A synchronization package as it stands on the line.
pub type SynchronizationBytes = [u8; SYNCHRONIZATION_PACKAGE_LENGTH];

const fn package_length(content_length: usize) -> usize {
    1 + content_length / GROUP_DATA_LENGTH * (GROUP_DATA_LENGTH + 1) + CHECK_LENGTH
}

/// Content bytes of a package that goes in `direction`.
pub const fn content_length(direction: Direction) -> usize {
    match direction {
        Direction::ToRobot => ACTION_CONTENT_LENGTH,
        Direction::ToPc => SYNCHRONIZATION_CONTENT_LENGTH,
    }
}

/// The time that `line_bytes` take on the line at 8N1 (ten bits a byte), in ms, rounded up.
///
/// # Panics
/// When `baud` is 0.
pub const fn line_time_ms(line_bytes: usize, baud: u32) -> u64 {
    (line_bytes as u64 * 10_000).div_ceil(baud as u64)
}

/// Writes a package's line bytes from its content.
///
/// # Panics
/// When the lengths are not those of one package: `CONTENT` a multiple of six and `LINE` the
/// package length that goes with it. Both are constants, so a wrong pair cannot be compiled.
pub fn encode<const CONTENT: usize, const LINE: usize>(
    header: HeaderByte,
    content: &[u8; CONTENT],
) -> [u8; LINE] {
    const {
        assert!(CONTENT.is_multiple_of(GROUP_DATA_LENGTH) && LINE == package_length(CONTENT));
    }
    let mut line = [0; LINE];
    line[0] = header.byte();
    let (body, check_bytes) = line[1..].split_at_mut(LINE - 1 - CHECK_LENGTH);
    let groups = content.chunks_exact(GROUP_DATA_LENGTH);
    for (group, bytes) in body.chunks_exact_mut(GROUP_DATA_LENGTH + 1).zip(groups) {
        let mut top_bits = 0;
        for (index, byte) in bytes.iter().enumerate() {
            top_bits |= byte >> 7 << index;
            group[1 + index] = byte & 0x7F;
        }
        group[0] = 0x80 | top_bits;
    }
    let mut check = crc::update(crc::INITIAL, header.byte());
    for byte in body.iter() {
        check = crc::update(check, *byte);
    }
    check_bytes.copy_from_slice(&check_to_bytes(check));
    line
}

/// Line bytes of a package that goes in `direction`.
pub const fn line_length(direction: Direction) -> usize {
    package_length(content_length(direction))
}

/// The content of the intact package that `line` begins with, whatever its header, in the first
/// `CONTENT` of the bytes given. None when a class or the check is wrong or bytes are missing.
///
/// A group of seven bytes is taken as one word, its synchronization byte lowest.
#[inline]
pub(crate) fn decode<const CONTENT: usize>(
    line: &[u8],
) -> Option<[u8; SYNCHRONIZATION_CONTENT_LENGTH]> {
    const CLASS_MASK: u64 = 0x0080_8080_8080_80C0;
    const CLASSES: u64 = 0x80;
    /// Times six bits in the low end of a word: bit `i` comes to stand at bit `8 * i + 7`, where no
    /// two of the products meet.
    const SPREAD: u64 = 1 << 7 | 1 << 14 | 1 << 21 | 1 << 28 | 1 << 35 | 1 << 42;
    const TOP_BITS: u64 = 0x8080_8080_8080;

    let line = line.get(..package_length(CONTENT))?;
    let (header, line) = line.split_first()?;
    let (body, check_bytes) = line.split_last_chunk::<CHECK_LENGTH>()?;
    let mut check = crc::update(crc::INITIAL, *header);
    let mut classes_are_right = true;
    let mut content = [0; SYNCHRONIZATION_CONTENT_LENGTH];
    let groups = body.as_chunks::<{ GROUP_DATA_LENGTH + 1 }>().0;
    for (group, place) in groups.iter().zip(content.as_chunks_mut::<GROUP_DATA_LENGTH>().0) {
        let mut bytes = [0; 8];
        bytes[..group.len()].copy_from_slice(group);
        let word = u64::from_le_bytes(bytes);
        classes_are_right &= word & CLASS_MASK == CLASSES;
        let top_bits = (word & 0x3F).wrapping_mul(SPREAD) & TOP_BITS;
        let [bytes @ .., _, _] = (word >> 8 | top_bits).to_le_bytes();
        *place = bytes;
        check = crc::update_group(check, *group);
    }
    (classes_are_right && *check_bytes == check_to_bytes(check)).then_some(content)
}

/// The check as three data bytes: bits 0-6, bits 7-13, bits 14-15.
pub const fn check_to_bytes(check: u16) -> [u8; CHECK_LENGTH] {
    [(check & 0x7F) as u8, (check >> 7 & 0x7F) as u8, (check >> 14) as u8]
}

/// Offsets in the content of an action package.
pub(crate) mod action {
    pub(crate) const SESSION: usize = 0;
    pub(crate) const SEQUENCE: usize = 1;
    pub(crate) const KIND: usize = 2;
    pub(crate) const ARGUMENTS: usize = 3;

    pub(crate) const HELLO_LOWEST: usize = 3;
    pub(crate) const HELLO_HIGHEST: usize = 4;
    pub(crate) const HELLO_SESSION: usize = 5;
    pub(crate) const HELLO_END: usize = 6;

    pub(crate) const STEP_POSE: usize = 3;
    pub(crate) const STEP_DURATION: usize = 5;
    pub(crate) const STEP_FLAGS: usize = 7;
    pub(crate) const STEP_BUMPERS: usize = 8;
    pub(crate) const STEP_END: usize = 9;

    pub(crate) const CONFIGURE_PARAMETER: usize = 3;
    pub(crate) const CONFIGURE_VALUE: usize = 4;
    pub(crate) const CONFIGURE_END: usize = 6;

    pub(crate) const AIM_PAN: usize = 3;
    pub(crate) const AIM_TILT: usize = 5;
    pub(crate) const AIM_SPEED: usize = 7;
    pub(crate) const AIM_END: usize = 9;
}

/// Offsets in the content of a synchronization package.
pub(crate) mod synchronization {
    pub(crate) const SESSION: usize = 0;
    pub(crate) const SEQUENCE: usize = 1;
    pub(crate) const KIND: usize = 2;
    pub(crate) const STATUS: usize = 3;

    pub(crate) const MODE: usize = 4;
    pub(crate) const INPUTS: usize = 5;
    pub(crate) const PRESSES: usize = 6;
    pub(crate) const MOTORS: usize = 9;
    pub(crate) const POSE_REACHED: usize = 10;
    pub(crate) const QUEUE_FREE: usize = 12;
    pub(crate) const STEPS_ENDED: usize = 13;
    pub(crate) const BOOT: usize = 15;
    pub(crate) const ERRORS: usize = 16;
    pub(crate) const CAUSE: usize = 17;

    pub(crate) const PAN: usize = 5;
    pub(crate) const TILT: usize = 7;
    pub(crate) const PAN_TARGET: usize = 9;
    pub(crate) const TILT_TARGET: usize = 11;
    pub(crate) const AXES: usize = 13;

    pub(crate) const HELLO_VERSION: usize = 4;
    pub(crate) const HELLO_FIRMWARE: usize = 5;
    pub(crate) const HELLO_CLOCK: usize = 8;
    pub(crate) const HELLO_QUEUE: usize = 9;
    pub(crate) const HELLO_DEAD_MAN: usize = 10;
    pub(crate) const HELLO_LAST_SEQUENCE: usize = 12;

    pub(crate) const COUNTERS: usize = 4;
}

/// Reads a little-endian 16-bit word of a content.
pub(crate) fn word<const N: usize>(content: &[u8; N], offset: usize) -> u16 {
    u16::from_le_bytes([content[offset], content[offset + 1]])
}

/// Writes a little-endian 16-bit word into a content.
pub(crate) fn put_word<const N: usize>(content: &mut [u8; N], offset: usize, word: u16) {
    content[offset..offset + 2].copy_from_slice(&word.to_le_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Address;

    #[test]
    fn lengths_and_times_of_the_specification() {
        assert_eq!((ACTION_PACKAGE_LENGTH, SYNCHRONIZATION_PACKAGE_LENGTH), (18, 25));
        assert_eq!(line_time_ms(ACTION_PACKAGE_LENGTH, 57_600), 4);
        assert_eq!(line_time_ms(SYNCHRONIZATION_PACKAGE_LENGTH, 57_600), 5);
    }

    #[test]
    fn worked_bytes_of_the_specification() {
        let header = HeaderByte { direction: Direction::ToRobot, address: Address::Motion };
        let example = [1, 2, 4, 0xA5, 0x2A, 0x10, 0x27, 1, 0x3F, 0, 0, 0];
        let mut expected =
            [0xC9, 0x88, 1, 2, 4, 0x25, 0x2A, 0x10, 0x80, 0x27, 1, 0x3F, 0, 0, 0, 0x4B, 0x31, 0];
        assert_eq!(encode::<12, 18>(header, &example), expected);
        expected = [
            0xC9, 0xBF, 0x7F, 0x7F, 0x7F, 0x7F, 0x7F, 0x7F, 0xBF, 0x7F, 0x7F, 0x7F, 0x7F, 0x7F,
            0x7F, 0x32, 0x51, 2,
        ];
        assert_eq!(encode::<12, 18>(header, &[0xFF; 12]), expected);
        expected = [0xC9, 0x80, 0, 0, 0, 0, 0, 0, 0x80, 0, 0, 0, 0, 0, 0, 0x7E, 0x1E, 0];
        assert_eq!(encode::<12, 18>(header, &[0; 12]), expected);
    }
}
