//! Actions as they are stored.

use serde::Serialize;

use crate::language::{ActionDraft, parse_text};

/// An action as it is stored: one version of it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Action {
    /// The name it is played by.
    pub name: String,
    /// What it does, for people.
    pub description: String,
    /// Words to find it by.
    pub tags: Vec<String>,
    /// What the user wrote, word for word.
    pub text: String,
    /// What the checker warned of when it was saved, one each.
    pub warnings: Vec<String>,
    /// How the motion went on the virtual body before it was saved, as JSON, where it was tried.
    pub trial: Option<String>,
    /// 1 for the first save, one more with each.
    pub version: u32,
    /// When the action was first saved, in milliseconds since 1970 (UTC).
    pub created_ms: i64,
    /// When this version was saved, in milliseconds since 1970 (UTC).
    pub changed_ms: i64,
}

impl Action {
    /// What the text says; none where it cannot be read, which no save allows.
    pub fn draft(&self) -> Option<ActionDraft> {
        parse_text(&self.text).actions.into_iter().next().map(|action| action.draft)
    }
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
    /// How many steps it makes, with those it plays.
    pub step_count: u32,
    /// How long it lasts once, at speed 1, in milliseconds, with all it plays; waits for bumpers are
    /// not counted.
    pub duration_ms: u64,
    /// The names of the joints it moves, in the order of the link.
    pub joints: Vec<&'static str>,
    /// The name of its content, the same in every registry: SHA-256 of what it does, in hexadecimal.
    pub content_hash: String,
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
}
