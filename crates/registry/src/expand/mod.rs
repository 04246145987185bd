//! From an action to the steps that the robot's queue takes.

mod quantity;
mod row;
mod walk;

use std::sync::Arc;

use crate::check::{Finding, Rule};
use crate::compiled::CompiledAction;
use crate::language::{ActionDraft, Span, TIMES_MAX, Value};

pub(crate) use quantity::{Values, Wanted, default_values, resolve};
pub(crate) use walk::endless;

/// The most steps an action may make when compiled.
pub const COMPILED_STEPS_MAX: usize = 100_000;
/// The longest an action may last: a day, in milliseconds.
pub const DURATION_MS_MAX: u64 = 24 * 60 * 60 * 1000;
/// How many actions may lie within each other.
pub const NESTING_MAX: usize = 32;
/// The slowest an action may be played.
pub const SPEED_MIN: f64 = 0.1;
/// The fastest an action may be played.
pub const SPEED_MAX: f64 = 10.0;

/// How an action is played.
#[derive(Clone, Debug, PartialEq)]
pub struct CompileOptions {
    /// How often in a row, 1..=1000.
    pub times: u16,
    /// How fast, 0.1..=10: durations are divided by it, rounded to the nearest millisecond, and
    /// are at least 1 ms. Motors run no faster: at high speeds joints do not arrive.
    pub speed: f64,
    /// Whether left and right change places.
    pub mirrored: bool,
    /// Values of its parameters; the others have their defaults.
    pub arguments: Vec<(String, Value)>,
}

impl Default for CompileOptions {
    /// Once, at speed 1, as it is written.
    fn default() -> CompileOptions {
        CompileOptions { times: 1, speed: 1.0, mirrored: false, arguments: Vec::new() }
    }
}

/// The actions that others can play.
pub trait KnownActions {
    /// The action of a name.
    fn draft(&self, name: &str) -> Option<Arc<ActionDraft>>;
    /// Every name, for a suggestion where one is not known.
    fn names(&self) -> Vec<String>;
}

/// No action at all.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoActions;

impl KnownActions for NoActions {
    fn draft(&self, _: &str) -> Option<Arc<ActionDraft>> {
        None
    }

    fn names(&self) -> Vec<String> {
        Vec::new()
    }
}

/// Compiles `draft`, which may play those of `known`.
///
/// A step that lasts more than 65535 ms at a low speed becomes several: the first sends the
/// joints, the others only wait.
///
/// # Errors
/// The first thing that is wrong, with its place in the text of `draft`: options or quantities out of
/// range, unknown names, circles, or an action beyond [`COMPILED_STEPS_MAX`], [`DURATION_MS_MAX`] or
/// [`NESTING_MAX`]. The work is bounded, whatever is asked for.
pub fn compile(
    draft: &ActionDraft,
    known: &dyn KnownActions,
    options: &CompileOptions,
) -> Result<CompiledAction, Finding> {
    let CompileOptions { times, speed, mirrored, ref arguments } = *options;
    let refused = |message: String, help: String| {
        let finding = Finding::new(Rule::OutOfRange, draft.name.span, message).help(help);
        Err(finding.within(&draft.name.text))
    };
    if !(1..=TIMES_MAX).contains(&times) {
        let help = format!("an action is played 1 to {TIMES_MAX} times");
        return refused(format!("{times} times"), help);
    }
    if !(SPEED_MIN..=SPEED_MAX).contains(&speed) {
        let help = format!("the speed is {SPEED_MIN} to {SPEED_MAX}, 1 being as written");
        return refused(format!("speed {speed}"), help);
    }
    let mut values = default_values(draft);
    for (name, value) in arguments {
        quantity::set_argument(draft, &mut values, name, *value, Span::default())
            .map_err(|finding| finding.within(&draft.name.text))?;
    }
    let mut budget = walk::Budget::default();
    let round = walk::Round { draft, values: &values, mirrored, speed, times };
    walk::compile_rounds(&round, known, &mut budget, &mut Vec::new())
        .map_err(|finding| finding.within(&draft.name.text))
}

#[cfg(test)]
mod tests;
