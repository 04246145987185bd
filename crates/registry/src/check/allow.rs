//! Rules that an action silences.

use super::{Finding, Rule};
use crate::language::ActionDraft;
use crate::suggest::closest;

/// The findings that remain, with those about the silencing itself, and those that were silenced.
pub(super) fn silence(draft: &ActionDraft, findings: Vec<Finding>) -> (Vec<Finding>, Vec<Finding>) {
    let mut remaining = Vec::new();
    let mut allowed: Vec<(Rule, bool)> = Vec::new();
    for allowance in &draft.allowances {
        match rule_of(allowance) {
            Ok(rule) => allowed.push((rule, false)),
            Err(finding) => {
                remaining.push(finding.within(&draft.name.text));
                continue;
            }
        }
        if allowance.reason.trim().is_empty() {
            let message = format!("`{}` is silenced without a reason", allowance.rule.text);
            let finding = Finding::new(Rule::Misplaced, allowance.span, message)
                .help("say why it may be, between the quotation marks");
            remaining.push(finding.within(&draft.name.text));
        }
    }
    let mut silenced = Vec::new();
    for finding in findings {
        match allowed.iter_mut().find(|(rule, _)| *rule == finding.rule) {
            Some((_, is_used)) => {
                *is_used = true;
                silenced.push(finding);
            }
            None => remaining.push(finding),
        }
    }
    for (rule, _) in allowed.iter().filter(|(_, is_used)| !is_used) {
        let allowance = draft.allowances.iter().find(|it| it.rule.text == rule.name());
        let span = allowance.map(|it| it.span).unwrap_or_default();
        let message = format!("nothing in this action breaks the rule `{rule}`");
        let finding = Finding::new(Rule::NeedlessAllow, span, message).help("take the line away");
        remaining.push(finding.within(&draft.name.text));
    }
    (remaining, silenced)
}

fn rule_of(allowance: &crate::language::Allowance) -> Result<Rule, Finding> {
    let name = &allowance.rule;
    let silenceable = || Rule::ALL.iter().filter(|rule| rule.is_silenceable()).map(|it| it.name());
    match Rule::from_name(&name.text) {
        Some(rule) if rule.is_silenceable() => Ok(rule),
        Some(rule) => {
            let message = format!("the rule `{rule}` cannot be silenced");
            let help =
                format!("those that can are {}", silenceable().collect::<Vec<_>>().join(", "));
            Err(Finding::new(Rule::Misplaced, name.span, message).help(help))
        }
        None => {
            let message = format!("there is no rule `{}`", name.text);
            let help = closest(&name.text, silenceable()).map_or_else(
                || format!("the rules are {}", silenceable().collect::<Vec<_>>().join(", ")),
                |meant| format!("did you mean `{meant}`?"),
            );
            Err(Finding::new(Rule::UnknownName, name.span, message).help(help))
        }
    }
}
