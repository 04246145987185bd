//! What a check finds, and where.

use std::fmt;

use crate::check::{Rule, Severity};
use crate::language::Span;

/// One thing that a check has found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The rule that is broken.
    pub rule: Rule,
    /// What is wrong, in one sentence.
    pub message: String,
    /// The place in the text of [`Findings`].
    pub span: Span,
    /// What to say of the place, under it; may be empty.
    pub label: Box<str>,
    /// Other places that belong to it, and what to say of each.
    pub also: Vec<(Span, String)>,
    /// What to do.
    pub help: Option<Box<str>>,
    /// The action, where its name is known.
    pub action: Option<Box<str>>,
}

impl Finding {
    /// A finding without label and help.
    pub fn new(rule: Rule, span: Span, message: impl Into<String>) -> Finding {
        Finding {
            rule,
            message: message.into(),
            span,
            label: Box::default(),
            also: Vec::new(),
            help: None,
            action: None,
        }
    }

    /// The same with a word at its place.
    #[must_use]
    pub fn label(mut self, label: impl Into<String>) -> Finding {
        self.label = label.into().into_boxed_str();
        self
    }

    /// The same with another place.
    #[must_use]
    pub fn and(mut self, span: Span, label: impl Into<String>) -> Finding {
        self.also.push((span, label.into()));
        self
    }

    /// The same with advice.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Finding {
        self.help = Some(help.into().into_boxed_str());
        self
    }

    /// The same, found in the action of this name.
    #[must_use]
    pub fn within(mut self, action: &str) -> Finding {
        self.action = Some(action.into());
        self
    }

    /// The message with its advice, in one line.
    pub fn in_words(&self) -> String {
        match &self.help {
            Some(help) => format!("{}: {help}", self.message),
            None => self.message.clone(),
        }
    }

    /// How grave it is.
    pub const fn severity(&self) -> Severity {
        self.rule.severity()
    }
}

/// All that was found in a text, in its order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Findings {
    /// The text that the places are in.
    pub text: String,
    /// What was found.
    pub list: Vec<Finding>,
}

impl Findings {
    /// Findings in `text`, in the order of their places.
    pub fn new(text: impl Into<String>, mut list: Vec<Finding>) -> Findings {
        list.sort_by_key(|finding| finding.span.start);
        Findings { text: text.into(), list }
    }

    /// Whether an error is among them.
    pub fn has_errors(&self) -> bool {
        self.errors().next().is_some()
    }

    /// The errors.
    pub fn errors(&self) -> impl Iterator<Item = &Finding> {
        self.list.iter().filter(|finding| finding.severity() == Severity::Error)
    }

    /// The warnings.
    pub fn warnings(&self) -> impl Iterator<Item = &Finding> {
        self.list.iter().filter(|finding| finding.severity() == Severity::Warning)
    }

    /// Line and column, from 1, of where a finding begins; columns count characters.
    pub fn place(&self, span: Span) -> (usize, usize) {
        line_and_column(&self.text, span.start)
    }
}

/// Line and column, from 1, of a byte of `text`; columns count characters.
fn line_and_column(text: &str, offset: usize) -> (usize, usize) {
    let before = text.get(..offset.min(text.len())).unwrap_or(text);
    let line = before.matches('\n').count() + 1;
    let begin = before.rfind('\n').map_or(0, |end| end + 1);
    (line, before[begin..].chars().count() + 1)
}

/// One finding a line: `error[joint-two-ways] in line 3: ...; help`.
impl fmt::Display for Findings {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, finding) in self.list.iter().enumerate() {
            if index > 0 {
                formatter.write_str("\n")?;
            }
            let (line, _) = self.place(finding.span);
            let (severity, rule) = (finding.severity().name(), finding.rule);
            write!(formatter, "{severity}[{rule}] in line {line}: {}", finding.message)?;
            if let Some(help) = &finding.help {
                write!(formatter, "; {help}")?;
            }
        }
        Ok(())
    }
}

impl std::error::Error for Findings {}
