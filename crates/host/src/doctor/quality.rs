//! How well packages go to and fro: as many STATE as go in a second, and what both ends counted.

use rsapien_protocol::{
    ACTION_PACKAGE_LENGTH, Address, CountersReport, Report, Request, SYNCHRONIZATION_PACKAGE_LENGTH,
};

use super::line::ProbeLine;
use super::{Case, Finding};
use crate::Error;

pub(super) const NAME: &str = "line";

/// Packages sent again that are no pattern yet.
const SPIKES_MAX: u32 = 2;

/// The most packages that are sent, whatever the link's clock says.
const PACKAGES_MAX: u32 = 10_000;

/// What was counted while the line was measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LineQuality {
    /// How long it was measured, in ms.
    pub measured_ms: u64,
    /// Requests, each of which is sent up to three times.
    pub requests: u32,
    /// Requests that were never answered.
    pub lost: u32,
    /// Packages sent again because their answer did not come.
    pub resent: u32,
    /// Packages abandoned or dropped at this end.
    pub errors_here: u16,
    /// Packages abandoned or dropped by the motion controller, CRC errors among them; none when it did not tell.
    pub errors_there: Option<u16>,
    /// UART framing errors at the motion controller.
    pub framing_errors: u16,
    /// UART overruns at the motion controller.
    pub overruns: u16,
    /// Median time from a package to its answer, in ms.
    pub round_trip_median_ms: u64,
    /// Longest time from a package to its answer, in ms, resends included.
    pub round_trip_worst_ms: u64,
}

impl LineQuality {
    /// Requests of a thousand that did not go through at once.
    pub fn troubled_per_mille(&self) -> u32 {
        (self.resent + self.lost) * 1000 / self.requests.max(1)
    }

    fn errors(&self) -> u32 {
        u32::from(self.errors_here)
            + u32::from(self.errors_there.unwrap_or(0))
            + u32::from(self.framing_errors)
            + u32::from(self.overruns)
    }
}

pub(super) fn check(case: &mut Case<'_>) {
    let measure_ms = case.options.measure_ms;
    let Some(line) = case.line.as_mut() else { return };
    let baud = line.baud();
    match measure(line, measure_ms) {
        Ok(quality) => {
            case.quality = Some(quality);
            case.tell(errors(&quality));
            if quality.lost < quality.requests {
                case.tell(round_trip(&quality, baud));
            }
        }
        Err(error) => case.lose_line(NAME, &error),
    }
}

fn measure(line: &mut ProbeLine, measure_ms: u64) -> Result<LineQuality, Error> {
    let mut quality = LineQuality::default();
    let here = line.counts().errors;
    let before = counters(line)?;
    let start_ms = line.now_ms();
    let mut round_trips_ms = Vec::new();
    while line.now_ms() - start_ms < measure_ms && quality.requests < PACKAGES_MAX {
        let asked = line.ask(Address::Motion, Request::State)?;
        quality.requests += 1;
        quality.resent += u32::from(asked.tries.saturating_sub(1));
        match asked.answer {
            Some(_) => round_trips_ms.push(asked.round_trip_ms),
            None => quality.lost += 1,
        }
    }
    quality.measured_ms = line.now_ms() - start_ms;
    let after = counters(line)?;
    quality.errors_here = line.counts().errors.wrapping_sub(here);
    if let (Some(before), Some(after)) = (before, after) {
        let since = |count: fn(&CountersReport) -> u16| count(&after).wrapping_sub(count(&before));
        quality.errors_there =
            Some(since(|counts| counts.resets).wrapping_add(since(|counts| counts.crc_errors)));
        quality.framing_errors = since(|counts| counts.framing_errors);
        quality.overruns = since(|counts| counts.overruns);
    }
    round_trips_ms.sort_unstable();
    quality.round_trip_median_ms =
        round_trips_ms.get(round_trips_ms.len() / 2).copied().unwrap_or(0);
    quality.round_trip_worst_ms = round_trips_ms.last().copied().unwrap_or(0);
    Ok(quality)
}

fn counters(line: &mut ProbeLine) -> Result<Option<CountersReport>, Error> {
    Ok(match line.ask(Address::Motion, Request::Counters)?.answer {
        Some((_, Report::Counters(report))) => Some(report),
        _ => None,
    })
}

pub(super) fn errors(quality: &LineQuality) -> Finding {
    let LineQuality { requests, resent, lost, errors_here, measured_ms, .. } = *quality;
    if resent + lost + quality.errors() == 0 {
        let found =
            format!("{requests} of {requests} packages answered in {measured_ms} ms, no errors");
        return Finding::good(NAME, "clean", found);
    }
    let there = match quality.errors_there {
        Some(count) => format!("{count} at the robot"),
        None => "unknown at the robot".to_owned(),
    };
    let mut found = format!(
        "of {requests} packages in {measured_ms} ms {resent} were sent again and {lost} never answered; \
         reception errors: {errors_here} here, {there}"
    );
    for (count, name) in
        [(quality.framing_errors, "framing errors"), (quality.overruns, "overruns")]
    {
        if count > 0 {
            found = format!("{found}, {count} {name}");
        }
    }
    // A spike now and then is what resends are for.
    if lost == 0 && (resent <= SPIKES_MAX || quality.troubled_per_mille() < 10) {
        return Finding::advice(NAME, "line-errors", found)
            .remedy("nothing, if it stays so; rsapien doctor again tells");
    }
    Finding::problem(NAME, "line-bad", found)
        .remedy("look at ground between PC and robot, the plugs, the cable's length and its way past the motors")
        .remedy("framing errors tell of a speed that is off: the right crystal and clock in the firmware?")
        .remedy("a firmware and --baud of 19200 stand more")
}

fn round_trip(quality: &LineQuality, baud: u32) -> Finding {
    let (median, worst) = (quality.round_trip_median_ms, quality.round_trip_worst_ms);
    // Ten bits a byte, rounded up.
    let bits = (ACTION_PACKAGE_LENGTH + SYNCHRONIZATION_PACKAGE_LENGTH) as u64 * 10;
    let on_line_ms = (bits * 1000).div_ceil(u64::from(baud.max(1)));
    let found = format!(
        "an answer takes {median} ms, at worst {worst} ms; the bytes alone take {on_line_ms} ms at {baud} baud"
    );
    if median > on_line_ms + 8 {
        return Finding::advice(NAME, "slow", found).remedy(
            "the adapter, or what stands between, holds bytes back: see latency above, leave hubs away",
        );
    }
    Finding::good(NAME, "round-trip", found)
}
