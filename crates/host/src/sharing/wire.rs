//! What guest and holder say to each other: one JSON value a line.

mod report;

use std::sync::Arc;

use rsapien_protocol::{BumperMask, Pose, Step};
use rsapien_registry::{CompiledAction, Label, Reaction, Reactions, StepSource, Wait};
use serde::{Deserialize, Serialize};

pub(super) use report::ReportTold;

use crate::{Admission, Claim, Progress};

/// One more whenever what is said changes its meaning.
pub(super) const VERSION: u32 = 1;
/// The longest line that is read, in bytes: an action of some 100,000 steps.
pub(super) const LINE_LENGTH_MAX: usize = 16 << 20;

/// What a guest asks.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Ask {
    Play(Box<Play>),
    Pause,
    Resume,
    Cancel,
    Claims,
}

/// An action handed in.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Play {
    pub(super) version: u32,
    pub(super) program: String,
    pub(super) pid: u32,
    pub(super) policy: String,
    pub(super) from_label: Option<String>,
    pub(super) wait_for_rest: bool,
    pub(super) action: Action,
}

/// What the holder tells.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Told {
    Admitted { how: String, claims: Vec<ClaimTold> },
    Progress(ProgressTold),
    Report(Box<ReportTold>),
    Claimed { action: String, by: Vec<ClaimTold>, joints: Vec<u8> },
    Failed { text: String, is_refusal: bool },
    Claims { playing: Vec<ClaimTold>, waiting: Vec<ClaimTold> },
}

/// A compiled action. A reaction is 0 to go on, 1 to end, 2 + n for handler n.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Action {
    name: String,
    /// Pose word, duration in ms, bumpers that end it.
    steps: Vec<(u16, u16, u8)>,
    sources: Vec<Source>,
    reactions: Vec<[usize; BumperMask::COUNT]>,
    waits: Vec<WaitTold>,
    labels: Vec<(String, usize)>,
    handlers: Vec<Action>,
}

/// Action, step, outer step, round.
type Source = (String, usize, usize, u16);

