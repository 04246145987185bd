//! Actions, their parameters, and what is said about them; values and names.

use rsapien_protocol::{BumperMask, Primitive};

use super::Parser;
use super::statements::BEGINNINGS;
use crate::check::{Finding, Rule};
use crate::language::token::TokenKind;
use crate::language::tree::{ActionDraft, Allowance, Parameter, Quantity, Span, Value, Word};
use crate::suggest::closest;

/// The words that stand for several bumpers.
pub(crate) const GROUPS: [(&str, u8); 3] = [("feet", 0x0F), ("hands", 0x30), ("any", 0x3F)];

impl Parser<'_> {
    /// `action NAME(PARAMETER = VALUE, ...) { ... }`, of which the first word is the next token.
    pub(super) fn action(&mut self) -> Option<ActionDraft> {
        self.next();
        let read = self.action_behind_its_word();
        if read.is_none() {
            self.skip_to(|token| token.is_word("action"));
        }
        read
    }

    fn action_behind_its_word(&mut self) -> Option<ActionDraft> {
        let name = self.word("a name for the action", "as in `action wave {`")?;
        let mut draft = ActionDraft { name, ..ActionDraft::default() };
        if self.take_sign('(') {
            draft.parameters = self.parameters()?;
        }
        self.expect_sign('{', "what the action does stands between `{` and `}`")?;
        loop {
            let start = self.peek().span;
            if self.take_sign('}') {
                break;
            }
            match &self.peek().kind {
                TokenKind::End => {
                    self.tell(
                        draft.name.span,
                        format!("the action `{}` is not closed", draft.name.text),
                        "begins here",
                        "put `}` behind its last statement",
                    );
                    return Some(draft);
                }
                TokenKind::Word(word) => match word.as_str() {
                    "description" => self.description(&mut draft),
                    "tags" => self.tags(&mut draft),
                    "allow" => self.allowance(start, &mut draft),
                    _ => draft.body.extend(self.statement()),
                },
                _ => draft.body.extend(self.statement()),
            }
        }
        Some(draft)
    }

    fn parameters(&mut self) -> Option<Vec<Parameter>> {
        let mut parameters = Vec::new();
        while !self.take_sign(')') {
            let name = self.word("a parameter", "as in `action wave(rounds = 2) {`")?;
            self.expect_sign('=', "a parameter has a default, as in `rounds = 2`")?;
            let (default, _) = self.value("a default", "such as `2`, `0.8` or `650ms`")?;
            let span = self.since(name.span);
            parameters.push(Parameter { name, default, span });
            if !self.take_sign(',') && !self.peek().is_sign(')') {
                self.expected("`,` or `)`", "parameters stand between `(` and `)`");
                return None;
            }
        }
        Some(parameters)
    }

    fn description(&mut self, draft: &mut ActionDraft) {
        let start = self.next().span;
        if let Some(text) = self.string("what the action does", "as in `description \"Waves.\"`") {
            if !draft.description.is_empty() {
                let span = self.since(start);
                let finding =
                    Finding::new(Rule::DefinedTwice, span, "the action has two descriptions")
                        .help("put both into one text; `\\n` begins a new line in it");
                self.findings.push(finding);
            }
            draft.description = text;
        } else {
            self.skip_statement();
        }
    }

    fn tags(&mut self, draft: &mut ActionDraft) {
        self.next();
        loop {
            let Some(tag) = self.tag() else {
                self.skip_statement();
                return;
            };
            draft.tags.push(tag);
            if !self.take_sign(',') {
                return;
            }
        }
    }

    /// A tag may begin with a digit.
    fn tag(&mut self) -> Option<Word> {
        if let TokenKind::Number { digits, unit } = &self.peek().kind {
            let text = format!("{digits}{unit}");
            let span = self.next().span;
            return Some(Word { text, span });
        }
        self.word("a tag", "as in `tags greeting, arms`")
    }

    fn allowance(&mut self, start: Span, draft: &mut ActionDraft) {
        self.next();
        let help = "as in `allow arms-meet-trunk \"the thing lies between them\"`";
        let read = self.word("the name of a rule", help).and_then(|rule| {
            let reason = self.string("the reason in quotation marks", help)?;
            Some(Allowance { rule, reason, span: self.since(start) })
        });
        match read {
            Some(allowance) => draft.allowances.push(allowance),
            None => self.skip_statement(),
        }
    }

    pub(super) fn word(&mut self, what: &str, help: &str) -> Option<Word> {
        if let TokenKind::Word(text) = &self.peek().kind {
            let text = text.clone();
            let span = self.next().span;
            return Some(Word { text, span });
        }
        self.expected(what, help);
        None
    }

    fn string(&mut self, what: &str, help: &str) -> Option<String> {
        if let TokenKind::String(text) = &self.peek().kind {
            let text = text.clone();
            self.next();
            return Some(text);
        }
        self.expected(what, help);
        None
    }

    /// A value, or the name of a parameter.
    pub(super) fn quantity(&mut self, what: &str, help: &str) -> Option<Quantity> {
        if matches!(self.peek().kind, TokenKind::Word(_)) {
            return self.word(what, help).map(Quantity::Parameter);
        }
        self.value(what, help).map(|(value, span)| Quantity::Value(value, span))
    }

    fn value(&mut self, what: &str, help: &str) -> Option<(Value, Span)> {
        let TokenKind::Number { digits, unit } = &self.peek().kind else {
            self.expected(what, help);
            return None;
        };
        let value = read_value(digits, unit);
        let written = format!("{digits}{unit}");
        let span = self.next().span;
        match value {
            Ok(value) => Some((value, span)),
            Err((rule, why)) => {
                let message = format!("`{written}` {why}");
                let finding = Finding::new(rule, span, message).help(
                    "times are written as `650ms`, `1.5s` or `2min`, numbers as `3` or `0.8`",
                );
                self.findings.push(finding);
                // Read as something that is in range everywhere, so that nothing else is told of it.
                let stand_in =
                    if unit_is_time(&written) { Value::DurationMs(1000) } else { Value::count(1) };
                Some((stand_in, span))
            }
        }
    }

    /// `left-hand, right-hand`, `feet`.
    pub(super) fn bumpers(&mut self) -> Option<BumperMask> {
        let mut bits = 0;
        loop {
            let word = self.word("a bumper", &bumper_help())?;
            match bumper_bits(&word.text) {
                Some(more) => bits |= more,
                None => self.unknown_bumper(&word),
            }
            if !self.take_sign(',') {
                return Some(BumperMask::from_low_bits(bits));
            }
        }
    }

    fn unknown_bumper(&mut self, word: &Word) {
        let names = BumperMask::NAMES.into_iter().chain(GROUPS.map(|(name, _)| name));
        let help = closest(&word.text, names)
            .map_or_else(bumper_help, |name| format!("did you mean `{name}`?"));
        let message = format!("there is no bumper `{}`", word.text);
        let finding = Finding::new(Rule::UnknownName, word.span, message).help(help);
        self.findings.push(finding);
    }

    /// A motion primitive by its name or number.
    pub(super) fn primitive(&mut self) -> Option<(Option<Primitive>, Span)> {
        let help = "a joint and a position, such as `right-arm-up`, or a number from 1 to 21";
        let text = match &self.peek().kind {
            TokenKind::Word(word) if !BEGINNINGS.contains(&word.as_str()) => word.clone(),
            TokenKind::Number { digits, unit } => format!("{digits}{unit}"),
            _ => {
                self.expected("a motion primitive", help);
                return None;
            }
        };
        let span = self.next().span;
        if let Ok(primitive) = Primitive::parse(&text) {
            return Some((Some(primitive), span));
        }
        let names: Vec<String> = Primitive::all().map(|it| it.to_string()).collect();
        let help = closest(&text, names.iter().map(String::as_str)).map_or_else(
            || format!("write {help}; an action is put in with `play`"),
            |name| format!("did you mean `{name}`?"),
        );
        let message = format!("there is no motion primitive `{text}`");
        self.findings.push(Finding::new(Rule::UnknownName, span, message).help(help));
        Some((None, span))
    }
}

