//! Steps under construction, and rows of them that run side by side.

use std::collections::BTreeSet;
use std::sync::Arc;

use rsapien_protocol::{Joint, Pose};

use crate::check::{Finding, Rule};
use crate::compiled::{Label, Reaction, Reactions, StepSource, Wait};
use crate::language::Span;

/// A step that may still be longer than the robot's queue takes.
#[derive(Clone, Debug)]
pub(super) struct RowStep {
    pub(super) pose: Pose,
    pub(super) duration_ms: u64,
    pub(super) reactions: Reactions,
    pub(super) source: StepSource,
    /// The statement in the action compiled that it comes from.
    pub(super) span: Span,
}

/// Steps in a row, with what stands between them.
#[derive(Clone, Debug, Default)]
pub(super) struct Row {
    pub(super) steps: Vec<RowStep>,
    pub(super) waits: Vec<Wait>,
    pub(super) labels: Vec<Label>,
    pub(super) duration_ms: u64,
}

impl Row {
    pub(super) fn push(&mut self, step: RowStep) {
        self.duration_ms = self.duration_ms.saturating_add(step.duration_ms);
        self.steps.push(step);
    }

    pub(super) fn label(&mut self, name: &str) {
        self.labels.push(Label { name: Arc::from(name), step: self.steps.len() });
    }

    /// Puts `rows` behind what is there, side by side. A step's pose is what starts at its moment, and
    /// it lasts until the next moment at which something starts or a row ends.
    pub(super) fn append_together(&mut self, rows: &[Row]) -> Result<(), Finding> {
        check_joints(rows)?;
        let mut moments = BTreeSet::new();
        let begins: Vec<Vec<u64>> = rows
            .iter()
            .map(|row| {
                let mut at_ms = 0;
                let begins: Vec<u64> = row
                    .steps
                    .iter()
                    .map(|step| {
                        let begin_ms = at_ms;
                        at_ms += step.duration_ms;
                        begin_ms
                    })
                    .collect();
                moments.extend(begins.iter().copied());
                moments.insert(at_ms);
                begins
            })
            .collect();
        let moments: Vec<u64> = moments.into_iter().collect();
        let offset = self.steps.len();
        for (row, begins) in rows.iter().zip(&begins) {
            for label in &row.labels {
                let at_ms = begins.get(label.step).copied().unwrap_or(row.duration_ms);
                let step = moments.partition_point(|moment| *moment < at_ms);
                self.labels.push(Label { name: Arc::clone(&label.name), step: offset + step });
            }
        }
        let mut next: Vec<usize> = vec![0; rows.len()];
        for pair in moments.windows(2) {
            let &[from_ms, to_ms] = pair else { continue };
            let mut merged: Option<RowStep> = None;
            for (index, row) in rows.iter().enumerate() {
                let starts = begins[index].get(next[index]) == Some(&from_ms);
                if starts {
                    next[index] += 1;
                }
                // The step under way in this row, if it has not ended.
                let Some(step) = next[index].checked_sub(1).and_then(|at| row.steps.get(at)) else {
                    continue;
                };
                if from_ms >= row.duration_ms {
                    continue;
                }
                let pose = if starts { step.pose } else { Pose::EMPTY };
                merge(&mut merged, step, pose, starts);
            }
            if let Some(step) = merged {
                self.push(RowStep { duration_ms: to_ms - from_ms, ..step });
            }
        }
        self.labels.sort_by_key(|label| label.step);
        Ok(())
    }
}

/// Adds what a row does at a moment; the first row that starts something there gives the source.
fn merge(merged: &mut Option<RowStep>, step: &RowStep, pose: Pose, starts: bool) {
    let Some(whole) = merged else {
        *merged = Some(RowStep { pose, ..step.clone() });
        return;
    };
    if starts && whole.pose.is_empty() && !pose.is_empty() {
        (whole.source, whole.span) = (step.source.clone(), step.span);
    }
    for primitive in pose.primitives() {
        whole.pose = whole.pose.with(primitive.joint(), Some(primitive.position()));
    }
    for (reaction, more) in whole.reactions.0.iter_mut().zip(step.reactions.0) {
        if *reaction == Reaction::GoOn {
            *reaction = more;
        }
    }
}

/// Refuses rows that move the same joint.
fn check_joints(rows: &[Row]) -> Result<(), Finding> {
    let mut movers: [Option<(usize, Span)>; Joint::COUNT] = [None; Joint::COUNT];
    for (index, row) in rows.iter().enumerate() {
        for step in &row.steps {
            for primitive in step.pose.primitives() {
                let joint = primitive.joint();
                let mover = &mut movers[usize::from(joint.index())];
                match *mover {
                    None => *mover = Some((index, step.span)),
                    Some((other, _)) if other == index => {}
                    Some((_, first)) => {
                        let message = format!("two tracks move the joint {joint}");
                        let finding = Finding::new(Rule::JointTwoWays, step.span, message)
                            .label(format!("{joint} is moved here"))
                            .and(first, "and by another track here")
                            .help(
                                "give each joint to one of the tracks, or put one behind the other",
                            );
                        return Err(finding);
                    }
                }
            }
        }
    }
    Ok(())
}
