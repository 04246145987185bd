//! Statuses: how a controller answers an action package.

/// What a controller did with an action package.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, thiserror::Error)]
#[repr(u8)]
pub enum Status {
    /// Done, or accepted and under way.
    #[error("accepted")]
    Accepted = 0,
    /// The kind means nothing to this version of the firmware.
    #[error("unknown kind: the firmware is older than this program")]
    UnknownKind = 1,
    /// An argument is out of its range, or an unused byte is not zero.
    #[error("bad argument: out of range, or an unused byte is not zero")]
    BadArgument = 2,
    /// No place in the queue; nothing was queued.
    #[error("queue full: nothing was queued, wait until steps have ended")]
    QueueFull = 3,
    /// The session named is not the open one.
    #[error("no session: open one with HELLO")]
    NoSession = 4,
    /// Not the number after the last executed one.
    #[error("out of sequence: not the number after the last executed one")]
    OutOfSequence = 5,
    /// Stopped by the dead-man or by a bumper that ends the action.
    #[error("held by the dead-man or by a bumper that ends the action: INIT or STOP releases it")]
    Held = 6,
    /// No version in common.
    #[error("version not spoken: program and firmware have no protocol version in common")]
    VersionNotSpoken = 7,
    /// The other controller serves this kind.
    #[error("not this controller's: the other controller serves this kind")]
    NotThisControllers = 8,
    /// A step before INIT, or an aim before HOME.
    #[error("not initialised: INIT comes before a step, HOME before an aim")]
    NotInitialised = 9,
}

impl Status {
    /// Every status, in the order of its byte.
    pub const ALL: [Status; 10] = [
        Status::Accepted,
        Status::UnknownKind,
        Status::BadArgument,
        Status::QueueFull,
        Status::NoSession,
        Status::OutOfSequence,
        Status::Held,
        Status::VersionNotSpoken,
        Status::NotThisControllers,
        Status::NotInitialised,
    ];

    /// The refusals in the order in which a controller tells them where several apply.
    pub const PRECEDENCE: [Status; 9] = [
        Status::UnknownKind,
        Status::NotThisControllers,
        Status::BadArgument,
        Status::VersionNotSpoken,
        Status::NoSession,
        Status::OutOfSequence,
        Status::NotInitialised,
        Status::Held,
        Status::QueueFull,
    ];

    /// The status of a byte; none above 9.
    pub const fn from_byte(byte: u8) -> Option<Status> {
        if (byte as usize) < Status::ALL.len() { Some(Status::ALL[byte as usize]) } else { None }
    }

    /// The byte on the line, 0..=9.
    pub const fn byte(self) -> u8 {
        self as u8
    }

    /// Whether the package was accepted.
    pub const fn is_accepted(self) -> bool {
        matches!(self, Status::Accepted)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_is_one_status_or_none() {
        for byte in 0..=255u8 {
            assert_eq!(Status::from_byte(byte).map(Status::byte), (byte < 10).then_some(byte));
        }
    }

    #[test]
    fn the_precedence_names_every_refusal_once() {
        for status in Status::ALL {
            let told = Status::PRECEDENCE.iter().filter(|other| **other == status).count();
            assert_eq!(told, usize::from(!status.is_accepted()));
        }
    }
}
