//! From a byte or a tick to the motors' pins.

use super::Measured;
use super::rig::{PATIENCE_CYCLES, Rig};
use crate::firmware::gpsim::{GpsimError, Happening, Image};
use crate::firmware::hex::motor_of;
use rsapien_protocol::{
    ActionPackage, Address, BumperMask, Joint, Parameter, Pose, Position, Request, Step,
};

/// What the motors do, measured of one image.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motors {
    /// From the last byte of a STEP to the last of its seven motors on, alone on the line.
    pub(super) step_on: Measured,
    /// The same in a crowd.
    pub(super) step_on_in_a_crowd: Measured,
    /// From the last byte of a STEP that turns seven motors to the last of them off.
    pub(super) step_turns: Measured,
    /// From the tick in which a step starts to the last of its seven motors on.
    pub(super) start_on: Measured,
    /// From the last byte of STOP to the last of seven motors off, alone on the line.
    pub(super) stop_off: Measured,
    /// The same in a crowd.
    pub(super) stop_off_in_a_crowd: Measured,
    /// From the last byte of the last package to the last of seven motors off.
    pub(super) silence_off: Measured,
    /// Between the two senses of a motor, both outputs off.
    pub(super) dead: Measured,
}

/// Samples over the phase of a tick, but for those that take half a second each.
const PHASES: u64 = 200;
const SILENCE_PHASES: u64 = 8;
/// The turn of a motor is tried at phases so many cycles apart, about the tick.
const TURNS: u64 = 300;

pub(super) fn measure(image: &Image) -> Result<Motors, GpsimError> {
    let mut rig = Rig::ready(image)?;
    Ok(Motors {
        step_on: step_on(&mut rig, Line::Alone)?,
        step_on_in_a_crowd: step_on(&mut rig, Line::Crowd)?,
        step_turns: step_turns(&mut rig)?,
        start_on: start_on(&mut rig)?,
        stop_off: stop_off(&mut rig, Line::Alone)?,
        stop_off_in_a_crowd: stop_off(&mut rig, Line::Crowd)?,
        dead: dead(&mut rig)?,
        silence_off: silence_off(&mut rig)?,
    })
}

/// What else is on the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Line {
    /// Nothing: the PC waits for every answer, as the rules of the link have it.
    Alone,
    /// Another package right before, whose answer goes out now, and other bytes right behind.
    Crowd,
}

/// A step that sends every joint to `position`, at once.
fn all_to(position: Position) -> Request {
    let pose =
        Joint::ALL.into_iter().fold(Pose::EMPTY, |pose, joint| pose.with(joint, Some(position)));
    Request::Step(Step {
        pose,
        duration_ms: u16::MAX,
        replace: true,
        ending_bumpers: BumperMask::NONE,
    })
}

fn end_position(sample: u64) -> Position {
    if sample.is_multiple_of(2) { Position::First } else { Position::Last }
}

impl Rig {
    /// Lets the robot rest: no motor on, none just gone off.
    fn rest(&mut self) -> Result<(), GpsimError> {
        self.ask(Request::Stop)?;
        self.run_ms(3)
    }

    /// Sends a package so that its last byte comes at `phase` of `phases` of a tick. Gives the cycle of
    /// the last byte, and what happened from there on for some ms.
    fn send_at(
        &mut self,
        request: Request,
        line: Line,
        (phase, phases): (u64, u64),
        reach_back: u64,
    ) -> Result<(u64, Vec<(u64, Happening)>), GpsimError> {
        let tick = self.tick_edge()?;
        let (mut bytes, mut behind) = (Vec::new(), Vec::new());
        if line == Line::Crowd {
            bytes = self.package(Request::State);
            let other = ActionPackage { session: 1, sequence: 0, request: Request::State };
            behind.extend(other.encode(Address::Camera));
        }
        bytes.extend(self.package(request));
        let (last_byte, before) = (bytes.len() - 1, self.line_cycles(bytes.len()));
        bytes.extend(&behind);
        let ms = self.cycles_a_ms();
        let end = tick + (before / ms + 2) * ms + reach_back_phase(ms, phase, phases, reach_back);
        self.chip.send(&bytes, end - before)?;
        self.run_to(end + self.line_cycles(behind.len()) + 2 * ms + PATIENCE_CYCLES)?;
        let log = self.take();
        let mut heard = log.iter().filter(|(_, happening)| *happening == Happening::Heard);
        let last = heard.nth(last_byte).map(|(at, _)| *at);
        let last = last.ok_or_else(|| GpsimError::Broken("a package was not heard".to_owned()))?;
        Ok((last, log.into_iter().filter(|(at, _)| *at >= last).collect()))
    }
}

/// Where in a tick a sample lies: over all of it, or in the last `reach_back` cycles of one.
fn reach_back_phase(ms: u64, phase: u64, phases: u64, reach_back: u64) -> u64 {
    if reach_back == 0 {
        ms * phase / phases
    } else {
        ms - reach_back.min(ms) * (phases - phase) / phases
    }
}

/// The cycles of the motors' edges to `level`: sense, joint and cycle.
fn edges(log: &[(u64, Happening)], level: bool) -> Vec<((usize, usize), u64)> {
    let edge = |(at, happening): &(u64, Happening)| match happening {
        Happening::Edge(pin, to) if *to == level => Some((motor_of(pin)?, *at)),
        _ => None,
    };
    log.iter().filter_map(edge).collect()
}

