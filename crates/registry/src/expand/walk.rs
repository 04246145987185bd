//! The walk through an action and what it plays.

use std::sync::Arc;

use rsapien_protocol::{BumperMask, Pose, Primitive, Step};

use super::quantity::{Values, Wanted, default_values, resolve, set_argument, value_of};
use super::row::{Row, RowStep};
use super::{COMPILED_STEPS_MAX, DURATION_MS_MAX, KnownActions, NESTING_MAX};
use crate::check::{Finding, Rule};
use crate::compiled::{CompiledAction, Label, Reaction, Reactions, StepSource, Wait};
use crate::language::{
    ActionDraft, Play, Quantity, Response, Span, Statement, StatementKind, Track, Word,
};
use crate::suggest::closest;

/// What the compiling of a response counts for in statements, its own not counted.
const RESPONSE_COST: usize = 100;

/// How much work is left: repeats of repeats that make no step, and responses that play each other in
/// many ways, have to end, too.
pub(super) struct Budget {
    statements: usize,
}

impl Default for Budget {
    fn default() -> Budget {
        Budget { statements: 20 * COMPILED_STEPS_MAX }
    }
}

/// An action that is compiled on its own: the one asked for, or one that a response plays.
pub(super) struct Round<'a> {
    pub(super) draft: &'a ActionDraft,
    pub(super) values: &'a Values,
    pub(super) mirrored: bool,
    pub(super) speed: f64,
    pub(super) times: u16,
}

/// Compiles an action with nothing around it. `path` are the names of the actions it lies within.
pub(super) fn compile_rounds(
    round: &Round<'_>,
    known: &dyn KnownActions,
    budget: &mut Budget,
    path: &mut Vec<String>,
) -> Result<CompiledAction, Finding> {
    let name: Arc<str> = Arc::from(round.draft.name.text.as_str());
    path.push(name.to_string());
    let mut walk = Walk { known, budget, path, row: Row::default(), responses: Vec::new() };
    for number in 1..=round.times {
        let place = Place {
            values: round.values,
            name: &name,
            mirrored: round.mirrored,
            speed: round.speed,
            reactions: Reactions::default(),
            outer: None,
            round: number,
            in_track: false,
        };
        walk.statements(&round.draft.body, place, 1)?;
    }
    let Walk { row, responses, .. } = walk;
    path.pop();
    Ok(finish(round.draft.name.text.clone(), row, responses.into_iter().map(|it| it.1).collect()))
}

/// Cuts steps to what the queue takes.
fn finish(name: String, row: Row, handlers: Vec<CompiledAction>) -> CompiledAction {
    let mut action = CompiledAction { name, handlers, ..CompiledAction::default() };
    action.duration_ms = row.duration_ms;
    let mut new_index = Vec::with_capacity(row.steps.len() + 1);
    for step in row.steps {
        new_index.push(action.steps.len());
        let (mut left_ms, mut pose) = (step.duration_ms, step.pose);
        while left_ms > 0 {
            let part_ms = u16::try_from(left_ms).unwrap_or(u16::MAX);
            let mut part = Step::new(pose, part_ms);
            part.ending_bumpers = step.reactions.ending_bumpers();
            action.steps.push(part);
            action.sources.push(step.source.clone());
            action.reactions.push(step.reactions);
            left_ms -= u64::from(part_ms);
            pose = Pose::EMPTY;
        }
    }
    new_index.push(action.steps.len());
    let index_of = |step: usize| new_index.get(step).copied().unwrap_or(action.steps.len());
    action.waits = row
        .waits
        .into_iter()
        .map(|wait| Wait { before_step: index_of(wait.before_step), ..wait })
        .collect();
    action.labels =
        row.labels.into_iter().map(|label| Label { step: index_of(label.step), ..label }).collect();
    action
}

/// What holds at a place of the walk.
#[derive(Clone, Copy)]
struct Place<'a> {
    values: &'a Values,
    /// The action that is walked through.
    name: &'a Arc<str>,
    mirrored: bool,
    speed: f64,
    reactions: Reactions,
    /// Number and place of the statement in the action compiled, where this is another.
    outer: Option<(usize, Span)>,
    round: u16,
    in_track: bool,
}

