//! Random sessions that go deep: a PC that mostly does what it should, a body that makes arms find
//! their middles, and everything that can go wrong on a line, at the pins and with the supply.
//!
//! [`Generator`] says what happens next, looking at the reference model as a program looks at answers.
//! [`session`] plays it in lock step, where it also chooses how bytes, interrupts and passes of the main
//! routine come to lie between each other.

mod packages;

use super::bench::{Action, Bench, LockstepBench, World};
use super::body::{Body, SwitchBehaviour};
use super::compare::{Divergence, Failure, compare};
use super::coverage::Coverage;
use super::event::Event;
use super::program::{Program, ProgramError};
use packages::Packages;
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rsapien_firmware_model::{MiddleSwitches, ResetCause};
use rsapien_protocol::{Address, BumperMask, Joint, LineError};
use std::path::Path;

/// What happens next.
#[derive(Clone, Debug)]
pub enum Move {
    /// Something that happens at once.
    Act(Action),
    /// Time passes, in ms.
    Ticks(u32),
    /// The line brings bytes while the main routine does not get to look at them. Lock step only.
    Burst(Vec<u8>),
    /// Single interrupts and passes of the main routine. Lock step only.
    Events(Event, u32),
}

/// Makes up one session.
#[derive(Debug)]
pub struct Generator {
    random: Pcg64,
    address: Address,
    packages: Packages,
    /// What the session does so far, to be handed out before anything new.
    planned: Vec<Move>,
    /// The chance of mischief with every package, in percent.
    mischief_percent: u32,
    /// The chance that a bumper moves, in percent.
    bumpers_percent: u32,
    /// Whether lock-step moves may be made.
    single_interrupts: bool,
}

/// The generator of random numbers of a session.
pub fn random_of(seed: u64, address: Address, index: u64) -> Pcg64 {
    let stream = index << 2 | address as u64;
    Pcg64::seed_from_u64(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ stream)
}

impl Generator {
    /// A session of its own for every seed, controller and index.
    pub fn new(seed: u64, address: Address, index: u64, single_interrupts: bool) -> Generator {
        let mut random = random_of(seed, address, index);
        let travel_ms: [u16; Joint::COUNT] = std::array::from_fn(|_| random.random_range(100..190));
        let mut planned = vec![Move::Act(Action::Body(Box::new(Body::new(
            travel_ms,
            random.random_range(0..=1000),
        ))))];
        if random.random_ratio(1, 8) {
            let behaviour = if random.random() {
                SwitchBehaviour::StuckOpen
            } else {
                SwitchBehaviour::StuckClosed
            };
            planned.push(Move::Act(Action::SwitchBehaviour(behaviour)));
        }
        planned.reverse();
        let mischief_percent = [0, 2, 6, 25][random.random_range(0..4)];
        let bumpers_percent = [1, 5, 30][random.random_range(0..3)];
        let packages = Packages::new(&mut random, address, travel_ms);
        Generator {
            random,
            address,
            packages,
            planned,
            mischief_percent,
            bumpers_percent,
            single_interrupts,
        }
    }

    /// What happens next to a controller that is as `world` shows it.
    pub fn next(&mut self, world: &World) -> Move {
        if let Some(planned) = self.planned.pop() {
            return planned;
        }
        if self.random.random_ratio(self.mischief_percent, 100) {
            self.mischief(world);
        } else {
            let package = self.packages.right(&mut self.random, &world.reference);
            self.plan_line(package);
        }
        if self.random.random_ratio(self.bumpers_percent, 100) {
            self.bounce(world);
        }
        self.planned.pop().unwrap_or(Move::Ticks(1))
    }

    /// A package, and a while behind it.
    fn plan_line(&mut self, bytes: Vec<u8>) {
        let wait = self.wait_ms();
        if wait > 0 {
            self.planned.push(Move::Ticks(wait));
        }
        self.planned.push(Move::Act(Action::Line(bytes)));
    }

    fn wait_ms(&mut self) -> u32 {
        match self.random.random_range(0..100) {
            0..20 => 0,
            20..50 => self.random.random_range(1..5),
            50..85 => self.random.random_range(5..20),
            85..99 => self.random.random_range(20..100),
            _ => self.random.random_range(100..600),
        }
    }

