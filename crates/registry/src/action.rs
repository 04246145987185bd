//! Actions: named lists of steps, each moving joints together or playing another action.

use std::collections::BTreeSet;

use rsapien_protocol::{BumperMask, Joint, Pose, Primitive};
use serde::{Serialize, Serializer};

use crate::form::StepForm;
use crate::problem::Problem;

/// The longest an action's, a tag's name may be, in characters.
pub const NAME_LENGTH_MAX: usize = 64;
/// The longest a description may be, in characters.
pub const DESCRIPTION_LENGTH_MAX: usize = 2000;
/// The most tags of one action.
pub const TAGS_MAX: usize = 32;
/// The most steps written in one action; playing other actions makes longer ones.
pub const STEPS_MAX: usize = 1000;
/// The most repeats of one step, and of an action when it is compiled.
pub const TIMES_MAX: u16 = 1000;

/// An action as a user writes it, before it is stored.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ActionDraft {
    /// The name it is played by: 1 to 64 lower-case letters, digits and hyphens, beginning with a
    /// letter and not ending with a hyphen; neither a primitive's name nor `pause`.
    pub name: String,
    /// What it does, for people; at most 2000 characters.
    pub description: String,
    /// Words to find it by, of the same characters as a name; at most 32, none twice.
    pub tags: Vec<String>,
    /// What is done, in order: 1 to 1000 steps.
    pub steps: Vec<ActionStep>,
}

impl ActionDraft {
    /// An action without description and tags.
    pub fn new(name: impl Into<String>, steps: Vec<ActionStep>) -> ActionDraft {
        ActionDraft { name: name.into(), description: String::new(), tags: Vec::new(), steps }
    }

    /// The names of the actions its steps play, each once, in alphabetical order.
    pub fn played(&self) -> BTreeSet<&str> {
        self.steps.iter().filter_map(ActionStep::played).collect()
    }
}

/// One step of an action.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ActionStep {
    /// Motion primitives that start together; the empty pose is a pause.
    Move {
        /// Where joints are sent.
        pose: Pose,
        /// How long the step lasts, 1..=65535 ms, whether or not the joints have arrived. Motors
        /// of joints still travelling keep running into the next step.
        duration_ms: u16,
        /// Bumpers that end the whole action when pressed while this step runs.
        ending_bumpers: BumperMask,
        /// How often the step is done in a row, 1..=1000.
        times: u16,
    },
    /// Another action of the registry.
    Play {
        /// Its name.
        action: String,
        /// How often it is played in a row, 1..=1000.
        times: u16,
    },
}

impl ActionStep {
    /// How long a step lasts where a short form gives no duration: 1000 ms, in which every joint
    /// of the robot travels from end to end.
    pub const DURATION_MS_DEFAULT: u16 = 1000;

    /// The primitives together for `duration_ms`, once, ended by no bumper.
    ///
    /// # Errors
    /// [`Problem::OppositePositions`] or [`Problem::PrimitiveTwice`] when two of them move the same
    /// joint.
    pub fn together(primitives: &[Primitive], duration_ms: u16) -> Result<ActionStep, Problem> {
        Ok(ActionStep::moving(pose_of(primitives)?, duration_ms))
    }

    /// A pose for `duration_ms`, once, ended by no bumper.
    pub const fn moving(pose: Pose, duration_ms: u16) -> ActionStep {
        ActionStep::Move { pose, duration_ms, ending_bumpers: BumperMask::NONE, times: 1 }
    }

    /// Nothing new for `duration_ms`: joints under way keep travelling.
    pub const fn pause(duration_ms: u16) -> ActionStep {
        ActionStep::moving(Pose::EMPTY, duration_ms)
    }

    /// Another action, `times` in a row.
    pub fn play(action: impl Into<String>, times: u16) -> ActionStep {
        ActionStep::Play { action: action.into(), times }
    }

    /// The action this step plays, if it does.
    pub fn played(&self) -> Option<&str> {
        match self {
            ActionStep::Move { .. } => None,
            ActionStep::Play { action, .. } => Some(action),
        }
    }
}

/// The same keys as in the TOML form: `do` or `pause` or `play`, `ms`, `until`, `times`.
impl Serialize for ActionStep {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        StepForm::of(self).serialize(serializer)
    }
}

/// An action as it is stored: one version of it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Action {
    /// What the user wrote.
    #[serde(flatten)]
    pub draft: ActionDraft,
    /// 1 for the first save, one more with each.
    pub version: u32,
    /// When the action was first saved, in milliseconds since 1970 (UTC).
    pub created_ms: i64,
    /// When this version was saved, in milliseconds since 1970 (UTC).
    pub changed_ms: i64,
}

/// What a list of actions shows of each.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ActionSummary {
    /// Its name.
    pub name: String,
    /// What it does.
    pub description: String,
    /// Words to find it by.
    pub tags: Vec<String>,
    /// How many steps are written in it, before those it plays are put in.
    pub step_count: u32,
    /// How long it lasts once, at speed 1, in milliseconds, with all it plays.
    pub duration_ms: u64,
    /// The version now in force.
    pub version: u32,
    /// When the action was first saved, in milliseconds since 1970 (UTC).
    pub created_ms: i64,
    /// When the version in force was saved, in milliseconds since 1970 (UTC).
    pub changed_ms: i64,
}

/// One of the versions an action has had.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct VersionSummary {
    /// 1 for the first save, one more with each.
    pub version: u32,
    /// When it was saved, in milliseconds since 1970 (UTC).
    pub changed_ms: i64,
    /// Its description.
    pub description: String,
    /// How many steps are written in it.
    pub step_count: u32,
}

/// One pose of several primitives.
///
/// # Errors
/// As of [`ActionStep::together`].
pub(crate) fn pose_of(primitives: &[Primitive]) -> Result<Pose, Problem> {
    let mut pose = Pose::EMPTY;
    for &primitive in primitives {
        let joint: Joint = primitive.joint();
        match pose.get(joint) {
            None => pose = pose.with(joint, Some(primitive.position())),
            Some(position) if position == primitive.position() => {
                return Err(Problem::PrimitiveTwice { primitive });
            }
            Some(position) => {
                let first = Primitive::new(joint, position);
                return Err(Problem::OppositePositions { first, second: primitive });
            }
        }
    }
    Ok(pose)
}
