//! Pictures that are written about a detection.

use std::path::{Path, PathBuf};

use rsapien_vision::io::save_gray_png;
use rsapien_vision::{Ellipse, GrayImage, Picture, Stages, draw, paper};

use super::search::Search;
use crate::cli::diagnostics::{self, Result};

/// Colour of the virtual ellipses among the pictures of the paper's stages.
const VIRTUAL_ELLIPSE_COLOR: draw::Color = [64, 96, 255];
/// Share of its brightness that a picture keeps beneath arcs and candidates.
const GROUND_BRIGHTNESS: f32 = 0.35;

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

/// Writes what each stage of the detector gave; `place` tells where, by the stage's name. The detector of the paper looks
/// once more for it, the default one keeps what lay between the stages of the last picture.
pub(super) fn write(
    search: &Search,
    picture: &Picture,
    gray: &GrayImage,
    ellipses: &[Ellipse],
    place: impl Fn(&str) -> PathBuf,
) -> Result<()> {
    save_gray(gray, &place("1-grey"))?;
    match search {
        Search::Default(detector) => write_default(gray, detector.stages(), &place)?,
        Search::Paper { detector, seed } => {
            write_paper(&detector.detect_with_stages(&gray.view(), *seed).1, &place)?;
        }
    }
    save(&annotated(picture, ellipses), &place("6-ellipses"))
}

fn write_default(
    gray: &GrayImage,
    stages: Stages<'_>,
    place: &impl Fn(&str) -> PathBuf,
) -> Result<()> {
    type Draw = fn(&mut Picture, Stages<'_>);
    let black = draw::stages::ground(&gray.view(), 0.0);
    let darkened = draw::stages::ground(&gray.view(), GROUND_BRIGHTNESS);
    let pictures: [(&Picture, Draw, &str); 4] = [
        (&black, draw::stages::edge_points, "2-edge-points"),
        (&black, draw::stages::chains, "3-chains"),
        (&darkened, draw::stages::arcs, "4-arcs"),
        (&darkened, draw::stages::candidates, "5-candidates"),
    ];
    for (ground, draw, stage) in pictures {
        let mut drawn = ground.clone();
        draw(&mut drawn, stages);
        save(&drawn, &place(stage))?;
    }
    Ok(())
}

fn write_paper(stages: &paper::Stages, place: &impl Fn(&str) -> PathBuf) -> Result<()> {
    save_gray(&stages.denoised, &place("2-noise-reduced"))?;
    save_gray(&stages.gradient, &place("3-gradient"))?;
    save_gray(&stages.binary, &place("4-edges"))?;
    let mut candidates = Picture::from_gray(&stages.binary.view());
    for candidate in &stages.virtual_ellipses {
        draw::ellipse(&mut candidates, &candidate.ellipse, VIRTUAL_ELLIPSE_COLOR);
    }
    save(&candidates, &place("5-virtual-ellipses"))
}
