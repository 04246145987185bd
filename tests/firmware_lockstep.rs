//! The C core against the reference model, in lock step: after every byte, every interrupt and every
//! tick both must transmit, drive, report and count the same.

use rsapien_protocol::{Address, CountersReport};
use rsapien_tests::firmware::bench::{Bench, LockstepBench};
use rsapien_tests::firmware::compare::{Failure, compare};
use rsapien_tests::firmware::coverage::Coverage;
use rsapien_tests::firmware::event::Event;
use rsapien_tests::firmware::mutants::{self, Fate};
use rsapien_tests::firmware::program::{self, Build, Program};
use rsapien_tests::firmware::random::{Difference, compare_sessions};
use rsapien_tests::firmware::scenario::Scenario;
use rsapien_tests::firmware::vectors::{self, Brought};
use rsapien_tests::workspace;
use std::fmt::Write as _;
use std::path::PathBuf;

/// Where sessions that differed are kept, and replayed from before anything else.
const REGRESSIONS: &str = "tests/regressions/firmware";
/// Seeds of the random sessions that every run compares.
const SEEDS: [u64; 3] = [1, 20_061, 0x5_EED0];
/// Events that every seed compares for either controller.
const EVENTS_A_SEED: u64 = 1_000_000;

fn program_path(address: Address, build: Build) -> PathBuf {
    let folder = program::build().unwrap_or_else(|error| panic!("{error}"));
    program::path(&folder, address, build)
}

/// Compares what a bench wrote down with both builds of the C core.
#[track_caller]
fn check(address: Address, origin: &str, bench: &LockstepBench) {
    for build in [Build::Plain, Build::Sanitized] {
        let path = program_path(address, build);
        let mut program = Program::start(&path, address).unwrap_or_else(|error| panic!("{error}"));
        if let Some(found) = compare(&mut program, address, &bench.events, &bench.records) {
            let failure =
                Failure::shrink(&path, address, origin.to_owned(), &bench.events, found).unwrap();
            panic!("{}", failure.report(None));
        }
    }
}

fn play(folder: &str) -> Vec<Scenario> {
    let scenarios = Scenario::all_of(folder);
    let mut errors = String::new();
    for scenario in &scenarios {
        let mut bench = LockstepBench::new(scenario.address, 0);
        let played = scenario.play(&mut bench);
        // What differs tells more than what the model was expected to do.
        check(scenario.address, &scenario.name, &bench);
        if let Err(error) = played {
            let _ = writeln!(errors, "{error}");
        }
    }
    assert!(errors.is_empty(), "the model does not do what scenarios expect:\n{errors}");
    scenarios
}

#[test]
fn sessions_that_differed_once() {
    play(REGRESSIONS);
}

#[test]
fn scenarios() {
    let scenarios = play("tests/scenarios");
    for address in Address::ALL {
        let count = scenarios.iter().filter(|scenario| scenario.address == address).count();
        println!("{count} scenarios of the {} controller", address.name());
        assert!(count >= 10, "the scenarios of the {} controller are gone", address.name());
    }
}

#[test]
fn vectors_of_reception() {
    let streams = vectors::streams();
    assert!(streams.len() >= 15);
    for stream in streams {
        let mut bench = LockstepBench::new(stream.address, 0);
        bench.ticks(1, None).unwrap();
        let mut now_ms = stream.events.first().map_or(0, |(at_ms, _)| *at_ms);
        for (at_ms, brought) in &stream.events {
            (now_ms..*at_ms).for_each(|_| bench.tick());
            now_ms = *at_ms;
            match brought {
                Brought::Bytes(bytes) => bytes.iter().for_each(|byte| {
                    bench.happen(Event::Byte(*byte));
                    let inputs = bench.world().inputs;
                    bench.happen(Event::MainRoutine(inputs));
                }),
                Brought::LineError(error) => bench.happen(Event::LineError(*error)),
            }
        }
        (0..8).for_each(|_| bench.tick());
        check(stream.address, &stream.name, &bench);
        // The model counts as the vector says, and so then does the C core.
        let counters = bench.world().reference.counters();
        let [accepted, resets, crc_errors, framing_errors, overruns, errors] = stream.counts;
        let counted = (counters.accepted, counters.resets, counters.crc_errors);
        assert_eq!(counted, (accepted, resets, crc_errors), "{}", stream.name);
        let counted = (counters.framing_errors, counters.overruns);
        assert_eq!(counted, (framing_errors, overruns), "{}", stream.name);
        let told = match bench.world().reference.report() {
            rsapien_protocol::Report::Motion(report) => report.reception_errors,
            rsapien_protocol::Report::Camera(report) => report.reception_errors,
            other => panic!("not a controller's own report: {other:?}"),
        };
        assert_eq!(u16::from(told), errors, "{}", stream.name);
    }
}

