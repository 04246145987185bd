//! What differs between two actions, by joint and time.

use std::fmt;

use rsapien_protocol::{BumperMask, Joint, Position, Step};

use crate::compiled::CompiledAction;

/// The longest middle that is compared step with step; a longer one is told as a whole.
const MIDDLE_MAX: usize = 2000;

/// What differs between two actions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// The names of both.
    pub names: [String; 2],
    /// How long each lasts, in ms.
    pub durations_ms: [u64; 2],
    /// How many steps each has.
    pub step_counts: [usize; 2],
    /// The differences, in the order of time.
    pub changes: Vec<Change>,
}

/// One difference.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Change {
    /// The second has a step that the first has not.
    Added {
        /// When it begins in the second, in ms.
        at_ms: u64,
        /// The step.
        step: Step,
    },
    /// The first has a step that the second has not.
    Removed {
        /// When it begins in the first, in ms.
        at_ms: u64,
        /// The step.
        step: Step,
    },
    /// A step of both sends a joint elsewhere.
    Joint {
        /// When the step begins in the first and in the second, in ms.
        at_ms: [u64; 2],
        /// The joint.
        joint: Joint,
        /// Where each sends it.
        positions: [Option<Position>; 2],
    },
    /// A step of both lasts another time.
    Duration {
        /// When the step begins in the first and in the second, in ms.
        at_ms: [u64; 2],
        /// How long it lasts in each, in ms.
        durations_ms: [u16; 2],
    },
    /// A step of both is ended by other bumpers.
    Bumpers {
        /// When the step begins in the first and in the second, in ms.
        at_ms: [u64; 2],
        /// Which bumpers end it in each.
        bumpers: [BumperMask; 2],
    },
}

impl Difference {
    /// What `second` does otherwise than `first`.
    pub fn between(first: &CompiledAction, second: &CompiledAction) -> Difference {
        let begins = [begins_ms(&first.steps), begins_ms(&second.steps)];
        let mut changes = Vec::new();
        for pair in align(&first.steps, &second.steps) {
            match pair {
                (Some(left), Some(right)) => {
                    let at_ms = [begins[0][left], begins[1][right]];
                    compare(first.steps[left], second.steps[right], at_ms, &mut changes);
                }
                (Some(left), None) => changes
                    .push(Change::Removed { at_ms: begins[0][left], step: first.steps[left] }),
                (None, Some(right)) => changes
                    .push(Change::Added { at_ms: begins[1][right], step: second.steps[right] }),
                (None, None) => {}
            }
        }
        Difference {
            names: [first.name.clone(), second.name.clone()],
            durations_ms: [first.duration_ms, second.duration_ms],
            step_counts: [first.steps.len(), second.steps.len()],
            changes,
        }
    }

    /// Whether both do the same.
    pub fn is_empty(&self) -> bool {
        self.changes.is_empty()
    }
}

fn begins_ms(steps: &[Step]) -> Vec<u64> {
    let mut at_ms = 0;
    steps
        .iter()
        .map(|step| {
            let begin_ms = at_ms;
            at_ms += u64::from(step.duration_ms);
            begin_ms
        })
        .collect()
}

/// Pairs of steps that belong together, by the longest row of equal steps in common; what stands between
/// two of them is paired as far as both have steps there.
fn align(first: &[Step], second: &[Step]) -> Vec<(Option<usize>, Option<usize>)> {
    let prefix = first.iter().zip(second).take_while(|(left, right)| left == right).count();
    let rest = (&first[prefix..], &second[prefix..]);
    let suffix =
        rest.0.iter().rev().zip(rest.1.iter().rev()).take_while(|(left, right)| left == right);
    let suffix = suffix.count();
    let middle = (&rest.0[..rest.0.len() - suffix], &rest.1[..rest.1.len() - suffix]);
    let anchors = if middle.0.len().max(middle.1.len()) <= MIDDLE_MAX {
        common(middle.0, middle.1)
    } else {
        Vec::new()
    };
    let mut pairs: Vec<_> = (0..prefix).map(|index| (Some(index), Some(index))).collect();
    let (mut left, mut right) = (0, 0);
    for (next_left, next_right) in anchors.into_iter().chain([(middle.0.len(), middle.1.len())]) {
        while left < next_left || right < next_right {
            let pair = (
                (left < next_left).then_some(prefix + left),
                (right < next_right).then_some(prefix + right),
            );
            left += usize::from(pair.0.is_some());
            right += usize::from(pair.1.is_some());
            pairs.push(pair);
        }
        if next_left < middle.0.len() && next_right < middle.1.len() {
            pairs.push((Some(prefix + next_left), Some(prefix + next_right)));
            (left, right) = (next_left + 1, next_right + 1);
        }
    }
    let ends = (first.len() - suffix, second.len() - suffix);
    pairs.extend((0..suffix).map(|index| (Some(ends.0 + index), Some(ends.1 + index))));
    pairs
}