impl Place<'_> {
    fn source(&self, number: usize) -> StepSource {
        StepSource {
            action: Arc::clone(self.name),
            step: number,
            outer_step: self.outer.map_or(number, |(outer, _)| outer),
            round: self.round,
        }
    }

    /// The speed at which an action is played from here.
    fn speed_of(&self, play: &Play) -> Result<f64, Finding> {
        match &play.speed {
            Some(speed) => Ok(self.speed * speed_of(speed, self.values)?),
            None => Ok(self.speed),
        }
    }

    fn scaled_ms(&self, duration_ms: u32) -> u64 {
        // At least one; a float too large for the type becomes its largest value.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
        let scaled = (f64::from(duration_ms) / self.speed).round().max(1.0) as u64;
        scaled
    }
}

struct Walk<'w> {
    known: &'w dyn KnownActions,
    budget: &'w mut Budget,
    path: &'w mut Vec<String>,
    row: Row,
    /// What responses play, each once.
    responses: Vec<(ResponseKey, CompiledAction)>,
}

/// What makes one response differ from another.
#[derive(PartialEq)]
struct ResponseKey {
    action: String,
    values: Values,
    mirrored: bool,
    speed: f64,
    times: u16,
}

impl Walk<'_> {
    /// Walks through statements, the first step among which has this number; returns the next number.
    fn statements(
        &mut self,
        statements: &[Statement],
        mut place: Place<'_>,
        mut number: usize,
    ) -> Result<usize, Finding> {
        for statement in statements {
            self.spend(1, statement.span, place)?;
            if let StatementKind::On { bumpers, response } = &statement.kind {
                place.reactions = self.reactions(*bumpers, response, place, statement.span)?;
                continue;
            }
            number = self.statement(statement, place, number)?;
        }
        Ok(number)
    }

    fn statement(
        &mut self,
        statement: &Statement,
        place: Place<'_>,
        number: usize,
    ) -> Result<usize, Finding> {
        let span = place.outer.map_or(statement.span, |(_, span)| span);
        match &statement.kind {
            StatementKind::Do { primitives, duration } => {
                let pose =
                    pose_of(primitives.iter().map(|(primitive, _)| *primitive), place.mirrored);
                let duration_ms = match duration {
                    Some(duration) => resolve(duration, Wanted::Duration, place.values)?,
                    None => u32::from(
                        pose.primitives().map(|it| it.joint().settle_ms()).max().unwrap_or(1),
                    ),
                };
                self.step(pose, duration_ms, place, number, span)?;
                Ok(number + 1)
            }
            StatementKind::Wait { duration } => {
                let duration_ms = resolve(duration, Wanted::Duration, place.values)?;
                self.step(Pose::EMPTY, duration_ms, place, number, span)?;
                Ok(number + 1)
            }
            StatementKind::WaitFor { bumpers, limit, otherwise } => {
                if place.in_track {
                    return Err(in_track("a wait for a bumper", span));
                }
                let limit_ms = resolve(limit, Wanted::Limit, place.values)?;
                let bumpers = mirrored_bumpers(*bumpers, place.mirrored);
                let otherwise = self.reaction(otherwise, place, span)?;
                let before_step = self.row.steps.len();
                let source = place.source(number);
                self.row.waits.push(Wait { before_step, bumpers, limit_ms, otherwise, source });
                Ok(number + 1)
            }
            StatementKind::Play(play) => {
                self.play(play, place, number, span)?;
                Ok(number + 1)
            }
            StatementKind::Repeat { count, body } => {
                let Some(count) = count else { return Err(endless(span)) };
                let times = resolve(count, Wanted::Count, place.values)?;
                let mut behind = number;
                for _ in 0..times {
                    self.spend(1, span, place)?;
                    behind = self.statements(body, place, number)?;
                }
                Ok(behind)
            }
            StatementKind::Mirror { body } => {
                let place = Place { mirrored: !place.mirrored, ..place };
                self.statements(body, place, number)
            }
            StatementKind::Speed { factor, body } => {
                let speed = place.speed * speed_of(factor, place.values)?;
                self.statements(body, Place { speed, ..place }, number)
            }
            StatementKind::Together { tracks } => self.tracks(tracks, place, number),
            StatementKind::Label { name } => {
                self.row.label(&name.text);
                Ok(number)
            }
            // Taken where the block is walked through, since it holds for the rest of it.
            StatementKind::On { .. } => Ok(number),
        }
    }

    fn tracks(
        &mut self,
        tracks: &[Track],
        place: Place<'_>,
        mut number: usize,
    ) -> Result<usize, Finding> {
        let place = Place { in_track: true, ..place };
        let before = std::mem::take(&mut self.row);
        let mut rows = Vec::with_capacity(tracks.len());
        for track in tracks {
            number = self.statements(&track.body, place, number)?;
            rows.push(std::mem::take(&mut self.row));
        }
        self.row = before;
        self.row.append_together(&rows)?;
        Ok(number)
    }

    fn step(
        &mut self,
        pose: Pose,
        duration_ms: u32,
        place: Place<'_>,
        number: usize,
        span: Span,
    ) -> Result<(), Finding> {
        let duration_ms = place.scaled_ms(duration_ms);
        let source = place.source(number);
        self.row.push(RowStep { pose, duration_ms, reactions: place.reactions, source, span });
        if self.row.duration_ms > DURATION_MS_MAX {
            let finding = Finding::new(Rule::OutOfRange, span, "the action is longer than a day")
                .label("here it is more than 24 hours");
            return Err(finding.help("let it do less, or play it several times"));
        }
        if self.row.steps.len() > COMPILED_STEPS_MAX {
            return Err(too_many_steps(span));
        }
        Ok(())
    }

    fn spend(&mut self, cost: usize, span: Span, place: Place<'_>) -> Result<(), Finding> {
        let span = place.outer.map_or(span, |(_, span)| span);
        match self.budget.statements.checked_sub(cost) {
            Some(left) => self.budget.statements = left,
            None => return Err(too_many_steps(span)),
        }
        Ok(())
    }

    fn play(
        &mut self,
        play: &Play,
        place: Place<'_>,
        number: usize,
        span: Span,
    ) -> Result<(), Finding> {
        let (draft, values) = self.prepare(play, place, span)?;
        let times = times_of(play, place.values)?;
        let speed = place.speed_of(play)?;
        let name: Arc<str> = Arc::from(play.action.text.as_str());
        let inner = Place {
            values: &values,
            name: &name,
            mirrored: place.mirrored != play.mirrored,
            speed,
            outer: Some(place.outer.unwrap_or((number, span))),
            ..place
        };
        self.path.push(play.action.text.clone());
        for _ in 0..times {
            self.spend(1, span, place)?;
            self.statements(&draft.body, inner, 1).map_err(|finding| {
                // Places in another text mean nothing here.
                if finding.action.is_some() { finding } else { moved(finding, &name, span) }
            })?;
        }
        self.path.pop();
        Ok(())
    }

    /// The action that is played, and the values of its parameters.
    fn prepare(
        &self,
        play: &Play,
        place: Place<'_>,
        span: Span,
    ) -> Result<(Arc<ActionDraft>, Values), Finding> {
        let name = &play.action;
        if self.path.contains(&name.text) {
            return Err(circle(self.path, name, span));
        }
        if self.path.len() >= NESTING_MAX {
            let message = format!("actions play each other more than {NESTING_MAX} deep");
            return Err(Finding::new(Rule::OutOfRange, span, message)
                .help("put what they do into fewer actions"));
        }
        let draft = self.known.draft(&name.text).ok_or_else(|| unknown_action(self.known, name))?;
        let mut values = default_values(&draft);
        for (parameter, quantity) in &play.arguments {
            let value = value_of(quantity, place.values)?;
            let whole = parameter.span.to(quantity.span());
            set_argument(&draft, &mut values, &parameter.text, value, whole)?;
        }
        Ok((draft, values))
    }

    fn reactions(
        &mut self,
        bumpers: BumperMask,
        response: &Response,
        place: Place<'_>,
        span: Span,
    ) -> Result<Reactions, Finding> {
        if place.in_track {
            return Err(in_track("`on`", place.outer.map_or(span, |(_, span)| span)));
        }
        let reaction = self.reaction(response, place, span)?;
        let bumpers = mirrored_bumpers(bumpers, place.mirrored);
        let mut reactions = place.reactions;
        for (index, slot) in reactions.0.iter_mut().enumerate() {
            if bumpers.contains(index) {
                *slot = reaction;
            }
        }
        Ok(reactions)
    }

    fn reaction(
        &mut self,
        response: &Response,
        place: Place<'_>,
        span: Span,
    ) -> Result<Reaction, Finding> {
        let play = match response {
            Response::GoOn => return Ok(Reaction::GoOn),
            Response::End => return Ok(Reaction::End),
            Response::Play(play) => play,
        };
        self.spend(RESPONSE_COST, span, place)?;
        let (draft, values) = self.prepare(play, place, span)?;
        let speed = place.speed_of(play)?;
        let key = ResponseKey {
            action: play.action.text.clone(),
            values,
            mirrored: place.mirrored != play.mirrored,
            speed,
            times: times_of(play, place.values)?,
        };
        if let Some(index) = self.responses.iter().position(|(known, _)| *known == key) {
            return Ok(Reaction::Play(index));
        }
        let round = Round {
            draft: &draft,
            values: &key.values,
            mirrored: key.mirrored,
            speed: key.speed,
            times: key.times,
        };
        let compiled = compile_rounds(&round, self.known, self.budget, self.path)
            .map_err(|finding| moved(finding, &key.action, span))?;
        self.responses.push((key, compiled));
        Ok(Reaction::Play(self.responses.len() - 1))
    }
}

