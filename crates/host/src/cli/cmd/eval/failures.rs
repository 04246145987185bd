//! Pictures of what was found, missed and false.

use std::fs;
use std::path::{Path, PathBuf};

use rsapien_vision::evaluate::{PictureScore, Truth};
use rsapien_vision::{Ellipse, Picture, draw};

use crate::cli::cmd::detect::save;
use crate::cli::diagnostics::{Failure, Result};

const FOUND_COLOR: draw::Color = draw::ELLIPSE_COLOR;
const MISSED_COLOR: draw::Color = [255, 32, 32];
const FALSE_COLOR: draw::Color = [255, 160, 0];

/// Where the pictures go.
pub(super) struct Failures {
    folder: PathBuf,
}

impl Failures {
    pub(super) fn new(folder: &Path) -> Self {
        Self { folder: folder.to_owned() }
    }

    /// Writes a picture to its set's folder. What need not be found is drawn in no case.
    pub(super) fn write(
        &self,
        set: &str,
        mut picture: Picture,
        found: &[Ellipse],
        truth: &Truth,
        score: &PictureScore,
        overlap_min: f64,
    ) -> Result<()> {
        for (index, ellipse) in found.iter().enumerate() {
            let is_ignored =
                || truth.ignore.iter().any(|other| ellipse.overlap(other) >= overlap_min);
            if score.matches.iter().any(|pair| pair.found == index) {
                draw::ellipse(&mut picture, ellipse, FOUND_COLOR);
            } else if !is_ignored() {
                draw::ellipse(&mut picture, ellipse, FALSE_COLOR);
            }
        }
        for (index, ellipse) in truth.ellipses.iter().enumerate() {
            if !score.matches.iter().any(|pair| pair.truth == index) {
                draw::ellipse(&mut picture, ellipse, MISSED_COLOR);
            }
        }
        let folder = self.folder.join(set);
        fs::create_dir_all(&folder).map_err(|error| Failure::file("make", &folder, &error))?;
        let stem = Path::new(&truth.image).file_stem().unwrap_or_default().to_string_lossy();
        save(&picture, &folder.join(format!("{stem}.png")))
    }
}
