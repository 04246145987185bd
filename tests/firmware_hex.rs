//! The third leg of the comparison: the images that are flashed, in gpsim, against the reference model.
//! Every byte transmitted must be equal, and the pins within a tick.
//!
//! Needs the feature `firmware-simulator`, and the bridge: `make -C firmware-pic/sim`. What is missing is
//! a failure here, not a skip: a machine without gpsim leaves the feature away.

use rsapien_protocol::{ActionPackage, Address, LineError, Request};
use rsapien_tests::firmware::bench::{Action, Bench, BenchError};
use rsapien_tests::firmware::coverage::Coverage;
use rsapien_tests::firmware::gpsim::Image;
use rsapien_tests::firmware::hex::HexBench;
use rsapien_tests::firmware::random::{Generator, Move};
use rsapien_tests::firmware::scenario::{Scenario, is_rest};
use rsapien_tests::firmware::timing;
use rsapien_tests::firmware::vectors::{self, Brought};
use rsapien_tests::{read, workspace};
use std::time::Instant;

/// Packages that the random sessions have accepted, for either controller.
const PACKAGES: u64 = 6_000;
/// Packages of a session, which begins with a power-on.
const PACKAGES_A_SESSION: u64 = 300;
const SEED: u64 = 9;

/// What was compared.
#[derive(Clone, Copy, Debug, Default)]
struct Compared {
    bytes: u64,
    ticks: u64,
    pulses: u64,
    left_out: u64,
}

impl Compared {
    fn add(&mut self, bench: &HexBench) {
        self.bytes += bench.bytes_equal;
        self.ticks += bench.ticks_equal;
        self.pulses += bench.pulses_equal;
        self.left_out += bench.left_out;
    }
}

/// Does something for both controllers at once.
fn for_both(work: impl Fn(Address) -> Result<(), String> + Sync) {
    let outcomes = std::thread::scope(|scope| {
        Address::ALL
            .map(|address| {
                scope.spawn({
                    let work = &work;
                    move || work(address)
                })
            })
            .map(|thread| thread.join().unwrap())
    });
    let errors: Vec<String> = outcomes.into_iter().filter_map(Result::err).collect();
    assert!(errors.is_empty(), "{}", errors.join("\n"));
}

#[test]
fn scenarios() {
    let scenarios = Scenario::all_of("tests/scenarios");
    for_both(|address| {
        let begun = Instant::now();
        let image = Image::committed(address);
        let (mut compared, mut played) = (Compared::default(), 0);
        let mut errors = Vec::new();
        for scenario in scenarios.iter().filter(|scenario| scenario.address == address) {
            if let Some(why) = &scenario.only_lockstep {
                println!("{} is played in lock step only: {why}", scenario.name);
                continue;
            }
            let mut bench = HexBench::new(&image, 0).map_err(|error| error.to_string())?;
            if let Err(error) = scenario.play(&mut bench) {
                errors.push(error.to_string());
            }
            compared.add(&bench);
            played += 1;
        }
        println!(
            "{}: {played} scenarios, {compared:?}, {:.0} s",
            address.name(),
            begun.elapsed().as_secs_f64()
        );
        if errors.is_empty() { Ok(()) } else { Err(errors.join("\n")) }
    });
}

#[test]
fn vectors_of_reception() {
    let is_overrun =
        |(_, brought): &(u64, Brought)| matches!(brought, Brought::LineError(LineError::Overrun));
    let mut played = 0;
    for stream in vectors::streams() {
        // Nothing makes the chip lose a byte at will.
        if stream.events.iter().any(is_overrun) {
            continue;
        }
        let mut bench = HexBench::new(&Image::committed(stream.address), 0).unwrap();
        bench.ticks(2, None).unwrap();
        let mut now_ms = stream.events.first().map_or(0, |(at_ms, _)| *at_ms);
        for (at_ms, brought) in &stream.events {
            let wait = u32::try_from(at_ms - now_ms).unwrap();
            now_ms = *at_ms;
            let action = match brought {
                Brought::Bytes(bytes) => {
                    bench
                        .ticks(wait, Some(bytes).filter(|bytes| is_rest(bytes)).map(Vec::as_slice))
                        .unwrap();
                    Action::Line(bytes.clone())
                }
                Brought::LineError(error) => {
                    bench.ticks(wait, None).unwrap();
                    Action::LineError(*error)
                }
            };
            bench.perform(action).unwrap();
        }
        bench.ticks(8, None).unwrap();
        let counters = bench.world().reference.counters();
        let [accepted, resets, crc_errors, framing_errors, ..] = stream.counts;
        let counted =
            [counters.accepted, counters.resets, counters.crc_errors, counters.framing_errors];
        assert_eq!(counted, [accepted, resets, crc_errors, framing_errors], "{}", stream.name);
        // The chip's own counts, in its answer.
        let ask = ActionPackage { session: 0, sequence: 0, request: Request::Counters };
        bench.perform(Action::Line(ask.encode(stream.address).to_vec())).unwrap();
        bench.ticks(8, None).unwrap_or_else(|error| panic!("{}: {error}", stream.name));
        assert!(bench.bytes_equal >= 25, "{}", stream.name);
        played += 1;
    }
    println!("{played} streams of the vectors");
    assert!(played >= 12);
}

#[test]
fn random_packages() {
    for_both(|address| {
        let begun = Instant::now();
        let mut coverage = Coverage::new(address);
        let mut compared = Compared::default();
        let mut index = 0;
        while coverage.packages() < PACKAGES {
            session(address, index, &mut coverage, &mut compared).map_err(|error| {
                format!("seed {SEED}, {} session {index}: {error}", address.name())
            })?;
            index += 1;
        }
        print!("{}", coverage.table());
        println!("{}: {compared:?}, {:.0} s", address.name(), begun.elapsed().as_secs_f64());
        Ok(())
    });
}

fn session(
    address: Address,
    index: u64,
    coverage: &mut Coverage,
    compared: &mut Compared,
) -> Result<(), BenchError> {
    let boot = u8::try_from(index % 256).unwrap_or(0);
    let mut bench = HexBench::new(&Image::committed(address), boot)?;
    let mut generator = Generator::new(SEED, address, index, false);
    while bench.world().coverage.packages() < PACKAGES_A_SESSION {
        match generator.next(bench.world()) {
            Move::Act(action) => bench.perform(action)?,
            Move::Ticks(count) => bench.ticks(count, None)?,
            Move::Burst(_) | Move::Events(..) => {}
        }
    }
    compared.add(&bench);
    coverage.add(&bench.world().coverage);
    coverage.sessions += 1;
    Ok(())
}

#[test]
fn the_timing_page_tells_what_the_flashed_images_take() {
    // The simulator is exact to the cycle, so what was printed once must come out again.
    let page = read(&workspace().join("docs/firmware-timing.md"));
    let measured =
        timing::tables_of_the_committed_images().unwrap_or_else(|error| panic!("{error}"));
    let missing: Vec<&str> =
        measured.lines().filter(|line| !page.lines().any(|told| told == *line)).collect();
    assert!(
        missing.is_empty(),
        "docs/firmware-timing.md is of other images: print it anew by the example firmware-timing\n{}",
        missing.join("\n")
    );
}
