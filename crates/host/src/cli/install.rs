//! Files of ours in the folders of this user.

use std::fs;
use std::path::Path;

use super::diagnostics::{Failure, Result};

/// Writes a file, and makes its folder where it is not there.
pub(crate) fn write(path: &Path, content: &[u8]) -> Result<()> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(|error| Failure::file("make", folder, &error))?;
    }
    fs::write(path, content).map_err(|error| Failure::file("write", path, &error))
}

/// The system names no folders for this user.
pub(crate) fn no_home() -> Failure {
    Failure::new("this system names no home folder for you")
        .hint("leave --install away, and write to a file of your choice")
}