fn times_of(play: &Play, values: &Values) -> Result<u16, Finding> {
    let Some(times) = &play.times else { return Ok(1) };
    Ok(u16::try_from(resolve(times, Wanted::Count, values)?).unwrap_or(u16::MAX))
}

fn speed_of(factor: &Quantity, values: &Values) -> Result<f64, Finding> {
    Ok(f64::from(resolve(factor, Wanted::Speed, values)?) / 1000.0)
}

fn pose_of(primitives: impl Iterator<Item = Primitive>, is_mirrored: bool) -> Pose {
    primitives.fold(Pose::EMPTY, |pose, primitive| {
        let primitive = if is_mirrored { primitive.mirrored() } else { primitive };
        pose.with(primitive.joint(), Some(primitive.position()))
    })
}

fn mirrored_bumpers(bumpers: BumperMask, is_mirrored: bool) -> BumperMask {
    if is_mirrored { bumpers.mirrored() } else { bumpers }
}

/// A finding in another action, told at the place where that is played.
fn moved(finding: Finding, action: &str, span: Span) -> Finding {
    let message = format!("in `{action}`: {}", finding.message);
    Finding { message, span, also: Vec::new(), ..finding }.label("played here").within(action)
}

fn in_track(what: &str, span: Span) -> Finding {
    Finding::new(Rule::Misplaced, span, format!("{what} stands in a track"))
        .help("put it before or behind the `together { ... }`")
}

