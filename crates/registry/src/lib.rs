#![doc = include_str!("../README.md")]
#![allow(clippy::doc_markdown, reason = "RoboRegistry and SQLite are names, not code")]

#[cfg(feature = "store")]
mod action;
pub mod check;
mod compiled;
#[cfg(feature = "store")]
mod error;
pub mod expand;
#[cfg(feature = "store")]
mod hash;
pub mod language;
pub mod motion;
#[cfg(feature = "store")]
mod store;
mod suggest;
pub mod timeline;

#[cfg(feature = "store")]
pub use action::{Action, ActionSummary, VersionSummary};
pub use check::{Finding, Findings, Rule, Severity};
pub use compiled::{CompiledAction, Label, Reaction, Reactions, StepSource, Wait};
#[cfg(feature = "store")]
pub use error::RegistryError;
pub use expand::{CompileOptions, KnownActions, NoActions, compile};
#[cfg(feature = "store")]
pub use hash::CONTENT_HASH_SHORT;
pub use language::{ActionDraft, Statement, parse_text, print_action, print_actions};
#[cfg(feature = "store")]
pub use store::{
    BUSY_TIMEOUT_MS, Bundle, BundlePlan, BundlePolicy, BundledAction, CONTENT_HASH_MIN, Conflict,
    ImportPolicy, ImportReport, Integrity, IntegrityProblem, Manifest, Query, Registry, Trials,
};
pub use timeline::Timeline;
