//! `too-short`: a joint is sent on before it can have arrived.

use std::collections::BTreeSet;

use rsapien_protocol::{Joint, Position};

use super::Look;
use crate::check::{Finding, Rule};

/// What is known of a joint: it is somewhere between two places, in ms of travel from its first
/// position, and on its way to another.
struct Known {
    low_ms: u64,
    high_ms: u64,
    sent: Option<Sent>,
}

#[derive(Clone, Copy)]
struct Sent {
    to: Position,
    at_ms: u64,
    step: usize,
}

pub(super) fn findings(look: &Look<'_>) -> Vec<Finding> {
    let mut known = Joint::ALL.map(|joint| Known {
        low_ms: 0,
        high_ms: u64::from(joint.full_travel_ms()),
        sent: None,
    });
    let mut findings = Vec::new();
    let mut told = BTreeSet::new();
    let mut waits = look.compiled.waits.iter().peekable();
    let mut at_ms = 0;
    for (index, step) in look.compiled.steps.iter().enumerate() {
        while waits.next_if(|wait| wait.before_step <= index).is_some() {
            // Whatever was under way has arrived when a wait is over.
            at_ms += 10_000;
        }
        for primitive in step.pose.primitives() {
            let joint = primitive.joint();
            let known = &mut known[usize::from(joint.index())];
            let next = Sent { to: primitive.position(), at_ms, step: index };
            let Some(sent) = known.sent else {
                known.sent = Some(next);
                continue;
            };
            if sent.to == next.to {
                continue;
            }
            let travel_ms = u64::from(joint.full_travel_ms());
            let target_ms = u64::from(sent.to.number() - 1) * travel_ms / 2;
            let needed_ms = known.low_ms.abs_diff(target_ms).max(known.high_ms.abs_diff(target_ms));
            let had_ms = at_ms - sent.at_ms;
            let steps = (look.place(sent.step).0.start, look.place(index).0.start, joint);
            if needed_ms > had_ms && told.insert(steps) {
                findings.extend(too_short(look, joint, sent, index, needed_ms, had_ms));
            }
            known.low_ms = nearer(known.low_ms, target_ms, had_ms);
            known.high_ms = nearer(known.high_ms, target_ms, had_ms);
            known.sent = Some(next);
        }
        at_ms += u64::from(step.duration_ms);
    }
    findings
}

/// Where a joint is after a time on its way.
fn nearer(from_ms: u64, target_ms: u64, time_ms: u64) -> u64 {
    if from_ms < target_ms {
        (from_ms + time_ms).min(target_ms)
    } else {
        from_ms.saturating_sub(time_ms).max(target_ms)
    }
}

fn too_short(
    look: &Look<'_>,
    joint: Joint,
    sent: Sent,
    next: usize,
    needed_ms: u64,
    had_ms: u64,
) -> Option<Finding> {
    let name = joint.position_names()[usize::from(sent.to.number() - 1)];
    let message = format!("{joint} is sent on before it can have arrived at {name}");
    let label = format!("needs up to {needed_ms} ms to arrive, and has {had_ms} ms");
    let finding = look.finding(Rule::TooShort, sent.step, message, label)?;
    let (span, _) = look.place(next);
    let finding =
        if span.start == finding.span.start { finding } else { finding.and(span, "sent on here") };
    Some(finding.help(format!(
        "give it {} ms more; or, where it is meant, say `allow too-short \"why\"`",
        needed_ms - had_ms
    )))
}
