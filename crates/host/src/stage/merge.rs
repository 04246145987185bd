//! Actions side by side: their steps become one row of slices for the robot's one queue.
//!
//! A slice lasts at most until the next of them ends a step, and at most [`SLICE_MS`] where others may join at any
//! moment. It sends the joints of
//! every step that begins with it and leaves the others as they are, so that each action's joints are sent when,
//! and for as long as, its own text says. Without this the robot's queue could only hold one action.

use std::collections::VecDeque;

use rsapien_protocol::{BumperMask, Joint, Pose, Step};

/// The longest slice, in ms: an action that joins begins when the slices already queued have ended.
pub(crate) const SLICE_MS: u16 = 200;

/// The steps of one action, as far as they are known.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    pub(crate) id: u64,
    pub(crate) steps: Vec<Step>,
    /// The step that begins next.
    next: usize,
    /// What is left to be sent of the step before it, in ms.
    left_ms: u16,
    /// The joints are to be sent once more where they were last: STOP has cut their way short.
    is_cut: bool,
    /// Slices sent with a share of it that have not ended.
    under_way: usize,
    /// Steps that have ended.
    pub(crate) ended: usize,
    /// Steps of which the first slice was accepted.
    pub(crate) accepted: usize,
}

/// One slice's share of one action.
#[derive(Clone, Copy, Debug)]
struct Share {
    id: u64,
    /// The step it is of, and what was left of that before this slice.
    step: usize,
    left_ms: u16,
}

/// A slice, and whose it is.
#[derive(Clone, Debug)]
struct Slice {
    duration_ms: u16,
    shares: Vec<Share>,
}

impl Part {
    pub(crate) fn new(id: u64, steps: Vec<Step>) -> Part {
        Part { id, steps, next: 0, left_ms: 0, is_cut: false, under_way: 0, ended: 0, accepted: 0 }
    }

    /// Whether the next slice would begin a step of it.
    pub(crate) const fn is_at_a_step(&self) -> bool {
        self.left_ms == 0
    }

    /// Whether there is nothing more to send.
    pub(crate) const fn is_sent(&self) -> bool {
        self.left_ms == 0 && self.next >= self.steps.len()
    }

    /// Whether everything sent has ended.
    pub(crate) const fn stands(&self) -> bool {
        self.under_way == 0
    }

    /// How long it still lasts, with what is on its way, in ms.
    pub(crate) fn left_ms(&self) -> u64 {
        let rest = self.steps.get(self.next..).unwrap_or_default();
        u64::from(self.left_ms) + crate::player::duration_ms(rest)
    }

    /// The step that the next slice is of, and what is left of it.
    fn head(&self) -> Option<(usize, &Step, u16)> {
        if self.left_ms > 0 {
            let step = self.next.checked_sub(1)?;
            return Some((step, self.steps.get(step)?, self.left_ms));
        }
        let step = self.steps.get(self.next)?;
        Some((self.next, step, step.duration_ms))
    }

    /// Where its joints were sent so far.
    fn targets(&self) -> Pose {
        let begun = self.steps.get(..self.next).unwrap_or_default();
        begun.iter().fold(Pose::EMPTY, |pose, step| joined(pose, step.pose))
    }
}

/// `pose`, and over it `other`.
fn joined(pose: Pose, other: Pose) -> Pose {
    Joint::ALL.into_iter().fold(pose, |pose, joint| match other.get(joint) {
        Some(position) => pose.with(joint, Some(position)),
        None => pose,
    })
}

/// The actions that go on side by side, and the slices sent of them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Merge {
    pub(crate) parts: Vec<Part>,
    sent: VecDeque<Slice>,
    proposed: Option<Slice>,
    /// Whether others may join at any moment, so that no slice is to be long.
    pub(crate) is_shared: bool,
}

