//! What can be seen of an action by itself: names, kinds and ranges, places of statements.

use std::collections::BTreeMap;

use rsapien_protocol::{Joint, Primitive};

use super::{Finding, Rule};
use crate::expand::{Values, Wanted, default_values, endless, resolve};
use crate::language::{
    ActionDraft, DESCRIPTION_LENGTH_MAX, NAME_LENGTH_MAX, Play, Quantity, RESERVED_NAME,
    STATEMENTS_MAX, Span, Statement, StatementKind, TAGS_MAX, Track, Word, is_name, is_tag,
};

/// Everything wrong with an action that can be seen without knowing the others.
pub(crate) fn form_findings(draft: &ActionDraft) -> Vec<Finding> {
    let mut form = Form { values: default_values(draft), findings: Vec::new() };
    form.head(draft);
    let mut labels = BTreeMap::new();
    let mut count = 0;
    draft.visit(&mut |statement| {
        count += 1;
        if let StatementKind::Label { name } = &statement.kind {
            form.unique(&mut labels, name, "label");
        }
    });
    if count > STATEMENTS_MAX {
        let message = format!("{count} statements: an action has at most {STATEMENTS_MAX}");
        let finding = Finding::new(Rule::OutOfRange, draft.name.span, message);
        form.findings
            .push(finding.help("put some of them into actions of their own, and play those"));
    }
    form.block(&draft.body, draft.name.span, "the action", false);
    form.findings.into_iter().map(|finding| finding.within(&draft.name.text)).collect()
}

/// What is wrong with a name for an action, if anything.
pub fn check_name(name: &str) -> Option<Finding> {
    name_finding(&Word::new(name))
}

fn name_finding(name: &Word) -> Option<Finding> {
    let text = &name.text;
    let refused = |message: String, help: &str| {
        Some(Finding::new(Rule::BadName, name.span, message).help(help))
    };
    if text == RESERVED_NAME {
        refused(format!("`{text}` is a word of the short form of steps"), "choose another name")
    } else if Primitive::parse(text).is_ok_and(|primitive| primitive.to_string() == *text) {
        refused(format!("`{text}` is the name of a motion primitive"), "choose another name")
    } else {
        bad_name(name, "an action")
    }
}

fn bad_name(name: &Word, what: &str) -> Option<Finding> {
    (!is_name(&name.text)).then(|| {
        let message = format!("`{}` is no name for {what}", name.text);
        let help = format!(
            "use 1 to {NAME_LENGTH_MAX} lower-case letters, digits and hyphens, beginning with a \
             letter and not ending with a hyphen"
        );
        Finding::new(Rule::BadName, name.span, message).help(help)
    })
}

struct Form {
    values: Values,
    findings: Vec<Finding>,
}

impl Form {
    fn head(&mut self, draft: &ActionDraft) {
        self.findings.extend(name_finding(&draft.name));
        let mut parameters = BTreeMap::new();
        for parameter in &draft.parameters {
            self.unique(&mut parameters, &parameter.name, "parameter");
        }
        let length = draft.description.chars().count();
        if length > DESCRIPTION_LENGTH_MAX {
            let message = format!("the description has {length} characters");
            let help = format!("at most {DESCRIPTION_LENGTH_MAX} are allowed");
            let finding = Finding::new(Rule::OutOfRange, draft.name.span, message).help(help);
            self.findings.push(finding);
        }
        if let Some(tag) = draft.tags.get(TAGS_MAX) {
            let message = format!("{} tags", draft.tags.len());
            let help = format!("at most {TAGS_MAX} are allowed");
            self.findings.push(Finding::new(Rule::OutOfRange, tag.span, message).help(help));
        }
        let mut seen: BTreeMap<&str, Span> = BTreeMap::new();
        for tag in &draft.tags {
            if !is_tag(&tag.text) {
                let message = format!("`{}` is no tag", tag.text);
                let finding = Finding::new(Rule::BadName, tag.span, message);
                let help = "use lower-case letters, digits and hyphens";
                self.findings.push(finding.help(help));
            }
            if let Some(first) = seen.insert(&tag.text, tag.span) {
                self.findings.push(twice(&tag.text, "tag", tag.span, first));
            }
        }
    }

