//! Classes of line bytes: the top bits say what a byte is, so a receiver that joins anywhere
//! knows where it is.

/// The protocol version this crate speaks.
pub const PROTOCOL_VERSION: u8 = 1;

/// What the top bits of a line byte make it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ByteClass {
    /// `0xxxxxxx`: the low seven bits of a content byte, or CRC bits.
    Data,
    /// `10mmmmmm`: bit `i` is the top bit of the `i`-th of the six data bytes behind it.
    Synchronization,
    /// `11daavvv`: begins a package.
    Header,
}

impl ByteClass {
    /// The class of a line byte.
    #[inline]
    pub const fn of(byte: u8) -> ByteClass {
        match byte >> 6 {
            0 | 1 => ByteClass::Data,
            2 => ByteClass::Synchronization,
            _ => ByteClass::Header,
        }
    }
}

/// Which way a package goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Direction {
    /// An action package.
    ToRobot = 0,
    /// A communication synchronization package.
    ToPc = 1,
}

/// A controller on the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum Address {
    /// The PIC18F452 that moves the robot.
    Motion = 1,
    /// The PIC18F2320 that positions the camera.
    Camera = 2,
}

impl Address {
    /// Both controllers.
    pub const ALL: [Address; 2] = [Address::Motion, Address::Camera];

    /// The name as users write it.
    pub const fn name(self) -> &'static str {
        match self {
            Address::Motion => "motion",
            Address::Camera => "camera",
        }
    }
}

impl core::fmt::Display for Address {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        formatter.write_str(self.name())
    }
}

/// A header byte of this version.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct HeaderByte {
    /// Which way the package goes.
    pub direction: Direction,
    /// Whose package it is.
    pub address: Address,
}

impl HeaderByte {
    /// The byte on the line.
    pub const fn byte(self) -> u8 {
        0xC0 | (self.direction as u8) << 5 | (self.address as u8) << 3 | PROTOCOL_VERSION
    }

    /// The header of a byte; none for another class, a reserved address or another version.
    #[inline]
    pub const fn from_byte(byte: u8) -> Option<HeaderByte> {
        if !matches!(ByteClass::of(byte), ByteClass::Header) || byte & 7 != PROTOCOL_VERSION {
            return None;
        }
        let direction = if byte & 0x20 == 0 { Direction::ToRobot } else { Direction::ToPc };
        match byte >> 3 & 3 {
            1 => Some(HeaderByte { direction, address: Address::Motion }),
            2 => Some(HeaderByte { direction, address: Address::Camera }),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_has_one_class_and_headers_are_four() {
        let mut headers = 0;
        for byte in 0..=255u8 {
            let class = match byte {
                0..=0x7F => ByteClass::Data,
                0x80..=0xBF => ByteClass::Synchronization,
                0xC0..=0xFF => ByteClass::Header,
            };
            assert_eq!(ByteClass::of(byte), class);
            if let Some(header) = HeaderByte::from_byte(byte) {
                assert_eq!(header.byte(), byte);
                assert_eq!(class, ByteClass::Header);
                headers += 1;
            }
        }
        assert_eq!(headers, 4);
    }
}
