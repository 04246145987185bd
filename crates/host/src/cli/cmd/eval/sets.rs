//! Folders of pictures whose ellipses are known.

use std::fs;
use std::path::{Path, PathBuf};

use rsapien_vision::Ellipse;
use rsapien_vision::evaluate::Truth;
use serde::Deserialize;

use crate::cli::diagnostics::{Failure, Result};

/// Pictures of one kind, and what there is to find in them.
pub(super) struct Set {
    /// The folder's name.
    pub(super) name: String,
    folder: PathBuf,
    /// One a picture, by the name of its file.
    pub(super) truths: Vec<Truth>,
}

/// What a file in `gt/` holds.
#[derive(Deserialize)]
struct TruthFile {
    image: String,
    ellipses: Vec<Vec<f64>>,
    #[serde(default)]
    ignore: Vec<Vec<f64>>,
}

/// The ellipse of the numbers `[cx, cy, a, b, theta]`; more of them are left alone.
pub(super) fn ellipse(numbers: &[f64]) -> Option<Ellipse> {
    let [x, y, major, minor, theta_rad] = *numbers.first_chunk()?;
    let ellipse = Ellipse {
        center_x_px: x,
        center_y_px: y,
        semi_major_px: major,
        semi_minor_px: minor,
        theta_rad,
    };
    Some(ellipse.canonical())
}

/// The sets of these folders, in their order, those within a folder by name.
pub(super) fn find(folders: &[PathBuf]) -> Result<Vec<Set>> {
    let mut sets = Vec::new();
    for folder in folders {
        if is_set(folder) {
            sets.push(Set::read(folder)?);
            continue;
        }
        let below = entries(folder)?;
        let mut below = below.iter().filter(|path| is_set(path)).peekable();
        if below.peek().is_none() {
            return Err(Failure::new(format!("{} holds no pictures with truth", folder.display()))
                .hint("name a folder that holds images/ and gt/, or one of such folders"));
        }
        for set in below {
            sets.push(Set::read(set)?);
        }
    }
    Ok(sets)
}

fn is_set(folder: &Path) -> bool {
    folder.join("images").is_dir() && folder.join("gt").is_dir()
}

/// What is in a folder, by name.
fn entries(folder: &Path) -> Result<Vec<PathBuf>> {
    let failed = |error| Failure::file("read", folder, &error);
    let entries = fs::read_dir(folder).map_err(failed)?;
    let mut paths: Vec<PathBuf> = entries
        .map(|entry| entry.map(|entry| entry.path()).map_err(failed))
        .collect::<Result<_>>()?;
    paths.sort_unstable();
    Ok(paths)
}

impl Set {
    fn read(folder: &Path) -> Result<Self> {
        let is_truth = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "json");
        let files = entries(&folder.join("gt"))?;
        let truths: Vec<Truth> = files
            .iter()
            .filter(|path| is_truth(path))
            .map(|path| truth(path))
            .collect::<Result<_>>()?;
        if truths.is_empty() {
            return Err(Failure::new(format!("{} holds no truth", folder.join("gt").display()))
                .hint("it holds a JSON file for each picture of images/"));
        }
        // `.` and `..` have a name once they are resolved.
        let whole = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
        let name = whole.file_name().map_or_else(|| "set".into(), |name| name.to_string_lossy());
        Ok(Self { name: name.into_owned(), folder: folder.to_owned(), truths })
    }

    /// Where the picture is.
    pub(super) fn image(&self, truth: &Truth) -> PathBuf {
        self.folder.join("images").join(&truth.image)
    }
}

fn truth(path: &Path) -> Result<Truth> {
    let text = fs::read_to_string(path).map_err(|error| Failure::file("read", path, &error))?;
    let wrong = |reason: &str| {
        Failure::new(format!("{}: {reason}", path.display())).hint(
            "a truth is {\"image\": name, \"ellipses\": [[cx, cy, a, b, theta], ...], \"ignore\": [...]}",
        )
    };
    let file: TruthFile = serde_json::from_str(&text).map_err(|error| wrong(&error.to_string()))?;
    let ellipses = |rows: &[Vec<f64>]| {
        rows.iter()
            .map(|row| ellipse(row).ok_or_else(|| wrong("an ellipse has fewer than five numbers")))
            .collect::<Result<Vec<_>>>()
    };
    Ok(Truth {
        ellipses: ellipses(&file.ellipses)?,
        ignore: ellipses(&file.ignore)?,
        image: file.image,
    })
}
