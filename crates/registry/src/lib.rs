#![doc = include_str!("../README.md")]
#![allow(clippy::doc_markdown, reason = "RoboRegistry and SQLite are names, not code")]

mod action;
pub mod check;
mod compile;
mod compiled;
mod draft_check;
mod error;
pub mod expand;
mod form;
mod graph;
pub mod language;
mod problem;
mod store;
mod suggest;
mod text;

pub use action::{
    Action, ActionDraft, ActionStep, ActionSummary, DESCRIPTION_LENGTH_MAX, NAME_LENGTH_MAX,
    STEPS_MAX, TAGS_MAX, TIMES_MAX, VersionSummary,
};
pub use compile::{
    COMPILED_STEPS_MAX, CompileOptions, DURATION_MS_MAX, NESTING_MAX, SPEED_MAX, SPEED_MIN, compile,
};
pub use compiled::{CompiledAction, Label, Reaction, Reactions, StepSource, Wait};
pub use draft_check::check_draft;
pub use error::RegistryError;
pub use problem::{Finding, Findings, Problem};
pub use store::{BUSY_TIMEOUT_MS, ImportPolicy, ImportReport, Registry};
pub use text::{read_toml, write_toml};
