//! Copies of the C core in which one number is wrong: what the comparison is worth is whether it sees them.

use super::program::{Build, make, path};
use super::random::{Difference, compare_sessions};
use crate::{files, read, workspace};
use rsapien_protocol::Address;
use std::path::PathBuf;

/// Random events that a mutant has to survive to be called equal.
const EVENTS: u64 = 1_000_000;
const SEED: u64 = 4;
const HEADER: &str = "constants.h";

/// How a wrong number was met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    /// The compiler refuses the copy.
    DoesNotCompile,
    /// It differs from the model: the event in which it was seen, and of which controller.
    Differs(Address, usize),
    /// Nothing was seen.
    Survives,
}

/// The names of the numbers of `constants.h`.
///
/// # Panics
/// When the header cannot be read.
pub fn names() -> Vec<String> {
    let text = read(&workspace().join("firmware-pic/core").join(HEADER));
    let name = |line: &str| {
        let mut words = line.strip_prefix("#define ")?.split_whitespace();
        let name = words.next()?;
        words.next().map(|_| name.to_owned())
    };
    text.lines().filter_map(name).collect()
}

/// Makes the number `name` larger by one in a copy of the C core, and compares that with the model.
///
/// # Errors
/// When the copy cannot be made or compared.
pub fn try_out(name: &str) -> Result<Fate, String> {
    let folder = copy(name).map_err(|error| format!("{name}: {error}"))?;
    let out = folder.join("out");
    let programs = Address::ALL.map(|address| path(&out, address, Build::Plain));
    let mut arguments = vec![format!("OUT={}", out.display()), "CFLAGS=-O1".to_owned()];
    arguments.extend(programs.iter().map(|program| program.display().to_string()));
    if make(&folder.join("firmware-pic/port/host"), &arguments).is_err() {
        return Ok(Fate::DoesNotCompile);
    }
    for (address, program) in Address::ALL.into_iter().zip(programs) {
        match compare_sessions(&program, address, SEED, EVENTS) {
            Ok(_) => {}
            Err(Difference::Session(different)) => {
                return Ok(Fate::Differs(address, different.divergence.event_number));
            }
            Err(Difference::Program(error)) => return Err(error.to_string()),
        }
    }
    Ok(Fate::Survives)
}

fn copy(name: &str) -> std::io::Result<PathBuf> {
    let root = workspace();
    let folder = root.join("target/firmware/mutants").join(name);
    for part in ["firmware-pic/core", "firmware-pic/port/host"] {
        let to = folder.join(part);
        std::fs::create_dir_all(&to)?;
        for from in files(&root.join(part), &[".c", ".h", "Makefile"]) {
            let text = read(&from);
            let text = if from.ends_with(HEADER) { one_more(&text, name) } else { text };
            std::fs::write(to.join(from.file_name().unwrap_or_default()), text)?;
        }
    }
    Ok(folder)
}

fn one_more(text: &str, name: &str) -> String {
    let begin = format!("#define {name} ");
    let line = |line: &str| {
        line.strip_prefix(&begin)
            .map_or_else(|| line.to_owned(), |value| format!("{begin}({value} + 1)"))
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n") + "\n"
}
