//! Actions as trees of statements.

use std::collections::BTreeSet;

use rsapien_protocol::{BumperMask, Pose, Primitive};

/// A place in a text, in bytes. Places are no part of what an action means: all are equal.
#[derive(Clone, Copy, Debug, Default)]
pub struct Span {
    /// The first byte.
    pub start: usize,
    /// One behind the last byte.
    pub end: usize,
}

impl Span {
    /// From the beginning of this one to the end of `last`.
    #[must_use]
    pub const fn to(self, last: Span) -> Span {
        Span { start: self.start, end: last.end }
    }
}

impl PartialEq for Span {
    fn eq(&self, _: &Span) -> bool {
        true
    }
}

impl Eq for Span {}

/// A word with its place.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Word {
    /// The word.
    pub text: String,
    /// Where it stands.
    pub span: Span,
}

impl Word {
    /// A word that stands nowhere.
    pub fn new(text: impl Into<String>) -> Word {
        Word { text: text.into(), span: Span::default() }
    }
}

/// An action as a user writes it, before it is stored.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ActionDraft {
    /// The name it is played by: 1 to 64 lower-case letters, digits and hyphens, beginning with a
    /// letter and not ending with a hyphen; neither a primitive's name nor a word of the language.
    pub name: Word,
    /// What may be chosen when it is played.
    pub parameters: Vec<Parameter>,
    /// What it does, for people; at most 2000 characters.
    pub description: String,
    /// Words to find it by, of the same characters as a name; at most 32, none twice.
    pub tags: Vec<Word>,
    /// Rules of the checker that are silenced.
    pub allowances: Vec<Allowance>,
    /// What is done, in order.
    pub body: Vec<Statement>,
}

/// A parameter of an action: its default tells its kind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parameter {
    /// Its name.
    pub name: Word,
    /// Its value where none is given.
    pub default: Value,
    /// Where it stands.
    pub span: Span,
}

/// A rule of the checker that is silenced in an action.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Allowance {
    /// The rule's name.
    pub rule: Word,
    /// Why.
    pub reason: String,
    /// Where it stands.
    pub span: Span,
}

/// A time or a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Value {
    /// A time in milliseconds.
    DurationMs(u32),
    /// A number in thousandths: 1500 is 1.5.
    Thousandths(u32),
}

impl Value {
    /// A whole number; at most 4,294,967.
    pub const fn count(count: u32) -> Value {
        Value::Thousandths(count.saturating_mul(1000))
    }
}

/// A value, or the name of the parameter that has it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A value.
    Value(Value, Span),
    /// The parameter of this name.
    Parameter(Word),
}

impl Quantity {
    /// A time in milliseconds.
    pub const fn duration_ms(duration_ms: u32) -> Quantity {
        Quantity::Value(Value::DurationMs(duration_ms), Span { start: 0, end: 0 })
    }

    /// A whole number.
    pub const fn count(count: u32) -> Quantity {
        Quantity::Value(Value::count(count), Span { start: 0, end: 0 })
    }

    /// A number in thousandths.
    pub const fn thousandths(thousandths: u32) -> Quantity {
        Quantity::Value(Value::Thousandths(thousandths), Span { start: 0, end: 0 })
    }

    /// Where it stands.
    pub const fn span(&self) -> Span {
        match self {
            Quantity::Value(_, span) => *span,
            Quantity::Parameter(word) => word.span,
        }
    }
}

/// A statement and its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Statement {
    /// What it says.
    pub kind: StatementKind,
    /// Where it stands, its block with it.
    pub span: Span,
}

/// What a statement says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StatementKind {
    /// `do right-arm-up + tilt-left for 650ms`: motion primitives that start together. The step lasts
    /// so long whether or not the joints have arrived; motors of joints still travelling keep running
    /// into the next step. Without a duration it lasts as long as its joints need from end to end.
    Do {
        /// The primitives, and where each stands.
        primitives: Vec<(Primitive, Span)>,
        /// How long the step lasts, 1 to 65535 ms.
        duration: Option<Quantity>,
    },
    /// `wait 300ms`: nothing new; joints under way keep travelling.
    Wait {
        /// How long, 1 to 65535 ms.
        duration: Quantity,
    },
    /// `wait for right-hand at most 10s else end`: stands until a bumper is pressed.
    WaitFor {
        /// The bumpers, one of which ends the wait.
        bumpers: BumperMask,
        /// How long at most, 1 ms to an hour.
        limit: Quantity,
        /// What is done when none was pressed by then; written only where it is not to go on.
        otherwise: Response,
    },
    /// `play wave(rounds = 3) mirrored at 0.8 times 2`: another action.
    Play(Play),
    /// `repeat 3 { ... }`.
    Repeat {
        /// How often, 1 to 1000. None is a mistake that the checker tells.
        count: Option<Quantity>,
        /// What.
        body: Vec<Statement>,
    },
    /// `mirror { ... }`: left for right.
    Mirror {
        /// What is mirrored.
        body: Vec<Statement>,
    },
    /// `speed 0.8 { ... }`: durations are divided by the factor. Limits of waits for bumpers are not.
    Speed {
        /// 0.1 to 10.
        factor: Quantity,
        /// What is played faster or slower.
        body: Vec<Statement>,
    },
    /// `together { track { ... } track { ... } }`: side by side, each with joints of its own.
    Together {
        /// What runs side by side.
        tracks: Vec<Track>,
    },
    /// `on feet end`: what is done when one of the bumpers is met, from here to the end of the block,
    /// also in what is played there.
    On {
        /// The bumpers.
        bumpers: BumperMask,
        /// What is done.
        response: Response,
    },
    /// `label top`: a place with a name.
    Label {
        /// The name, of the same form as an action's.
        name: Word,
    },
}

