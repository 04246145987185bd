//! `legs-not-symmetrical` and `trunk-against-legs`: what makes a walking robot go astray, or fall.

use rsapien_protocol::{Joint, Position};

use super::{Look, row};
use crate::check::{Finding, Rule};
use crate::motion::Movement;

/// Tilted beyond this share of the trunk's travel from a side, both legs carry weight; as in the virtual body.
pub const FREE_TILT: f64 = 0.35;
/// The travel of one leg that the other may lack: walking begins with half a stride.
const HALF_STRIDE: f64 = 0.5;
/// Beside that, how much one leg may travel less than the other, as a share.
const TOLERANCE: f64 = 0.1;
/// How long trunk and leg may move together, in ms.
const TOGETHER_MS_MAX: u64 = 100;

pub(super) fn findings(look: &Look<'_>) -> Vec<Finding> {
    let mut findings = Vec::new();
    findings.extend(asymmetry(look));
    findings.extend(weight_onto_a_moving_leg(look));
    findings.extend(scissors_under_a_swinging_trunk(look));
    findings
}

/// The paper, section 2: with a slow controller "the robot can not walk properly - legs do not move
/// symmetrically".
fn asymmetry(look: &Look<'_>) -> Option<Finding> {
    let tilt = row(look.motion, Joint::Tilt);
    let reaches = |beyond: &dyn Fn(f64) -> bool| tilt.iter().any(|movement| beyond(movement.to));
    let swings = reaches(&|to| to < FREE_TILT) && reaches(&|to| to > 1.0 - FREE_TILT);
    if !swings {
        return None;
    }
    let travel = |leg: Joint| -> f64 {
        let loaded = |movement: &&Movement| {
            let middle_ms = u64::midpoint(movement.from_ms, movement.to_ms);
            let tilt = look.motion.place(Joint::Tilt, middle_ms);
            if leg == Joint::LeftLeg { tilt <= 1.0 - FREE_TILT } else { tilt >= FREE_TILT }
        };
        let loaded = row(look.motion, leg).iter().filter(loaded);
        loaded.map(|movement| (movement.to - movement.from).abs()).sum()
    };
    let (left, right) = (travel(Joint::LeftLeg), travel(Joint::RightLeg));
    let limit = HALF_STRIDE + TOLERANCE * left.max(right);
    if (left - right).abs() <= limit + 1e-9 {
        return None;
    }
    let message = format!(
        "the legs do not move symmetrically: the left one pushes over {left:.1} of its travel, the right \
         one over {right:.1}"
    );
    let finding = look.of_all(Rule::LegsNotSymmetrical, message);
    Some(finding.label("in this action").help(
        "let both legs push alike, or the robot turns; where it is meant to turn, say `allow \
         legs-not-symmetrical \"why\"`",
    ))
}

fn overlap_ms(one: &Movement, other: &Movement) -> u64 {
    one.to_ms.min(other.to_ms).saturating_sub(one.from_ms.max(other.from_ms))
}

/// The trunk swings to a side while the leg of that side, which is to carry the weight, travels.
fn weight_onto_a_moving_leg(look: &Look<'_>) -> Option<Finding> {
    for swing in row(look.motion, Joint::Tilt) {
        let leg = match swing.target {
            Position::First => Joint::LeftLeg,
            Position::Last => Joint::RightLeg,
            Position::Middle => continue,
        };
        for movement in near(row(look.motion, leg), swing) {
            let together_ms = overlap_ms(swing, movement);
            if together_ms > TOGETHER_MS_MAX {
                let message = format!(
                    "the trunk puts the weight onto the {leg} while that is still moving: the robot may \
                     fall"
                );
                let label = format!("{together_ms} ms of the swing and of the leg coincide");
                return told(look, swing, movement, message, label);
            }
        }
    }
    None
}

/// The legs travel against each other while the trunk swings.
fn scissors_under_a_swinging_trunk(look: &Look<'_>) -> Option<Finding> {
    for swing in row(look.motion, Joint::Tilt) {
        for left in near(row(look.motion, Joint::LeftLeg), swing) {
            for right in near(row(look.motion, Joint::RightLeg), swing) {
                let from_ms = swing.from_ms.max(left.from_ms).max(right.from_ms);
                let to_ms = swing.to_ms.min(left.to_ms).min(right.to_ms);
                let together_ms = to_ms.saturating_sub(from_ms);
                if left.sense != right.sense && together_ms > TOGETHER_MS_MAX {
                    let message =
                        "the legs move against each other while the trunk swings: the robot \
                                   may fall"
                            .to_owned();
                    let label = format!("{together_ms} ms of the swing and of both legs coincide");
                    return told(look, swing, left, message, label);
                }
            }
        }
    }
    None
}

/// The movements that may overlap with a swing.
fn near<'a>(row: &'a [Movement], swing: &Movement) -> &'a [Movement] {
    let from = row.partition_point(|movement| movement.to_ms <= swing.from_ms);
    let to = row.partition_point(|movement| movement.from_ms < swing.to_ms);
    row.get(from..to).unwrap_or_default()
}

fn told(
    look: &Look<'_>,
    swing: &Movement,
    leg: &Movement,
    message: String,
    label: String,
) -> Option<Finding> {
    let finding = look.finding(Rule::TrunkAgainstLegs, swing.step, message, label)?;
    let (span, _) = look.place(leg.step);
    let finding = if span.start == finding.span.start {
        finding
    } else {
        finding.and(span, "the leg is sent here")
    };
    Some(finding.help("let the trunk arrive before the legs move, or the legs before the trunk"))
}
