//! `rsapien state --timing`: where the time goes between a request and its answer.

use std::io::Write;
use std::time::Duration;

use crate::cli::context::Context;
use crate::cli::diagnostics::Result;
use crate::cli::exit::Status;
use crate::cli::output::Table;
use crate::cli::progress::Progress;
use crate::cli::robot;
use crate::timing::{Spread, Timing, TimingProbe};
use crate::{LinkAddress, RobotOptions};

/// An adapter that takes longer has a latency timer that can be set shorter.
const ADAPTER_GOOD_MS: u64 = 6;

pub(super) fn run(context: &Context, out: &mut impl Write, requests: u32) -> Result<Status> {
    let address = robot::address(context)?;
    let probe = TimingProbe::default();
    let mut options = RobotOptions::for_user("rsapien state");
    options.on_line = Some(probe.sink());
    let open = robot::open_with(context, &address, options)?;
    // This moves nothing, so that its end stops nothing.
    open.interrupt.stop_nothing();
    let sensors = open.done(open.robot.sensors())?;
    let mut progress = Progress::new(context.style, requests as usize);
    let measured = probe.measure(&open.robot, &sensors, context.baud, requests as usize, |_| {
        progress.next("request");
        !open.interrupt.is_raised()
    });
    drop(progress);
    let timing = open.done(measured)?;
    open.interrupt.check()?;
    let link = open.robot.link_name();
    let has_adapter = matches!(address, LinkAddress::Auto | LinkAddress::Serial(_));
    context.style.answer(
        out,
        &json(link, &timing),
        text(link, &timing, context.baud, has_adapter),
    )?;
    Ok(Status::Done)
}

fn ms(duration: Duration) -> f64 {
    (duration.as_secs_f64() * 1e5).round() / 100.0
}

fn json(link: &str, timing: &Timing) -> serde_json::Value {
    let spread = |spread: Spread| {
        serde_json::json!({
            "best_ms": ms(spread.best), "median_ms": ms(spread.median), "worst_ms": ms(spread.worst),
        })
    };
    serde_json::json!({
        "link": link,
        "requests": timing.requests,
        "pc": spread(timing.pc),
        "line_ms": ms(timing.line),
        "firmware_at_most_ms": timing.firmware_at_most.map(ms),
        "adapter_and_firmware": spread(timing.rest),
        "total": spread(timing.total),
    })
}

fn text(link: &str, timing: &Timing, baud: u32, has_adapter: bool) -> String {
    let number = |duration| format!("{:.2}", ms(duration));
    let mut table = Table::new(&["share", "best ms", "median ms", "worst ms", ""]);
    let mut row = |share: &str, numbers: [String; 3], how: &str| {
        table.row([vec![share.to_owned()], numbers.to_vec(), vec![how.to_owned()]].concat());
    };
    let measured = |spread: Spread| [spread.best, spread.median, spread.worst].map(number);
    row("PC", measured(timing.pc), "measured: this program and this computer");
    let adapter = if has_adapter { "adapter" } else { "connection" };
    row(adapter, measured(timing.rest), "what is left of the whole, the firmware's share in it");
    row("line", [timing.line; 3].map(number), &format!("reckoned: both packages at {baud} bit/s"));
    let (worst, how) = timing.firmware_at_most.map_or_else(
        || ("-".to_owned(), "unknown: its clock was never simulated"),
        |bound| {
            (number(bound), "at most: one pass of its main routine, in the simulator of the chips")
        },
    );
    row("firmware", ["-".to_owned(), "-".to_owned(), worst], how);
    row("whole", measured(timing.total), "measured; a heartbeat that is under way goes first");
    let count = timing.requests;
    let mut text = format!("{link}: {count} requests for the state\n{table}");
    if has_adapter && timing.rest.median > Duration::from_millis(ADAPTER_GOOD_MS) {
        text.push_str(
            "\nthe adapter holds answers back: rsapien doctor tells how to set its latency timer",
        );
    }
    text
}
