//! The rules of motion: what a sound action should not do with the robot.

mod arms;
mod arrival;
mod effort;
mod legs;

pub use effort::BATTERY_MOTOR_S;
pub use legs::FREE_TILT;

use rsapien_protocol::Joint;

use super::{Finding, Rule};
use crate::compiled::{CompiledAction, StepSource};
use crate::expand::KnownActions;
use crate::language::{ActionDraft, Span, Statement};
use crate::motion::Motion;

/// Everything that the rules of motion say of an action, each cause once.
pub(super) fn motion_findings(
    draft: &ActionDraft,
    compiled: &CompiledAction,
    known: &dyn KnownActions,
) -> Vec<Finding> {
    let motion = Motion::of(compiled);
    let look = Look { draft, statements: draft.steps(), compiled, motion: &motion, known };
    let mut findings = arrival::findings(&look);
    findings.extend(legs::findings(&look));
    findings.extend(arms::findings(&look));
    findings.extend(effort::findings(&look));
    findings.into_iter().map(|finding| finding.within(&draft.name.text)).collect()
}

/// What a rule looks at.
struct Look<'a> {
    draft: &'a ActionDraft,
    statements: Vec<&'a Statement>,
    compiled: &'a CompiledAction,
    motion: &'a Motion,
    known: &'a dyn KnownActions,
}

impl Look<'_> {
    /// The statement of the action that makes a compiled step, and the action that is played there, if
    /// the step is another's.
    fn place(&self, step: usize) -> (Span, Option<&str>) {
        let Some(source) = self.compiled.sources.get(step) else {
            return (self.draft.name.span, None);
        };
        let span = self.statement(source).map_or(self.draft.name.span, |statement| statement.span);
        let other = &*source.action != self.draft.name.text.as_str();
        (span, other.then_some(&*source.action))
    }

    fn statement(&self, source: &StepSource) -> Option<&Statement> {
        self.statements.get(source.outer_step.checked_sub(1)?).copied()
    }

    /// A finding at the statement that makes a compiled step; none where the step is another action's, and
    /// that one silences the rule.
    fn finding(&self, rule: Rule, step: usize, message: String, label: String) -> Option<Finding> {
        let (span, other) = self.place(step);
        if let Some(other) = other.and_then(|name| self.known.draft(name))
            && other.allowances.iter().any(|allowance| allowance.rule.text == rule.name())
        {
            return None;
        }
        let label = match other {
            Some(action) => format!("{label} (in `{action}`)"),
            None => label,
        };
        Some(Finding::new(rule, span, message).label(label))
    }

    /// A finding of the whole action.
    fn of_all(&self, rule: Rule, message: String) -> Finding {
        Finding::new(rule, self.draft.name.span, message)
    }
}

/// A joint's movements.
fn row(motion: &Motion, joint: Joint) -> &[crate::motion::Movement] {
    &motion.rows[usize::from(joint.index())]
}

#[cfg(test)]
mod tests;
