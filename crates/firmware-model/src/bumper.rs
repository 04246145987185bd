//! How the main routine tests the bumpers.
//!
//! ```text
//!  each bumper:   differs from what is believed ─► differing + 1 ─► = 5: believed; a press is counted
//!                 as believed                   ─► differing = 0
//! ```
//!
//! The bumpers are tested once a tick, in the first pass of the main routine after it. A change
//! is believed when [`BUMPER_DEBOUNCE_TESTS`] tests in a row have seen it, so 4 ms after the
//! first of them. At reset no bumper is believed to be pressed: one that is counts as a press.

use rsapien_protocol::BumperMask;

/// Tests in a row, 1 ms apart, that must see a change before it is believed.
pub const BUMPER_DEBOUNCE_TESTS: u8 = 5;

#[derive(Clone, Debug)]
pub(crate) struct Bumpers {
    pressed: u8,
    differing: [u8; BumperMask::COUNT],
    presses: [u8; BumperMask::COUNT],
}

impl Bumpers {
    pub(crate) const fn new() -> Bumpers {
        Bumpers { pressed: 0, differing: [0; BumperMask::COUNT], presses: [0; BumperMask::COUNT] }
    }

    pub(crate) fn test(&mut self, pins: BumperMask) {
        let changed = pins.bits() ^ self.pressed;
        for index in 0..BumperMask::COUNT {
            let bit = 1 << index;
            if changed & bit == 0 {
                self.differing[index] = 0;
                continue;
            }
            self.differing[index] += 1;
            if self.differing[index] == BUMPER_DEBOUNCE_TESTS {
                self.differing[index] = 0;
                self.pressed ^= bit;
                if self.pressed & bit != 0 {
                    self.presses[index] = (self.presses[index] + 1) & 0x0F;
                }
            }
        }
    }

    pub(crate) const fn pressed(&self) -> BumperMask {
        BumperMask::from_low_bits(self.pressed)
    }

    pub(crate) const fn presses(&self) -> [u8; BumperMask::COUNT] {
        self.presses
    }
}