#[derive(Debug, Serialize, Deserialize)]
struct WaitTold {
    before_step: usize,
    bumpers: u8,
    limit_ms: u32,
    otherwise: usize,
    source: Source,
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct ClaimTold {
    action: String,
    program: String,
    pid: u32,
    joints: u8,
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct ProgressTold {
    steps_ended: usize,
    steps_total: usize,
    elapsed_ms: u64,
    total_ms: u64,
    label: Option<usize>,
    waiting_for: u8,
    is_paused: bool,
    handler: Option<usize>,
}

fn reaction_number(reaction: Reaction) -> usize {
    match reaction {
        Reaction::GoOn => 0,
        Reaction::End => 1,
        Reaction::Play(index) => 2 + index,
    }
}

fn reaction(number: usize) -> Reaction {
    match number {
        0 => Reaction::GoOn,
        1 => Reaction::End,
        more => Reaction::Play(more - 2),
    }
}

fn source_told(source: &StepSource) -> Source {
    (source.action.to_string(), source.step, source.outer_step, source.round)
}

fn source((action, step, outer_step, round): Source) -> StepSource {
    StepSource { action: Arc::from(action), step, outer_step, round }
}

impl Action {
    pub(super) fn of(action: &CompiledAction) -> Action {
        let step = |step: &Step| (step.pose.word(), step.duration_ms, step.ending_bumpers.bits());
        let wait = |wait: &Wait| WaitTold {
            before_step: wait.before_step,
            bumpers: wait.bumpers.bits(),
            limit_ms: wait.limit_ms,
            otherwise: reaction_number(wait.otherwise),
            source: source_told(&wait.source),
        };
        Action {
            name: action.name.clone(),
            steps: action.steps.iter().map(step).collect(),
            sources: action.sources.iter().map(source_told).collect(),
            reactions: action.reactions.iter().map(|it| it.0.map(reaction_number)).collect(),
            waits: action.waits.iter().map(wait).collect(),
            labels: action.labels.iter().map(|it| (it.name.to_string(), it.step)).collect(),
            handlers: action.handlers.iter().map(Action::of).collect(),
        }
    }

    /// The action; none where a pose is none, or a wait stands outside it.
    pub(super) fn compiled(self) -> Option<CompiledAction> {
        let steps = self.steps.into_iter().map(|(word, duration_ms, bumpers)| {
            let ending_bumpers = BumperMask::from_bits(bumpers)?;
            Some(Step { ending_bumpers, ..Step::new(Pose::from_word(word).ok()?, duration_ms) })
        });
        let steps = steps.collect::<Option<Vec<Step>>>()?;
        let waits = self.waits.into_iter().map(|wait| {
            Some(Wait {
                before_step: Some(wait.before_step).filter(|step| *step <= steps.len())?,
                bumpers: BumperMask::from_bits(wait.bumpers)?,
                limit_ms: wait.limit_ms,
                otherwise: reaction(wait.otherwise),
                source: source(wait.source),
            })
        });
        let waits = waits.collect::<Option<Vec<Wait>>>()?;
        let labels = self.labels.into_iter();
        let labels = labels.map(|(name, step)| {
            Some(step).filter(|step| *step <= steps.len())?;
            Some(Label { name: Arc::from(name), step })
        });
        let handlers = self.handlers.into_iter().map(Action::compiled);
        Some(CompiledAction {
            name: self.name,
            duration_ms: crate::player::duration_ms(&steps),
            sources: self.sources.into_iter().map(source).collect(),
            reactions: self.reactions.into_iter().map(|it| Reactions(it.map(reaction))).collect(),
            waits: waits.is_sorted_by_key(|wait| wait.before_step).then_some(waits)?,
            labels: labels.collect::<Option<_>>()?,
            handlers: handlers.collect::<Option<_>>()?,
            steps,
        })
    }
}

impl ClaimTold {
    pub(super) fn of(claims: &[Claim]) -> Vec<ClaimTold> {
        let told = |claim: &Claim| ClaimTold {
            action: claim.action.clone(),
            program: claim.program.clone(),
            pid: claim.pid,
            joints: claim.joints,
        };
        claims.iter().map(told).collect()
    }

    pub(super) fn claims(told: Vec<ClaimTold>) -> Vec<Claim> {
        let claim =
            |ClaimTold { action, program, pid, joints }| Claim { action, program, pid, joints };
        told.into_iter().map(claim).collect()
    }
}

impl Told {
    pub(super) fn admitted(admission: &Admission) -> Told {
        let (how, claims): (&str, &[Claim]) = match admission {
            Admission::Begins => ("begins", &[]),
            Admission::Waits { behind } => ("waits", behind),
            Admission::Replaces { ended } => ("replaces", ended),
            Admission::Beside { others } => ("beside", others),
        };
        Told::Admitted { how: how.to_owned(), claims: ClaimTold::of(claims) }
    }
}

/// The admission of a word; none for an unknown one.
pub(super) fn admission(how: &str, claims: Vec<ClaimTold>) -> Option<Admission> {
    let claims = ClaimTold::claims(claims);
    Some(match how {
        "begins" => Admission::Begins,
        "waits" => Admission::Waits { behind: claims },
        "replaces" => Admission::Replaces { ended: claims },
        "beside" => Admission::Beside { others: claims },
        _ => return None,
    })
}

impl ProgressTold {
    pub(super) fn of(progress: &Progress) -> ProgressTold {
        ProgressTold {
            steps_ended: progress.steps_ended,
            steps_total: progress.steps_total,
            elapsed_ms: progress.elapsed_ms,
            total_ms: progress.total_ms,
            label: progress.label,
            waiting_for: progress.waiting_for.bits(),
            is_paused: progress.is_paused,
            handler: progress.handler,
        }
    }

    pub(super) fn progress(&self) -> Progress {
        Progress {
            steps_ended: self.steps_ended,
            steps_total: self.steps_total,
            elapsed_ms: self.elapsed_ms,
            total_ms: self.total_ms,
            label: self.label,
            waiting_for: BumperMask::from_low_bits(self.waiting_for),
            is_paused: self.is_paused,
            handler: self.handler,
        }
    }
}

/// One value as its line.
pub(super) fn line(value: &impl Serialize) -> Vec<u8> {
    let mut line = serde_json::to_vec(value).unwrap_or_default();
    line.push(b'\n');
    line
}

/// Puts bytes together to lines.
#[derive(Default)]
pub(super) struct Lines {
    bytes: Vec<u8>,
    searched: usize,
}

impl Lines {
    /// Takes what has come. False where a line is too long.
    pub(super) fn take(&mut self, bytes: &[u8]) -> bool {
        self.bytes.extend_from_slice(bytes);
        self.bytes.len() <= LINE_LENGTH_MAX
    }

    /// The next whole line.
    pub(super) fn next(&mut self) -> Option<Vec<u8>> {
        let unsearched = self.bytes.get(self.searched..).unwrap_or_default();
        let Some(end) = unsearched.iter().position(|byte| *byte == b'\n') else {
            self.searched = self.bytes.len();
            return None;
        };
        let rest = self.bytes.split_off(self.searched + end + 1);
        self.searched = 0;
        Some(std::mem::replace(&mut self.bytes, rest))
    }
}

#[cfg(test)]
mod tests;
