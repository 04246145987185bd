//! Several processes on one registry, and processes that are killed.
//!
//! The children are this test program itself, running its one ignored test.

use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use rsapien_registry::language::Word;
use rsapien_registry::{
    ActionDraft, BUSY_TIMEOUT_MS, CompileOptions, Registry, RegistryError, Statement,
};
use rusqlite::Connection;

/// Tells a child which file it works on, and under which prefix it saves how many actions.
const PATH_VARIABLE: &str = "REGISTRY_TEST_PATH";
const PREFIX_VARIABLE: &str = "REGISTRY_TEST_PREFIX";
const COUNT_VARIABLE: &str = "REGISTRY_TEST_COUNT";

fn numbered(prefix: &str, number: u32) -> ActionDraft {
    let mut draft = ActionDraft::new(
        format!("{prefix}{number}"),
        vec![
            Statement::parse_short("tilt-left+right-arm-up:500").unwrap(),
            Statement::play("wave", 2),
        ],
    );
    draft.description = format!("number {number} of {prefix}");
    draft
}

/// Saves actions one by one and tells of each when it is committed.
#[test]
#[ignore = "the child of the other tests"]
fn child_that_saves() {
    let Ok(path) = std::env::var(PATH_VARIABLE) else { return };
    let prefix = std::env::var(PREFIX_VARIABLE).unwrap();
    let count: u32 = std::env::var(COUNT_VARIABLE).unwrap().parse().unwrap();
    let mut registry = Registry::open(path).unwrap();
    let mut out = std::io::stdout();
    for number in 0..count {
        registry.save(&numbered(&prefix, number)).unwrap();
        writeln!(out, "\ncommitted {number}").unwrap();
        out.flush().unwrap();
        // An action that all children save in turn.
        let mut shared = numbered(&prefix, number);
        shared.name = Word::new("shared");
        registry.save(&shared).unwrap();
    }
}

fn child(path: &Path, prefix: &str, count: u32) -> Child {
    Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "child_that_saves", "--ignored", "--nocapture", "--test-threads=1"])
        .env(PATH_VARIABLE, path)
        .env(PREFIX_VARIABLE, prefix)
        .env(COUNT_VARIABLE, count.to_string())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap()
}

/// The number of a line that tells of a commit; a last line may be cut short by the kill.
fn committed(line: &str) -> Option<u32> {
    line.strip_prefix("committed ")?.strip_suffix('\n')?.parse().ok()
}

fn check_integrity(path: &Path) {
    let connection = Connection::open(path).unwrap();
    let told: String =
        connection.query_row("PRAGMA integrity_check", [], |row| row.get(0)).unwrap();
    assert_eq!(told, "ok");
    let broken = connection.prepare("PRAGMA foreign_key_check").unwrap().exists([]).unwrap();
    assert!(!broken, "foreign keys point nowhere");
}

#[test]
fn processes_write_at_once_from_the_first_open_on() {
    const CHILDREN: usize = 3;
    const COUNT: u32 = 15;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("registry.sqlite");
    let prefix = |index: usize| format!("p{index}-");
    let children: Vec<Child> =
        (0..CHILDREN).map(|index| child(&path, &prefix(index), COUNT)).collect();
    for child in children {
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    }
    let registry = Registry::open(&path).unwrap();
    for index in 0..CHILDREN {
        for number in 0..COUNT {
            let draft = numbered(&prefix(index), number);
            assert_eq!(registry.get(&draft.name.text).unwrap().draft().unwrap(), draft);
        }
    }
    let versions: Vec<u32> =
        registry.history("shared").unwrap().into_iter().map(|it| it.version).collect();
    assert!(versions.into_iter().eq(1..=u32::try_from(CHILDREN).unwrap() * COUNT));
    assert_eq!(registry.history("wave").unwrap().len(), 1, "the seed library came once");
    check_integrity(&path);
}

