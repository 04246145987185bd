//! Every error of one to four bits and every burst of up to 16 line bits in a package is refused.
//!
//! Bits are taken in the order of the line: byte by byte, least significant bit first. All patterns
//! are fed to the real [`Receiver`], none is left to an argument, with two exceptions that the code
//! names: once reception is hunting again inside the package, fewer bytes are left than a package
//! has, so the rest of such patterns is counted without being fed.
//!
//! Start and stop bits: a burst of up to 16 bits on the line that damages them too damages data bits
//! that lie at most as far apart, so while bytes are still framed at their places it is one of the
//! bursts here. Where a stop bit reads 0 the UART tells a framing error, which resets reception;
//! where framing slips (a start bit is missed, or seen where none was), bytes come out shifted. The
//! last test goes through all of that too, with a UART of its own, for a few contents.
//!
//! Which patterns are refused does not depend on the content: flipping the low bits of a data or
//! synchronization byte keeps its class, flipping its top bits changes it, and the check is linear
//! (a pattern passes if its own check, begun at zero, is zero). So one content would do; the
//! examples of the specification and two others are gone through all the same.

use rsapien_protocol::{
    Address, ByteClass, Content, Direction, Fed, HeaderByte, LineError, Receiver, ReceptionState,
    frame,
};

const fn header(direction: Direction, address: Address) -> HeaderByte {
    HeaderByte { direction, address }
}

/// Bytes that look like nothing in particular, from a fixed seed.
fn scrambled<const N: usize>(seed: u32) -> [u8; N] {
    let mut state = seed;
    [(); N].map(|()| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        state.to_be_bytes()[0]
    })
}

fn actions() -> Vec<Vec<u8>> {
    let header = header(Direction::ToRobot, Address::Motion);
    let example = [1, 2, 4, 0xA5, 0x2A, 0x10, 0x27, 1, 0x3F, 0, 0, 0];
    [example, [0xFF; 12], [0; 12], scrambled(1), scrambled(2)]
        .map(|content| frame::encode::<12, 18>(header, &content).to_vec())
        .to_vec()
}

fn synchronizations() -> Vec<Vec<u8>> {
    [(Address::Motion, [0; 18]), (Address::Camera, scrambled(3))]
        .map(|(address, content)| {
            frame::encode::<18, 25>(header(Direction::ToPc, address), &content).to_vec()
        })
        .to_vec()
}

/// The receivers that hear a package, each with the packages: a robot's knows its own address, the
/// PC's takes either address, so for it a damaged header may still be one.
fn cases() -> Vec<(Receiver, Vec<u8>)> {
    let to_robot = actions().into_iter().map(|line| (Receiver::for_robot(Address::Motion), line));
    let to_pc = synchronizations().into_iter().map(|line| (Receiver::for_pc(), line));
    to_robot.chain(to_pc).collect()
}

fn binomial(n: u64, k: u64) -> u64 {
    (0..k).fold(1, |value, index| value * n.saturating_sub(index) / (index + 1))
}

/// How many patterns of up to `flips` bits there are in `bits` bits, the empty one included.
fn patterns(bits: u64, flips: u64) -> u64 {
    (0..=flips).map(|count| binomial(bits, count)).sum()
}

struct Enumeration<'line> {
    line: &'line [u8],
    /// Which changes of one byte flip at most 0, 1, 2, 3 or 4 of its bits.
    masks: [Vec<u8>; 5],
    accepted: u64,
    refused: u64,
}

impl Enumeration<'_> {
    /// Feeds the bytes from `place` on in every way that flips at most `flips` bits of them.
    fn run(&mut self, receiver: &Receiver, place: usize, flips: usize) {
        let Some(byte) = self.line.get(place) else {
            self.refused += 1;
            return;
        };
        for index in 0..self.masks[flips].len() {
            let mask = self.masks[flips][index];
            let left = flips - mask.count_ones() as usize;
            let mut next = receiver.clone();
            match next.feed(byte ^ mask, 0) {
                Fed::Package(_) => self.accepted += 1,
                _ if next.state() == ReceptionState::Hunting => {
                    // Too few bytes are left for a package, whatever becomes of them.
                    let bits = 8 * (self.line.len() - place - 1) as u64;
                    self.refused += patterns(bits, left as u64);
                }
                _ => self.run(&next, place + 1, left),
            }
        }
    }
}

#[test]
fn every_error_of_one_to_four_bits() {
    let masks = [0, 1, 2, 3, 4]
        .map(|flips| (0..=255u8).filter(|mask| mask.count_ones() <= flips).collect::<Vec<_>>());
    let mut total = 0;
    for (receiver, line) in cases() {
        let mut all = Enumeration { line: &line, masks: masks.clone(), accepted: 0, refused: 0 };
        all.run(&receiver, 0, 4);
        assert_eq!(all.accepted, 1, "only the undamaged package passes: {line:02x?}");
        assert_eq!(all.refused, patterns(8 * line.len() as u64, 4) - 1);
        total += all.refused;
    }
    println!("{total} patterns of 1 to 4 bits refused");
}

