//! Screens on a terminal: a model that events change, drawn again and again, and what it wants done to the robot.
//!
//! A model knows no robot and no terminal, so tests press its keys and look at what it draws. Space is STOP on every
//! screen, whatever else it shows.

mod driver;
pub(crate) mod parts;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};

use ratatui::Frame;
use ratatui::crossterm::event::{self, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use rsapien_protocol::{Joint, Position};
use rsapien_registry::{CompileOptions, CompiledAction, Registry};

use self::driver::Driver;
use super::context::Context;
use super::diagnostics::{Failure, Result};
use super::robot::OpenRobot;
use super::signal;
use crate::{Claim, Progress, RobotState};

/// How often the screen is drawn where no key is pressed.
const FRAME: Duration = Duration::from_millis(50);

/// What happens.
#[derive(Clone, Debug)]
pub(crate) enum Event {
    /// A key was pressed.
    Key(KeyEvent),
    /// What is known of the robot now, and what is played on it and waits.
    State(Box<RobotState>, Vec<Claim>),
    /// The robot was told something, or did.
    Told(Told),
}

/// What becomes of what was asked.
#[derive(Clone, Debug)]
pub(crate) enum Told {
    /// An action goes on.
    Progress { action: String, progress: Progress },
    /// An action has ended, and how.
    Ended { action: String, how: String },
    /// Something worth a line.
    Remark(String),
}

/// What a model wants done.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Effect {
    /// STOP, before everything else.
    Stop,
    /// Play an action of the registry.
    PlayNamed(String),
    /// Play this.
    Play(Box<CompiledAction>),
    /// Send one joint somewhere.
    Nudge(Joint, Position),
    /// Pause what is played, or let it go on.
    Pause(bool),
    /// End what is played.
    End,
    /// Initialise the robot.
    Init,
    /// Leave the screen; motors off first.
    Leave,
}

/// A screen.
pub(crate) trait Model {
    /// Takes what happens, and tells what is to be done.
    fn update(&mut self, event: Event) -> Vec<Effect>;
    /// Draws it.
    fn draw(&self, frame: &mut Frame<'_>);
}

/// Whether a terminal is a screen now, and is to be restored.
static IS_OPEN: AtomicBool = AtomicBool::new(false);

/// Makes the terminal as it was, if it is a screen.
fn restore() {
    if IS_OPEN.swap(false, Ordering::SeqCst) {
        ratatui::restore();
    }
}

/// Restores the terminal, however the screen is left.
struct Restored;

impl Drop for Restored {
    fn drop(&mut self) {
        restore();
    }
}

/// Refuses what is no terminal.
pub(crate) fn check(context: &Context, command: &str, instead: &str) -> Result<()> {
    use std::io::IsTerminal;
    if context.style.output.is_terminal() && std::io::stdin().is_terminal() && !context.style.json {
        return Ok(());
    }
    Err(Failure::new(format!("{command} draws on a terminal, and this is none")).hint(instead))
}

/// Shows `model` until it is left. Other programs can play on the robot meanwhile.
pub(crate) fn run(open: &OpenRobot, registry: &Registry, model: &mut impl Model) -> Result<()> {
    let (tell, told) = channel();
    let driver = Driver::new(open, tell)?;
    let sensors = open.done(open.robot.sensors())?;
    let mut terminal = ratatui::try_init()?;
    IS_OPEN.store(true, Ordering::SeqCst);
    signal::before_exit(restore);
    let restored = Restored;
    let mut is_left = false;
    while !is_left && !open.interrupt.is_raised() {
        let mut events: Vec<Event> = told.try_iter().map(Event::Told).collect();
        let (playing, waiting) = driver.claims();
        let claims = playing.into_iter().chain(waiting).collect();
        events.push(Event::State(Box::new(sensors.state()), claims));
        for event in events {
            is_left |= perform(&driver, registry, model.update(event));
        }
        terminal.draw(|frame| model.draw(frame))?;
        let until = Instant::now() + FRAME;
        while event::poll(until.saturating_duration_since(Instant::now()))? {
            let event::Event::Key(key) = event::read()? else { break };
            if key.kind == KeyEventKind::Release {
                continue;
            }
            // It is no signal here: the terminal gives every key.
            if key.code == KeyCode::Char('c') && key.modifiers.contains(KeyModifiers::CONTROL) {
                driver.stop_now()?;
                return Err(Failure::interrupted());
            }
            is_left |= perform(&driver, registry, model.update(Event::Key(key)));
        }
    }
    if sensors.state().is_moving() {
        driver.stop_now()?;
    }
    drop(restored);
    open.interrupt.check()
}

/// Does what a model wants; whether it wants to leave.
fn perform(driver: &Driver, registry: &Registry, effects: Vec<Effect>) -> bool {
    let mut is_left = false;
    for effect in effects {
        match effect {
            Effect::Stop => driver.stop(),
            Effect::PlayNamed(name) => match registry.compile(&name, &CompileOptions::default()) {
                Ok(action) => driver.play(action),
                Err(error) => driver.remark(error.to_string()),
            },
            Effect::Play(action) => driver.play(*action),
            Effect::Nudge(joint, position) => driver.nudge(joint, position),
            Effect::Pause(is_paused) => driver.pause(is_paused),
            Effect::End => driver.end(),
            Effect::Init => driver.init(),
            Effect::Leave => is_left = true,
        }
    }
    is_left
}
