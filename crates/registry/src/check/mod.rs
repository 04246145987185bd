//! The checker: rules, and what breaks them.

mod finding;
mod form;
mod rule;
mod text;

pub use finding::{Finding, Findings};
pub use rule::{Rule, Severity};
pub use text::{CheckedAction, CheckedText, check_text};
