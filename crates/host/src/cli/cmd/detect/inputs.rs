//! Which pictures are meant: files, the pictures in folders, patterns that no shell has filled in.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use rsapien_vision::Picture;
use rsapien_vision::io::FILE_BYTES_MAX;

use crate::cli::diagnostics::{self, Failure, Result};

/// Ends of the names that pictures in a folder have.
const ENDINGS: [&str; 8] = ["png", "jpg", "jpeg", "bmp", "pnm", "pgm", "ppm", "pbm"];

/// The standard input.
const STANDARD_INPUT: &str = "-";

/// Whether this name stands for the standard input.
pub(super) fn is_standard_input(path: &Path) -> bool {
    path == Path::new(STANDARD_INPUT)
}

/// The pictures meant by what was given, in its order, and what was given in vain.
pub(super) fn pictures(given: &[PathBuf]) -> (Vec<PathBuf>, Vec<Failure>) {
    let (mut found, mut failures) = (Vec::new(), Vec::new());
    for path in given {
        match expand(path) {
            Ok(pictures) => found.extend(pictures),
            Err(failure) => failures.push(failure),
        }
    }
    (found, failures)
}

fn expand(path: &Path) -> Result<Vec<PathBuf>> {
    if is_standard_input(path) || path.is_file() {
        return Ok(vec![path.to_owned()]);
    }
    if path.is_dir() {
        let found = in_folder(path)?;
        return if found.is_empty() {
            Err(Failure::new(format!("{} is a folder without pictures", path.display()))
                .hint(format!("a picture's name ends in {}", ENDINGS.join(", "))))
        } else {
            Ok(found)
        };
    }
    match path.to_str() {
        Some(pattern) if pattern.contains(['*', '?', '[']) && !path.exists() => by_pattern(pattern),
        // What is not there is told when it is to be read.
        _ => Ok(vec![path.to_owned()]),
    }
}

/// The pictures of a folder, by name.
pub(in crate::cli::cmd) fn in_folder(folder: &Path) -> Result<Vec<PathBuf>> {
    let failed = |error| Failure::file("read", folder, &error);
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        if ending.is_some_and(|ending| ENDINGS.contains(&ending.as_str())) && path.is_file() {
            found.push(path);
        }
    }
    found.sort_unstable();
    Ok(found)
}

fn by_pattern(pattern: &str) -> Result<Vec<PathBuf>> {
    let paths = glob::glob(pattern).map_err(|error| {
        Failure::new(format!("{pattern} is no pattern of names: {error}"))
            .hint("`*` stands for any letters, `?` for one, `[abc]` for one of these, `**` for any folders")
    })?;
    let found: Vec<PathBuf> =
        paths.filter_map(std::result::Result::ok).filter(|path| path.is_file()).collect();
    if found.is_empty() {
        return Err(Failure::new(format!("no file is called {pattern}"))
            .hint("it is looked for from the current folder"));
    }
    Ok(found)
}

/// Reads a picture; every failure names the file.
pub(in crate::cli::cmd) fn read(path: &Path) -> Result<Picture> {
    let decoded = if is_standard_input(path) {
        let mut bytes = Vec::new();
        std::io::stdin()
            .take(FILE_BYTES_MAX)
            .read_to_end(&mut bytes)
            .map_err(|error| Failure::file("read", path, &error))?;
        Picture::decode(&bytes)
    } else if path.metadata().is_ok_and(|file| file.is_file() && file.len() == 0) {
        return Err(Failure::new(format!("{} is empty", path.display())));
    } else {
        Picture::open(path)
    };
    decoded.map_err(|error| diagnostics::picture(path, &error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_and_patterns_become_their_pictures_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        for name in ["b.PNG", "a.jpg", "c.txt", "a[1].png"] {
            fs::write(place(name), "").unwrap();
        }
        fs::create_dir(place("empty.png")).unwrap();
        let (found, failures) = pictures(&[
            folder.path().to_owned(),
            place("?.*"),
            place("a[1].png"),
            place("empty.png"),
            place("z*.png"),
            place("not-there.png"),
            PathBuf::from("-"),
        ]);
        let names: Vec<_> =
            found.iter().map(|path| path.file_name().unwrap().to_string_lossy()).collect();
        let expected = [
            "a.jpg",
            "a[1].png",
            "b.PNG",
            "a.jpg",
            "b.PNG",
            "c.txt",
            "a[1].png",
            "not-there.png",
            "-",
        ];
        assert_eq!(names, expected);
        let told: Vec<_> = failures.iter().map(ToString::to_string).collect();
        assert!(told[0].contains("without pictures") && told[1].contains("z*.png"), "{told:?}");
        assert_eq!(told.len(), 2);
    }
}