    fn mischief(&mut self, world: &World) {
        let right = self.packages.right(&mut self.random, &world.reference);
        let random = &mut self.random;
        match random.random_range(0..if self.single_interrupts { 22 } else { 15 }) {
            0..3 => {
                let wrong = self.packages.wrong(random, &world.reference);
                self.plan_line(wrong);
            }
            3 => {
                let again = self.packages.again();
                self.plan_line(again);
            }
            4..6 => {
                let damaged = packages::damaged(random, right);
                self.plan_line(damaged);
            }
            6 => {
                let garbage = packages::garbage(random);
                self.plan_line(garbage);
            }
            7 => {
                // The first part, a silence about as long as is allowed, the rest.
                let (first, rest) = right.split_at(random.random_range(1..right.len()));
                let gap = random.random_range(17..24);
                self.planned.push(Move::Act(Action::Line(rest.to_vec())));
                self.planned.push(Move::Ticks(gap));
                self.planned.push(Move::Act(Action::Line(first.to_vec())));
            }
            8..10 => {
                let (first, rest) = right.split_at(random.random_range(0..right.len()));
                let framing = !self.single_interrupts || random.random();
                let error = if framing { LineError::Framing } else { LineError::Overrun };
                self.planned.push(Move::Act(Action::Line(rest.to_vec())));
                self.planned.push(Move::Act(Action::LineError(error)));
                self.planned.push(Move::Act(Action::Line(first.to_vec())));
            }
            10 => self.planned.push(Move::Ticks(random.random_range(400..800))),
            11 => self.planned.push(Move::Act(Action::Supply(random.random()))),
            12 if self.address == Address::Motion => {
                let [left, right] = random.random();
                let wait = random.random_range(1..30);
                if let Some(body) = &world.body {
                    self.planned.push(Move::Act(Action::Body(body.clone())));
                }
                self.planned.push(Move::Ticks(wait));
                let switches = MiddleSwitches { left, right };
                self.planned.push(Move::Act(Action::Switches(switches)));
            }
            12..15 => {
                // Several packages with nothing between them.
                for _ in 0..random.random_range(2..5) {
                    let package = self.packages.right(random, &world.reference);
                    self.planned.push(Move::Act(Action::Line(package)));
                }
            }
            _ => self.lockstep_mischief(right),
        }
    }

    fn lockstep_mischief(&mut self, right: Vec<u8>) {
        let random = &mut self.random;
        let inputs = rsapien_firmware_model::Inputs::default();
        match random.random_range(0..40) {
            0..10 => {
                let mut bytes = packages::garbage(random);
                bytes.extend(right);
                bytes.extend(packages::garbage(random));
                self.planned.push(Move::Burst(bytes));
            }
            10..16 => self.planned.push(Move::Events(Event::Timer, random.random_range(1..12))),
            16 => self.planned.push(Move::Events(Event::Timer, random.random_range(110..150))),
            17..23 => self.planned.push(Move::Events(Event::InputChange(inputs), 1)),
            23..28 => {
                self.planned
                    .push(Move::Events(Event::MainRoutine(inputs), random.random_range(1..5)));
            }
            28..34 => {
                let count = random.random_range(0..=40);
                self.planned.push(Move::Events(Event::Transmit(count), 1));
            }
            34..36 => {
                let wait = random.random_range(1..160);
                self.planned.push(Move::Ticks(wait));
                self.planned.push(Move::Act(Action::Line(right)));
                self.planned.push(Move::Events(Event::Hang, 1));
            }
            36..39 => {
                let causes = [ResetCause::PowerOn, ResetCause::BrownOut, ResetCause::Watchdog];
                let cause = causes[random.random_range(0..3)];
                self.planned.push(Move::Events(Event::Reset(cause), 1));
            }
            _ => self.planned.push(Move::Events(Event::Anew(random.random()), 1)),
        }
    }

    /// A bumper is pressed or let go, and bounces.
    fn bounce(&mut self, world: &World) {
        let random = &mut self.random;
        let bit = 1u8 << random.random_range(0..BumperMask::COUNT);
        let before = world.inputs.bumpers.bits();
        let mut bits = if random.random_ratio(1, 10) { random.random() } else { before ^ bit };
        for _ in 0..random.random_range(0..4) {
            let mask = BumperMask::from_low_bits(bits);
            self.planned.push(Move::Act(Action::Bumpers(mask)));
            self.planned.push(Move::Ticks(random.random_range(1..7)));
            bits ^= bit;
        }
        self.planned.push(Move::Act(Action::Bumpers(BumperMask::from_low_bits(bits))));
    }
}