/// One of several rows of statements that run side by side.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Track {
    /// What is done in it.
    pub body: Vec<Statement>,
    /// Where it stands.
    pub span: Span,
}

/// How another action is played.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Play {
    /// Its name.
    pub action: Word,
    /// Values of its parameters.
    pub arguments: Vec<(Word, Quantity)>,
    /// Whether left and right change places.
    pub mirrored: bool,
    /// How fast, 0.1 to 10; as written where none is given.
    pub speed: Option<Quantity>,
    /// How often, 1 to 1000; once where none is given.
    pub times: Option<Quantity>,
}

/// What is done when a bumper is met, or a wait was in vain.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Response {
    /// The action goes on.
    #[default]
    GoOn,
    /// It ends.
    End,
    /// It ends, and another is played.
    Play(Play),
}

impl Play {
    /// Once, as it is written.
    pub fn new(action: impl Into<String>) -> Play {
        Play { action: Word::new(action), ..Play::default() }
    }
}

impl From<StatementKind> for Statement {
    /// A statement that stands nowhere.
    fn from(kind: StatementKind) -> Statement {
        Statement { kind, span: Span::default() }
    }
}

impl Statement {
    /// Motion primitives that start together, for `duration_ms`.
    pub fn moving(pose: Pose, duration_ms: u16) -> Statement {
        let primitives = pose.primitives().map(|primitive| (primitive, Span::default())).collect();
        let duration = Some(Quantity::duration_ms(u32::from(duration_ms)));
        StatementKind::Do { primitives, duration }.into()
    }

    /// Nothing new for `duration_ms`.
    pub fn wait(duration_ms: u16) -> Statement {
        StatementKind::Wait { duration: Quantity::duration_ms(u32::from(duration_ms)) }.into()
    }

    /// Another action, `times` in a row.
    pub fn play(action: impl Into<String>, times: u16) -> Statement {
        let times = (times != 1).then(|| Quantity::count(u32::from(times)));
        StatementKind::Play(Play { times, ..Play::new(action) }).into()
    }

    /// The rows of statements within it: none, one (a block), or several (tracks).
    pub fn blocks(&self) -> impl Iterator<Item = &[Statement]> {
        let (one, tracks): (Option<&[Statement]>, &[Track]) = match &self.kind {
            StatementKind::Repeat { body, .. }
            | StatementKind::Mirror { body }
            | StatementKind::Speed { body, .. } => (Some(body), &[]),
            StatementKind::Together { tracks } => (None, tracks),
            _ => (None, &[]),
        };
        one.into_iter().chain(tracks.iter().map(|track| track.body.as_slice()))
    }

    /// How it plays another action, if it does: at once, or as a response.
    pub fn played(&self) -> Option<&Play> {
        match &self.kind {
            StatementKind::Play(play)
            | StatementKind::On { response: Response::Play(play), .. }
            | StatementKind::WaitFor { otherwise: Response::Play(play), .. } => Some(play),
            _ => None,
        }
    }

    /// Whether it is a step: something that takes time by itself, which blocks do not.
    pub fn is_step(&self) -> bool {
        matches!(
            self.kind,
            StatementKind::Do { .. }
                | StatementKind::Wait { .. }
                | StatementKind::WaitFor { .. }
                | StatementKind::Play(_)
        )
    }
}

impl ActionDraft {
    /// An action without description and tags.
    pub fn new(name: impl Into<String>, body: Vec<Statement>) -> ActionDraft {
        ActionDraft { name: Word::new(name), body, ..ActionDraft::default() }
    }

    /// Calls `visit` with every statement, those within others too, in the order of the text.
    pub fn visit<'a>(&'a self, visit: &mut impl FnMut(&'a Statement)) {
        visit_all(&self.body, visit);
    }

    /// The steps, those within blocks too, in the order of the text. Step number `n` of an action, from
    /// 1, is the one with index `n - 1`.
    pub fn steps(&self) -> Vec<&Statement> {
        let mut steps = Vec::new();
        self.visit(&mut |statement| {
            if statement.is_step() {
                steps.push(statement);
            }
        });
        steps
    }

    /// The names of the actions it plays, as steps or as responses, each once, in alphabetical order.
    pub fn played(&self) -> BTreeSet<&str> {
        let mut names = BTreeSet::new();
        self.visit(&mut |statement| {
            names.extend(statement.played().map(|play| play.action.text.as_str()));
        });
        names
    }
}

fn visit_all<'a>(statements: &'a [Statement], visit: &mut impl FnMut(&'a Statement)) {
    for statement in statements {
        visit(statement);
        for block in statement.blocks() {
            visit_all(block, visit);
        }
    }
}
