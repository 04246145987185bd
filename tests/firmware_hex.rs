//! The third leg of the comparison: the images that are flashed, in gpsim, against the reference model.
//! Every byte transmitted must be equal, and the pins within a tick.
//!
//! Needs the feature `firmware-simulator`, and the bridge: `make -C firmware-pic/sim`. What is missing is
//! a failure here, not a skip: a machine without gpsim leaves the feature away.

use rsapien_protocol::Address;
use rsapien_tests::firmware::bench::{Bench, BenchError};
use rsapien_tests::firmware::coverage::Coverage;
use rsapien_tests::firmware::gpsim::Image;
use rsapien_tests::firmware::hex::HexBench;
use rsapien_tests::firmware::random::{Generator, Move};
use rsapien_tests::firmware::scenario::Scenario;
use rsapien_tests::firmware::timing;
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
