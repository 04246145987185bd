//! What `rsapien top` knows, and what its keys do.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use ratatui::Frame;
use ratatui::crossterm::event::{KeyCode, KeyEvent};
use rsapien_protocol::{Joint, Mode, Pose};

use super::draw;
use crate::cli::screen::parts::{Palette, neighbour};
use crate::cli::screen::{Effect, Event, Model, Told};
use crate::{Claim, Progress, RobotState};

/// How many remarks are kept.
const REMARKS_KEPT: usize = 50;

/// An action that can be played.
#[derive(Clone, Debug)]
pub(super) struct Named {
    pub(super) name: String,
    pub(super) description: String,
    pub(super) duration_ms: u64,
}

/// What the keys mean.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Shown {
    /// Robot and keys.
    Robot,
    /// The list of actions, as far as they fit to the letters typed.
    Actions { letters: String, selected: usize },
    /// The help.
    Help,
}

/// The screen.
pub(super) struct Top {
    pub(super) link: String,
    pub(super) actions: Vec<Named>,
    pub(super) trips_us: Arc<Mutex<Vec<u64>>>,
    pub(super) palette: Palette,
    pub(super) shown: Shown,
    pub(super) state: RobotState,
    pub(super) claims: Vec<Claim>,
    /// The action that is played from here, and how far it is.
    pub(super) playing: Option<(String, Progress)>,
    pub(super) is_paused: bool,
    pub(super) selected: usize,
    /// Where joints were sent by keys.
    pub(super) sent: Pose,
    pub(super) remarks: VecDeque<String>,
}

impl Top {
    pub(super) fn new(
        link: &str,
        actions: Vec<Named>,
        trips_us: Arc<Mutex<Vec<u64>>>,
        palette: Palette,
    ) -> Top {
        Top {
            link: link.to_owned(),
            actions,
            trips_us,
            palette,
            shown: Shown::Robot,
            state: RobotState::default(),
            claims: Vec::new(),
            playing: None,
            is_paused: false,
            selected: 0,
            sent: Pose::EMPTY,
            remarks: VecDeque::new(),
        }
    }

    pub(super) fn remark(&mut self, text: impl Into<String>) {
        if self.remarks.len() >= REMARKS_KEPT {
            self.remarks.pop_front();
        }
        self.remarks.push_back(text.into());
    }

    /// The actions whose names have all the letters typed, or whose descriptions do.
    pub(super) fn found(&self, letters: &str) -> Vec<&Named> {
        let fits = |named: &&Named| {
            named.name.contains(letters)
                || named.description.to_lowercase().contains(&letters.to_lowercase())
        };
        let mut found: Vec<&Named> = self.actions.iter().filter(fits).collect();
        found.sort_by_key(|named| !named.name.starts_with(letters));
        found
    }

    pub(super) fn trips_us(&self) -> Vec<u64> {
        self.trips_us.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn key(&mut self, key: KeyEvent) -> Vec<Effect> {
        if key.code == KeyCode::Char(' ') {
            self.is_paused = false;
            return vec![Effect::Stop];
        }
        match self.shown.clone() {
            Shown::Robot => self.key_on_robot(key.code),
            Shown::Help => {
                self.shown = Shown::Robot;
                Vec::new()
            }
            Shown::Actions { letters, selected } => {
                self.key_on_actions(key.code, letters, selected)
            }
        }
    }

    fn key_on_robot(&mut self, code: KeyCode) -> Vec<Effect> {
        match code {
            KeyCode::Char('q') => return vec![Effect::Leave],
            KeyCode::Char('?' | 'h') => self.shown = Shown::Help,
            KeyCode::Char('p') | KeyCode::Enter => {
                self.shown = Shown::Actions { letters: String::new(), selected: 0 };
            }
            KeyCode::Char('r') if self.playing.is_some() => {
                self.is_paused = !self.is_paused;
                return vec![Effect::Pause(self.is_paused)];
            }
            KeyCode::Char('e') | KeyCode::Esc if self.playing.is_some() => {
                self.is_paused = false;
                return vec![Effect::End];
            }
            KeyCode::Char('i') => {
                self.remark("the robot is initialised");
                return vec![Effect::Init];
            }
            KeyCode::Up => self.selected = self.selected.saturating_sub(1),
            KeyCode::Down => self.selected = (self.selected + 1).min(Joint::COUNT - 1),
            KeyCode::Left => return self.nudge(false),
            KeyCode::Right => return self.nudge(true),
            _ => {}
        }
        Vec::new()
    }

    fn nudge(&mut self, is_next: bool) -> Vec<Effect> {
        let Some(joint) = Joint::ALL.get(self.selected).copied() else { return Vec::new() };
        let report = self.state.motion_report();
        let position = neighbour(report.as_ref(), self.sent, joint, is_next);
        self.sent = self.sent.with(joint, Some(position));
        vec![Effect::Nudge(joint, position)]
    }

    fn key_on_actions(
        &mut self,
        code: KeyCode,
        mut letters: String,
        selected: usize,
    ) -> Vec<Effect> {
        let count = self.found(&letters).len();
        let selected = match code {
            KeyCode::Esc => {
                self.shown = Shown::Robot;
                return Vec::new();
            }
            KeyCode::Enter => {
                let name = self.found(&letters).get(selected).map(|named| named.name.clone());
                self.shown = Shown::Robot;
                self.is_paused = false;
                return name.map(Effect::PlayNamed).into_iter().collect();
            }
            KeyCode::Up => selected.saturating_sub(1),
            KeyCode::Down => (selected + 1).min(count.saturating_sub(1)),
            KeyCode::Backspace => {
                letters.pop();
                0
            }
            KeyCode::Char(letter) => {
                letters.push(letter);
                0
            }
            _ => selected,
        };
        self.shown = Shown::Actions { letters, selected };
        Vec::new()
    }
}

impl Model for Top {
    fn update(&mut self, event: Event) -> Vec<Effect> {
        match event {
            Event::Key(key) => return self.key(key),
            Event::State(state, claims) => {
                let was = self.state.motion_report().map(|report| report.mode);
                let report = state.motion_report();
                let is = report.map(|report| report.mode);
                let now = is.filter(|_| was != is);
                if let Some(mode @ (Mode::Held | Mode::Stopped | Mode::Fresh)) = now {
                    self.sent = Pose::EMPTY;
                    self.remark(format!("the robot is {}", mode.name()));
                }
                // What has arrived is where it stands.
                for joint in Joint::ALL {
                    if report.is_some_and(|report| report.position(joint) == self.sent.get(joint)) {
                        self.sent = self.sent.with(joint, None);
                    }
                }
                self.state = *state;
                self.claims = claims;
            }
            Event::Told(Told::Progress { action, progress }) => {
                let is_nudge = progress.steps_total == 1 && self.playing.is_some();
                if !is_nudge {
                    self.playing = Some((action, progress));
                }
            }
            Event::Told(Told::Ended { action, how }) => {
                if self.playing.as_ref().is_some_and(|(playing, _)| *playing == action) {
                    self.playing = None;
                    self.is_paused = false;
                }
                self.remark(format!("{action}: {how}"));
            }
            Event::Told(Told::Remark(text)) => self.remark(text),
        }
        Vec::new()
    }

    fn draw(&self, frame: &mut Frame<'_>) {
        draw::draw(self, frame);
    }
}

#[cfg(test)]
mod tests;