/// A repeat without an end.
pub(crate) fn endless(span: Span) -> Finding {
    Finding::new(Rule::EndlessRepeat, span, "this repeat never ends")
        .label("how often?")
        .help("say how often, as in `repeat 10 { ... }`")
}

fn too_many_steps(span: Span) -> Finding {
    let message = format!("the action makes more than {COMPILED_STEPS_MAX} steps");
    Finding::new(Rule::OutOfRange, span, message).help("repeat less")
}

fn circle(path: &[String], name: &Word, span: Span) -> Finding {
    let from = path.iter().position(|outer| *outer == name.text).unwrap_or(0);
    let mut names: Vec<&str> = path[from..].iter().map(String::as_str).collect();
    names.push(&name.text);
    let message = format!("actions play each other in a circle: {}", names.join(" -> "));
    Finding::new(Rule::Circle, span, message)
        .label("this never ends")
        .help("use `repeat` to do something several times")
}

fn unknown_action(known: &dyn KnownActions, name: &Word) -> Finding {
    let message = format!("there is no action `{}`", name.text);
    let finding = Finding::new(Rule::UnknownName, name.span, message);
    let names = known.names();
    match closest(&name.text, names.iter().map(String::as_str)) {
        Some(meant) => finding.help(format!("did you mean `{meant}`?")),
        None => finding.help("save that action first, or write it in the same text"),
    }
}
