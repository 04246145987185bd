//! An action as a picture: its joints over time.

mod difference;
mod svg;
#[cfg(test)]
mod tests;
mod text;

use rsapien_protocol::{BumperMask, Joint};

use crate::compiled::CompiledAction;
use crate::motion::Motion;

pub use difference::{Change, Difference};
pub use svg::SvgOptions;

/// The joints of an action over time, reckoned with nominal travel times. Waits for bumpers take no
/// time here, since nobody knows how long they last.
#[derive(Clone, Debug, PartialEq)]
pub struct Timeline {
    /// The action's name.
    pub name: String,
    /// The movements of every joint, and when steps begin.
    pub motion: Motion,
    /// Places with names: when, in ms, and the names of all that are there.
    pub labels: Vec<(u64, String)>,
    /// Waits for bumpers: when, in ms, for which, and how long at most, in ms.
    pub waits: Vec<(u64, BumperMask, u32)>,
    /// When bumpers end the action: from, to, in ms, and which.
    pub endings: Vec<(u64, u64, BumperMask)>,
}

impl Timeline {
    /// The timeline of a compiled action.
    pub fn of(action: &CompiledAction) -> Timeline {
        let motion = Motion::of(action);
        let begin_ms = |step: usize| {
            motion.step_begins_ms.get(step).copied().unwrap_or_else(|| motion.duration_ms())
        };
        let mut endings: Vec<(u64, u64, BumperMask)> = Vec::new();
        for (index, step) in action.steps.iter().enumerate() {
            let (from_ms, to_ms) = (begin_ms(index), begin_ms(index + 1));
            match endings.last_mut() {
                _ if step.ending_bumpers.is_empty() => {}
                Some((_, end_ms, bumpers))
                    if *end_ms == from_ms && *bumpers == step.ending_bumpers =>
                {
                    *end_ms = to_ms;
                }
                _ => endings.push((from_ms, to_ms, step.ending_bumpers)),
            }
        }
        let mut labels: Vec<(u64, String)> = Vec::new();
        for label in &action.labels {
            let at_ms = begin_ms(label.step);
            match labels.last_mut() {
                // A wait takes no time here, so that what stands before and behind it coincides.
                Some((last_ms, names)) if *last_ms == at_ms => {
                    names.push_str(", ");
                    names.push_str(&label.name);
                }
                _ => labels.push((at_ms, label.name.to_string())),
            }
        }
        let waits = action.waits.iter();
        Timeline {
            name: action.name.clone(),
            labels,
            waits: waits.map(|it| (begin_ms(it.before_step), it.bumpers, it.limit_ms)).collect(),
            endings,
            motion,
        }
    }

    /// How long the action lasts, waits for bumpers not counted, in ms.
    pub fn duration_ms(&self) -> u64 {
        self.motion.duration_ms()
    }

    /// Until when the picture goes: to the end of the last movement, in ms, at least 1.
    fn end_ms(&self) -> u64 {
        let ends = self.motion.rows.iter().flatten().map(|movement| movement.motor_until_ms);
        ends.max().unwrap_or(0).max(self.duration_ms()).max(1)
    }

    /// A distance between marks on the ruler that leaves about `count` of them, in ms.
    fn ruler_ms(&self, count: u64) -> u64 {
        let wanted_ms = self.end_ms().div_ceil(count.max(1));
        let nice = [100, 200, 500, 1000, 2000, 5000, 10_000, 20_000, 30_000, 60_000, 300_000];
        let round = |hours: u64| hours * 3_600_000;
        nice.into_iter()
            .chain([1, 2, 6, 12].map(|count| round(count) / 2))
            .find(|step_ms| *step_ms >= wanted_ms)
            .unwrap_or(round(12))
    }
}

/// `1.2 s` or `3 min 20 s` on a ruler.
fn mark(ms: u64) -> String {
    match (ms / 60_000, ms % 60_000) {
        (0, ms) if ms % 1000 == 0 => format!("{} s", ms / 1000),
        (0, ms) => format!("{}.{} s", ms / 1000, ms % 1000 / 100),
        (minutes, 0) => format!("{minutes} min"),
        (minutes, ms) => format!("{minutes} min {} s", ms / 1000),
    }
}

/// The name of the position where a movement ends.
fn target_name(joint: Joint, movement: &crate::motion::Movement) -> &'static str {
    joint.position_names()[usize::from(movement.target.number() - 1)]
}
