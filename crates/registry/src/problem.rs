//! What can be wrong with an action, and where.

use std::fmt;

use rsapien_protocol::{BumperMask, Primitive};

use crate::action::{DESCRIPTION_LENGTH_MAX, NAME_LENGTH_MAX, STEPS_MAX, TAGS_MAX, TIMES_MAX};
use crate::compile::{COMPILED_STEPS_MAX, DURATION_MS_MAX, NESTING_MAX};

/// One thing that is wrong with an action.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Problem {
    /// The name has other characters, another beginning or end, or is too long.
    #[error(
        "{name:?} is no name for an action: use 1 to {NAME_LENGTH_MAX} lower-case letters, digits \
         and hyphens, beginning with a letter and not ending with a hyphen"
    )]
    BadName {
        /// The name refused.
        name: String,
    },
    /// The name is one of the 21 primitives'.
    #[error("{name:?} is the name of a motion primitive: choose another")]
    NameOfPrimitive {
        /// The name refused.
        name: String,
    },
    /// The name means something else where steps are written.
    #[error("{name:?} is a word of the step language: choose another name")]
    ReservedName {
        /// The name refused.
        name: String,
    },
    /// Two actions of one text bear the same name.
    #[error("{name:?} is defined twice, first in line {first_line}")]
    DefinedTwice {
        /// The name they share.
        name: String,
        /// The line of the first of them.
        first_line: usize,
    },
    /// The description is too long.
    #[error(
        "the description has {length} characters: at most {DESCRIPTION_LENGTH_MAX} are allowed"
    )]
    LongDescription {
        /// Its length in characters.
        length: usize,
    },
    /// A tag has other characters, is too long or empty.
    #[error("{tag:?} is no tag: use 1 to {NAME_LENGTH_MAX} lower-case letters, digits and hyphens")]
    BadTag {
        /// The tag refused.
        tag: String,
    },
    /// A tag is given twice.
    #[error("the tag {tag:?} is given twice")]
    TagTwice {
        /// The tag.
        tag: String,
    },
    /// There are too many tags.
    #[error("{count} tags: at most {TAGS_MAX} are allowed")]
    TooManyTags {
        /// How many there are.
        count: usize,
    },
    /// The action has no steps or too many.
    #[error("{count} steps: an action has 1 to {STEPS_MAX}; let it play other actions for more")]
    StepCount {
        /// How many there are.
        count: usize,
    },
    /// A text names no motion primitive.
    #[error(
        "{text:?} is no motion primitive{}",
        suggestion.as_deref().map_or(PRIMITIVE_FORM.to_owned(), |name| did_you_mean(Some(name)))
    )]
    UnknownPrimitive {
        /// The text.
        text: String,
        /// The primitive whose name comes nearest.
        suggestion: Option<String>,
    },
    /// A text names no bumper.
    #[error(
        "{text:?} is no bumper: the bumpers are {}, and \"feet\" stands for the first four",
        BumperMask::NAMES.join(", ")
    )]
    UnknownBumper {
        /// The text.
        text: String,
    },
    /// One step sends a joint to two positions.
    #[error("{first} and {second} cannot run together: they move the same joint")]
    OppositePositions {
        /// The primitive written first.
        first: Primitive,
        /// The primitive that contradicts it.
        second: Primitive,
    },
    /// One step names a primitive twice.
    #[error("{primitive} is given twice in one step")]
    PrimitiveTwice {
        /// The primitive.
        primitive: Primitive,
    },
    /// A duration is zero, negative or too long for one step.
    #[error("a duration of {ms} ms: a step lasts 1 to 65535 ms")]
    BadDuration {
        /// The duration in milliseconds.
        ms: i64,
    },
    /// A number of repeats is zero, negative or too large.
    #[error("{times} times: a step is repeated 1 to {TIMES_MAX} times")]
    BadTimes {
        /// The number of repeats.
        times: i64,
    },
    /// A step says neither or more than one of what it can do.
    #[error("a step has exactly one of do, pause and play, this one has {}", listed(found))]
    StepKind {
        /// Which of them it has.
        found: Vec<&'static str>,
    },
    /// A step moves joints but says not for how long.
    #[error("do needs ms, the duration of the step in milliseconds")]
    MissingDuration,
    /// A key does not go with what the step does.
    #[error("{key} does not go with {with}")]
    MisplacedKey {
        /// The key.
        key: &'static str,
        /// What the step does.
        with: &'static str,
    },
    /// A step in the short form cannot be read.
    #[error(
        "{text:?} is no step: write PRIMITIVE[+PRIMITIVE...][:MS][*TIMES], pause:MS or ACTION[*TIMES]"
    )]
    BadShortStep {
        /// The text.
        text: String,
    },
    /// A step plays an action that does not exist.
    #[error("plays {name:?}, which is no action{}", did_you_mean(suggestion.as_deref()))]
    UnknownAction {
        /// The name it plays.
        name: String,
        /// The action whose name comes nearest.
        suggestion: Option<String>,
    },
    /// Actions play each other in a circle.
    #[error("actions play each other in a circle: {}", path.join(" -> "))]
    Cycle {
        /// The names along the circle; the first is also the last.
        path: Vec<String>,
    },
    /// Actions play actions too deeply.
    #[error("actions play each other {depth} deep: at most {NESTING_MAX} are allowed")]
    TooDeep {
        /// How many actions lie within each other.
        depth: u32,
    },
    /// Compiled, the action would have too many steps.
    #[error("it makes {count} steps when compiled: at most {COMPILED_STEPS_MAX} are allowed")]
    TooManyCompiledSteps {
        /// How many it would have, or `u64::MAX` where that cannot be counted.
        count: u64,
    },
    /// The action would last too long.
    #[error("it lasts {duration_ms} ms: at most {DURATION_MS_MAX} (a day) are allowed")]
    TooLong {
        /// How long it would last, or `u64::MAX` where that cannot be counted.
        duration_ms: u64,
    },
    /// The text is not TOML or not of the form asked for.
    #[error("{message}")]
    Toml {
        /// What the reader of the text says.
        message: String,
    },
}

