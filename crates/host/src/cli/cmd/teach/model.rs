//! What `rsapien teach` knows, and what its keys do.

use std::fmt::Write as _;

use ratatui::Frame;
use ratatui::crossterm::event::{KeyCode, KeyEvent};
use rsapien_protocol::{BumperMask, Joint, Pose};
use rsapien_registry::CompiledAction;

use super::draw;
use crate::RobotState;
use crate::cli::screen::parts::{Palette, neighbour};
use crate::cli::screen::{Effect, Event, Model, Told};

/// To this a step's duration is rounded, in ms; + and - change it by as much.
const ROUNDED_MS: u32 = 50;
/// The longest step, in ms.
const LONGEST_MS: u32 = 65_500;

/// What the checker says.
#[derive(Clone, Debug, Default)]
pub(super) struct Checked {
    pub(super) lines: Vec<String>,
    pub(super) has_errors: bool,
    pub(super) compiled: Option<CompiledAction>,
}

/// A step: what starts together, and how long it lasts; a wait where nothing starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Taught {
    pub(super) pose: Pose,
    pub(super) duration_ms: u32,
}

/// What is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shown {
    Robot,
    Help,
    /// Whether it is to be left without having been saved.
    Leaving,
}

type Check<'a> = &'a dyn Fn(&str) -> Checked;

/// The screen.
pub(super) struct Teach<'a> {
    pub(super) name: String,
    pub(super) palette: Palette,
    pub(super) marks: BumperMask,
    pub(super) state: RobotState,
    pub(super) shown: Shown,
    pub(super) selected: usize,
    /// Where joints were sent, until they are there.
    pub(super) sent: Pose,
    pub(super) steps: Vec<Taught>,
    /// The step that is not marked yet.
    pub(super) open: Pose,
    /// When its first joint was sent; of one that has none, when the last step was marked.
    since_ms: Option<u64>,
    presses: Option<[u8; BumperMask::COUNT]>,
    pub(super) remark: String,
    pub(super) findings: Vec<String>,
    pub(super) is_playing: bool,
    is_saved: bool,
    check: Check<'a>,
}

