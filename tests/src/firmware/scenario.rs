//! Scenarios: what a person would write on paper, played on a bench.
//!
//! A scenario is a text file of `tests/scenarios`, one statement a line, `#` for remarks:
//!
//! ```text
//! controller motion | camera              whom it is for; the first statement
//! only lock-step: WHY                     cannot be played on the chip
//! session N                               under which `send` sends from now on (7 before)
//! send REQUEST [session N] [sequence N] [to motion | camera]
//!     HELLO [versions LOWEST HIGHEST] [proposing N]   STATE   STOP   COUNTERS   INIT   HOME
//!     STEP [JOINT:POSITION...] [pose WORD] for MS [replace] [until BUMPER...]
//!     CONFIGURE dead-man MS               CONFIGURE travel JOINT MS
//!     AIM pan CENTIDEG tilt CENTIDEG [speed DEG_PER_S]
//!     content HEX...                      twelve bytes, as they are
//!     vector NAME                         an action package of tests/vectors, as it is
//!     again                               the same bytes once more
//! bytes HEX...                            on the line; nobody looks at them yet
//! error framing | overrun
//! tick N                                  N ms pass; the line takes 6 bytes a ms
//! tick until MODE within N
//! press BUMPER    release BUMPER    switch left|right open|closed    supply low|good
//! body travel MS*7 at PERMILLE            a body drives the switches from now on
//! body switches works|stuck-open|stuck-closed
//! reset power-on|brown-out|watchdog    hang    anew BOOT
//! main    timer N    input-change    transmit N    line N      single interrupts, lock step only
//! repeat N ... end
//! expect WHAT VALUE                       of the model; both sides are compared all the time anyway
//! ```
//!
//! A package is numbered by itself, one after the last one executed, unless it says otherwise.

mod expect;
mod parse;

use super::bench::{Action, Bench, BenchError};
use super::body::{Body, SwitchBehaviour};
use super::event::Event;
use super::vectors;
use crate::{files, read, workspace};
use expect::Expectation;
use rsapien_firmware_model::Inputs;
use rsapien_protocol::{
    ACTION_PACKAGE_LENGTH, ActionPackage, Address, ByteClass, Direction, HeaderByte, LineError,
    Mode, Request, frame,
};

/// One scenario.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// The name of its file, without the ending.
    pub name: String,
    /// The controller it is for.
    pub address: Address,
    /// Why it cannot be played on the chip, if so.
    pub only_lockstep: Option<String>,
    statements: Vec<Statement>,
}

#[derive(Clone, Debug)]
struct Statement {
    line: usize,
    what: What,
}

#[derive(Clone, Debug)]
enum What {
    Session(u8),
    Send(Template),
    Bytes(Vec<u8>),
    Error(LineError),
    Tick(u32),
    TickUntil(Mode, u32),
    Bumper(usize, bool),
    Switch { left: bool, closed: bool },
    Supply(bool),
    Body(Box<Body>),
    Switches(SwitchBehaviour),
    Event(Event, u32),
    Line(u8),
    Expect(Expectation),
    Repeat(u32, Vec<Statement>),
}

#[derive(Clone, Debug)]
struct Template {
    what: Package,
    session: Option<u8>,
    sequence: Option<u8>,
    to: Option<Address>,
}

#[derive(Clone, Debug)]
enum Package {
    Request(Request),
    HelloHere { lowest_version: u8, highest_version: u8 },
    Content([u8; 12]),
    Line(Vec<u8>),
    Again,
}

impl Scenario {
    /// The scenario of a text.
    ///
    /// # Errors
    /// What is wrong, and in which line.
    pub fn parse(name: &str, text: &str) -> Result<Scenario, String> {
        parse::scenario(name, text).map_err(|error| format!("{name}: {error}"))
    }

    /// Every scenario of a folder of the checkout, in the order of their names.
    ///
    /// # Panics
    /// When one cannot be read.
    pub fn all_of(folder: &str) -> Vec<Scenario> {
        let folder = workspace().join(folder);
        let paths = if folder.exists() { files(&folder, &[".scenario"]) } else { Vec::new() };
        paths
            .iter()
            .map(|path| {
                let name = path.file_stem().unwrap_or_default().to_string_lossy();
                Scenario::parse(&name, &read(path)).unwrap_or_else(|error| panic!("{error}"))
            })
            .collect()
    }

    /// Plays it.
    ///
    /// # Errors
    /// When the two sides of the bench differ, or the model does not do what the scenario expects.
    pub fn play(&self, bench: &mut dyn Bench) -> Result<(), BenchError> {
        let mut player = Player { bench, address: self.address, session: 7, last: Vec::new() };
        player.play_all(&self.statements).map_err(|(line, error)| {
            BenchError(format!("{}.scenario, line {line}: {error}", self.name))
        })
    }
}

struct Player<'bench> {
    bench: &'bench mut dyn Bench,
    address: Address,
    session: u8,
    last: Vec<u8>,
}

type Played = Result<(), (usize, BenchError)>;

