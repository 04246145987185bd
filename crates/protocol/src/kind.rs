//! Kinds of action packages.

use crate::Address;

/// What an action package asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Kind {
    /// Opens a session.
    Hello = 0x01,
    /// Interrogation of the state, and the heartbeat.
    State = 0x02,
    /// All motors off, queue emptied.
    Stop = 0x03,
    /// Interrogation of the counters.
    Counters = 0x04,
    /// Robot initialisation: every joint is driven to its middle position.
    Init = 0x10,
    /// Queues a step of an action.
    Step = 0x11,
    /// Sets a parameter.
    Configure = 0x12,
    /// Sends the camera's axes to a direction.
    Aim = 0x20,
    /// Drives both camera axes to zero.
    Home = 0x21,
}

impl Kind {
    /// Every kind, in the order of its byte.
    pub const ALL: [Kind; 9] = [
        Kind::Hello,
        Kind::State,
        Kind::Stop,
        Kind::Counters,
        Kind::Init,
        Kind::Step,
        Kind::Configure,
        Kind::Aim,
        Kind::Home,
    ];

    /// The kind of a byte; none for the bytes that mean nothing in this version.
    pub const fn from_byte(byte: u8) -> Option<Kind> {
        match byte {
            0x01 => Some(Kind::Hello),
            0x02 => Some(Kind::State),
            0x03 => Some(Kind::Stop),
            0x04 => Some(Kind::Counters),
            0x10 => Some(Kind::Init),
            0x11 => Some(Kind::Step),
            0x12 => Some(Kind::Configure),
            0x20 => Some(Kind::Aim),
            0x21 => Some(Kind::Home),
            _ => None,
        }
    }

    /// The byte on the line.
    pub const fn byte(self) -> u8 {
        self as u8
    }

    /// Whether it is executed only in its turn, under a session and a sequence number.
    pub const fn is_numbered(self) -> bool {
        self as u8 >= 0x10
    }

    /// Whether the controller at `address` serves it; if not, it answers status 8.
    ///
    /// CONFIGURE sets the dead-man, which both controllers have, and travel times, which the
    /// camera controller refuses as a bad argument.
    pub const fn is_served_by(self, address: Address) -> bool {
        match self {
            Kind::Hello | Kind::State | Kind::Stop | Kind::Counters | Kind::Configure => true,
            Kind::Init | Kind::Step => matches!(address, Address::Motion),
            Kind::Aim | Kind::Home => matches!(address, Address::Camera),
        }
    }

    /// The name as the specification writes it.
    pub const fn name(self) -> &'static str {
        match self {
            Kind::Hello => "HELLO",
            Kind::State => "STATE",
            Kind::Stop => "STOP",
            Kind::Counters => "COUNTERS",
            Kind::Init => "INIT",
            Kind::Step => "STEP",
            Kind::Configure => "CONFIGURE",
            Kind::Aim => "AIM",
            Kind::Home => "HOME",
        }
    }
}

impl core::fmt::Display for Kind {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        formatter.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_is_one_kind_or_none() {
        for byte in 0..=255u8 {
            let known = Kind::ALL.into_iter().filter(|kind| kind.byte() == byte).count();
            assert_eq!(usize::from(Kind::from_byte(byte).is_some()), known);
            if let Some(kind) = Kind::from_byte(byte) {
                assert_eq!(kind.byte(), byte);
                assert_eq!(kind.is_numbered(), byte >= 0x10);
                assert!(kind.is_served_by(Address::Motion) || kind.is_served_by(Address::Camera));
            }
        }
    }
}
