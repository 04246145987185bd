//! The log of packages as a text file.

use std::fs::File;
use std::io::{LineWriter, Write};
use std::path::Path;

use crate::PackageSink;
use crate::cli::diagnostics::{Failure, Result};

/// Writes each package to `path` as it goes over the line, one a line.
pub(super) fn to_file(path: &Path) -> Result<PackageSink> {
    let failed = |error| Failure::file("write", path, &error);
    let mut file = LineWriter::new(File::create(path).map_err(failed)?);
    writeln!(file, "# seconds, -> to the robot or <- to the PC, controller, package")
        .map_err(failed)?;
    Ok(Box::new(move |record| {
        // A full disk costs the log, not the robot's motion.
        let _ = writeln!(file, "{record}");
    }))
}
