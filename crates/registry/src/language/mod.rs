//! The language in which actions are written: what a text means, and the text of what is meant.
//!
//! ```text
//!   text ──► tokens ──► ActionDraft (a tree with places) ──► compile
//!    ▲                        │
//!    └──────── print ◄────────┘
//! ```

mod parse;
mod print;
mod short;
mod token;
mod tree;

pub use parse::{ParsedAction, ParsedText, parse_text};
pub(crate) use print::value as value_text;
pub use print::{print_action, print_actions};
pub(crate) use short::RESERVED_NAME;
pub use short::parse_value;
pub use tree::{
    ActionDraft, Allowance, Parameter, Play, Quantity, Response, Span, Statement, StatementKind,
    Track, Value, Word,
};

/// The longest an action's, a tag's, a label's or a parameter's name may be, in characters.
pub const NAME_LENGTH_MAX: usize = 64;
/// The longest a description may be, in characters.
pub const DESCRIPTION_LENGTH_MAX: usize = 2000;
/// The most tags of one action.
pub const TAGS_MAX: usize = 32;
/// The most statements written in one action; playing other actions makes longer ones.
pub const STATEMENTS_MAX: usize = 5000;
/// The most repeats of a block, of an action that is played, and of an action when it is compiled.
pub const TIMES_MAX: u16 = 1000;
/// The longest that a wait for a bumper may last, in milliseconds: an hour.
pub const WAIT_LIMIT_MS_MAX: u32 = 3_600_000;

/// Whether a text is of the form of a name: 1 to 64 lower-case letters, digits and hyphens, beginning
/// with a letter and not ending with a hyphen.
pub(crate) fn is_name(text: &str) -> bool {
    is_tag(text) && text.starts_with(|first: char| first.is_ascii_lowercase())
}

/// As [`is_name`], but it may begin with a digit.
pub(crate) fn is_tag(text: &str) -> bool {
    (1..=NAME_LENGTH_MAX).contains(&text.len())
        && text.bytes().all(|byte| matches!(byte, b'a'..=b'z' | b'0'..=b'9' | b'-'))
        && !text.starts_with('-')
        && !text.ends_with('-')
}
