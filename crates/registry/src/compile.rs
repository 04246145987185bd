//! From an action to the steps the robot's queue takes.

use std::sync::Arc;

use rsapien_protocol::{Pose, Step};

use crate::action::{ActionDraft, ActionStep, TIMES_MAX};
use crate::compiled::{CompiledAction, Reactions, StepSource};
use crate::error::RegistryError;
use crate::graph::{Graph, Size};
use crate::problem::{Finding, Findings};

/// The most steps an action may make when compiled.
pub const COMPILED_STEPS_MAX: u64 = 100_000;
/// The longest an action may last: a day, in milliseconds.
pub const DURATION_MS_MAX: u64 = 24 * 60 * 60 * 1000;
/// How many actions may lie within each other.
pub const NESTING_MAX: u32 = 32;
/// The slowest an action may be compiled.
pub const SPEED_MIN: f64 = 0.1;
/// The fastest an action may be compiled.
pub const SPEED_MAX: f64 = 10.0;

/// How an action is played.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompileOptions {
    /// How often in a row, 1..=1000.
    pub times: u16,
    /// How fast, 0.1..=10: durations are divided by it, rounded to the nearest millisecond, and
    /// are at least 1 ms. Motors run no faster: at high speeds joints do not arrive.
    pub speed: f64,
}

impl Default for CompileOptions {
    /// Once, at speed 1.
    fn default() -> CompileOptions {
        CompileOptions { times: 1, speed: 1.0 }
    }
}

/// Compiles `draft`, which may play those of `played`, each of which may play others of them.
///
/// A step that lasts more than 65535 ms at a low speed becomes several: the first sends the
/// joints, the others only wait.
///
/// # Errors
/// [`RegistryError::BadTimes`] and [`RegistryError::BadSpeed`] for options out of range;
/// [`RegistryError::Refused`] when `draft` or what it plays does not pass
/// [`check_draft`](crate::check_draft), plays what is not given, plays in a circle, or breaks
/// [`COMPILED_STEPS_MAX`], [`DURATION_MS_MAX`] or [`NESTING_MAX`]. Nothing is expanded before that
/// is known.
pub fn compile(
    draft: &ActionDraft,
    played: &[ActionDraft],
    options: CompileOptions,
) -> Result<CompiledAction, RegistryError> {
    let CompileOptions { times, speed } = options;
    if !(1..=TIMES_MAX).contains(&times) {
        return Err(RegistryError::BadTimes { times });
    }
    if !(SPEED_MIN..=SPEED_MAX).contains(&speed) {
        return Err(RegistryError::BadSpeed { speed });
    }
    let drafts: Vec<&ActionDraft> = std::iter::once(draft).chain(played).collect();
    let findings: Vec<Finding> =
        drafts.iter().flat_map(|draft| crate::draft_check::check_draft(draft)).collect();
    refuse(findings)?;
    let graph = Graph::of_drafts(&drafts, |draft| own_size(draft, speed)).map_err(refusal)?;
    let sizes = graph.measure(&[0]).map_err(refusal)?;
    refuse(graph.beyond_bounds(&sizes))?;
    let mut whole = Size { depth: 1, ..Size::default() };
    whole.add_repeated(sizes.first().copied().unwrap_or_default(), times);
    refuse(whole.problem().map(|problem| Finding::of(&draft.name, None, problem)))?;

    let capacity = usize::try_from(whole.steps).unwrap_or(0);
    let mut expansion = Expansion {
        drafts: &drafts,
        names: drafts.iter().map(|draft| Arc::from(draft.name.as_str())).collect(),
        graph: &graph,
        speed,
        steps: Vec::with_capacity(capacity),
        sources: Vec::with_capacity(capacity),
    };
    for round in 1..=times {
        expansion.expand(0, round, None);
    }
    Ok(CompiledAction {
        name: draft.name.clone(),
        reactions: expansion
            .steps
            .iter()
            .map(|step| Reactions::ending(step.ending_bumpers))
            .collect(),
        steps: expansion.steps,
        sources: expansion.sources,
        duration_ms: whole.duration_ms,
        ..CompiledAction::default()
    })
}

/// The size of the steps of `draft` that move joints, at `speed`.
pub(crate) fn own_size(draft: &ActionDraft, speed: f64) -> Size {
    let mut own = Size::default();
    for step in &draft.steps {
        if let ActionStep::Move { duration_ms, times, .. } = step {
            let duration_ms = scaled_ms(*duration_ms, speed);
            let steps = u64::from(duration_ms.div_ceil(u32::from(u16::MAX)));
            let part = Size { steps, duration_ms: u64::from(duration_ms), depth: 0 };
            own.add_repeated(part, *times);
        }
    }
    own
}

/// A duration at a speed in range: at most ten times as long, so that it fits.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1..=655350")]
fn scaled_ms(duration_ms: u16, speed: f64) -> u32 {
    (f64::from(duration_ms) / speed).round().max(1.0) as u32
}

fn refuse(findings: impl IntoIterator<Item = Finding>) -> Result<(), RegistryError> {
    let findings: Vec<Finding> = findings.into_iter().collect();
    if findings.is_empty() { Ok(()) } else { Err(RegistryError::Refused(Findings(findings))) }
}

fn refusal(finding: Finding) -> RegistryError {
    RegistryError::Refused(Findings(vec![finding]))
}

/// Steps under construction. Depth and number are bounded before it starts.
struct Expansion<'a> {
    drafts: &'a [&'a ActionDraft],
    names: Vec<Arc<str>>,
    graph: &'a Graph,
    speed: f64,
    steps: Vec<Step>,
    sources: Vec<StepSource>,
}

impl Expansion<'_> {
    fn expand(&mut self, index: usize, round: u16, outer_step: Option<usize>) {
        let mut plays = self.graph.nodes[index].plays.iter();
        let draft = self.drafts[index];
        for (number, step) in (1..).zip(&draft.steps) {
            let outer_step = outer_step.unwrap_or(number);
            match step {
                ActionStep::Play { times, .. } => {
                    let Some(play) = plays.next() else { continue };
                    for _ in 0..*times {
                        self.expand(play.node, round, Some(outer_step));
                    }
                }
                ActionStep::Move { pose, duration_ms, ending_bumpers, times } => {
                    let source = StepSource {
                        action: self.names[index].clone(),
                        step: number,
                        outer_step,
                        round,
                    };
                    for _ in 0..*times {
                        let mut pose = *pose;
                        let mut left_ms = scaled_ms(*duration_ms, self.speed);
                        while left_ms > 0 {
                            let part_ms = u16::try_from(left_ms).unwrap_or(u16::MAX);
                            let mut step = Step::new(pose, part_ms);
                            step.ending_bumpers = *ending_bumpers;
                            self.steps.push(step);
                            self.sources.push(source.clone());
                            left_ms -= u32::from(part_ms);
                            pose = Pose::EMPTY;
                        }
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
