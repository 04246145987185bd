//! When bytes come to the chip: so that both sides see a package in the same tick.

use super::{BEHIND_LINE_AT, HexBench, IN_FLIGHT, LINE_AT, Sent};
use crate::firmware::bench::BenchError;
use crate::firmware::scenario::is_rest;
use rsapien_protocol::SYNCHRONIZATION_PACKAGE_LENGTH;

/// Where an owed answer must not begin, in hundredths of a tick, since the tick might be told in it or not.
const OWED_FROM: u64 = 10;
const OWED_TO: u64 = 50;
/// Bytes of an answer, and how many of them are out when the next answer can begin.
const ANSWER_BYTES: u64 = SYNCHRONIZATION_PACKAGE_LENGTH as u64;
const OWED_BYTES: u64 = ANSWER_BYTES - IN_FLIGHT as u64;

impl HexBench {
    /// The first cycle not before `earliest` where bytes may begin to come: so that a package ends inside
    /// a tick, or its rest begins there, and so that the answer does not begin about a tick because
    /// another is still on its way.
    fn begin_of_line(&self, earliest: u64, bytes: &[u8]) -> u64 {
        let length = self.byte_cycles * bytes.len() as u64;
        let mut begin = earliest.max(self.line_free_at);
        loop {
            let first = self.hundredths(begin + self.byte_cycles);
            let last = self.hundredths(begin + length);
            let fits = if is_rest(bytes) {
                // The silence before it is what counts.
                (15..60).contains(&first) && (10..78).contains(&last)
            } else {
                last == LINE_AT
            };
            if fits && self.answer_begins_well(begin + length) {
                return begin;
            }
            begin += self.tick_cycles / 200;
        }
    }

    /// Whether the answer to a package that is complete at `end` begins well inside a tick.
    fn answer_begins_well(&self, end: u64) -> bool {
        if self.in_flight.is_empty() {
            return true;
        }
        let apart = self.tick_cycles / 2;
        let free = self.answer_began + OWED_BYTES * self.byte_cycles;
        // Behind the answer that is on its way another one may wait already.
        let free_again = free + ANSWER_BYTES * self.byte_cycles;
        let fits = |at: u64| (OWED_FROM..OWED_TO).contains(&self.hundredths(at));
        if end + apart < free {
            fits(free)
        } else if !self.another_is_owed {
            end > free + apart
        } else if end > free + apart && end + apart < free_again {
            fits(free_again)
        } else {
            end > free_again + apart
        }
    }

    /// Gives bytes to the bridge, to come in the part of a tick where they belong, not before the tick of
    /// the cycle `in_tick`. Gives where they end.
    pub(super) fn schedule(&mut self, bytes: &[u8], tick_begins: u64) -> Result<u64, BenchError> {
        let length = self.byte_cycles * bytes.len() as u64;
        let earliest = if is_rest(bytes) {
            tick_begins + self.tick_cycles * 15 / 100 - self.byte_cycles
        } else {
            (tick_begins + self.tick_cycles * (LINE_AT - 1) / 100).saturating_sub(length)
        };
        let begin = self.begin_of_line(earliest.max(self.cycle), bytes);
        let free = self.answer_began + OWED_BYTES * self.byte_cycles;
        self.another_is_owed =
            !self.in_flight.is_empty() && (self.another_is_owed || begin + length < free);
        self.chip.send(bytes, begin)?;
        self.sent.extend(bytes.iter().map(|byte| Sent::Byte(*byte)));
        self.line_free_at = begin + length;
        Ok(begin + length)
    }

    pub(super) fn line(&mut self, bytes: &[u8]) -> Result<(), BenchError> {
        if bytes.is_empty() {
            return Ok(());
        }
        let end = match self.scheduled.take() {
            Some(scheduled) if scheduled.bytes == bytes => scheduled.end_cycle,
            Some(_) => return Err(BenchError("another line was told ahead".to_owned())),
            None => self.schedule(bytes, self.tick_cycle)?,
        };
        // A line that is behind the clock of its own by rounding has been heard by then too.
        self.go_on_to(end)?;
        self.go_on_to(self.part(BEHIND_LINE_AT).max(self.cycle))
    }

    pub(super) fn framing_error(&mut self) -> Result<(), BenchError> {
        let begin = self.begin_of_line(self.cycle, &[0x55]);
        let end = begin + self.byte_cycles;
        self.chip.tell(&format!("send-framing 55 {begin}"))?;
        self.sent.push_back(Sent::Framing);
        // Behind a missing stop bit the line has to rest before the next start bit is one.
        self.line_free_at = end + self.byte_cycles;
        self.go_on_to(end + self.byte_cycles)
    }
}