#[test]
fn a_writer_waits_and_a_reader_does_not() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("registry.sqlite");
    drop(Registry::open(&path).unwrap());
    let holder = Connection::open(&path).unwrap();
    holder.execute_batch("BEGIN IMMEDIATE").unwrap();

    let begun = Instant::now();
    let mut registry = Registry::open(&path).unwrap();
    assert!(registry.compile("wave", &CompileOptions::default()).is_ok());
    assert!(begun.elapsed() < Duration::from_millis(BUSY_TIMEOUT_MS), "reading waited");
    let draft = ActionDraft::new("late", vec![Statement::wait(1)]);
    let error = registry.save(&draft).unwrap_err();
    assert!(matches!(error, RegistryError::Busy { waited_ms: BUSY_TIMEOUT_MS, .. }), "{error}");
    assert!(begun.elapsed() >= Duration::from_millis(BUSY_TIMEOUT_MS));
    holder.execute_batch("ROLLBACK").unwrap();
    assert_eq!(registry.save(&draft).unwrap(), 1);
}

/// Steele, Lea and Flood's `SplitMix64`, enough to choose moments.
struct Moments(u64);

impl Moments {
    fn below(&mut self, bound: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (mixed ^ (mixed >> 31)) % bound
    }
}

/// Kills at moments from a seed: the process's number, or `REGISTRY_TEST_SEED`.
#[test]
fn what_was_committed_outlasts_kill_9() {
    let seed = std::env::var("REGISTRY_TEST_SEED").ok().and_then(|seed| seed.parse().ok());
    let seed: u64 = seed.unwrap_or_else(|| u64::from(std::process::id()));
    println!("REGISTRY_TEST_SEED={seed}");
    let mut moments = Moments(seed);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("registry.sqlite");
    let mut reported_in_all = 0;
    let mut kept: Vec<ActionDraft> = Vec::new();
    for round in 0..12 {
        // Every third round begins with no file, and half of those are killed while it is made.
        if round % 3 == 0 {
            kept.clear();
            for ending in ["", "-wal", "-shm"] {
                let name = format!("registry.sqlite{ending}");
                let _ = std::fs::remove_file(folder.path().join(name));
            }
        }
        let lines_first = if round % 6 == 0 { 0 } else { 1 + moments.below(12) };
        let delay_us = moments.below(if lines_first == 0 { 20_000 } else { 3000 });
        let prefix = format!("r{round}-");
        let mut child = child(&path, &prefix, 1000);
        let mut output = BufReader::new(child.stdout.take().unwrap());
        let mut reported = Vec::new();
        while reported.len() < usize::try_from(lines_first).unwrap() {
            let mut line = String::new();
            assert!(output.read_line(&mut line).unwrap() > 0, "the child ended by itself");
            reported.extend(committed(&line));
        }
        std::thread::sleep(Duration::from_micros(delay_us));
        child.kill().unwrap();
        let mut rest = String::new();
        output.read_to_string(&mut rest).unwrap();
        child.wait().unwrap();
        reported.extend(rest.split_inclusive('\n').filter_map(committed));
        println!("round {round}: {} reported, killed {delay_us} us later", reported.len());

        assert!(reported.iter().copied().eq(0..u32::try_from(reported.len()).unwrap()));
        reported_in_all += reported.len();
        kept.extend(reported.iter().map(|number| numbered(&prefix, *number)));
        let registry = Registry::open(&path).unwrap();
        for draft in &kept {
            assert_eq!(&registry.get(&draft.name.text).unwrap().draft().unwrap(), draft);
        }
        // At most the one action whose report the kill cut off.
        let stored =
            registry.list().unwrap().iter().filter(|it| it.name.starts_with(&prefix)).count();
        assert!(stored - reported.len() <= 1, "{stored} stored");
        assert_eq!(registry.history("wave").unwrap().len(), 1);
        drop(registry);
        check_integrity(&path);
    }
    assert!(reported_in_all >= 10, "the kills came before anything was committed");
}
