//! Random sessions into the reference model and the C core, for as long as one likes.
//!
//! ```text
//! cargo run -p rsapien-tests --release --example firmware-differential -- --events N --seed S
//! ```
//!
//! `--events` counts the events of both controllers together (10,000,000 unless said otherwise), `--seed`
//! begins anew where another run began (the clock's otherwise). `--programs FOLDER` compares the
//! programs of another folder than the one the C core is built to, `--sanitized` those that check their
//! own memory. `--broken-constants` compares copies of the C core instead, in each of which one number of
//! `constants.h` is larger by one. A session that differs is kept in `tests/regressions/firmware`, unless `--programs` says
//! that the programs are others.

use rsapien_protocol::Address;
use rsapien_tests::firmware::mutants::{self, Fate};
use rsapien_tests::firmware::program::{self, Build};
use rsapien_tests::firmware::random::{Difference, compare_sessions};
use rsapien_tests::workspace;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

struct Options {
    events: u64,
    seed: u64,
    programs: Option<PathBuf>,
    build: Build,
    broken_constants: bool,
}

fn options() -> Result<Options, String> {
    let clock = SystemTime::now().duration_since(UNIX_EPOCH).map_err(|error| error.to_string())?;
    let mut options = Options {
        events: 10_000_000,
        seed: clock.as_secs(),
        programs: None,
        build: Build::Plain,
        broken_constants: false,
    };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or_else(|| format!("{word} wants a value"));
        match word.as_str() {
            "--events" => options.events = number(&value()?)?,
            "--seed" => options.seed = number(&value()?)?,
            "--programs" => options.programs = Some(value()?.into()),
            "--sanitized" => options.build = Build::Sanitized,
            "--broken-constants" => options.broken_constants = true,
            other => return Err(format!("no such option: {other}")),
        }
    }
    Ok(options)
}

fn number(word: &str) -> Result<u64, String> {
    word.replace(['_', ','], "").parse().map_err(|_| format!("{word} is not a number"))
}

fn run() -> Result<(), String> {
    let Options { events, seed, programs, build, broken_constants } = options()?;
    if broken_constants {
        return break_constants();
    }
    let is_ours = programs.is_none();
    let folder = match programs {
        Some(folder) => folder,
        None => program::build().map_err(|error| error.to_string())?,
    };
    println!("seed {seed}, {events} events");
    let begun = Instant::now();
    let compared = std::thread::scope(|scope| {
        Address::ALL
            .map(|address| {
                let path = program::path(&folder, address, build);
                scope.spawn(move || compare_sessions(&path, address, seed, events.div_ceil(2)))
            })
            .map(|thread| thread.join().map_err(|_| "a comparison panicked".to_owned()))
    });
    let mut sum = 0;
    for (address, compared) in Address::ALL.into_iter().zip(compared) {
        match compared? {
            Ok(coverage) => {
                print!("{}", coverage.table());
                sum += coverage.event_count();
            }
            Err(Difference::Session(different)) => {
                let path = program::path(&folder, address, build);
                let failure = different.shrink(&path).map_err(|error| error.to_string())?;
                let folder = workspace().join("tests/regressions/firmware");
                let kept = if is_ours { failure.keep(address, &folder) } else { Ok(None) };
                let kept = kept.map_err(|error| error.to_string())?;
                return Err(failure.report(kept.as_deref()));
            }
            Err(Difference::Program(error)) => return Err(error.to_string()),
        }
    }
    println!("{sum} events equal in {:.1} s", begun.elapsed().as_secs_f64());
    Ok(())
}

fn break_constants() -> Result<(), String> {
    let mut survivors = 0;
    for name in mutants::names() {
        let told = match mutants::try_out(&name)? {
            Fate::DoesNotCompile => "does not compile".to_owned(),
            Fate::Differs(address, event) => format!("{} differs in event {event}", address.name()),
            Fate::Survives => {
                survivors += 1;
                "is not seen".to_owned()
            }
        };
        println!("{name:34} + 1 {told}");
    }
    println!("{survivors} of {} wrong numbers are not seen", mutants::names().len());
    Ok(())
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
