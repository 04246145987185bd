//! `needs-the-pc`, `against-end-stop`, `drains-batteries`: what an action costs.

use std::collections::VecDeque;

use rsapien_protocol::{Joint, Parameter};

use super::{Look, row};
use crate::check::{Finding, Rule};

/// The span of time within which overruns are summed up, in ms.
const WINDOW_MS: u64 = 10_000;
/// The most that a motor may be driven against its end stop within that, in ms. Joints that arrive
/// before they are sent back stay below 1250 ms.
const AGAINST_STOP_MS_MAX: u64 = 1500;
/// What fresh batteries give, in seconds of one running motor: 1.5 V at 20 microvolts a second, as the
/// virtual robot's batteries drain.
pub const BATTERY_MOTOR_S: u64 = 75_000;
/// The share of it above which an action is told to drain the batteries, in percent.
const SHARE_PERCENT_MAX: u64 = 5;

pub(super) fn findings(look: &Look<'_>) -> Vec<Finding> {
    let mut findings = Vec::new();
    findings.extend(needs_the_pc(look));
    findings.extend(Joint::ALL.into_iter().filter_map(|joint| against_end_stop(look, joint)));
    findings.extend(drains_batteries(look));
    findings
}

fn needs_the_pc(look: &Look<'_>) -> Option<Finding> {
    let waits_ms: u64 = look.compiled.waits.iter().map(|wait| u64::from(wait.limit_ms)).sum();
    let total_ms = look.compiled.duration_ms.saturating_add(waits_ms);
    let longest_ms = u64::from(*Parameter::DEAD_MAN_MS.end());
    if total_ms <= longest_ms {
        return None;
    }
    let message = format!(
        "it lasts up to {} s, longer than the robot goes on when the PC falls silent",
        total_ms.div_ceil(1000)
    );
    let finding = look.of_all(Rule::NeedsThePc, message).label("this action");
    Some(finding.help(format!(
        "the dead-man ends motion after {} ms of silence, {longest_ms} ms at most: make sure that it may \
         end anywhere, and say `allow needs-the-pc \"why\"`",
        Parameter::DEAD_MAN_MS_DEFAULT
    )))
}

fn against_end_stop(look: &Look<'_>, joint: Joint) -> Option<Finding> {
    let mut window: VecDeque<(u64, u64)> = VecDeque::new();
    let mut sum_ms = 0;
    for movement in row(look.motion, joint).iter().filter(|movement| movement.is_complete) {
        let overrun_ms = movement.motor_until_ms.saturating_sub(movement.to_ms);
        window.push_back((movement.to_ms, overrun_ms));
        sum_ms += overrun_ms;
        while let Some((at_ms, overrun_ms)) = window.front().copied()
            && at_ms + WINDOW_MS < movement.to_ms
        {
            window.pop_front();
            sum_ms -= overrun_ms;
        }
        if sum_ms > AGAINST_STOP_MS_MAX {
            let message = format!("the motor of {joint} is driven against its end stop for long");
            let label = format!("{sum_ms} ms of the {} s before", WINDOW_MS / 1000);
            let finding = look.finding(Rule::AgainstEndStop, movement.step, message, label)?;
            return Some(finding.help("let the joint go further before it comes back, or rest"));
        }
    }
    None
}

fn drains_batteries(look: &Look<'_>) -> Option<Finding> {
    let on_ms: u64 = (look.motion.rows.iter().flatten())
        .map(|movement| movement.motor_until_ms.saturating_sub(movement.from_ms))
        .sum();
    let percent = on_ms / (BATTERY_MOTOR_S * 10);
    if percent < SHARE_PERCENT_MAX {
        return None;
    }
    let message = format!("it takes about {percent} % of what fresh batteries hold");
    let finding = look.of_all(Rule::DrainsBatteries, message);
    let label = format!("{} motor-seconds", on_ms / 1000);
    Some(finding.label(label).help("repeat less, or move fewer joints at once"))
}
