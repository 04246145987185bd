//! Pictures that are written about a detection.

use std::path::{Path, PathBuf};

use rsapien_vision::io::save_gray_png;
use rsapien_vision::paper::Stages;
use rsapien_vision::{Ellipse, GrayImage, Picture, draw};

use crate::cli::diagnostics::{self, Result};

/// Colour of the virtual ellipses among the pictures of the stages.
const VIRTUAL_ELLIPSE_COLOR: draw::Color = [64, 96, 255];

/// The picture with the ellipses drawn.
pub(super) fn annotated(picture: &Picture, ellipses: &[Ellipse]) -> Picture {
    let mut drawn = picture.clone();
    draw::annotate(&mut drawn, ellipses);
    drawn
}

/// Writes a picture as PNG.
pub(in crate::cli::cmd) fn save(picture: &Picture, path: &Path) -> Result<()> {
    picture.save_png(path).map_err(|error| diagnostics::picture(path, &error))
}

/// Writes a grey picture as PNG.
pub(in crate::cli::cmd) fn save_gray(gray: &GrayImage, path: &Path) -> Result<()> {
    save_gray_png(gray, path).map_err(|error| diagnostics::picture(path, &error))
}

/// Writes what each stage of the paper's detector gave; `place` tells where, by the stage's name.
pub(super) fn write(
    picture: &Picture,
    gray: &GrayImage,
    ellipses: &[Ellipse],
    stages: &Stages,
    place: impl Fn(&str) -> PathBuf,
) -> Result<()> {
    save_gray(gray, &place("1-grey"))?;
    save_gray(&stages.denoised, &place("2-noise-reduced"))?;
    save_gray(&stages.gradient, &place("3-gradient"))?;
    save_gray(&stages.binary, &place("4-edges"))?;
    let mut candidates = Picture::from_gray(&stages.binary.view());
    for candidate in &stages.virtual_ellipses {
        draw::ellipse(&mut candidates, &candidate.ellipse, VIRTUAL_ELLIPSE_COLOR);
    }
    save(&candidates, &place("5-virtual-ellipses"))?;
    save(&annotated(picture, ellipses), &place("6-ellipses"))
}