#[test]
fn vectors_of_action_packages() {
    for package in vectors::packages("action_packages") {
        let mut bench = LockstepBench::new(package.address, 0);
        package.line.iter().for_each(|byte| bench.happen(Event::Byte(*byte)));
        (0..8).for_each(|_| bench.tick());
        check(package.address, &package.name, &bench);
        let answer = bench.world().answer.expect("every intact package is answered");
        if let Some(status) = package.refused_status {
            assert_eq!(answer.status.byte(), status, "{}", package.name);
        }
    }
}

#[test]
fn vectors_of_synchronization_packages() {
    // What one controller says, the other and it itself must not take for theirs. The scenario
    // `answers-of-the-vectors` makes the controllers say them.
    for package in vectors::packages("synchronization_packages") {
        for address in Address::ALL {
            let mut bench = LockstepBench::new(address, 6);
            package.line.iter().for_each(|byte| bench.happen(Event::Byte(*byte)));
            (0..8).for_each(|_| bench.tick());
            check(address, &package.name, &bench);
            assert_eq!(bench.world().answer_count, 0, "{}", package.name);
            assert_eq!(
                bench.world().reference.counters(),
                CountersReport::default(),
                "{}",
                package.name
            );
        }
    }
}

#[test]
fn random_sessions() {
    println!("seeds {SEEDS:?}, {EVENTS_A_SEED} events of either controller each");
    let compared = std::thread::scope(|scope| {
        Address::ALL
            .map(|address| scope.spawn(move || compare_seeds(address)))
            .map(|thread| thread.join().unwrap())
    });
    let mut sum = 0;
    for coverage in compared {
        let coverage = coverage.unwrap_or_else(|told| panic!("{told}"));
        print!("{}", coverage.table());
        assert_eq!(coverage.missing(), Vec::<String>::new(), "the sessions are not deep enough");
        sum += coverage.event_count();
    }
    println!("{sum} events, equal in the model and in the C core");
    assert!(sum >= 1_000_000);
}

fn compare_seeds(address: Address) -> Result<Coverage, String> {
    let mut coverage = Coverage::new(address);
    for (index, seed) in SEEDS.into_iter().enumerate() {
        let build = if index == 0 { Build::Sanitized } else { Build::Plain };
        let path = program_path(address, build);
        match compare_sessions(&path, address, seed, EVENTS_A_SEED) {
            Ok(seen) => coverage.add(&seen),
            Err(Difference::Session(different)) => {
                let failure = different.shrink(&path).map_err(|error| error.to_string())?;
                let kept = failure.keep(address, &workspace().join(REGRESSIONS)).unwrap();
                return Err(failure.report(kept.as_deref()));
            }
            Err(Difference::Program(error)) => return Err(error.to_string()),
        }
    }
    Ok(coverage)
}

#[test]
fn one_wrong_number_in_c_is_seen() {
    // Every number can be tried by the example `firmware-differential -- --broken-constants`.
    for name in ["BUMPER_DEBOUNCE_TESTS", "FULL_TRAVEL_MS_TILT", "HOME_SETTLE_MS"] {
        let fate = mutants::try_out(name).unwrap_or_else(|error| panic!("{error}"));
        println!("{name} + 1: {fate:?}");
        assert!(matches!(fate, Fate::Differs(..)), "{name}: {fate:?}");
    }
}