#[test]
fn every_burst_of_up_to_16_bits() {
    let mut total = 0u64;
    for (receiver, line) in cases() {
        let bits = 8 * line.len();
        let mut before = receiver.clone();
        for first in 0..bits {
            if first % 8 == 0 && first > 0 {
                before.feed(line[first / 8 - 1], 0);
            }
            let room = (bits - first).min(16);
            // The burst begins with a flipped bit; the bits behind it are flipped or not.
            for rest in 0..1u32 << (room - 1) {
                let mask = (rest << 1 | 1) << (first % 8);
                let mut receiver = before.clone();
                for (index, byte) in line[first / 8..].iter().enumerate() {
                    let flipped = mask.checked_shr(8 * u32::try_from(index).unwrap()).unwrap_or(0);
                    let fed = receiver.feed(byte ^ flipped.to_le_bytes()[0], 0);
                    assert!(!matches!(fed, Fed::Package(_)), "burst {mask:x} at bit {first}");
                    if receiver.state() == ReceptionState::Hunting {
                        break;
                    }
                }
                total += 1;
            }
        }
    }
    println!("{total} bursts of up to 16 bits refused");
}

#[test]
fn a_changed_class_resets_and_a_changed_header_is_skipped() {
    for (receiver, line) in cases() {
        let own = HeaderByte::from_byte(line[0]).unwrap();
        for (place, byte) in line.iter().enumerate() {
            for damaged in 0..=255u8 {
                let mut receiver = receiver.clone();
                for byte in &line[..place] {
                    receiver.feed(*byte, 0);
                }
                let fed = receiver.feed(damaged, 0);
                let is_own = HeaderByte::from_byte(damaged).is_some_and(|header| {
                    header.direction == own.direction
                        && (own.direction == Direction::ToPc || header.address == own.address)
                });
                if ByteClass::of(damaged) == ByteClass::Header {
                    assert_eq!(fed, if is_own { Fed::More } else { Fed::Skipped });
                    assert_eq!(receiver.counts().resets, u16::from(place > 0));
                } else if place == 0 {
                    assert_eq!(fed, Fed::Skipped);
                } else if ByteClass::of(damaged) != ByteClass::of(*byte) {
                    assert_eq!((fed, receiver.counts().resets), (Fed::Reset, 1));
                } else {
                    let completes = damaged == *byte && place + 1 == line.len();
                    assert_eq!(matches!(fed, Fed::Package(_)), completes);
                }
            }
        }
    }
}

/// A UART on the bits of a line that idles at 1: 8N1, sampled once a bit.
fn receive(mut receiver: Receiver, bits: &[bool]) -> Option<Content> {
    let mut accepted = None;
    let mut at = 0;
    while at < bits.len() {
        if bits[at] {
            at += 1;
            continue;
        }
        let byte = (0..8).fold(0, |byte, index| {
            byte | u8::from(bits.get(at + 1 + index).copied().unwrap_or(true)) << index
        });
        if bits.get(at + 9).copied().unwrap_or(true) {
            if let Fed::Package(content) = receiver.feed(byte, 0) {
                accepted = Some(content);
            }
        } else {
            receiver.line_error(LineError::Framing);
        }
        at += 10;
        // After a framing error the line has to come back to 1 before a start bit can be seen.
        while at < bits.len() && !bits[at - 1] && !bits[at] {
            at += 1;
        }
    }
    accepted
}

#[test]
fn every_burst_of_up_to_16_bits_start_and_stop_bits_included() {
    // A frame that begins a bit late may still give the same byte, and so the same package.
    let mut unharmed = 0u64;
    let mut total = 0u64;
    for (receiver, line) in cases().into_iter().step_by(3) {
        let clean: Vec<bool> = line
            .iter()
            .flat_map(|byte| {
                let data = (0..8).map(move |index| byte >> index & 1 == 1);
                [false].into_iter().chain(data).chain([true])
            })
            .collect();
        let undamaged = receive(receiver.clone(), &clean);
        assert!(undamaged.is_some());
        for first in 0..clean.len() {
            let room = (clean.len() - first).min(16);
            for rest in 0..1u32 << (room - 1) {
                let mut bits = [true; 250];
                let bits = &mut bits[..clean.len()];
                bits.copy_from_slice(&clean);
                for (index, bit) in bits[first..first + room].iter_mut().enumerate() {
                    *bit ^= (rest << 1 | 1) >> index & 1 == 1;
                }
                let accepted = receive(receiver.clone(), bits);
                if accepted == undamaged {
                    unharmed += 1;
                } else {
                    assert_eq!(accepted, None, "burst {rest:x} at line bit {first} of {line:02x?}");
                }
                total += 1;
            }
        }
    }
    println!(
        "{total} bursts of up to 16 bits, start and stop bits included: {unharmed} left every byte as it was"
    );
}
