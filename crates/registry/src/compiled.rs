//! An action as a player takes it: steps for the robot's queue, and what the PC does around them.

use std::sync::Arc;

use rsapien_protocol::{BumperMask, Step};

/// A compiled action.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CompiledAction {
    /// The action's name.
    pub name: String,
    /// The steps in order; none replaces the queue. Each is ended by the bumpers to which the action
    /// reacts while it runs.
    pub steps: Vec<Step>,
    /// Where each step of `steps` comes from.
    pub sources: Vec<StepSource>,
    /// What is done when a bumper is met during each step of `steps`.
    pub reactions: Vec<Reactions>,
    /// Waits for bumpers, in the order in which they come.
    pub waits: Vec<Wait>,
    /// Places with a name, in the order in which they come.
    pub labels: Vec<Label>,
    /// The actions that reactions play instead of the rest.
    pub handlers: Vec<CompiledAction>,
    /// How long all steps last together, in milliseconds; waits for bumpers are not counted.
    pub duration_ms: u64,
}

/// What is done when a bumper is met, or a wait for one has been in vain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Reaction {
    /// Nothing: the action goes on.
    #[default]
    GoOn,
    /// The action ends, motors off.
    End,
    /// The action ends, motors off, and this one of its handlers is played.
    Play(usize),
}

/// A reaction for each of the six bumpers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Reactions(pub [Reaction; BumperMask::COUNT]);

impl Reactions {
    /// The bumpers that end the step: those whose reaction is not to go on.
    pub fn ending_bumpers(self) -> BumperMask {
        let bits = (0..).zip(self.0).fold(0, |bits, (index, reaction)| {
            bits | (u8::from(reaction != Reaction::GoOn) << index)
        });
        BumperMask::from_low_bits(bits)
    }

    /// What is done when `pressed` are met together: the reaction of the first of them that has one.
    pub fn to(self, pressed: BumperMask) -> Reaction {
        let mut reactions = self.0.into_iter().enumerate();
        reactions
            .find(|(index, reaction)| pressed.contains(*index) && *reaction != Reaction::GoOn)
            .map_or(Reaction::GoOn, |(_, reaction)| reaction)
    }
}

/// A wait for a bumper: the PC watches, the robot stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wait {
    /// The index in the steps of the one that follows; their number at the very end.
    pub before_step: usize,
    /// The wait is over when one of them is pressed.
    pub bumpers: BumperMask,
    /// How long it lasts at most, in milliseconds.
    pub limit_ms: u32,
    /// What is done when nobody has pressed one of them by then.
    pub otherwise: Reaction,
    /// Where it is written.
    pub source: StepSource,
}

/// A place with a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// Its name.
    pub name: Arc<str>,
    /// The index of the step that follows; the number of steps at the very end.
    pub step: usize,
}

/// Where a compiled step comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StepSource {
    /// The action it is written in: the one compiled, or one that it plays.
    pub action: Arc<str>,
    /// The number of the step in that action, from 1.
    pub step: usize,
    /// The number of the step in the action compiled, from 1.
    pub outer_step: usize,
    /// In which repeat of the whole action, from 1.
    pub round: u16,
}

impl CompiledAction {
    /// An action of these steps, each ended by the bumpers it names.
    pub fn from_steps(name: &str, steps: Vec<Step>) -> CompiledAction {
        let action: Arc<str> = Arc::from(name);
        let sources = (1..=steps.len())
            .map(|step| StepSource {
                action: Arc::clone(&action),
                step,
                outer_step: step,
                round: 1,
            })
            .collect();
        let reactions = steps.iter().map(|step| Reactions::ending(step.ending_bumpers)).collect();
        let duration_ms = steps.iter().map(|step| u64::from(step.duration_ms)).sum();
        let name = name.to_owned();
        CompiledAction { name, steps, sources, reactions, duration_ms, ..CompiledAction::default() }
    }

    /// The joints it moves, its handlers' among them; bit `j` is that of the joint with index `j`.
    pub fn joints(&self) -> u8 {
        let poses = self.steps.iter().flat_map(|step| step.pose.primitives());
        let own = poses.fold(0, |bits, primitive| bits | (1 << primitive.joint().index()));
        self.handlers.iter().fold(own, |bits, handler| bits | handler.joints())
    }
}

impl Reactions {
    /// The action ends when one of `bumpers` is met.
    pub fn ending(bumpers: BumperMask) -> Reactions {
        Reactions(std::array::from_fn(|index| {
            if bumpers.contains(index) { Reaction::End } else { Reaction::GoOn }
        }))
    }
}
