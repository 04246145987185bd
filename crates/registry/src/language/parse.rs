//! From tokens to trees. A mistake is told and skipped, so that one look finds all of them.

mod items;
mod statements;

pub(crate) use items::{GROUPS, read_value};

use crate::check::{Finding, Findings, Rule};

use super::token::{Token, TokenKind, tokens};
use super::tree::{ActionDraft, Span};

/// A text as it was read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ParsedText {
    /// The actions, in the order of the text; those with mistakes as far as they could be read.
    pub actions: Vec<ParsedAction>,
    /// What could not be read.
    pub findings: Vec<Finding>,
}

/// An action and the text it was read from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParsedAction {
    /// What it says; places are in the whole text.
    pub draft: ActionDraft,
    /// Where it stands in the whole text, with the comments right above it.
    pub span: Span,
}

impl ParsedText {
    /// The actions, where every one could be read.
    ///
    /// # Errors
    /// What could not be read. `text` is the one that was parsed.
    pub fn into_actions(self, text: &str) -> Result<Vec<ParsedAction>, Findings> {
        if self.findings.is_empty() {
            Ok(self.actions)
        } else {
            Err(Findings::new(text, self.findings))
        }
    }
}

/// Reads the actions of a text. What they mean together is not looked at.
pub fn parse_text(text: &str) -> ParsedText {
    let mut parser = Parser { text, tokens: tokens(text), at: 0, findings: Vec::new() };
    let mut actions = Vec::new();
    let mut behind_last = 0;
    while parser.peek().kind != TokenKind::End {
        if !parser.peek().is_word("action") {
            let found = parser.peek().described();
            parser.tell(
                parser.peek().span,
                format!("expected an action, found {found}"),
                "here",
                "an action begins with `action NAME {`",
            );
            parser.skip_to(|token| token.is_word("action"));
            continue;
        }
        let begin = parser.comments_above(behind_last);
        if let Some(draft) = parser.action() {
            behind_last = parser.last_end();
            actions.push(ParsedAction { draft, span: Span { start: begin, end: behind_last } });
        }
    }
    ParsedText { actions, findings: parser.findings }
}

struct Parser<'a> {
    text: &'a str,
    /// Never empty: the last one is the end.
    tokens: Vec<Token>,
    at: usize,
    findings: Vec<Finding>,
}

impl Parser<'_> {
    fn peek(&self) -> &Token {
        &self.tokens[self.at]
    }

    fn next(&mut self) -> Token {
        let token = self.tokens[self.at].clone();
        self.at = (self.at + 1).min(self.tokens.len() - 1);
        token
    }

    /// Where the last token that was taken ends.
    fn last_end(&self) -> usize {
        self.tokens[self.at.saturating_sub(1)].span.end
    }

    /// From `start` to the end of the last token.
    fn since(&self, start: Span) -> Span {
        Span { start: start.start, end: self.last_end().max(start.end) }
    }

    /// Takes the next token if it is this word.
    fn take_word(&mut self, word: &str) -> bool {
        let is_it = self.peek().is_word(word);
        if is_it {
            self.next();
        }
        is_it
    }

    fn take_sign(&mut self, sign: char) -> bool {
        let is_it = self.peek().is_sign(sign);
        if is_it {
            self.next();
        }
        is_it
    }

    fn tell(&mut self, span: Span, message: String, label: &str, help: &str) {
        let finding = Finding::new(Rule::Syntax, span, message).label(label).help(help);
        self.findings.push(finding);
    }

    /// Tells that something else was expected than what comes next.
    fn expected(&mut self, what: &str, help: &str) {
        let found = self.peek().described();
        let span = self.peek().span;
        self.tell(span, format!("expected {what}, found {found}"), "here", help);
    }

    fn expect_sign(&mut self, sign: char, help: &str) -> Option<()> {
        if self.take_sign(sign) {
            return Some(());
        }
        self.expected(&format!("`{sign}`"), help);
        None
    }

    /// Skips to the first token for which `is_end` holds outside of what is skipped in braces; the end
    /// of the text always does.
    fn skip_to(&mut self, is_end: impl Fn(&Token) -> bool) {
        let mut depth = 0_usize;
        loop {
            let token = self.peek();
            if token.kind == TokenKind::End || (depth == 0 && is_end(token)) {
                return;
            }
            if token.is_sign('{') {
                depth += 1;
            } else if token.is_sign('}') {
                depth = depth.saturating_sub(1);
            }
            self.next();
        }
    }

    /// Where the comment lines begin that stand right above the next token, which is the first of its
    /// line; nothing before `earliest` belongs to them.
    fn comments_above(&self, earliest: usize) -> usize {
        let start = self.peek().span.start;
        let mut begin = start;
        let line_begin = |at: usize| self.text[..at].rfind('\n').map_or(0, |end| end + 1);
        let mut line = line_begin(start);
        if self.text[line..start].trim() != "" {
            return start;
        }
        while line > earliest {
            let above = line_begin(line - 1);
            let is_comment = self.text[above..line].trim_start().starts_with('#');
            if above < earliest || !is_comment {
                break;
            }
            (begin, line) = (above, above);
        }
        begin
    }
}

#[cfg(test)]
mod tests;
