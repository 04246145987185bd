//! `arms-meet-trunk`: an arm at the side with its hand closed, on the side to which the trunk leans.

use rsapien_protocol::Joint;

use super::{Look, row};
use crate::check::{Finding, Rule};

/// Nearer to an end than this share of its travel, a joint counts as being there.
const THERE: f64 = 0.25;

pub(super) fn findings(look: &Look<'_>) -> Vec<Finding> {
    let sides =
        [(Joint::RightArm, Joint::RightHand, true), (Joint::LeftArm, Joint::LeftHand, false)];
    sides
        .into_iter()
        .filter_map(|(arm, hand, is_right)| meeting(look, arm, hand, is_right))
        .collect()
}

fn meeting(look: &Look<'_>, arm: Joint, hand: Joint, is_right: bool) -> Option<Finding> {
    // They can only meet when one of the three has moved; the last to arrive is to blame.
    let mut ends: Vec<(u64, usize)> = [arm, hand, Joint::Tilt]
        .into_iter()
        .flat_map(|joint| row(look.motion, joint))
        .map(|movement| (movement.to_ms, movement.step))
        .collect();
    ends.sort_unstable();
    let (_, step) = ends.into_iter().find(|(at_ms, _)| {
        let place = |joint| look.motion.place(joint, *at_ms);
        let tilt = if is_right { place(Joint::Tilt) } else { 1.0 - place(Joint::Tilt) };
        place(arm) > 1.0 - THERE && place(hand) < THERE && tilt > 1.0 - THERE
    })?;
    let side = if is_right { "right" } else { "left" };
    let message = format!("the {side} hand meets the trunk or the leg");
    let label = format!("here the {arm} is down, the hand in, and the trunk leans to that side");
    let finding = look.finding(Rule::ArmsMeetTrunk, step, message, label)?;
    Some(finding.help("open the hand, lift the arm, or let the trunk come back first"))
}
