//! From the text of a scenario to its statements.

use super::expect::Expectation;
use super::{Package, Scenario, Statement, Template, What, vector};
use crate::firmware::body::{Body, SwitchBehaviour};
use crate::firmware::event::{Event, line_error_name};
use rsapien_firmware_model::{Inputs, ResetCause};
use rsapien_protocol::{
    Address, AimTarget, BumperMask, Joint, LineError, Mode, Parameter, Pose, Position, Request,
    Step,
};
use std::str::FromStr;

type Parsed<T> = Result<T, String>;

pub(super) fn scenario(name: &str, text: &str) -> Parsed<Scenario> {
    let mut address = None;
    let mut only_lockstep = None;
    let mut blocks: Vec<(u32, usize, Vec<Statement>)> = vec![(1, 0, Vec::new())];
    for (index, line) in text.lines().enumerate() {
        let number = index + 1;
        let at = |error: String| format!("line {number}: {error}");
        let line = line.split('#').next().unwrap_or("").trim();
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.as_slice() {
            [] => {}
            ["controller", name] => address = Some(self::address(name).map_err(at)?),
            ["only", "lock-step:", ..] => {
                only_lockstep = line.split_once(':').map(|(_, why)| why.trim().to_owned());
            }
            ["repeat", count] => {
                blocks.push((self::number(count).map_err(at)?, number, Vec::new()));
            }
            ["end"] => {
                let (count, line, inner) =
                    blocks.pop().ok_or_else(|| at("end of nothing".into()))?;
                let (.., outer) = blocks.last_mut().ok_or_else(|| at("end of nothing".into()))?;
                outer.push(Statement { line, what: What::Repeat(count, inner) });
            }
            words => {
                let what = statement(words).map_err(at)?;
                if let Some((.., block)) = blocks.last_mut() {
                    block.push(Statement { line: number, what });
                }
            }
        }
    }
    let address = address.ok_or("does not say for which controller it is")?;
    match (blocks.pop(), blocks.is_empty()) {
        (Some((.., statements)), true) => {
            Ok(Scenario { name: name.to_owned(), address, only_lockstep, statements })
        }
        _ => Err("a repeat has no end".to_owned()),
    }
}

fn statement(words: &[&str]) -> Parsed<What> {
    let no_inputs = Inputs::default();
    Ok(match words {
        ["session", session] => What::Session(number(session)?),
        ["send", words @ ..] => What::Send(template(words)?),
        ["bytes", bytes @ ..] => What::Bytes(hex(bytes)?),
        ["error", name] => {
            let errors = [LineError::Framing, LineError::Overrun];
            What::Error(named(name, errors, line_error_name)?)
        }
        ["tick", "until", mode, "within", count] => {
            What::TickUntil(named(mode, Mode::ALL, Mode::name)?, number(count)?)
        }
        ["tick", count] => What::Tick(number(count)?),
        ["press", name] => What::Bumper(bumper(name)?, true),
        ["release", name] => What::Bumper(bumper(name)?, false),
        ["switch", side @ ("left" | "right"), state @ ("open" | "closed")] => {
            What::Switch { left: *side == "left", closed: *state == "closed" }
        }
        ["supply", state @ ("low" | "good")] => What::Supply(*state == "low"),
        ["body", "travel", travel @ .., "at", place] => {
            let travel: Vec<u16> = travel.iter().copied().map(number).collect::<Parsed<_>>()?;
            let travel = travel.try_into().map_err(|_| "a body has seven joints")?;
            What::Body(Box::new(Body::new(travel, number(place)?)))
        }
        ["body", "switches", behaviour] => What::Switches(match *behaviour {
            "works" => SwitchBehaviour::Works,
            "stuck-open" => SwitchBehaviour::StuckOpen,
            "stuck-closed" => SwitchBehaviour::StuckClosed,
            other => return Err(format!("no such behaviour: {other}")),
        }),
        ["reset", name] => {
            let causes = [ResetCause::PowerOn, ResetCause::BrownOut, ResetCause::Watchdog];
            let cause = named(name, causes, |cause| cause.stop_cause().name())?;
            What::Event(Event::Reset(cause), 1)
        }
        ["hang"] => What::Event(Event::Hang, 1),
        ["anew", boot] => What::Event(Event::Anew(number(boot)?), 1),
        ["main"] => What::Event(Event::MainRoutine(no_inputs), 1),
        ["timer", count] => What::Event(Event::Timer, number(count)?),
        ["input-change"] => What::Event(Event::InputChange(no_inputs), 1),
        ["transmit", count] => What::Event(Event::Transmit(number(count)?), 1),
        ["line", count] => What::Line(number(count)?),
        ["expect", words @ ..] => What::Expect(Expectation::parse(words)?),
        other => return Err(format!("no such statement: {}", other.join(" "))),
    })
}

fn template(mut words: &[&str]) -> Parsed<Template> {
    let (mut session, mut sequence, mut to) = (None, None, None);
    loop {
        words = match words {
            [before @ .., "session", value] => {
                session = Some(number(value)?);
                before
            }
            [before @ .., "sequence", value] => {
                sequence = Some(number(value)?);
                before
            }
            [before @ .., "to", name] => {
                to = Some(address(name)?);
                before
            }
            _ => break,
        };
    }
    Ok(Template { what: package(words)?, session, sequence, to })
}

