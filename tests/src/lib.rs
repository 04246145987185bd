//! Helpers for the tests across crates.

pub mod firmware;
pub mod library;

use std::path::{Path, PathBuf};

/// The top folder of the checkout.
pub fn workspace() -> PathBuf {
    let mut folder = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    folder.pop();
    folder
}

/// Every file below `folder` whose name ends in one of `endings`, in order, but for what is built or
/// fetched.
///
/// # Panics
/// When a folder cannot be read.
pub fn files(folder: &Path, endings: &[&str]) -> Vec<PathBuf> {
    const NOT_OURS: [&str; 4] = ["target", "artifacts", "__pycache__", "rsapien-demo"];
    let mut found = Vec::new();
    let entries =
        std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    for entry in entries {
        let path = entry.expect("a folder can be read").path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() && !name.starts_with('.') && !NOT_OURS.contains(&name.as_str()) {
            found.extend(files(&path, endings));
        } else if path.is_file()
            && path.extension().is_none_or(|extension| extension != "so")
            && endings.iter().any(|ending| name.ends_with(ending))
        {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// The text of a file.
///
/// # Panics
/// When it cannot be read.
pub fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The part of a Rust file that is not tests: what stands before its test module.
pub fn without_tests(text: &str) -> &str {
    text.split("#[cfg(test)]\nmod tests {").next().unwrap_or(text)
}

/// Whether a Rust file is a module that only tests compile: `tests.rs`, or one that its parent declares
/// behind `#[cfg(test)]`.
///
/// # Panics
/// When the parent cannot be read.
pub fn is_test_module(path: &Path) -> bool {
    let (Some(folder), Some(stem)) = (path.parent(), path.file_stem()) else { return false };
    let stem = stem.to_string_lossy();
    let parents = [folder.with_extension("rs"), folder.join("mod.rs"), folder.join("lib.rs")];
    let declared = format!("#[cfg(test)]\nmod {stem};");
    let is_behind_test =
        parents.iter().any(|parent| parent.exists() && read(parent).contains(&declared));
    is_behind_test
        || folder.ends_with("tests")
        || (folder.with_extension("rs").exists() && is_test_module(folder))
}
