//! Recorded answers beside new ones: what can be compared, and where they differ first.
//!
//! A state is what it was when the controller was asked. A change that came a moment before the
//! question in one run may come a moment behind it in the other. So with a tolerance, a value is right
//! if it is one that the other run had within the tolerance around that moment, as far as its answers
//! tell, and the other way round: a value that only one run has is a difference.

mod values;

use std::collections::VecDeque;

use rsapien_protocol::{Address, Report, Request, SynchronizationPackage};

use self::values::{Origin, Value, Values, values};
use super::exchange::Exchange;

/// What the head's angles may differ by with a tolerance, beyond where they were around that moment.
const ANGLE_SLACK_CENTIDEG: i64 = 100;

/// A value of an answer that differs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// Which.
    pub name: String,
    /// As it was recorded.
    pub recorded: String,
    /// As it is now.
    pub now: String,
}

/// Where answers differ first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// When the recorded answer came, or the request was sent that has none now; in ms of the recorded clock.
    pub time_ms: u64,
    /// The number of the request among the packages of the PC, from 1 on.
    pub package: u64,
    /// The controller.
    pub address: Address,
    /// The request, in words.
    pub request: String,
    /// What differs, at least one.
    pub fields: Vec<Field>,
}

struct Sample {
    difference: Difference,
    /// None of a state that was asked for beyond the end of the recording.
    recorded: Option<Values>,
    now: Values,
}

impl Sample {
    fn time_ms(&self) -> u64 {
        self.difference.time_ms
    }
}

/// Compares answers as they come.
pub(super) struct Comparer {
    /// None: everything has to be the same, byte for byte.
    tolerance_ms: Option<u64>,
    /// Per controller: recorded, now.
    origins: [[Origin; 2]; 2],
    /// Per controller: those of which some may still be needed, and how many are decided.
    samples: [(VecDeque<Sample>, usize); 2],
    found: Option<Difference>,
    pub(super) compared: u64,
}

impl Comparer {
    pub(super) fn new(tolerance_ms: Option<u64>) -> Comparer {
        Comparer {
            tolerance_ms,
            origins: Default::default(),
            samples: Default::default(),
            found: None,
            compared: 0,
        }
    }

    /// Takes the new answer of an exchange; whether a difference is known. Before what is to be compared
    /// begins, answers only tell where counts begin.
    pub(super) fn push(
        &mut self,
        exchange: &Exchange,
        now: Option<&SynchronizationPackage>,
        is_compared: bool,
    ) -> bool {
        let Some((answered_ms, recorded)) = &exchange.answer else { return false };
        let index = usize::from(exchange.address == Address::Camera);
        let difference = |time_ms, fields| Difference {
            time_ms,
            package: exchange.number,
            address: exchange.address,
            request: exchange.words.clone(),
            fields,
        };
        let Some(now) = now else {
            if is_compared {
                let recorded = recorded.status.to_string();
                let field =
                    Field { name: "answer".to_owned(), recorded, now: "no answer".to_owned() };
                self.note(difference(exchange.time_ms, vec![field]));
            }
            return self.found.is_some();
        };
        let is_exact = self.tolerance_ms.is_none();
        let [of_recorded, of_now] = &mut self.origins[index];
        let is_init = exchange.package.request == Request::Init;
        let values = |origin: &mut Origin, package: &SynchronizationPackage| {
            if is_init && package.status.is_accepted() {
                origin.steps = Some(0);
            }
            values(origin, package, is_exact)
        };
        let (recorded, now_values) = (values(of_recorded, recorded), values(of_now, now));
        if !is_compared {
            return false;
        }
        self.compared += 1;
        let is_state = matches!(now.report, Report::Motion(_) | Report::Camera(_));
        let sample = Sample {
            difference: difference(*answered_ms, Vec::new()),
            recorded: Some(recorded),
            now: now_values,
        };
        if is_exact || !is_state {
            let fields = differing(&sample, |_, _, _| false);
            self.note_all(sample.difference, fields);
        } else {
            self.samples[index].0.push_back(sample);
            self.decide(index, false);
        }
        self.found.is_some()
    }

    /// Takes a state that was asked for at `time_ms`, beyond the end of the recording: what the last recorded
    /// answers tell may be true a moment later.
    pub(super) fn push_beyond(
        &mut self,
        address: Address,
        time_ms: u64,
        now: &SynchronizationPackage,
    ) {
        let index = usize::from(address == Address::Camera);
        let now = values(&mut self.origins[index][1], now, false);
        let difference =
            Difference { time_ms, package: 0, address, request: String::new(), fields: Vec::new() };
        self.samples[index].0.push_back(Sample { difference, recorded: None, now });
    }

