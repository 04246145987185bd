//! The corpora of the fuzz targets, replayed. The targets themselves: `cargo fuzz run reception` and
//! `cargo fuzz run session` (stable compilers need `RUSTC_BOOTSTRAP=1`).

#[path = "../fuzz/src/reception.rs"]
mod reception;
#[path = "../fuzz/src/session.rs"]
mod session;

fn replay(target: &str, drive: fn(&[u8])) {
    let folder = format!("{}/fuzz/corpus/{target}", env!("CARGO_MANIFEST_DIR"));
    let entries = std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{folder}: {error}"));
    let mut inputs: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    inputs.sort();
    assert!(!inputs.is_empty(), "{folder} is empty");
    for path in inputs {
        let input = std::fs::read(&path).unwrap();
        // The name is printed if the test fails.
        println!("{}", path.display());
        drive(&input);
        // Every beginning of an input is an input too.
        for length in 0..input.len().min(200) {
            drive(&input[..length]);
        }
    }
}

#[test]
fn reception_corpus() {
    replay("reception", reception::drive);
}

#[test]
fn session_corpus() {
    replay("session", session::drive);
}