/// The longest common subsequence, as pairs of indices.
fn common(first: &[Step], second: &[Step]) -> Vec<(usize, usize)> {
    let width = second.len() + 1;
    // lengths[i * width + j]: of what is left behind i and j.
    let mut lengths = vec![0_u16; (first.len() + 1) * width];
    for i in (0..first.len()).rev() {
        for j in (0..second.len()).rev() {
            lengths[i * width + j] = if first[i] == second[j] {
                lengths[(i + 1) * width + j + 1] + 1
            } else {
                lengths[(i + 1) * width + j].max(lengths[i * width + j + 1])
            };
        }
    }
    let (mut i, mut j) = (0, 0);
    let mut pairs = Vec::new();
    while i < first.len() && j < second.len() {
        if first[i] == second[j] {
            pairs.push((i, j));
            (i, j) = (i + 1, j + 1);
        } else if lengths[(i + 1) * width + j] >= lengths[i * width + j + 1] {
            i += 1;
        } else {
            j += 1;
        }
    }
    pairs
}

fn compare(left: Step, right: Step, at_ms: [u64; 2], changes: &mut Vec<Change>) {
    for joint in Joint::ALL {
        let positions = [left.pose.get(joint), right.pose.get(joint)];
        if positions[0] != positions[1] {
            changes.push(Change::Joint { at_ms, joint, positions });
        }
    }
    if left.duration_ms != right.duration_ms {
        let durations_ms = [left.duration_ms, right.duration_ms];
        changes.push(Change::Duration { at_ms, durations_ms });
    }
    if left.ending_bumpers != right.ending_bumpers {
        let bumpers = [left.ending_bumpers, right.ending_bumpers];
        changes.push(Change::Bumpers { at_ms, bumpers });
    }
}

fn seconds(ms: u64) -> String {
    format!("{}.{:03} s", ms / 1000, ms % 1000)
}

/// `1.150 s`, or `1.150 s (1.800 s)` where the second is at another time.
fn times([first, second]: [u64; 2]) -> String {
    if first == second {
        seconds(first)
    } else {
        format!("{} ({})", seconds(first), seconds(second))
    }
}

/// The names of the bumpers that are in `bumpers` and not in `others`.
fn only_in(bumpers: BumperMask, others: BumperMask) -> impl Iterator<Item = &'static str> {
    let only = bumpers.bits() & !others.bits();
    let names = BumperMask::NAMES.into_iter().enumerate();
    names.filter(move |(bit, _)| only & (1 << bit) != 0).map(|(_, name)| name)
}

fn step_text(step: Step) -> String {
    let names: Vec<String> = step.pose.primitives().map(|it| it.to_string()).collect();
    let names = if names.is_empty() { "wait".to_owned() } else { names.join(" + ") };
    format!("{names} for {} ms", step.duration_ms)
}

/// `right-arm     1.150 s  front -> up`.
impl fmt::Display for Change {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Change::Added { at_ms, step } => {
                write!(formatter, "+ {}  {}", seconds(*at_ms), step_text(*step))
            }
            Change::Removed { at_ms, step } => {
                write!(formatter, "- {}  {}", seconds(*at_ms), step_text(*step))
            }
            Change::Joint { at_ms, joint, positions } => {
                let name = |position: Option<Position>| {
                    position.map_or("as it is", |position| {
                        joint.position_names()[usize::from(position.number() - 1)]
                    })
                };
                let [first, second] = positions.map(name);
                write!(formatter, "~ {}  {joint}: {first} -> {second}", times(*at_ms))
            }
            Change::Duration { at_ms, durations_ms: [first, second] } => {
                write!(formatter, "~ {}  lasts {first} ms -> {second} ms", times(*at_ms))
            }
            Change::Bumpers { at_ms, bumpers: [first, second] } => {
                write!(formatter, "~ {}  bumpers that end it:", times(*at_ms))?;
                only_in(*second, *first).try_for_each(|name| write!(formatter, " +{name}"))?;
                only_in(*first, *second).try_for_each(|name| write!(formatter, " -{name}"))
            }
        }
    }
}

/// One line a difference, below a line about both.
impl fmt::Display for Difference {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [first, second] = &self.names;
        if self.is_empty() {
            return write!(formatter, "{first} and {second} do the same");
        }
        let [first_ms, second_ms] = self.durations_ms.map(seconds);
        let [first_count, second_count] = self.step_counts;
        write!(
            formatter,
            "{first}: {first_count} steps, {first_ms}   ->   {second}: {second_count} steps, {second_ms}"
        )?;
        self.changes.iter().try_for_each(|change| write!(formatter, "\n{change}"))
    }
}