    /// Tells a bad name, and one that was there before.
    fn unique<'a>(&mut self, seen: &mut BTreeMap<&'a str, Span>, name: &'a Word, what: &str) {
        self.findings.extend(bad_name(name, &format!("a {what}")));
        if let Some(first) = seen.insert(&name.text, name.span) {
            self.findings.push(twice(&name.text, what, name.span, first));
        }
    }

    fn block(&mut self, body: &[Statement], place: Span, what: &str, in_track: bool) {
        if !has_steps(body) {
            let finding = Finding::new(Rule::Empty, place, format!("{what} has no steps"))
                .help("a step is `do ...`, `wait ...` or `play ...`");
            self.findings.push(finding);
        }
        for statement in body {
            self.statement(statement, in_track);
        }
    }

    fn statement(&mut self, statement: &Statement, in_track: bool) {
        let span = statement.span;
        match &statement.kind {
            StatementKind::Do { primitives, duration } => {
                self.primitives(primitives);
                if let Some(duration) = duration {
                    self.quantity(duration, Wanted::Duration);
                }
            }
            StatementKind::Wait { duration } => self.quantity(duration, Wanted::Duration),
            StatementKind::WaitFor { limit, .. } => {
                self.quantity(limit, Wanted::Limit);
                if in_track {
                    self.misplaced("a wait for a bumper", span);
                }
            }
            StatementKind::Play(_) | StatementKind::Label { .. } => {}
            StatementKind::Repeat { count, body } => {
                match count {
                    Some(count) => self.quantity(count, Wanted::Count),
                    None => self.findings.push(endless(head_of(span))),
                }
                self.block(body, span, "the repeat", in_track);
            }
            StatementKind::Mirror { body } => self.block(body, span, "the mirror", in_track),
            StatementKind::Speed { factor, body } => {
                self.quantity(factor, Wanted::Speed);
                self.block(body, span, "the block", in_track);
            }
            StatementKind::Together { tracks } => self.tracks(tracks, span),
            StatementKind::On { .. } => {
                if in_track {
                    self.misplaced("`on`", span);
                }
            }
        }
        if let Some(play) = statement.played() {
            self.play(play);
        }
    }

    fn tracks(&mut self, tracks: &[Track], span: Span) {
        if tracks.is_empty() {
            let finding = Finding::new(Rule::Empty, span, "no tracks run together here")
                .help("as in `together { track { ... } track { ... } }`");
            self.findings.push(finding);
        }
        for track in tracks {
            self.block(&track.body, track.span, "the track", true);
        }
    }

    fn play(&mut self, play: &Play) {
        if let Some(times) = &play.times {
            self.quantity(times, Wanted::Count);
        }
        if let Some(speed) = &play.speed {
            self.quantity(speed, Wanted::Speed);
        }
        let mut arguments = BTreeMap::new();
        for (name, _) in &play.arguments {
            if let Some(first) = arguments.insert(name.text.as_str(), name.span) {
                self.findings.push(twice(&name.text, "argument", name.span, first));
            }
        }
    }

    fn quantity(&mut self, quantity: &Quantity, wanted: Wanted) {
        self.findings.extend(resolve(quantity, wanted, &self.values).err());
    }

    fn primitives(&mut self, primitives: &[(Primitive, Span)]) {
        let mut sent: [Option<(Primitive, Span)>; Joint::COUNT] = [None; Joint::COUNT];
        for &(primitive, span) in primitives {
            let joint = primitive.joint();
            let slot = &mut sent[usize::from(joint.index())];
            let Some((first, first_span)) = *slot else {
                *slot = Some((primitive, span));
                continue;
            };
            let finding = if first == primitive {
                Finding::new(Rule::JointTwoWays, span, format!("{primitive} is said twice"))
                    .help("say it once")
            } else {
                let message = format!("the joint {joint} is sent two ways at once");
                Finding::new(Rule::JointTwoWays, span, message)
                    .label(format!("{} here", primitive.position_name()))
                    .help("make two steps of it, one behind the other")
            };
            let label = format!("{} here", first.position_name());
            self.findings.push(finding.and(first_span, label));
        }
    }

    fn misplaced(&mut self, what: &str, span: Span) {
        let finding = Finding::new(Rule::Misplaced, span, format!("{what} stands in a track"))
            .help("put it before or behind the `together { ... }`");
        self.findings.push(finding);
    }
}

fn has_steps(body: &[Statement]) -> bool {
    body.iter().any(|statement| statement.is_step() || statement.blocks().any(has_steps))
}

/// The first word of a statement, where it has a text.
fn head_of(span: Span) -> Span {
    Span { start: span.start, end: span.end.min(span.start + "repeat".len()) }
}

fn twice(name: &str, what: &str, span: Span, first: Span) -> Finding {
    Finding::new(Rule::DefinedTwice, span, format!("the {what} `{name}` is there twice"))
        .and(first, "first here")
        .help("give it another name, or take one away")
}
