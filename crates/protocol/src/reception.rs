//! Reception: line bytes in, checked contents out. One state machine, the same on both ends.
//!
//! ```text
//!              header for me                sync byte            sixth data byte, groups left
//!  Hunting ───────────────────► Synchronization ─────► Data ──────────────► Synchronization
//!     ▲                                                  │ sixth data byte, last group
//!     │  wrong class, gap, line error (counted)          ▼
//!     ├───────────────────────────────────────────────  Check ── third byte: package or CRC error ─► Hunting
//! ```
//!
//! A header byte in any state abandons what was under way and starts afresh.

use crate::frame::{self, GROUP_DATA_LENGTH, SYNCHRONIZATION_CONTENT_LENGTH};
use crate::{ACTION_CONTENT_LENGTH, Address, ByteClass, Direction, HeaderByte, crc};

/// The longest silence between two bytes of a package at the robot, in ms.
pub const GAP_MS_ROBOT: u64 = 20;
/// The longest silence between two bytes of a package at the PC, whose USB adapter holds bytes
/// back, in ms.
pub const GAP_MS_PC: u64 = 50;

/// Where reception stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum ReceptionState {
    /// Waits for a header; every other byte is skipped.
    Hunting = 0,
    /// The next byte is a synchronization byte.
    Synchronization = 1,
    /// The next byte is a data byte of a group.
    Data = 2,
    /// The next byte is a byte of check.
    Check = 3,
}

/// What the UART says of a byte that it could not receive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LineError {
    /// No stop bit where one belongs.
    Framing,
    /// A byte was lost because nobody fetched the one before.
    Overrun,
}

/// 16-bit counts of what reception met, modulo 65536.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Counts {
    /// Packages with a right check.
    pub accepted: u16,
    /// Packages abandoned: wrong class, gap, line error or a new header inside a package.
    pub resets: u16,
    /// Packages dropped for their check.
    pub crc_errors: u16,
    /// Framing errors.
    pub framing_errors: u16,
    /// Overruns.
    pub overruns: u16,
    /// All of the errors, each event once: what the report's byte 16 tells modulo 256.
    pub errors: u16,
}

/// A checked content.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Content {
    address: Address,
    direction: Direction,
    bytes: [u8; SYNCHRONIZATION_CONTENT_LENGTH],
}

impl Content {
    /// Whose package it is.
    pub const fn address(&self) -> Address {
        self.address
    }

    /// Which way it went.
    pub const fn direction(&self) -> Direction {
        self.direction
    }

    /// The content of an action package (of one to the PC: its first twelve bytes).
    pub fn action(&self) -> &[u8; ACTION_CONTENT_LENGTH] {
        let (first, _) =
            self.bytes.split_first_chunk().unwrap_or((&[0; ACTION_CONTENT_LENGTH], &[]));
        first
    }

    /// The content of a synchronization package (of one to the robot: padded with zeros).
    pub const fn synchronization(&self) -> &[u8; SYNCHRONIZATION_CONTENT_LENGTH] {
        &self.bytes
    }
}

/// What one byte did.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fed {
    /// The byte has its place; the package goes on.
    More,
    /// Not part of a package for this receiver.
    Skipped,
    /// The byte completed a package, intact by its check.
    Package(Content),
    /// The byte completed a package whose check is wrong; dropped and counted.
    CrcError,
    /// The byte is of the wrong class for its place; the package is abandoned and counted.
    Reset,
}

/// The state machine of reception.
#[derive(Clone, Debug)]
pub struct Receiver {
    direction: Direction,
    own_address: Option<Address>,
    gap_ms: u64,
    state: ReceptionState,
    last_byte_ms: u64,
    check: u16,
    check_received: u16,
    top_bits: u8,
    group_index: u8,
    content_index: u8,
    content: Content,
    counts: Counts,
}

impl Receiver {
    /// A controller's receiver: action packages to `address`.
    pub const fn for_robot(address: Address) -> Receiver {
        Receiver::new(Direction::ToRobot, Some(address), GAP_MS_ROBOT)
    }

