//! Every interleaving of a small world: the real [`Session`], a user who wants a few steps done, a
//! line that loses, doubles and delays packages, a robot that is reset and a PC that is restarted.
//!
//! What is assumed of the world, and nothing else:
//!
//! * each direction of the line keeps the order of what it carries;
//! * an answer may be later than its deadline by any time; each time costs one fault;
//! * a PC that proposes its predecessor's session number again has taken longer to start than a
//!   package and its answer take; one that proposes another may start at any moment.
//!
//! What is shown of every state that can be reached with a bounded number of faults:
//!
//! * no step runs twice;
//! * a step reported accepted has run, exactly once;
//! * a step reported refused, or displaced before it was sent, has not run and never will;
//! * every request ends: where nothing is under way, nothing waits.

mod robot;

use super::*;
use crate::{Fed, Pose, Status, Step};
use robot::Robot;
use std::collections::{HashSet, VecDeque};
use std::hash::{BuildHasher, BuildHasherDefault, DefaultHasher, Hash};
use std::vec::Vec;

const ADDRESS: Address = Address::Motion;
/// A deadline that was set at 0 has passed; one set now has not. The model's time is otherwise 0.
const LATER_MS: u64 = 1000;

/// Bounds of one exploration.
#[derive(Clone, Copy)]
struct Bounds {
    /// Steps that the user wants done.
    steps: u16,
    /// Losses, doublings, late answers, resets and restarts, all together.
    faults: u8,
    /// How often the robot's queue fills or empties.
    queue_changes: u8,
    /// How often the user presses STOP.
    stops: u8,
    /// Whether the robot knows a duplicate when it sees one: the model finds out when it does not.
    robot_knows_duplicates: bool,
}

/// What the user was told of a step, by its ticket's owner.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
enum Told {
    Nothing,
    Accepted,
    NeverRuns,
    Unknown,
}

#[derive(Clone)]
struct World {
    session: Session,
    robot: Robot,
    to_robot: VecDeque<ActionPackage>,
    to_pc: VecDeque<SynchronizationPackage>,
    /// The step asked for last, whose ticket waits.
    waiting: Option<(Ticket, u16)>,
    steps_asked: u16,
    /// Bit `n`: step `n` has run.
    has_run: u16,
    told: [Told; 8],
    faults_left: u8,
    queue_changes_left: u8,
    stops_left: u8,
}

impl World {
    fn new(bounds: Bounds) -> World {
        let config = SessionConfig { first_session: 9, tries: 3, ..SessionConfig::default() };
        World {
            session: Session::new(config),
            robot: Robot { session: 0, last_sequence: 0, boot: 0, queue_is_full: false },
            to_robot: VecDeque::new(),
            to_pc: VecDeque::new(),
            waiting: None,
            steps_asked: 0,
            has_run: 0,
            told: [Told::Nothing; 8],
            faults_left: bounds.faults,
            queue_changes_left: bounds.queue_changes,
            stops_left: bounds.stops,
        }
    }

    /// All that decides what can happen from here. Two hashes make one of 128 bits: among the
    /// millions of states here a collision is out of the question.
    fn key(&self) -> u128 {
        let half = |salt: u8| {
            let session = &self.session;
            let key = (
                (salt, session.peers, session.outstanding, session.stop),
                (session.proposal, session.last_tag),
                (&self.robot, &self.to_robot, &self.to_pc, self.waiting),
                (self.steps_asked, self.has_run, self.told),
                (self.faults_left, self.queue_changes_left, self.stops_left),
            );
            BuildHasherDefault::<DefaultHasher>::default().hash_one(key)
        };
        u128::from(half(0)) << 64 | u128::from(half(1))
    }

