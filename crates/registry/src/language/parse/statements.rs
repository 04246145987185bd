//! Statements and their blocks.

use super::Parser;
use crate::check::{Finding, Rule};
use crate::language::token::{Token, TokenKind};
use crate::language::tree::{Play, Response, Span, Statement, StatementKind, Track, Word};
use crate::suggest::closest;

/// The words that begin a statement, or something else that an action holds.
pub(super) const BEGINNINGS: [&str; 12] = [
    "do",
    "wait",
    "play",
    "repeat",
    "mirror",
    "speed",
    "together",
    "on",
    "label",
    "description",
    "tags",
    "allow",
];

/// Blocks within blocks: no text may exhaust the stack.
const DEPTH_MAX: usize = 16;

const BLOCK_HELP: &str = "what belongs to it stands between `{` and `}`";
const TIME_HELP: &str = "a time such as `650ms` or `1.5s`, or the name of a parameter";
const NUMBER_HELP: &str = "a number such as `3`, or the name of a parameter";

impl Parser<'_> {
    /// The next statement; none when it could not be read, which was told and skipped.
    pub(super) fn statement(&mut self) -> Option<Statement> {
        self.statement_at(0)
    }

    fn statement_at(&mut self, depth: usize) -> Option<Statement> {
        let start = self.peek().span;
        let kind = self.statement_kind(depth);
        if kind.is_none() {
            self.skip_statement();
        }
        Some(Statement { kind: kind?, span: self.since(start) })
    }

    /// Goes on behind a statement that could not be read.
    pub(super) fn skip_statement(&mut self) {
        let begins =
            |token: &Token| token.is_sign('}') || BEGINNINGS.iter().any(|word| token.is_word(word));
        self.skip_to(begins);
    }

    fn statement_kind(&mut self, depth: usize) -> Option<StatementKind> {
        let token = self.next();
        let TokenKind::Word(word) = &token.kind else {
            self.no_statement(&token);
            return None;
        };
        match word.as_str() {
            "do" => self.do_primitives(),
            "wait" if self.take_word("for") => self.wait_for(),
            "wait" => {
                let duration = self.quantity("a time", TIME_HELP)?;
                Some(StatementKind::Wait { duration })
            }
            "play" => self.play().map(StatementKind::Play),
            "repeat" => {
                let count = if self.peek().is_sign('{') {
                    None
                } else {
                    Some(self.quantity("how often", NUMBER_HELP)?)
                };
                let body = self.block(depth)?;
                Some(StatementKind::Repeat { count, body })
            }
            "mirror" => self.block(depth).map(|body| StatementKind::Mirror { body }),
            "speed" => {
                let factor = self.quantity("how fast", NUMBER_HELP)?;
                let body = self.block(depth)?;
                Some(StatementKind::Speed { factor, body })
            }
            "together" => self.tracks(depth),
            "on" => {
                let bumpers = self.bumpers()?;
                let response = self.response("`end`, `go-on` or `play NAME`")?;
                Some(StatementKind::On { bumpers, response })
            }
            "label" => {
                let name = self.word("a name for the place", "as in `label top`")?;
                Some(StatementKind::Label { name })
            }
            _ => {
                self.no_statement(&token);
                None
            }
        }
    }

    fn no_statement(&mut self, token: &Token) {
        let mut finding = Finding::new(
            Rule::Syntax,
            token.span,
            format!("expected a statement, found {}", token.described()),
        )
        .help(format!("a statement begins with {}", BEGINNINGS[..9].join(", ")));
        if let TokenKind::Word(word) = &token.kind {
            if rsapien_protocol::Primitive::parse(word).is_ok() {
                finding = finding.help(format!("write `do {word}`"));
            } else if word == "pause" {
                finding = finding.help("write `wait 300ms`");
            } else if let Some(meant) = closest(word, BEGINNINGS.into_iter()) {
                finding = finding.help(format!("did you mean `{meant}`?"));
            }
        }
        self.findings.push(finding);
    }

    fn do_primitives(&mut self) -> Option<StatementKind> {
        let mut primitives = Vec::new();
        loop {
            let (primitive, span) = self.primitive()?;
            primitives.extend(primitive.map(|primitive| (primitive, span)));
            if !self.take_sign('+') {
                break;
            }
        }
        let duration =
            if self.take_word("for") { Some(self.quantity("a time", TIME_HELP)?) } else { None };
        Some(StatementKind::Do { primitives, duration })
    }

    fn wait_for(&mut self) -> Option<StatementKind> {
        let bumpers = self.bumpers()?;
        let help = "a wait for a bumper has a limit, as in `wait for right-hand at most 10s`";
        if !(self.take_word("at") && self.take_word("most")) {
            self.expected("`at most` and a time", help);
            return None;
        }
        let limit = self.quantity("a time", help)?;
        let otherwise = if self.take_word("else") {
            self.response("`end`, `go-on` or `play NAME`")?
        } else {
            Response::GoOn
        };
        Some(StatementKind::WaitFor { bumpers, limit, otherwise })
    }

    fn response(&mut self, what: &str) -> Option<Response> {
        if self.take_word("end") {
            Some(Response::End)
        } else if self.take_word("go-on") {
            Some(Response::GoOn)
        } else if self.take_word("play") {
            self.play().map(Response::Play)
        } else {
            self.expected(what, "as in `on feet end` and `on left-hand play step-back`");
            None
        }
    }

    /// What stands behind `play`.
    fn play(&mut self) -> Option<Play> {
        let action = self.word("the name of an action", "as in `play wave`")?;
        let mut play = Play { action, ..Play::default() };
        if self.take_sign('(') {
            play.arguments = self.arguments()?;
        }
        loop {
            let span = self.peek().span;
            let is_again = if self.take_word("mirrored") {
                std::mem::replace(&mut play.mirrored, true)
            } else if self.take_word("at") {
                play.speed.replace(self.quantity("how fast", NUMBER_HELP)?).is_some()
            } else if self.take_word("times") {
                play.times.replace(self.quantity("how often", NUMBER_HELP)?).is_some()
            } else {
                return Some(play);
            };
            if is_again {
                let again = Word { text: self.text[span.start..span.end].to_owned(), span };
                let message = format!("`{}` is said twice", again.text);
                let finding = Finding::new(Rule::Syntax, again.span, message).help("say it once");
                self.findings.push(finding);
            }
        }
    }

    fn arguments(&mut self) -> Option<Vec<(Word, crate::language::tree::Quantity)>> {
        let mut arguments = Vec::new();
        let help = "as in `play wave(rounds = 3)`";
        while !self.take_sign(')') {
            let name = self.word("a parameter of the action", help)?;
            self.expect_sign('=', help)?;
            arguments.push((name, self.quantity("a value", help)?));
            if !self.take_sign(',') && !self.peek().is_sign(')') {
                self.expected("`,` or `)`", help);
                return None;
            }
        }
        Some(arguments)
    }

    fn tracks(&mut self, depth: usize) -> Option<StatementKind> {
        let opening = self.peek().span;
        let help = "as in `together { track { ... } track { ... } }`";
        self.expect_sign('{', help)?;
        let mut tracks = Vec::new();
        while !self.take_sign('}') {
            let start = self.peek().span;
            if self.take_word("track") {
                let body = self.block(depth)?;
                tracks.push(Track { body, span: self.since(start) });
            } else if self.peek().kind == TokenKind::End {
                self.not_closed(opening);
                break;
            } else {
                self.expected("`track {`", help);
                return None;
            }
        }
        Some(StatementKind::Together { tracks })
    }

    fn block(&mut self, depth: usize) -> Option<Vec<Statement>> {
        let opening = self.peek().span;
        self.expect_sign('{', BLOCK_HELP)?;
        if depth >= DEPTH_MAX {
            let message = format!("blocks lie more than {DEPTH_MAX} deep");
            let finding = Finding::new(Rule::OutOfRange, opening, message)
                .help("make an action of what lies within, and play it");
            self.findings.push(finding);
            self.skip_to(|token| token.is_sign('}'));
            self.take_sign('}');
            return Some(Vec::new());
        }
        let mut body = Vec::new();
        while !self.take_sign('}') {
            if self.peek().kind == TokenKind::End {
                self.not_closed(opening);
                break;
            }
            if let TokenKind::Word(word) = &self.peek().kind
                && matches!(word.as_str(), "description" | "tags" | "allow")
            {
                let message = format!("`{word}` stands in a block");
                let span = self.peek().span;
                let finding = Finding::new(Rule::Misplaced, span, message)
                    .help("it belongs to the whole action: put it before the statements");
                self.findings.push(finding);
                self.next();
                self.skip_statement();
                continue;
            }
            body.extend(self.statement_at(depth + 1));
        }
        Some(body)
    }

    fn not_closed(&mut self, opening: Span) {
        self.tell(
            opening,
            "this block is not closed".to_owned(),
            "begins here",
            "put `}` behind it",
        );
    }
}
