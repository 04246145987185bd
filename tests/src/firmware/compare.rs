//! Events into the reference model and into the C core, record against record; a session that
//! differs is made as short as it gets and kept.

use super::event::{self, Event};
use super::program::{Program, ProgramError};
use super::record::{differences, split_first};
use super::reference::Reference;
use rsapien_protocol::Address;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Attempts that shrinking a session may cost.
const ATTEMPTS_MAX: usize = 600;

/// The first place where a session differs.
#[derive(Clone, Debug)]
pub struct Divergence {
    /// Which event of the session, from 0.
    pub event_number: usize,
    /// The event.
    pub event: Option<Event>,
    /// Both records by the names of their fields, what differs marked; or how the program ended.
    pub told: String,
}

/// Plays `events` to the reference model. Gives the records, one behind the other.
pub fn expected(address: Address, events: &[Event]) -> Vec<u8> {
    let mut reference = Reference::new(address, 0);
    let mut records = Vec::new();
    for event in events {
        reference.apply(*event, &mut records);
    }
    records
}

/// Plays `events` to a program that has just been started or made anew. Gives the first place where its
/// records are not the `expected` ones; a program that ended or hung differs there.
pub fn compare(
    program: &mut Program,
    address: Address,
    events: &[Event],
    expected: &[u8],
) -> Option<Divergence> {
    let answers = match program.answers(events) {
        Ok(answers) => answers,
        Err(error) => {
            let event_number = match error {
                ProgramError::Ended { records, .. } | ProgramError::Hung { records } => records,
                _ => 0,
            };
            let event = events.get(event_number).copied();
            return Some(Divergence { event_number, event, told: error.to_string() });
        }
    };
    if answers == expected {
        return None;
    }
    let (mut expected, mut found) = (expected, answers.as_slice());
    for (event_number, event) in events.iter().enumerate() {
        let pair = (split_first(address, expected), split_first(address, found));
        let (Some((one, behind_one)), Some((other, behind_other))) = pair else { break };
        if one != other {
            let told = differences(address, one, other);
            return Some(Divergence { event_number, event: Some(*event), told });
        }
        (expected, found) = (behind_one, behind_other);
    }
    let told = "the program gave more than the records of the events".to_owned();
    Some(Divergence { event_number: events.len(), event: None, told })
}

/// A session that differs, made short.
#[derive(Clone, Debug)]
pub struct Failure {
    /// Where the session came from.
    pub origin: String,
    /// Where it differs.
    pub divergence: Divergence,
    /// How many events the session had.
    pub event_count: usize,
    /// The shortest session found that differs, and where; none when the session does not differ in a
    /// program just started, so that something survived `anew`.
    pub shrunk: Option<(Vec<Event>, Divergence)>,
}

impl Failure {
    /// Shrinks the session of a divergence by replaying parts of it in fresh programs.
    ///
    /// # Errors
    /// When the program does not start any more.
    pub fn shrink(
        path: &Path,
        address: Address,
        origin: String,
        events: &[Event],
        divergence: Divergence,
    ) -> Result<Failure, ProgramError> {
        let differs = |events: &[Event]| -> Result<Option<Divergence>, ProgramError> {
            let mut program = Program::start(path, address)?;
            Ok(compare(&mut program, address, events, &expected(address, events)))
        };
        let event_count = events.len();
        let mut shrunk = None;
        if let Some(found) = differs(events)? {
            let events = events[..=found.event_number.min(event_count - 1)].to_vec();
            shrunk = Some(minimise(events, found, differs)?);
        }
        Ok(Failure { origin, divergence, event_count, shrunk })
    }

    /// Keeps the shortest session as a scenario in `folder`. Gives its path.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn keep(&self, address: Address, folder: &Path) -> std::io::Result<Option<PathBuf>> {
        let Some((events, divergence)) = &self.shrunk else { return Ok(None) };
        let mut text = format!("# Found by: {}\n# The last event differed:\n", self.origin);
        for line in divergence.told.lines().filter(|line| line.starts_with('!')) {
            let _ = writeln!(text, "#   {}", line.split_whitespace().collect::<Vec<_>>().join(" "));
        }
        let _ = writeln!(text, "controller {}", address.name());
        text.push_str("only lock-step: kept as events\n");
        text.push_str(&event::to_scenario(events));
        std::fs::create_dir_all(folder)?;
        let path = folder.join(format!("{}-{:016x}.scenario", address.name(), hash(&text)));
        std::fs::write(&path, text)?;
        Ok(Some(path))
    }

    /// All that is to be told, with the file that it was kept in.
    pub fn report(&self, kept: Option<&Path>) -> String {
        let mut text = format!(
            "model and C differ: {}\nevent {} of {}: {:?}\n  {:22} {:44} C core\n{}",
            self.origin,
            self.divergence.event_number,
            self.event_count,
            self.divergence.event,
            "field",
            "model",
            self.divergence.told,
        );
        if let Some((events, divergence)) = &self.shrunk {
            let _ = writeln!(
                text,
                "shrunk to {} events, which end in {:?}:\n{}",
                events.len(),
                divergence.event,
                divergence.told
            );
        } else {
            text.push_str("in a program just started it does not: something survives `anew`\n");
        }
        if let Some(path) = kept {
            let _ = writeln!(text, "kept in {}", path.display());
        }
        text
    }
}

/// Delta debugging: leaves out ever smaller parts as long as what is left differs.
fn minimise(
    mut events: Vec<Event>,
    mut found: Divergence,
    differs: impl Fn(&[Event]) -> Result<Option<Divergence>, ProgramError>,
) -> Result<(Vec<Event>, Divergence), ProgramError> {
    let mut attempts = 0;
    let mut part = events.len().div_ceil(2);
    while part > 0 && attempts < ATTEMPTS_MAX {
        let mut start = 0;
        let mut left_out_any = false;
        while start < events.len() && attempts < ATTEMPTS_MAX {
            let end = (start + part).min(events.len());
            let mut candidate = events[..start].to_vec();
            candidate.extend_from_slice(&events[end..]);
            attempts += 1;
            match differs(&candidate)? {
                Some(divergence) if !candidate.is_empty() => {
                    candidate.truncate(divergence.event_number + 1);
                    events = candidate;
                    found = divergence;
                    left_out_any = true;
                }
                _ => start = end,
            }
        }
        if !left_out_any || part > 1 {
            part /= 2;
        }
    }
    Ok((events, found))
}

/// FNV-1a, for a name that tells kept sessions apart.
fn hash(text: &str) -> u64 {
    text.bytes().fold(0xCBF2_9CE4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3)
    })
}