    /// The first difference, if there is one, when all answers were pushed.
    pub(super) fn finish(mut self) -> (Option<Difference>, u64) {
        self.decide(0, true);
        self.decide(1, true);
        (self.found, self.compared)
    }

    fn note_all(&mut self, difference: Difference, fields: Vec<Field>) {
        if !fields.is_empty() {
            self.note(Difference { fields, ..difference });
        }
    }

    fn note(&mut self, difference: Difference) {
        let is_first = self.found.as_ref().is_none_or(|found| difference.package < found.package);
        if is_first {
            self.found = Some(difference);
        }
    }

    /// Decides on the samples around which enough is known; at the `end`, on all.
    fn decide(&mut self, index: usize, end: bool) {
        let tolerance_ms = self.tolerance_ms.unwrap_or_default();
        let (samples, decided) = &mut self.samples[index];
        let mut noted = Vec::new();
        while let Some(sample) = samples.get(*decided) {
            let until_ms = sample.time_ms().saturating_add(tolerance_ms);
            let is_known = samples.back().is_some_and(|last| last.time_ms() > until_ms);
            if !end && !is_known {
                break;
            }
            let (first, last) = window(samples, *decided, tolerance_ms);
            let around: Vec<&Sample> = samples.range(first..=last).collect();
            // What the recorded robot told a moment later is not known at the end.
            let is_last =
                !samples.iter().any(|later| later.recorded.is_some() && later.time_ms() > until_ms);
            let fields = differing(sample, |name, recorded, now| {
                let of_recorded = around.iter().filter_map(|sample| sample.recorded.as_ref());
                (is_last && name != "status" || is_right(name, now, of_recorded))
                    && is_right(name, recorded, around.iter().map(|sample| &sample.now))
            });
            noted.push((sample.difference.clone(), fields));
            *decided += 1;
            // Those that no later sample's window reaches.
            let unneeded = first.min(decided.saturating_sub(1));
            samples.drain(..unneeded);
            *decided -= unneeded;
        }
        for (difference, fields) in noted {
            self.note_all(difference, fields);
        }
    }
}

/// The first and the last sample whose values may have held within the tolerance around sample `at`.
fn window(samples: &VecDeque<Sample>, at: usize, tolerance_ms: u64) -> (usize, usize) {
    let time_ms = |index: usize| samples.get(index).map_or(0, Sample::time_ms);
    let (mut first, mut last) = (at, at);
    // A value holds, as far as is known, until the next answer.
    while first > 0 && time_ms(first) >= time_ms(at).saturating_sub(tolerance_ms) {
        first -= 1;
    }
    while last + 1 < samples.len() && time_ms(last) <= time_ms(at).saturating_add(tolerance_ms) {
        last += 1;
    }
    (first, last)
}

/// Whether the other run had this value around that moment.
fn is_right<'values>(
    name: &str,
    value: &Value,
    others: impl Iterator<Item = &'values Values>,
) -> bool {
    // Statuses answer a request, not a moment.
    if name == "status" {
        return false;
    }
    let same_name = |values: &'values Values| values.iter().find(|(it, _)| it == name);
    let mut others = others.filter_map(same_name).map(|(_, value)| value);
    match value.centideg() {
        None => others.any(|other| other == value),
        Some(value) => {
            let angles: Vec<i64> = others.filter_map(Value::centideg).collect();
            let (Some(least), Some(most)) = (angles.iter().min(), angles.iter().max()) else {
                return false;
            };
            (least - ANGLE_SLACK_CENTIDEG..=most + ANGLE_SLACK_CENTIDEG).contains(&value)
        }
    }
}

fn differing(sample: &Sample, is_excused: impl Fn(&str, &Value, &Value) -> bool) -> Vec<Field> {
    let Some(recorded_values) = &sample.recorded else { return Vec::new() };
    let nothing = Value::Text("nothing".to_owned());
    let names = recorded_values.iter().chain(&sample.now).map(|(name, _)| name);
    let mut fields: Vec<Field> = Vec::new();
    for name in names {
        let of = |values: &Values| {
            let found = values.iter().find(|(it, _)| it == name);
            found.map_or(nothing.clone(), |(_, value)| value.clone())
        };
        let (recorded, now) = (of(recorded_values), of(&sample.now));
        let is_told = fields.iter().any(|field| field.name == *name);
        if recorded != now && !is_told && !is_excused(name, &recorded, &now) {
            let (recorded, now) = (recorded.to_string(), now.to_string());
            fields.push(Field { name: name.clone(), recorded, now });
        }
    }
    fields
}
