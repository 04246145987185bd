//! Answers of other detectors.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use rsapien_vision::Ellipse;
use serde::Deserialize;

use super::sets;
use crate::cli::diagnostics::{Failure, Result};

/// Another detector's answers.
pub(super) struct Peer {
    /// The file's or the folder's name.
    pub(super) name: String,
    answers: Answers,
}

enum Answers {
    /// Of every set together.
    All(ByImage),
    /// By the name of the set.
    BySet(BTreeMap<String, ByImage>),
}

type ByImage = BTreeMap<String, Answer>;

/// What another detector found in a picture.
pub(super) struct Answer {
    pub(super) ellipses: Vec<Ellipse>,
    /// How long it took, where it is told.
    pub(super) ms: Option<f64>,
}

#[derive(Deserialize)]
struct Line {
    image: String,
    ellipses: Vec<Vec<f64>>,
    ms: Option<f64>,
}

impl Peer {
    /// Reads a file of JSON lines, or every such file of a folder.
    pub(super) fn read(path: &Path) -> Result<Self> {
        let stem = |path: &Path| {
            path.file_stem()
                .map_or_else(|| "other".into(), |name| name.to_string_lossy())
                .into_owned()
        };
        if !path.is_dir() {
            return Ok(Self { name: stem(path), answers: Answers::All(lines(path)?) });
        }
        let failed = |error| Failure::file("read", path, &error);
        let mut by_set = BTreeMap::new();
        for entry in fs::read_dir(path).map_err(failed)? {
            let file: PathBuf = entry.map_err(failed)?.path();
            if file.extension().is_some_and(|ending| ending == "jsonl") {
                by_set.insert(stem(&file), lines(&file)?);
            }
        }
        if by_set.is_empty() {
            return Err(Failure::new(format!("{} holds no answers", path.display()))
                .hint("it holds a file of JSON lines for each set, SET.jsonl"));
        }
        Ok(Self { name: stem(path), answers: Answers::BySet(by_set) })
    }

    /// What it found in a picture of a set; `None` where it was not run.
    pub(super) fn answer(&self, set: &str, image: &str) -> Option<&Answer> {
        match &self.answers {
            Answers::All(answers) => answers.get(image),
            Answers::BySet(by_set) => by_set.get(set)?.get(image),
        }
    }
}

/// The answers of a file; of several for one picture the first.
fn lines(path: &Path) -> Result<ByImage> {
    let text = fs::read_to_string(path).map_err(|error| Failure::file("read", path, &error))?;
    let mut answers = ByImage::new();
    for (index, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let wrong = |reason: &str| {
            Failure::new(format!("{}, line {}: {reason}", path.display(), index + 1))
                .hint("a line is as of rsapien detect --json")
        };
        let line: Line = serde_json::from_str(line).map_err(|error| wrong(&error.to_string()))?;
        let ellipses = line.ellipses.iter().map(|numbers| sets::ellipse(numbers));
        let ellipses: Option<Vec<_>> = ellipses.collect();
        let ellipses = ellipses.ok_or_else(|| wrong("an ellipse has fewer than five numbers"))?;
        answers.entry(line.image).or_insert(Answer { ellipses, ms: line.ms });
    }
    Ok(answers)
}
