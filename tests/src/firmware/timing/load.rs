//! Both directions of the line full, how much of the chip that takes, and how soon it is there.

use super::Measured;
use super::rig::{Rig, answers, tick_pin};
use super::routines::busy;
use crate::firmware::gpsim::{GpsimError, Happening, Image};
use rsapien_protocol::{Address, BumperMask, Pose, Request, Step};

/// What a full line and full work cost, measured of one image.
#[derive(Clone, Copy, Debug)]
pub(super) struct Load {
    /// Shares of the chip's time in tenths of a percent: at rest, with seven joints on their way, and
    /// with everything at once.
    pub(super) rest_permille: u64,
    pub(super) moving_permille: u64,
    pub(super) busy_permille: u64,
    /// Packages sent without a pause, and those that the chip accepted.
    pub(super) sent: u64,
    pub(super) accepted: u64,
    /// Bytes that the chip sent meanwhile, as a share of what its line takes, and its errors.
    pub(super) answered_permille: u64,
    pub(super) errors: u64,
    /// From power-on to the first tick, and to the end of the first answer.
    pub(super) first_tick: u64,
    pub(super) first_answer: u64,
}

const MAIN: &str = "_controller_main_routine";
const SHARE_MS: u64 = 500;
const FULL_MS: u64 = 2000;

pub(super) fn measure(image: &Image) -> Result<Load, GpsimError> {
    let (first_tick, first_answer) = cold_start(image)?;
    let mut rig = Rig::ready(image)?;
    rig.mark(&[MAIN])?;
    rig.take();
    rig.run_ms(SHARE_MS)?;
    let at_rest = passes(&rig.take());
    // The shortest pass has nothing to do and no interrupt in it; what is not such passes is work.
    let empty = at_rest.best;
    let share = |passes: Measured, ms: u64| {
        let cycles = ms * image.cycles_a_ms();
        1000 - (passes.samples * empty).min(cycles) * 1000 / cycles
    };
    let rest_permille = share(at_rest, SHARE_MS);
    if image.address == Address::Motion {
        // Every joint on its way for seconds.
        let pose = Pose::from_word(0x1555).unwrap_or(Pose::MIDDLE);
        let step =
            Step { pose, duration_ms: 60_000, replace: true, ending_bumpers: BumperMask::NONE };
        rig.ask(Request::Step(step))?;
    } else {
        rig.ask(Request::Aim(rsapien_protocol::AimTarget {
            pan_centideg: 9000,
            tilt_centideg: 4500,
            speed_deg_per_s: 10,
        }))?;
    }
    rig.take();
    rig.run_ms(SHARE_MS)?;
    let moving_permille = share(passes(&rig.take()), SHARE_MS);
    let log = busy(&mut rig, SHARE_MS)?;
    let busy_permille = share(passes(&log), SHARE_MS);
    rig.chip.tell(&format!("unmark {MAIN}"))?;
    rig.run_ms(100)?;

    let before = rig.counters()?;
    rig.take();
    let (begin, mut sent) = (rig.cycle, 0);
    let bytes = rig.package(Request::State);
    while rig.cycle < begin + FULL_MS * image.cycles_a_ms() {
        rig.chip.send(&bytes, rig.cycle)?;
        sent += 1;
        let all = rig.line_cycles(bytes.len() * sent);
        // Never more than a package behind the line, so that it never rests.
        rig.run_to((begin + all).saturating_sub(rig.line_cycles(bytes.len())).max(rig.cycle))?;
    }
    let log = rig.take();
    let said = log.iter().filter(|(_, happening)| matches!(happening, Happening::Byte(_))).count();
    let broken = log.iter().filter(|(_, happening)| *happening == Happening::Framing).count();
    let possible = (rig.cycle - begin) / image.cycles_a_byte();
    let intact = answers(&log).len();
    rig.run_ms(100)?;
    let after = rig.counters()?;
    let errors = [
        after.resets.wrapping_sub(before.resets),
        after.crc_errors.wrapping_sub(before.crc_errors),
        after.framing_errors.wrapping_sub(before.framing_errors),
        after.overruns.wrapping_sub(before.overruns),
    ];
    // The first answer may lie at the edge of the log, and the last.
    let lost_answers = (said / 25).saturating_sub(intact);
    Ok(Load {
        rest_permille,
        moving_permille,
        busy_permille,
        sent: sent as u64,
        // COUNTERS itself was one.
        accepted: u64::from(after.accepted.wrapping_sub(before.accepted)) - 1,
        // The chip may be a little faster than its nominal speed.
        answered_permille: (said as u64 * 1000 / possible).min(1000),
        errors: errors.into_iter().map(u64::from).sum::<u64>() + (broken + lost_answers) as u64,
        first_tick,
        first_answer,
    })
}

fn passes(log: &[(u64, Happening)]) -> Measured {
    let marks: Vec<u64> = log
        .iter()
        .filter(|(_, happening)| matches!(happening, Happening::Mark(_)))
        .map(|(at, _)| *at)
        .collect();
    Measured::of(marks.windows(2).map(|pair| pair[1] - pair[0]))
}

/// A PC that asks again and again from the moment the power comes on.
fn cold_start(image: &Image) -> Result<(u64, u64), GpsimError> {
    let mut rig = Rig::power_on(image)?;
    let bytes = rig.package(Request::State);
    // The line rests for a byte behind each package: in a stream without a pause a receiver that begins
    // in the middle may take any bit for a start bit.
    for package in 0..50 {
        rig.chip.send(&bytes, package * rig.line_cycles(bytes.len() + 1))?;
    }
    let mut first_tick = None;
    for _ in 0..100 {
        rig.run_ms(1)?;
        let log = rig.take();
        let pin = tick_pin(image.address);
        let tick = log
            .iter()
            .find(|(_, happening)| matches!(happening, Happening::Edge(name, true) if name == pin));
        first_tick = first_tick.or(tick.map(|(at, _)| *at));
        let said: Vec<u64> = log
            .iter()
            .filter(|(_, happening)| matches!(happening, Happening::Byte(_)))
            .map(|(at, _)| *at)
            .collect();
        if let (Some(first_tick), Some(first)) = (first_tick, said.first()) {
            // The answer's other bytes follow without a pause.
            return Ok((first_tick, first + 24 * image.cycles_a_byte()));
        }
    }
    Err(GpsimError::Broken("there is no answer".to_owned()))
}
