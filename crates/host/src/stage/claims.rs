//! Who may play: claims on joints, and what is done when another has one.

use std::fmt;

use rsapien_protocol::Joint;

/// What is done with an action when another is being played.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Policy {
    /// It is refused.
    #[default]
    Refuse,
    /// It waits until everything before it has ended.
    Queue,
    /// What is being played ends, motors off; then it is played.
    Replace,
    /// It is played beside what is being played, if no joint is in both; otherwise it is refused.
    Merge,
}

impl Policy {
    /// All of them.
    pub const ALL: [Policy; 4] = [Policy::Refuse, Policy::Queue, Policy::Replace, Policy::Merge];

    /// Its name: `refuse`, `queue`, `replace`, `merge`.
    pub const fn name(self) -> &'static str {
        match self {
            Policy::Refuse => "refuse",
            Policy::Queue => "queue",
            Policy::Replace => "replace",
            Policy::Merge => "merge",
        }
    }

    /// The policy of a name.
    pub fn from_name(name: &str) -> Option<Policy> {
        Policy::ALL.into_iter().find(|policy| policy.name() == name)
    }
}

/// An action that is played or waits, and the joints that are its own meanwhile.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Claim {
    /// The action's name.
    pub action: String,
    /// Who plays it, such as `rsapien play`.
    pub program: String,
    /// The process; the stage's own, or that of a guest.
    pub pid: u32,
    /// The joints it moves, what it plays when it meets a bumper among them; bit `j` is the joint with index `j`.
    pub joints: u8,
}

impl Claim {
    /// The joints that are in both.
    pub fn common(&self, other: &Claim) -> Vec<Joint> {
        let bits = self.joints & other.joints;
        Joint::ALL.into_iter().filter(|joint| bits & (1 << joint.index()) != 0).collect()
    }
}

/// `dance of rsapien play (pid 4711)`.
impl fmt::Display for Claim {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let action = if self.action.is_empty() { "steps" } else { &self.action };
        write!(formatter, "{action} of {} (pid {})", self.program, self.pid)
    }
}

/// What becomes of an action that is to be played; told before anything moves for it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Admission {
    /// It begins; nothing else is played.
    Begins,
    /// It waits until these have ended; [`Begins`](Admission::Begins) is told then.
    Waits {
        /// What is played and what waits before it.
        behind: Vec<Claim>,
    },
    /// These end, motors off, and it begins.
    Replaces {
        /// What was played.
        ended: Vec<Claim>,
    },
    /// It begins beside these, which move other joints.
    Beside {
        /// What is played.
        others: Vec<Claim>,
    },
}

/// `waits behind dance of rsapien play (pid 4711)`.
impl fmt::Display for Admission {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Admission::Begins => formatter.write_str("begins"),
            Admission::Waits { behind } => write!(formatter, "waits behind {}", list(behind)),
            Admission::Replaces { ended } => write!(formatter, "replaces {}", list(ended)),
            Admission::Beside { others } => write!(formatter, "begins beside {}", list(others)),
        }
    }
}

/// Claims in a row of words.
pub(crate) fn list(claims: &[Claim]) -> String {
    let texts: Vec<String> = claims.iter().map(Claim::to_string).collect();
    texts.join(" and ")
}

/// What the claims at hand make of one more.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    Admitted(Admission),
    /// These stand in its way; with the joints that they have in common with it, where that is why.
    Refused {
        by: Vec<Claim>,
        joints: Vec<Joint>,
    },
}

/// Decides about `claim` when `playing` are played and `waiting` wait for them.
pub(crate) fn decide(
    claim: &Claim,
    policy: Policy,
    playing: &[Claim],
    waiting: &[Claim],
) -> Verdict {
    let all = || playing.iter().chain(waiting).cloned().collect::<Vec<Claim>>();
    if playing.is_empty() && waiting.is_empty() {
        return Verdict::Admitted(Admission::Begins);
    }
    match policy {
        Policy::Refuse => Verdict::Refused { by: all(), joints: Vec::new() },
        Policy::Queue => Verdict::Admitted(Admission::Waits { behind: all() }),
        Policy::Replace if playing.is_empty() => Verdict::Admitted(Admission::Begins),
        Policy::Replace => Verdict::Admitted(Admission::Replaces { ended: playing.to_vec() }),
        // Who joins now makes those who wait wait longer.
        Policy::Merge if !waiting.is_empty() => {
            Verdict::Refused { by: waiting.to_vec(), joints: Vec::new() }
        }
        Policy::Merge => {
            let has_common = |other: &&Claim| !claim.common(other).is_empty();
            let by: Vec<Claim> = playing.iter().filter(has_common).cloned().collect();
            if by.is_empty() {
                return Verdict::Admitted(Admission::Beside { others: playing.to_vec() });
            }
            let bits = by.iter().fold(0, |bits, other| bits | (other.joints & claim.joints));
            let common = Claim { joints: bits, ..claim.clone() };
            Verdict::Refused { by, joints: common.common(&common) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn claim(action: &str, joints: u8) -> Claim {
        Claim { action: action.to_owned(), program: "test".to_owned(), pid: 7, joints }
    }

    #[test]
    fn each_policy_says_what_it_does() {
        let (dance, wave, lean) =
            (claim("dance", 0b111), claim("wave", 0b1), claim("lean", 0b1000));
        let playing = [dance.clone()];
        for policy in Policy::ALL {
            assert_eq!(
                decide(&wave, policy, &[], &[]),
                Verdict::Admitted(Admission::Begins),
                "nobody is in the way"
            );
            assert_eq!(Policy::from_name(policy.name()), Some(policy));
        }
        let of = |claim: &Claim, policy| decide(claim, policy, &playing, &[]);
        let by = vec![dance.clone()];
        assert_eq!(
            of(&lean, Policy::Refuse),
            Verdict::Refused { by: by.clone(), joints: Vec::new() }
        );
        assert_eq!(
            of(&wave, Policy::Queue),
            Verdict::Admitted(Admission::Waits { behind: by.clone() })
        );
        assert_eq!(
            of(&wave, Policy::Replace),
            Verdict::Admitted(Admission::Replaces { ended: by.clone() })
        );
        assert_eq!(
            of(&lean, Policy::Merge),
            Verdict::Admitted(Admission::Beside { others: by.clone() })
        );
        let refused = Verdict::Refused { by: by.clone(), joints: vec![Joint::RightArm] };
        assert_eq!(of(&wave, Policy::Merge), refused);
    }

    #[test]
    fn nobody_is_overtaken_but_by_who_replaces() {
        let (dance, wave, lean) =
            (claim("dance", 0b111), claim("wave", 0b1), claim("lean", 0b1000));
        let (playing, waiting) = ([dance], [wave.clone()]);
        let merged = decide(&lean, Policy::Merge, &playing, &waiting);
        assert_eq!(merged, Verdict::Refused { by: vec![wave.clone()], joints: Vec::new() });
        let Verdict::Admitted(Admission::Waits { behind }) =
            decide(&lean, Policy::Queue, &playing, &waiting)
        else {
            panic!("it waits");
        };
        assert_eq!(behind.len(), 2);
        let replaced = decide(&lean, Policy::Replace, &playing, &waiting);
        assert!(
            matches!(replaced, Verdict::Admitted(Admission::Replaces { ended }) if ended.len() == 1)
        );
    }
}