impl<'a> Teach<'a> {
    /// Has its text checked by `check`.
    pub(super) fn new(
        name: &str,
        marks: BumperMask,
        check: Check<'a>,
        palette: Palette,
    ) -> Teach<'a> {
        Teach {
            name: name.to_owned(),
            palette,
            marks,
            state: RobotState::default(),
            shown: Shown::Robot,
            selected: 0,
            sent: Pose::EMPTY,
            steps: Vec::new(),
            open: Pose::EMPTY,
            since_ms: None,
            presses: None,
            remark: "left and right move the joint that is chosen; Enter marks the step".to_owned(),
            findings: Vec::new(),
            is_playing: false,
            is_saved: false,
            check,
        }
    }

    /// The action as it stands, and whether it is to be saved; none where nothing was taught.
    pub(super) fn taught(&self) -> Option<(String, bool)> {
        let has_any = !self.steps.is_empty() || !self.open.is_empty();
        has_any.then(|| (self.text(), self.is_saved))
    }

    /// The action as a text, what is not marked yet at its end.
    pub(super) fn text(&self) -> String {
        let mut text = format!("action {} {{\n", self.name);
        let open = Taught { pose: self.open, duration_ms: arrival_ms(self.open) };
        let open = (!self.open.is_empty()).then_some(open);
        for step in self.steps.iter().chain(&open) {
            let names: Vec<String> = step.pose.primitives().map(|it| it.to_string()).collect();
            let ms = step.duration_ms;
            // Writing to a string never fails.
            let _ = if names.is_empty() {
                writeln!(text, "    wait {ms}ms")
            } else {
                writeln!(text, "    do {} for {ms}ms", names.join(" + "))
            };
        }
        text + "}\n"
    }

    fn key(&mut self, key: KeyEvent) -> Vec<Effect> {
        if key.code == KeyCode::Char(' ') {
            self.forget_unmarked();
            return vec![Effect::Stop];
        }
        match (self.shown, key.code) {
            (Shown::Leaving, KeyCode::Char('y')) => return vec![Effect::Leave],
            (Shown::Leaving | Shown::Robot, KeyCode::Char('w')) => {
                self.shown = Shown::Robot;
                return self.save();
            }
            (Shown::Leaving | Shown::Help, _) => self.shown = Shown::Robot,
            (Shown::Robot, code) => return self.key_on_robot(code),
        }
        Vec::new()
    }

    fn key_on_robot(&mut self, code: KeyCode) -> Vec<Effect> {
        match code {
            KeyCode::Char('q') | KeyCode::Esc if self.taught().is_none() => {
                return vec![Effect::Leave];
            }
            KeyCode::Char('q') | KeyCode::Esc => self.shown = Shown::Leaving,
            KeyCode::Char('?' | 'h') => self.shown = Shown::Help,
            KeyCode::Up => self.selected = self.selected.saturating_sub(1),
            KeyCode::Down => self.selected = (self.selected + 1).min(Joint::COUNT - 1),
            KeyCode::Left => return self.nudge(false),
            KeyCode::Right => return self.nudge(true),
            KeyCode::Enter => self.mark(),
            KeyCode::Char('u') => self.undo(),
            KeyCode::Char('+') => self.change_last(|ms| (ms + ROUNDED_MS).min(LONGEST_MS)),
            KeyCode::Char('-') => {
                self.change_last(|ms| ms.saturating_sub(ROUNDED_MS).max(ROUNDED_MS));
            }
            KeyCode::Char('t') if !self.is_playing => return self.try_it(),
            KeyCode::Char('e') if self.is_playing => return vec![Effect::End],
            KeyCode::Char('i') => return vec![Effect::Init],
            _ => {}
        }
        Vec::new()
    }

    fn nudge(&mut self, is_next: bool) -> Vec<Effect> {
        let Some(joint) = Joint::ALL.get(self.selected).copied() else { return Vec::new() };
        if self.is_playing {
            "it is being played: e ends it".clone_into(&mut self.remark);
            return Vec::new();
        }
        let report = self.state.motion_report();
        let position = neighbour(report.as_ref(), self.sent, joint, is_next);
        if self.open.is_empty() {
            self.since_ms = Some(self.state.time_ms);
        }
        self.open = self.open.with(joint, Some(position));
        self.sent = self.sent.with(joint, Some(position));
        vec![Effect::Nudge(joint, position)]
    }

    fn mark(&mut self) {
        let now_ms = self.state.time_ms;
        let elapsed_ms = self.since_ms.map_or(0, |since_ms| now_ms.saturating_sub(since_ms));
        let elapsed_ms = u32::try_from(elapsed_ms).unwrap_or(LONGEST_MS).min(LONGEST_MS);
        let rounded_ms = (elapsed_ms + ROUNDED_MS / 2) / ROUNDED_MS * ROUNDED_MS;
        if self.open.is_empty() && (self.steps.is_empty() || rounded_ms == 0) {
            "nothing was moved since the last mark".clone_into(&mut self.remark);
            return;
        }
        let duration_ms = rounded_ms.max(arrival_ms(self.open));
        self.steps.push(Taught { pose: self.open, duration_ms });
        self.open = Pose::EMPTY;
        self.since_ms = Some(now_ms);
        self.findings.clear();
        self.remark = format!("step {} is marked: {duration_ms} ms", self.steps.len());
    }

    fn undo(&mut self) {
        if !self.open.is_empty() {
            self.forget_unmarked();
            "what was not marked is forgotten".clone_into(&mut self.remark);
        } else if self.steps.pop().is_some() {
            "the last step is forgotten; the robot stands as it did".clone_into(&mut self.remark);
        }
        self.findings.clear();
    }

    fn forget_unmarked(&mut self) {
        self.open = Pose::EMPTY;
        self.sent = Pose::EMPTY;
        self.since_ms = Some(self.state.time_ms);
    }

    fn change_last(&mut self, change: impl Fn(u32) -> u32) {
        if let Some(last) = self.steps.last_mut() {
            last.duration_ms = change(last.duration_ms);
            self.remark = format!("the last step lasts {} ms", last.duration_ms);
        }
    }

    fn try_it(&mut self) -> Vec<Effect> {
        let checked = (self.check)(&self.text());
        self.findings = checked.lines;
        match checked.compiled {
            Some(action) if self.taught().is_some() => {
                self.is_playing = true;
                "it is played from its beginning; e ends it".clone_into(&mut self.remark);
                vec![Effect::Play(Box::new(action))]
            }
            _ => {
                "there is nothing that could be played".clone_into(&mut self.remark);
                Vec::new()
            }
        }
    }

    fn save(&mut self) -> Vec<Effect> {
        if self.taught().is_none() {
            "there is nothing to be saved".clone_into(&mut self.remark);
            return Vec::new();
        }
        let checked = (self.check)(&self.text());
        self.findings = checked.lines;
        if checked.has_errors {
            "the checker refuses it: change it, or leave by q and mend its text"
                .clone_into(&mut self.remark);
            return Vec::new();
        }
        self.is_saved = true;
        vec![Effect::Leave]
    }

    fn take_state(&mut self, state: RobotState) {
        let report = state.motion_report();
        for joint in Joint::ALL {
            if report.is_some_and(|report| report.position(joint) == self.sent.get(joint)) {
                self.sent = self.sent.with(joint, None);
            }
        }
        self.state = state;
        let Some(report) = report else { return };
        let before = self.presses.replace(report.presses);
        let is_pressed = before.is_some_and(|before| {
            let counts = before.iter().zip(&report.presses).enumerate();
            counts.into_iter().any(|(index, (then, now))| then != now && self.marks.contains(index))
        });
        if is_pressed && self.shown == Shown::Robot && !self.is_playing {
            self.mark();
        }
    }
}

/// How long the joints of a pose take from wherever they are, in ms, to the next 50.
pub(super) fn arrival_ms(pose: Pose) -> u32 {
    let joints = pose.primitives().map(|primitive| u32::from(primitive.joint().full_travel_ms()));
    joints.max().unwrap_or(0).next_multiple_of(ROUNDED_MS)
}

impl Model for Teach<'_> {
    fn update(&mut self, event: Event) -> Vec<Effect> {
        match event {
            Event::Key(key) => return self.key(key),
            Event::State(state, _) => self.take_state(*state),
            Event::Told(Told::Ended { action, how }) => {
                if action == self.name {
                    self.is_playing = false;
                    self.forget_unmarked();
                }
                // Of what went as asked, the joints tell.
                if !how.starts_with("done") || action == self.name {
                    self.remark = format!("{action}: {how}");
                }
            }
            Event::Told(Told::Remark(text)) => self.remark = text,
            Event::Told(Told::Progress { .. }) => {}
        }
        Vec::new()
    }

    fn draw(&self, frame: &mut Frame<'_>) {
        draw::draw(self, frame);
    }
}

#[cfg(test)]
mod tests;