    /// Takes what the session has to tell, and checks it.
    fn fetch_events(&mut self) -> Result<(), &'static str> {
        while let Some(event) = self.session.poll_event() {
            let (ticket, told) = match event {
                SessionEvent::Answered { ticket, package, .. } => match package.status {
                    Status::Accepted => (ticket, Told::Accepted),
                    _ => (ticket, Told::NeverRuns),
                },
                SessionEvent::Failed { ticket, failure, .. } => match failure {
                    Failure::OutcomeUnknown { .. } => (ticket, Told::Unknown),
                    Failure::Displaced { .. } | Failure::NoAnswer { .. } => {
                        (ticket, Told::NeverRuns)
                    }
                },
                SessionEvent::Restarted { .. } => continue,
                SessionEvent::Incomprehensible { .. } => return Err("an answer made no sense"),
            };
            let Some((waiting, step)) = self.waiting else { continue };
            if waiting != ticket {
                continue;
            }
            self.waiting = None;
            self.told[usize::from(step)] = told;
            match (told, self.has_run >> step & 1) {
                (Told::Accepted, 0) => return Err("told accepted, but it has not run"),
                (Told::NeverRuns, 1) => return Err("told that it never runs, but it has run"),
                _ => {}
            }
        }
        Ok(())
    }

    fn run(&mut self, step: u16) -> Result<(), &'static str> {
        if self.has_run >> step & 1 == 1 {
            return Err("a step ran twice");
        }
        if self.told[usize::from(step)] == Told::NeverRuns {
            return Err("a step ran of which it was told that it never does");
        }
        self.has_run |= 1 << step;
        Ok(())
    }

    /// Every world that can come next, with what made it so.
    fn successors(&self, bounds: Bounds) -> Result<Vec<(&'static str, World)>, &'static str> {
        let mut all = Vec::new();
        self.of_the_user(bounds, &mut all);
        self.of_the_line(bounds, &mut all)?;
        self.of_time(&mut all);
        self.of_faults(&mut all);
        for (_, world) in &mut all {
            world.fetch_events()?;
        }
        Ok(all)
    }

    fn of_the_user(&self, bounds: Bounds, all: &mut Vec<(&'static str, World)>) {
        if self.session.is_free() && self.steps_asked < bounds.steps {
            let mut next = self.clone();
            if self.session.open_session(ADDRESS).is_none() {
                next.session.open(ADDRESS).unwrap();
                all.push(("the user opens a session", next));
            } else {
                next.steps_asked += 1;
                let step = Step::new(Pose::MIDDLE, next.steps_asked);
                let ticket = next.session.request(ADDRESS, Request::Step(step)).unwrap();
                next.waiting = Some((ticket, next.steps_asked));
                all.push(("the user asks for a step", next));
            }
        }
        if self.stops_left > 0 {
            let mut next = self.clone();
            next.stops_left -= 1;
            next.session.stop(ADDRESS).unwrap();
            all.push(("the user presses stop", next));
        }
        let mut next = self.clone();
        if let Some(bytes) = next.session.poll_transmit(0) {
            let mut receiver = Receiver::for_robot(ADDRESS);
            let mut package = None;
            for byte in bytes {
                if let Fed::Package(content) = receiver.feed(byte, 0) {
                    package = ActionPackage::parse(content.action()).ok();
                }
            }
            next.to_robot.push_back(package.expect("the session sends what it can read"));
            all.push(("the PC sends", next));
        }
    }

    fn of_the_line(
        &self,
        bounds: Bounds,
        all: &mut Vec<(&'static str, World)>,
    ) -> Result<(), &'static str> {
        let mut next = self.clone();
        if let Some(package) = next.to_robot.pop_front() {
            let (answer, runs) = next.robot.take(&package, bounds);
            next.to_pc.push_back(answer);
            if let Some(step) = runs {
                next.run(step)?;
            }
            all.push(("the robot answers", next));
        }
        let mut next = self.clone();
        if let Some(answer) = next.to_pc.pop_front() {
            next.session.handle_bytes(&answer.encode(ADDRESS), 0);
            all.push(("the PC hears", next));
        }
        Ok(())
    }

    fn of_time(&self, all: &mut Vec<(&'static str, World)>) {
        let Some(Outstanding { phase: Phase::Awaiting { .. }, .. }) = self.session.outstanding
        else {
            return;
        };
        let is_late = !self.to_robot.is_empty() || !self.to_pc.is_empty();
        if is_late && self.faults_left == 0 {
            return;
        }
        let mut next = self.clone();
        next.faults_left -= u8::from(is_late);
        next.session.handle_timeout(LATER_MS);
        all.push(("the deadline passes", next));
    }

    fn of_faults(&self, all: &mut Vec<(&'static str, World)>) {
        if self.queue_changes_left > 0 {
            let mut next = self.clone();
            next.queue_changes_left -= 1;
            next.robot.queue_is_full ^= true;
            all.push(("the queue fills or empties", next));
        }
        if self.faults_left == 0 {
            return;
        }
        let mut spent = self.clone();
        spent.faults_left -= 1;
        // What is lost is lost as late as it can be: earlier makes no other world.
        if let Some(package) = self.to_robot.front() {
            let mut next = spent.clone();
            next.to_robot.pop_front();
            all.push(("a package is lost", next));
            let mut next = spent.clone();
            next.to_robot.push_front(*package);
            all.push(("a package is doubled", next));
        }
        if let Some(answer) = self.to_pc.front() {
            let mut next = spent.clone();
            next.to_pc.pop_front();
            all.push(("an answer is lost", next));
            let mut next = spent.clone();
            next.to_pc.push_front(*answer);
            all.push(("an answer is doubled", next));
        }
        let mut next = spent.clone();
        let boot = self.robot.boot.wrapping_add(1);
        next.robot = Robot { session: 0, last_sequence: 0, boot, queue_is_full: false };
        all.push(("the robot is reset", next));

        let mut firsts = std::vec![101 + self.faults_left];
        if self.to_robot.is_empty() && self.to_pc.is_empty() {
            firsts.push(9);
        }
        for first_session in firsts {
            let mut next = spent.clone();
            let config = SessionConfig { first_session, ..self.session.config };
            next.session = Session::new(config);
            next.waiting = None;
            all.push(("the PC is restarted", next));
        }
    }
}

/// Goes through every world within the bounds. Gives how many there are, or what went wrong and
/// how it came to it.
fn explore(bounds: Bounds) -> Result<usize, (&'static str, Vec<&'static str>)> {
    let start = World::new(bounds);
    let mut seen = HashSet::from([start.key()]);
    // Each world keeps the way to it as an index into the list of all steps taken.
    let mut ways: Vec<(usize, &'static str)> = std::vec![(0, "start")];
    let mut open = VecDeque::from([(start, 0)]);
    while let Some((world, way)) = open.pop_front() {
        let told = |what| (what, way_to(&ways, way));
        let successors = world.successors(bounds).map_err(told)?;
        let all_is_done = world.steps_asked == bounds.steps && world.session.is_free();
        if successors.is_empty() && !all_is_done {
            return Err(told("a request waits for ever"));
        }
        for (what, next) in successors {
            if seen.insert(next.key()) {
                ways.push((way, what));
                open.push_back((next, ways.len() - 1));
            }
        }
    }
    Ok(seen.len())
}

fn way_to(ways: &[(usize, &'static str)], mut way: usize) -> Vec<&'static str> {
    let mut told = Vec::new();
    while way != 0 {
        told.push(ways[way].1);
        way = ways[way].0;
    }
    told.reverse();
    told
}

const BOUNDS: Bounds =
    Bounds { steps: 3, faults: 4, queue_changes: 2, stops: 0, robot_knows_duplicates: true };

fn explore_and_tell(name: &str, bounds: Bounds) {
    match explore(bounds) {
        Ok(worlds) => std::println!("{name}: {worlds} worlds"),
        Err((what, way)) => panic!("{name}: {what}, after: {}", way.join(", ")),
    }
}

#[test]
fn no_step_runs_twice_and_no_outcome_is_a_lie() {
    explore_and_tell("three steps, four faults", BOUNDS);
}

#[test]
fn nor_when_the_user_presses_stop() {
    explore_and_tell(
        "two steps, two stops, three faults",
        Bounds { steps: 2, faults: 3, stops: 2, queue_changes: 1, ..BOUNDS },
    );
}

#[test]
fn the_model_finds_a_robot_that_does_not_know_duplicates() {
    let bounds = Bounds { robot_knows_duplicates: false, queue_changes: 0, ..BOUNDS };
    let Err((what, _)) = explore(bounds) else { panic!("nothing found") };
    assert_eq!(what, "a step ran twice");
}
