//! The corpus of the fuzz target, replayed. The target itself: `cargo fuzz run detect` (stable compilers need
//! `RUSTC_BOOTSTRAP=1`).
#![allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, clippy::cast_sign_loss)]

#[path = "../fuzz/src/detect.rs"]
mod detect;

#[test]
fn detect_corpus() {
    let folder = format!("{}/fuzz/corpus/detect", env!("CARGO_MANIFEST_DIR"));
    let entries = std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{folder}: {error}"));
    let mut inputs: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    inputs.sort();
    assert!(!inputs.is_empty(), "{folder} is empty");
    for path in inputs {
        let input = std::fs::read(&path).unwrap();
        // The name is printed if the test fails.
        println!("{}", path.display());
        detect::drive(&input);
        // The beginnings of an input are inputs too.
        for length in [0, 11, 12, input.len() / 2] {
            detect::drive(&input[..length.min(input.len())]);
        }
    }
}