/// Plays the session `index` of `seed` in lock step until it has `event_count` events.
pub fn session(seed: u64, address: Address, index: u64, event_count: usize) -> LockstepBench {
    let mut generator = Generator::new(seed, address, index, true);
    let mut random = random_of(!seed, address, index);
    let mut bench = LockstepBench::new(address, random.random());
    bench.line_takes([6, 6, 2, 12][random.random_range(0..4)]);
    while bench.events.len() < event_count {
        match generator.next(bench.world()) {
            Move::Act(Action::Line(bytes)) => bring(&mut bench, &mut random, &bytes),
            Move::Act(action) => {
                // A lock-step bench never differs: nothing is compared yet.
                let _ = bench.perform(action);
            }
            Move::Ticks(count) => {
                for _ in 0..count {
                    bench.tick();
                    if random.random_ratio(1, 400) {
                        // More passes than one in a tick.
                        let inputs = bench.world().inputs;
                        bench.happen(Event::MainRoutine(inputs));
                    }
                }
            }
            Move::Burst(bytes) => {
                for byte in bytes {
                    bench.happen(Event::Byte(byte));
                }
            }
            Move::Events(event, count) => {
                let event = event.with_inputs(bench.world().inputs);
                (0..count).for_each(|_| bench.happen(event));
            }
        }
    }
    bench
}

/// Compares random sessions of `event_count` events in all, model against the program at `path`.
///
/// # Errors
/// The first session that differs; or why nothing can be compared.
pub fn compare_sessions(
    path: &Path,
    address: Address,
    seed: u64,
    event_count: u64,
) -> Result<Coverage, Difference> {
    let mut coverage = Coverage::new(address);
    let mut program = Program::start(path, address)?;
    let mut index = 0;
    while coverage.event_count() < event_count {
        let bench = session(seed, address, index, EVENTS_A_SESSION);
        if let Some(divergence) = compare(&mut program, address, &bench.events, &bench.records) {
            return Err(Difference::Session(Box::new(Different {
                origin: format!("seed {seed}, {} session {index}", address.name()),
                address,
                events: bench.events,
                divergence,
            })));
        }
        coverage.add(bench.coverage());
        coverage.sessions += 1;
        index += 1;
    }
    Ok(coverage)
}

/// Events of a session.
pub const EVENTS_A_SESSION: usize = 10_000;

/// A session that differs.
#[derive(Clone, Debug)]
pub struct Different {
    /// Where it came from.
    pub origin: String,
    /// Whose it is.
    pub address: Address,
    /// Its events.
    pub events: Vec<Event>,
    /// Where it differs.
    pub divergence: Divergence,
}

impl Different {
    /// Makes the session as short as it gets, in programs at `path`.
    ///
    /// # Errors
    /// When the program does not start any more.
    pub fn shrink(self, path: &Path) -> Result<Failure, ProgramError> {
        Failure::shrink(path, self.address, self.origin, &self.events, self.divergence)
    }
}

/// Why a comparison of random sessions ended before its time.
#[derive(Debug, thiserror::Error)]
pub enum Difference {
    /// A session differs.
    #[error("{}: event {} differs", .0.origin, .0.divergence.event_number)]
    Session(Box<Different>),
    /// There is nothing to compare with.
    #[error(transparent)]
    Program(#[from] ProgramError),
}

/// The line brings bytes: at once or over some ticks, with or without passes of the main routine.
fn bring(bench: &mut LockstepBench, random: &mut impl Rng, bytes: &[u8]) {
    let (bytes_a_tick, passes) = match random.random_range(0..10) {
        0..4 => (usize::MAX, 1),
        4..6 => (usize::MAX, 0),
        6..9 => (random.random_range(2..=12), 0),
        _ => (usize::MAX, usize::MAX),
    };
    for (index, byte) in bytes.iter().enumerate() {
        if index > 0 && index % bytes_a_tick == 0 {
            bench.tick();
        }
        bench.happen(Event::Byte(*byte));
        if passes == usize::MAX || passes == 1 && index + 1 == bytes.len() {
            let inputs = bench.world().inputs;
            bench.happen(Event::MainRoutine(inputs));
        }
    }
}