/// A problem and its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The line of the text, from 1, where there is a text.
    pub line: Option<usize>,
    /// The action, where its name is known.
    pub action: Option<String>,
    /// The number of the step in the action, from 1.
    pub step: Option<usize>,
    /// What is wrong.
    pub problem: Problem,
}

impl Finding {
    pub(crate) fn of(action: &str, step: Option<usize>, problem: Problem) -> Finding {
        Finding { line: None, action: Some(action.to_owned()), step, problem }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let line = self.line.map(|line| format!("line {line}"));
        let action = self.action.as_ref().map(|action| format!("action {action:?}"));
        let step = self.step.map(|step| format!("step {step}"));
        for place in [line, action, step].into_iter().flatten() {
            write!(formatter, "{place}: ")?;
        }
        self.problem.fmt(formatter)
    }
}

/// All that was found wrong, in the order of the text; one a line when shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Findings(pub Vec<Finding>);

impl fmt::Display for Findings {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, finding) in self.0.iter().enumerate() {
            if index > 0 {
                formatter.write_str("\n")?;
            }
            finding.fmt(formatter)?;
        }
        Ok(())
    }
}

impl std::error::Error for Findings {}

/// How a primitive is written, for a text that comes near to none.
const PRIMITIVE_FORM: &str = ": write a joint and a position, such as right-arm-up, or a number from \
                              1 to 21; an action is put in with play";

pub(crate) fn did_you_mean(suggestion: Option<&str>) -> String {
    suggestion.map(|name| format!("; did you mean {name:?}?")).unwrap_or_default()
}

fn listed(found: &[&str]) -> String {
    if found.is_empty() { "none".to_owned() } else { found.join(" and ") }
}