/// From `begin` to the last of seven edges.
fn last_of_seven(log: &[(u64, Happening)], level: bool, begin: u64) -> Result<u64, GpsimError> {
    let edges = edges(log, level);
    let last = edges.iter().map(|(_, at)| *at).max();
    match last {
        Some(last) if edges.len() == Joint::COUNT => Ok(last - begin),
        _ => Err(GpsimError::Broken(format!("{} motors changed, not seven", edges.len()))),
    }
}

fn step_on(rig: &mut Rig, line: Line) -> Result<Measured, GpsimError> {
    let mut measured = Measured::default();
    for phase in 0..PHASES {
        rig.rest()?;
        let (begin, log) = rig.send_at(all_to(end_position(phase)), line, (phase, PHASES), 0)?;
        measured.add(last_of_seven(&log, true, begin)?);
    }
    Ok(measured)
}

fn step_turns(rig: &mut Rig) -> Result<Measured, GpsimError> {
    rig.rest()?;
    rig.ask(all_to(Position::Last))?;
    let mut measured = Measured::default();
    for phase in 0..PHASES {
        let (begin, log) =
            rig.send_at(all_to(end_position(phase)), Line::Alone, (phase, PHASES), 0)?;
        measured.add(last_of_seven(&log, false, begin)?);
    }
    Ok(measured)
}

fn dead(rig: &mut Rig) -> Result<Measured, GpsimError> {
    rig.rest()?;
    rig.ask(all_to(Position::Last))?;
    let mut measured = Measured::default();
    // The last bytes come so long before a tick that the motors go off about it.
    let reach_back = rig.cycles_a_ms().min(8_000);
    for phase in 0..TURNS {
        let request = all_to(end_position(phase));
        let (_, log) = rig.send_at(request, Line::Alone, (phase, TURNS), reach_back)?;
        let on = edges(&log, true);
        for ((sense, joint), off_at) in edges(&log, false) {
            let turned = on.iter().find(|(motor, _)| *motor == (1 - sense, joint));
            let on_at = turned.map(|(_, at)| *at).filter(|at| *at >= off_at);
            let on_at =
                on_at.ok_or_else(|| GpsimError::Broken("a motor did not turn".to_owned()))?;
            measured.add(on_at - off_at);
        }
    }
    Ok(measured)
}

/// A step that waits behind a pause starts in a tick; bytes come and go all the while.
fn start_on(rig: &mut Rig) -> Result<Measured, GpsimError> {
    const PAUSE_MS: u16 = 100;
    let mut measured = Measured::default();
    // The earliest that the test point turns in its ms: where the timer matches, and what no interrupt
    // can be quicker than.
    let (ms, mut grid) = (rig.cycles_a_ms(), u64::MAX);
    for _ in 0..50 {
        grid = grid.min(rig.tick_edge()? % ms);
    }
    for sample in 0..PHASES / 4 {
        rig.rest()?;
        let mut pause = Step::new(Pose::EMPTY, PAUSE_MS);
        pause.replace = true;
        rig.ask(Request::Step(pause))?;
        let Request::Step(mut step) = all_to(end_position(sample)) else { continue };
        step.replace = false;
        let mut bytes = rig.package(Request::Step(step));
        let until = rig.cycle + u64::from(PAUSE_MS) * ms;
        while rig.cycle + rig.line_cycles(bytes.len()) < until {
            bytes.extend(rig.package(Request::State));
        }
        rig.take();
        rig.chip.send(&bytes, rig.cycle + sample * ms / (PHASES / 4))?;
        rig.run_to(until + 20 * ms)?;
        let log = rig.take();
        let first = edges(&log, true).first().map(|(_, at)| *at);
        let first =
            first.ok_or_else(|| GpsimError::Broken("the step does not start".to_owned()))?;
        // The tick before the first motor.
        let tick = (first - grid) / ms * ms + grid;
        measured.add(last_of_seven(&log, true, tick)?);
    }
    Ok(measured)
}

fn stop_off(rig: &mut Rig, line: Line) -> Result<Measured, GpsimError> {
    let mut measured = Measured::default();
    for phase in 0..PHASES {
        rig.rest()?;
        rig.ask(all_to(end_position(phase)))?;
        let (begin, log) = rig.send_at(Request::Stop, line, (phase, PHASES), 0)?;
        measured.add(last_of_seven(&log, false, begin)?);
    }
    Ok(measured)
}

fn silence_off(rig: &mut Rig) -> Result<Measured, GpsimError> {
    let timeout_ms = Parameter::DEAD_MAN_MS_DEFAULT;
    rig.ask(Request::Configure(Parameter::DeadMan { timeout_ms }))?;
    let mut measured = Measured::default();
    for phase in 0..SILENCE_PHASES {
        rig.configure_travel(100)?;
        rig.ask(Request::Init)?;
        for _ in 0..4 {
            rig.run_ms(100)?;
            rig.ask(Request::State)?;
        }
        rig.configure_travel(10_000)?;
        rig.ask(all_to(end_position(phase)))?;
        let tick = rig.tick_edge()?;
        let state = rig.package(Request::State);
        let ms = rig.cycles_a_ms();
        let end = tick + 20 * ms + ms * phase / SILENCE_PHASES;
        rig.send_until(&state, end)?;
        rig.run_to(end + (u64::from(timeout_ms) + 5) * ms)?;
        let log = rig.take();
        let heard = log.iter().rev().find(|(_, happening)| *happening == Happening::Heard);
        let begin = heard.map_or(0, |(at, _)| *at);
        measured.add(last_of_seven(&log, false, begin)?);
    }
    Ok(measured)
}