    /// The PC's receiver: synchronization packages of either controller.
    pub const fn for_pc() -> Receiver {
        Receiver::new(Direction::ToPc, None, GAP_MS_PC)
    }

    /// A listener on the line: packages of `direction` with either address, with the gap of the
    /// receiver they are meant for.
    pub const fn listening(direction: Direction) -> Receiver {
        match direction {
            Direction::ToRobot => Receiver::new(direction, None, GAP_MS_ROBOT),
            Direction::ToPc => Receiver::new(direction, None, GAP_MS_PC),
        }
    }

    const fn new(direction: Direction, own_address: Option<Address>, gap_ms: u64) -> Receiver {
        Receiver {
            direction,
            own_address,
            gap_ms,
            state: ReceptionState::Hunting,
            last_byte_ms: 0,
            check: 0,
            check_received: 0,
            top_bits: 0,
            group_index: 0,
            content_index: 0,
            content: Content {
                address: Address::Motion,
                direction,
                bytes: [0; SYNCHRONIZATION_CONTENT_LENGTH],
            },
            counts: Counts {
                accepted: 0,
                resets: 0,
                crc_errors: 0,
                framing_errors: 0,
                overruns: 0,
                errors: 0,
            },
        }
    }

    /// Where reception stands.
    pub const fn state(&self) -> ReceptionState {
        self.state
    }

    /// What was counted so far.
    pub const fn counts(&self) -> Counts {
        self.counts
    }

    /// When the package under way is abandoned if no further byte comes: the first ms at which
    /// [`expire`](Receiver::expire) resets it. None while hunting.
    pub const fn deadline_ms(&self) -> Option<u64> {
        match self.state {
            ReceptionState::Hunting => None,
            _ => Some(self.last_byte_ms.saturating_add(self.gap_ms + 1)),
        }
    }

    /// Abandons the package under way when more than the gap has passed since its last byte.
    /// Returns whether it did. [`feed`](Receiver::feed) calls it first.
    pub fn expire(&mut self, now_ms: u64) -> bool {
        let expired = self.state != ReceptionState::Hunting
            && now_ms.saturating_sub(self.last_byte_ms) > self.gap_ms;
        if expired {
            self.reset();
        }
        expired
    }

    /// Takes one line byte that came at `now_ms`.
    #[inline]
    pub fn feed(&mut self, byte: u8, now_ms: u64) -> Fed {
        self.expire(now_ms);
        self.last_byte_ms = now_ms;
        let class = ByteClass::of(byte);
        if class == ByteClass::Header {
            return self.begin(byte);
        }
        match (self.state, class) {
            (ReceptionState::Hunting, _) => Fed::Skipped,
            (ReceptionState::Synchronization, ByteClass::Synchronization) => {
                self.top_bits = byte;
                self.group_index = 0;
                self.check = crc::update(self.check, byte);
                self.state = ReceptionState::Data;
                Fed::More
            }
            (ReceptionState::Data, ByteClass::Data) => {
                self.take_data(byte);
                Fed::More
            }
            (ReceptionState::Check, ByteClass::Data) => self.take_check(byte),
            _ => {
                self.reset();
                Fed::Reset
            }
        }
    }