/// The bits of a bumper's or a group's name.
fn bumper_bits(name: &str) -> Option<u8> {
    let single = BumperMask::NAMES.iter().position(|bumper| *bumper == name);
    single
        .map(|index| 1 << index)
        .or_else(|| GROUPS.iter().find(|(group, _)| *group == name).map(|(_, bits)| *bits))
}

fn bumper_help() -> String {
    let groups = GROUPS.map(|(name, _)| name).join(", ");
    format!("the bumpers are {}, and together {groups}", BumperMask::NAMES.join(", "))
}

fn unit_is_time(written: &str) -> bool {
    written.ends_with(|letter: char| letter.is_ascii_alphabetic())
}

/// The value of a number with a unit, or the rule it breaks and how.
pub(crate) fn read_value(digits: &str, unit: &str) -> Result<Value, (Rule, &'static str)> {
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    if fraction.contains('.') || digits.ends_with('.') {
        return Err((Rule::Syntax, "is no number"));
    }
    let (factor, decimals_max): (u64, usize) = match unit {
        "" | "s" => (1000, 3),
        "ms" => (1, 0),
        "min" => (60_000, 3),
        _ => return Err((Rule::Syntax, "has a unit that is not known")),
    };
    if fraction.len() > decimals_max {
        let why = if decimals_max == 0 {
            "is finer than a millisecond"
        } else {
            "has more than three decimals"
        };
        return Err((Rule::OutOfRange, why));
    }
    let too_large = (Rule::OutOfRange, "is too large");
    let mut thousandths = whole.parse::<u64>().map_err(|_| too_large)?;
    thousandths = thousandths.checked_mul(1000).ok_or(too_large)?;
    thousandths += format!("{fraction:0<3}").parse::<u64>().unwrap_or(0);
    let scaled = thousandths.checked_mul(factor).ok_or(too_large)? / 1000;
    let value = u32::try_from(scaled).map_err(|_| too_large)?;
    Ok(if unit.is_empty() { Value::Thousandths(value) } else { Value::DurationMs(value) })
}
