//! The checker: rules, and what breaks them.

mod finding;
mod rule;

pub(crate) use finding::line_and_column;
pub use finding::{Finding, Findings};
pub use rule::{Rule, Severity};