impl Player<'_> {
    fn play_all(&mut self, statements: &[Statement]) -> Played {
        for (index, statement) in statements.iter().enumerate() {
            let behind = statements.get(index + 1..).unwrap_or_default();
            if let What::Repeat(count, inner) = &statement.what {
                for _ in 0..*count {
                    self.play_all(inner)?;
                }
            } else {
                self.play(&statement.what, behind).map_err(|error| (statement.line, error))?;
            }
        }
        Ok(())
    }

    fn play(&mut self, what: &What, behind: &[Statement]) -> Result<(), BenchError> {
        match what {
            What::Session(session) => self.session = *session,
            What::Send(template) => {
                self.last = self.line_bytes(template);
                self.bench.perform(Action::Line(self.last.clone()))?;
                return self.bench.perform(Action::Event(Event::MainRoutine(Inputs::default())));
            }
            What::Bytes(bytes) => return self.bench.perform(Action::Line(bytes.clone())),
            What::Error(error) => return self.bench.perform(Action::LineError(*error)),
            What::Tick(count) => {
                let then = self.line_after(behind);
                return self.bench.ticks(*count, then.as_deref());
            }
            What::TickUntil(mode, within) => return self.tick_until(*mode, *within),
            What::Bumper(index, pressed) => {
                let bit = 1 << index;
                let bits = self.bench.world().inputs.bumpers.bits();
                let bits = if *pressed { bits | bit } else { bits & !bit };
                let bumpers = rsapien_protocol::BumperMask::from_low_bits(bits);
                return self.bench.perform(Action::Bumpers(bumpers));
            }
            What::Switch { left, closed } => {
                let mut switches = self.bench.world().inputs.middle_switches;
                *(if *left { &mut switches.left } else { &mut switches.right }) = *closed;
                return self.bench.perform(Action::Switches(switches));
            }
            What::Supply(low) => return self.bench.perform(Action::Supply(*low)),
            What::Body(body) => return self.bench.perform(Action::Body(body.clone())),
            What::Switches(behaviour) => {
                return self.bench.perform(Action::SwitchBehaviour(*behaviour));
            }
            What::Event(event, count) => {
                for _ in 0..*count {
                    self.bench.perform(Action::Event(*event))?;
                }
            }
            What::Line(bytes_a_tick) => self.bench.line_takes(*bytes_a_tick),
            What::Expect(expectation) => return expectation.check(self.bench.world()),
            What::Repeat(..) => {}
        }
        Ok(())
    }

    fn tick_until(&mut self, mode: Mode, within: u32) -> Result<(), BenchError> {
        for _ in 0..within {
            if self.bench.world().reference.mode() == mode {
                return Ok(());
            }
            self.bench.ticks(1, None)?;
        }
        let found = self.bench.world().reference.mode();
        if found == mode {
            return Ok(());
        }
        Err(BenchError(format!("still {} after {within} ms, not {}", found.name(), mode.name())))
    }

    /// What the line brings before time passes again, for a bench on which bytes take time. Of bytes that
    /// have not the form of one package only the rest of one, since others may be counted before their end.
    fn line_after(&mut self, behind: &[Statement]) -> Option<Vec<u8>> {
        let session = self.session;
        let found = behind.iter().find_map(|statement| match &statement.what {
            What::Session(session) => {
                self.session = *session;
                None
            }
            What::Bumper(..) | What::Expect(_) => None,
            What::Send(template) => Some(Some(self.line_bytes(template))),
            What::Bytes(bytes) if is_rest(bytes) || is_package(bytes) => Some(Some(bytes.clone())),
            _ => Some(None),
        });
        self.session = session;
        found.flatten()
    }

    fn line_bytes(&mut self, template: &Template) -> Vec<u8> {
        let address = template.to.unwrap_or(self.address);
        let reference = &self.bench.world().reference;
        let session = template.session.unwrap_or(self.session);
        let sequence =
            template.sequence.unwrap_or_else(|| reference.last_sequence().wrapping_add(1));
        let request = match &template.what {
            Package::Again => return self.last.clone(),
            Package::Line(bytes) => return bytes.clone(),
            Package::Content(content) => {
                let header = HeaderByte { direction: Direction::ToRobot, address };
                return frame::encode::<12, 18>(header, content).to_vec();
            }
            Package::HelloHere { lowest_version, highest_version } => Request::Hello {
                lowest_version: *lowest_version,
                highest_version: *highest_version,
                session: self.session,
            },
            Package::Request(request) => *request,
        };
        ActionPackage { session, sequence, request }.encode(address).to_vec()
    }
}

/// Whether bytes are the rest of a package that has begun: no header is among them.
pub fn is_rest(bytes: &[u8]) -> bool {
    bytes.iter().all(|byte| ByteClass::of(*byte) != ByteClass::Header)
}

/// Whether bytes have the form of one package, intact or not: nothing comes of them before their end.
fn is_package(bytes: &[u8]) -> bool {
    bytes.len() == ACTION_PACKAGE_LENGTH && !is_rest(bytes) && is_rest(&bytes[1..])
}

/// The line bytes of an action package of `tests/vectors`.
fn vector(name: &str) -> Result<Vec<u8>, String> {
    let packages = vectors::packages("action_packages");
    let package = packages.into_iter().find(|package| package.name == name);
    package.map(|package| package.line).ok_or_else(|| format!("no action package {name:?}"))
}