impl Merge {
    /// The next slice of the parts for which `may_go_on`; none when no such part has anything to send.
    pub(crate) fn propose(&mut self, may_go_on: impl Fn(&Part) -> bool) -> Option<Step> {
        let going: Vec<&Part> = self.parts.iter().filter(|part| may_go_on(part)).collect();
        let heads: Vec<(&Part, usize, &Step, u16)> = going
            .into_iter()
            .filter_map(|part| part.head().map(|(step, of, left)| (part, step, of, left)))
            .collect();
        let shortest_ms = heads.iter().map(|(_, _, _, left_ms)| *left_ms).min()?;
        // Even slices: a short one at the end would be over before the next has come.
        let count = if self.is_shared { shortest_ms.div_ceil(SLICE_MS) } else { 1 };
        let duration_ms = shortest_ms.div_ceil(count);
        let mut pose = Pose::EMPTY;
        let mut bumpers = 0;
        for (part, _, step, _) in &heads {
            if part.is_cut {
                pose = joined(pose, part.targets());
            }
            if part.is_at_a_step() {
                pose = joined(pose, step.pose);
            }
            bumpers |= step.ending_bumpers.bits();
        }
        let shares = heads.iter().map(|(part, step, _, left_ms)| Share {
            id: part.id,
            step: *step,
            left_ms: *left_ms,
        });
        self.proposed = Some(Slice { duration_ms, shares: shares.collect() });
        let ending_bumpers = BumperMask::from_low_bits(bumpers);
        Some(Step { ending_bumpers, ..Step::new(pose, duration_ms) })
    }

    /// The slice proposed last was accepted. The parts it is of.
    pub(crate) fn accept(&mut self) -> Vec<u64> {
        let Some(slice) = self.proposed.take() else { return Vec::new() };
        for share in &slice.shares {
            let Some(part) = self.parts.iter_mut().find(|part| part.id == share.id) else {
                continue;
            };
            part.next = share.step + 1;
            part.left_ms = share.left_ms - slice.duration_ms;
            part.is_cut = false;
            part.under_way += 1;
            part.accepted = part.accepted.max(share.step + 1);
        }
        let whose = slice.shares.iter().map(|share| share.id).collect();
        self.sent.push_back(slice);
        whose
    }

    /// The robot has ended the oldest `count` slices. The parts of which a step ended with them.
    pub(crate) fn end(&mut self, count: usize) -> Vec<u64> {
        let mut told = Vec::new();
        for slice in self.sent.drain(..count.min(self.sent.len())) {
            for share in slice.shares {
                let Some(part) = self.parts.iter_mut().find(|part| part.id == share.id) else {
                    continue;
                };
                part.under_way = part.under_way.saturating_sub(1);
                if share.left_ms == slice.duration_ms {
                    part.ended = share.step + 1;
                    told.push(share.id);
                }
            }
        }
        told
    }

    /// How long the slice accepted last lasts, in ms.
    pub(crate) fn latest_ms(&self) -> u64 {
        self.sent.back().map_or(0, |slice| u64::from(slice.duration_ms))
    }

    /// What was sent and has not ended lasts so long, the slice under way left out, in ms.
    pub(crate) fn queued_ms(&self) -> u64 {
        self.sent.iter().skip(1).map(|slice| u64::from(slice.duration_ms)).sum()
    }

    /// The robot has forgotten what was sent and has not ended: it is to be sent again.
    pub(crate) fn rewind(&mut self) {
        self.proposed = None;
        for slice in self.sent.drain(..).rev() {
            for share in slice.shares {
                let Some(part) = self.parts.iter_mut().find(|part| part.id == share.id) else {
                    continue;
                };
                let Some(step) = part.steps.get(share.step) else { continue };
                let begins = share.left_ms == step.duration_ms;
                (part.next, part.left_ms) =
                    if begins { (share.step, 0) } else { (share.step + 1, share.left_ms) };
            }
        }
        for part in &mut self.parts {
            part.under_way = 0;
            part.is_cut = true;
        }
    }
}

#[cfg(test)]
mod tests;
