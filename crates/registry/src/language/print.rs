//! The text of an action: reading it gives the same action again.

use std::fmt::Write as _;

use rsapien_protocol::BumperMask;

use super::parse::GROUPS;
use super::tree::{ActionDraft, Play, Quantity, Response, Statement, StatementKind, Value, Word};

/// The text of several actions, in their order.
pub fn print_actions<'a>(drafts: impl IntoIterator<Item = &'a ActionDraft>) -> String {
    let texts: Vec<String> = drafts.into_iter().map(print_action).collect();
    texts.join("\n")
}

/// The text of an action; it ends with a new line.
pub fn print_action(draft: &ActionDraft) -> String {
    let mut printer = Printer { text: String::new() };
    printer.action(draft);
    printer.text
}

struct Printer {
    text: String,
}

impl Printer {
    fn line(&mut self, indent: usize, line: &str) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.text, "{:1$}{line}", "", 4 * indent);
    }

    fn action(&mut self, draft: &ActionDraft) {
        let ActionDraft { name, parameters, description, tags, allowances, body } = draft;
        let parameters: Vec<String> = parameters
            .iter()
            .map(|parameter| format!("{} = {}", parameter.name.text, value(parameter.default)))
            .collect();
        let parameters = match parameters.as_slice() {
            [] => String::new(),
            list => format!("({})", list.join(", ")),
        };
        self.line(0, &format!("action {}{parameters} {{", name.text));
        if !description.is_empty() {
            self.line(1, &format!("description {}", quoted(description)));
        }
        if !tags.is_empty() {
            self.line(1, &format!("tags {}", words(tags)));
        }
        for allowance in allowances {
            let reason = quoted(&allowance.reason);
            self.line(1, &format!("allow {} {reason}", allowance.rule.text));
        }
        self.statements(1, body);
        self.line(0, "}");
    }

    fn statements(&mut self, indent: usize, statements: &[Statement]) {
        for statement in statements {
            self.statement(indent, statement);
        }
    }

    fn statement(&mut self, indent: usize, statement: &Statement) {
        let block = |head: &str, body: &[Statement], printer: &mut Printer| {
            printer.line(indent, &format!("{head} {{"));
            printer.statements(indent + 1, body);
            printer.line(indent, "}");
        };
        match &statement.kind {
            StatementKind::Do { primitives, duration } => {
                let names: Vec<String> =
                    primitives.iter().map(|(primitive, _)| primitive.to_string()).collect();
                let duration = duration
                    .as_ref()
                    .map(|it| format!(" for {}", quantity(it)))
                    .unwrap_or_default();
                self.line(indent, &format!("do {}{duration}", names.join(" + ")));
            }
            StatementKind::Wait { duration } => {
                self.line(indent, &format!("wait {}", quantity(duration)));
            }
            StatementKind::WaitFor { bumpers, limit, otherwise } => {
                let otherwise = match otherwise {
                    Response::GoOn => String::new(),
                    other => format!(" else {}", response(other)),
                };
                let (bumpers, limit) = (bumper_words(*bumpers), quantity(limit));
                self.line(indent, &format!("wait for {bumpers} at most {limit}{otherwise}"));
            }
            StatementKind::Play(it) => self.line(indent, &play(it)),
            StatementKind::Repeat { count, body } => {
                let count = count.as_ref().map(|it| format!(" {}", quantity(it)));
                block(&format!("repeat{}", count.unwrap_or_default()), body, self);
            }
            StatementKind::Mirror { body } => block("mirror", body, self),
            StatementKind::Speed { factor, body } => {
                block(&format!("speed {}", quantity(factor)), body, self);
            }
            StatementKind::Together { tracks } => {
                self.line(indent, "together {");
                for track in tracks {
                    self.line(indent + 1, "track {");
                    self.statements(indent + 2, &track.body);
                    self.line(indent + 1, "}");
                }
                self.line(indent, "}");
            }
            StatementKind::On { bumpers, response: what } => {
                self.line(indent, &format!("on {} {}", bumper_words(*bumpers), response(what)));
            }
            StatementKind::Label { name } => self.line(indent, &format!("label {}", name.text)),
        }
    }
}

fn play(play: &Play) -> String {
    let Play { action, arguments, mirrored, speed, times } = play;
    let mut text = format!("play {}", action.text);
    if !arguments.is_empty() {
        let arguments: Vec<String> = arguments
            .iter()
            .map(|(name, value)| format!("{} = {}", name.text, quantity(value)))
            .collect();
        let _ = write!(text, "({})", arguments.join(", "));
    }
    if *mirrored {
        text.push_str(" mirrored");
    }
    if let Some(speed) = speed {
        let _ = write!(text, " at {}", quantity(speed));
    }
    if let Some(times) = times {
        let _ = write!(text, " times {}", quantity(times));
    }
    text
}

fn response(response: &Response) -> String {
    match response {
        Response::GoOn => "go-on".to_owned(),
        Response::End => "end".to_owned(),
        Response::Play(it) => play(it),
    }
}

fn quantity(quantity: &Quantity) -> String {
    match quantity {
        Quantity::Value(it, _) => value(*it),
        Quantity::Parameter(name) => name.text.clone(),
    }
}

/// A value as it is written.
pub(crate) fn value(value: Value) -> String {
    match value {
        Value::DurationMs(ms) => format!("{ms}ms"),
        Value::Thousandths(it) if it % 1000 == 0 => (it / 1000).to_string(),
        Value::Thousandths(it) => {
            let text = format!("{}.{:03}", it / 1000, it % 1000);
            text.trim_end_matches('0').to_owned()
        }
    }
}

/// Bumpers as they are written: a group's name where there is one.
fn bumper_words(bumpers: BumperMask) -> String {
    if let Some((name, _)) = GROUPS.iter().find(|(_, bits)| *bits == bumpers.bits()) {
        return (*name).to_owned();
    }
    bumpers.names().collect::<Vec<_>>().join(", ")
}

fn words(words: &[Word]) -> String {
    words.iter().map(|word| word.text.as_str()).collect::<Vec<_>>().join(", ")
}

/// A text in quotation marks, with its escapes.
fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for letter in text.chars() {
        match letter {
            '"' => quoted.push_str("\\\""),
            '\\' => quoted.push_str("\\\\"),
            '\n' => quoted.push_str("\\n"),
            '\t' => quoted.push_str("\\t"),
            other => quoted.push(other),
        }
    }
    quoted.push('"');
    quoted
}