    /// Takes line bytes that came at `now_ms`, up to the end of the first intact package. Gives its
    /// content, if there is one, and the bytes behind it, which are still to be fed.
    ///
    /// It does exactly what [`feed`](Receiver::feed) does byte by byte, but several times faster
    /// where whole packages lie in `bytes`.
    pub fn feed_slice<'bytes>(
        &mut self,
        mut bytes: &'bytes [u8],
        now_ms: u64,
    ) -> (Option<Content>, &'bytes [u8]) {
        if !bytes.is_empty() {
            self.expire(now_ms);
        }
        while let Some((first, rest)) = bytes.split_first() {
            if self.state == ReceptionState::Hunting
                && let Some(content) = self.whole_package(bytes)
            {
                self.last_byte_ms = now_ms;
                return (Some(content), &bytes[frame::line_length(self.direction)..]);
            }
            if let Fed::Package(content) = self.feed(*first, now_ms) {
                return (Some(content), rest);
            }
            bytes = rest;
        }
        (None, bytes)
    }

    /// The content of the intact package that `bytes` begin with. For anything else nothing is
    /// done: `feed` finds out what it is.
    #[inline]
    fn whole_package(&mut self, bytes: &[u8]) -> Option<Content> {
        let header = *bytes.first()?;
        let address = self.address_if_mine(header)?;
        let contents = match self.direction {
            Direction::ToRobot => frame::decode::<ACTION_CONTENT_LENGTH>(bytes)?,
            Direction::ToPc => frame::decode::<SYNCHRONIZATION_CONTENT_LENGTH>(bytes)?,
        };
        self.content = Content { address, direction: self.direction, bytes: contents };
        self.counts.accepted = self.counts.accepted.wrapping_add(1);
        Some(self.content)
    }

    /// Takes note of a byte that the UART could not receive.
    pub fn line_error(&mut self, error: LineError) {
        let count = match error {
            LineError::Framing => &mut self.counts.framing_errors,
            LineError::Overrun => &mut self.counts.overruns,
        };
        *count = count.wrapping_add(1);
        self.counts.errors = self.counts.errors.wrapping_add(1);
        if self.state != ReceptionState::Hunting {
            self.counts.resets = self.counts.resets.wrapping_add(1);
            self.state = ReceptionState::Hunting;
        }
    }

    fn begin(&mut self, byte: u8) -> Fed {
        if self.state != ReceptionState::Hunting {
            self.reset();
        }
        let Some(address) = self.address_if_mine(byte) else { return Fed::Skipped };
        self.content.address = address;
        self.content_index = 0;
        self.check = crc::update(crc::INITIAL, byte);
        self.state = ReceptionState::Synchronization;
        Fed::More
    }

    /// The address in a header byte that begins a package for this receiver.
    #[inline]
    fn address_if_mine(&self, byte: u8) -> Option<Address> {
        let header = HeaderByte::from_byte(byte)?;
        let mine = header.direction == self.direction
            && self.own_address.is_none_or(|address| address == header.address);
        mine.then_some(header.address)
    }

    #[inline]
    fn take_data(&mut self, byte: u8) {
        let top_bit = (self.top_bits >> self.group_index & 1) << 7;
        if let Some(place) = self.content.bytes.get_mut(usize::from(self.content_index)) {
            *place = byte | top_bit;
        }
        self.check = crc::update(self.check, byte);
        self.content_index += 1;
        self.group_index += 1;
        if usize::from(self.group_index) == GROUP_DATA_LENGTH {
            self.state = ReceptionState::Synchronization;
            if usize::from(self.content_index) == frame::content_length(self.direction) {
                self.group_index = 0;
                self.check_received = 0;
                self.state = ReceptionState::Check;
            }
        }
    }

    fn take_check(&mut self, byte: u8) -> Fed {
        let is_last = usize::from(self.group_index) == frame::CHECK_LENGTH - 1;
        if is_last && byte > frame::LAST_CHECK_BYTE_MAX {
            self.reset();
            return Fed::Reset;
        }
        self.check_received |= u16::from(byte) << (7 * self.group_index);
        self.group_index += 1;
        if !is_last {
            return Fed::More;
        }
        self.state = ReceptionState::Hunting;
        if self.check_received == self.check {
            self.counts.accepted = self.counts.accepted.wrapping_add(1);
            Fed::Package(self.content)
        } else {
            self.counts.crc_errors = self.counts.crc_errors.wrapping_add(1);
            self.counts.errors = self.counts.errors.wrapping_add(1);
            Fed::CrcError
        }
    }

    fn reset(&mut self) {
        self.counts.resets = self.counts.resets.wrapping_add(1);
        self.counts.errors = self.counts.errors.wrapping_add(1);
        self.state = ReceptionState::Hunting;
    }
}