fn package(words: &[&str]) -> Parsed<Package> {
    let request = match words {
        ["again"] => return Ok(Package::Again),
        ["vector", name] => return Ok(Package::Line(vector(name)?)),
        ["content", bytes @ ..] => {
            let content = hex(bytes)?.try_into().map_err(|_| "a content has twelve bytes")?;
            return Ok(Package::Content(content));
        }
        ["HELLO"] => return Ok(Package::HelloHere { lowest_version: 1, highest_version: 1 }),
        ["HELLO", "versions", lowest, highest] => {
            return Ok(Package::HelloHere {
                lowest_version: number(lowest)?,
                highest_version: number(highest)?,
            });
        }
        ["HELLO", "proposing", session] => {
            Request::Hello { lowest_version: 1, highest_version: 1, session: number(session)? }
        }
        ["STATE"] => Request::State,
        ["STOP"] => Request::Stop,
        ["COUNTERS"] => Request::Counters,
        ["INIT"] => Request::Init,
        ["HOME"] => Request::Home,
        ["STEP", words @ ..] => Request::Step(step(words)?),
        ["CONFIGURE", "dead-man", timeout] => {
            Request::Configure(Parameter::DeadMan { timeout_ms: number(timeout)? })
        }
        ["CONFIGURE", "travel", name, time] => Request::Configure(Parameter::TravelTime {
            joint: joint(name)?,
            full_travel_ms: number(time)?,
        }),
        ["AIM", "pan", pan, "tilt", tilt] => aim(pan, tilt, "0")?,
        ["AIM", "pan", pan, "tilt", tilt, "speed", speed] => aim(pan, tilt, speed)?,
        other => return Err(format!("no such package: {}", other.join(" "))),
    };
    Ok(Package::Request(request))
}

fn aim(pan: &str, tilt: &str, speed: &str) -> Parsed<Request> {
    Ok(Request::Aim(AimTarget {
        pan_centideg: number(pan)?,
        tilt_centideg: number(tilt)?,
        speed_deg_per_s: number(speed)?,
    }))
}

fn step(words: &[&str]) -> Parsed<Step> {
    let mut step = Step::new(Pose::EMPTY, 0);
    let mut words = words.iter().copied();
    while let Some(word) = words.next() {
        match word {
            "for" => step.duration_ms = number(words.next().ok_or("for how long?")?)?,
            "pose" => {
                let word = number(words.next().ok_or("which pose?")?)?;
                step.pose = Pose::from_word(word).map_err(|error| error.to_string())?;
            }
            "replace" => step.replace = true,
            "until" => {
                for name in words.by_ref() {
                    let bits = step.ending_bumpers.bits() | 1 << bumper(name)?;
                    step.ending_bumpers = BumperMask::from_low_bits(bits);
                }
            }
            primitive => {
                let (name, place) = primitive.split_once(':').ok_or(format!("what is {word}?"))?;
                let joint = joint(name)?;
                step.pose = step.pose.with(joint, Some(position(joint, place)?));
            }
        }
    }
    Ok(step)
}

pub(super) fn joint(name: &str) -> Parsed<Joint> {
    named(name, Joint::ALL, Joint::name)
}

pub(super) fn position(joint: Joint, name: &str) -> Parsed<Position> {
    let names = Position::ALL.into_iter().zip(joint.position_names());
    let found = names.into_iter().find(|(_, other)| *other == name);
    found.map(|(position, _)| position).ok_or_else(|| format!("{} has no {name}", joint.name()))
}

pub(super) fn bumper(name: &str) -> Parsed<usize> {
    let found = BumperMask::NAMES.into_iter().position(|other| other == name);
    found.ok_or_else(|| format!("no such bumper: {name}"))
}

fn address(name: &str) -> Parsed<Address> {
    named(name, Address::ALL, Address::name)
}

pub(super) fn named<T: Copy>(
    name: &str,
    all: impl IntoIterator<Item = T>,
    name_of: impl Fn(T) -> &'static str,
) -> Parsed<T> {
    let found = all.into_iter().find(|item| name_of(*item) == name);
    found.ok_or_else(|| format!("{name} is not known here"))
}

/// A number, decimal or with `0x`.
pub(super) fn number<T: FromStr + TryFrom<i64>>(word: &str) -> Parsed<T> {
    let number = match word.strip_prefix("0x") {
        Some(digits) => i64::from_str_radix(digits, 16),
        None => word.parse(),
    };
    let number = number.ok().and_then(|number| T::try_from(number).ok());
    number.ok_or_else(|| format!("{word} is not a number that fits here"))
}

fn hex(words: &[&str]) -> Parsed<Vec<u8>> {
    let byte =
        |word: &&str| u8::from_str_radix(word, 16).map_err(|_| format!("{word}: not a byte"));
    words.iter().map(byte).collect()
}
