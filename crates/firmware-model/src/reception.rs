//! The receive interrupt routine, and the half of reception that the main routine runs.
//!
//! The interrupt only moves bytes into a ring; it looks at none. The main routine takes them out
//! again and advances the state machine of [`rsapien_protocol::Receiver`] with the tick counter
//! *of the moment it takes them out*, so both ends of the comparison need no time stamp a byte.
//!
//! ```text
//!             byte or line error, ring has a place: put
//!            ┌───────┐
//!            ▼       │   byte or line error, ring is full       main routine: ring is empty,
//!         Collecting ─┴──────────────────────────► Overflowed ──── one overrun is told ────► Collecting
//!                                                    │    ▲
//!                                                    └────┘ byte or line error: lost
//! ```
//!
//! In C the tick counter becomes one saturating byte: the timer routine adds one each tick, each
//! byte taken out clears it, and a package under way is abandoned when it is above 20.

use rsapien_protocol::{Address, Content, Counts, Fed, LineError, Receiver};

/// Places in the ring between the receive interrupt and the main routine. At 115200 baud 11.5
/// bytes come in a tick, so the main routine may be late by more than 2 ms without a loss.
pub const RECEIVE_RING_LENGTH: u8 = 32;

/// What the UART handed to the receive interrupt.
#[derive(Clone, Copy, Debug)]
enum Received {
    Byte(u8),
    Error(LineError),
}

#[derive(Clone, Debug)]
pub(crate) struct Reception {
    ring: [Received; RECEIVE_RING_LENGTH as usize],
    first: u8,
    count: u8,
    overflowed: bool,
    receiver: Receiver,
}

impl Reception {
    pub(crate) const fn new(address: Address) -> Reception {
        Reception {
            ring: [Received::Byte(0); RECEIVE_RING_LENGTH as usize],
            first: 0,
            count: 0,
            overflowed: false,
            receiver: Receiver::for_robot(address),
        }
    }

    pub(crate) fn receive_byte(&mut self, byte: u8) {
        self.put(Received::Byte(byte));
    }

    pub(crate) fn receive_error(&mut self, error: LineError) {
        self.put(Received::Error(error));
    }

    /// Main routine: takes bytes out until a package is complete or the ring is empty. Bytes
    /// behind a complete package wait for the next pass, so that no answer is lost.
    pub(crate) fn next_package(&mut self, now_ms: u64) -> Option<Content> {
        self.receiver.expire(now_ms);
        while let Some(received) = self.take() {
            match received {
                Received::Byte(byte) => {
                    if let Fed::Package(content) = self.receiver.feed(byte, now_ms) {
                        return Some(content);
                    }
                }
                Received::Error(error) => self.receiver.line_error(error),
            }
        }
        if self.overflowed {
            self.overflowed = false;
            self.receiver.line_error(LineError::Overrun);
        }
        None
    }

    pub(crate) const fn counts(&self) -> Counts {
        self.receiver.counts()
    }

    fn put(&mut self, received: Received) {
        // Once a byte is lost the ones behind it are worth nothing: all are dropped until the
        // main routine has seen the end of what came before and told the receiver.
        if self.overflowed || self.count == RECEIVE_RING_LENGTH {
            self.overflowed = true;
            return;
        }
        let place = usize::from((self.first + self.count) % RECEIVE_RING_LENGTH);
        self.ring[place] = received;
        self.count += 1;
    }

    fn take(&mut self) -> Option<Received> {
        if self.count == 0 {
            return None;
        }
        let received = self.ring[usize::from(self.first % RECEIVE_RING_LENGTH)];
        self.first = (self.first + 1) % RECEIVE_RING_LENGTH;
        self.count -= 1;
        Some(received)
    }
}
