//! The checker: rules, and what breaks them.

mod allow;
mod finding;
mod form;
mod motion;
mod render;
mod rule;
mod text;

pub use finding::{Finding, Findings};
pub use form::check_name;
pub use motion::{BATTERY_MOTOR_S, FREE_TILT};
pub use render::render;
pub use rule::{Rule, Severity};
pub use text::{CheckedAction, CheckedText, check_text};
