//! From a world to a picture.

use std::sync::Arc;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::error::within;
use super::noise::NormalTable;
use super::scene::{Hit, Scene};
use super::shade::Shader;
use super::{CameraError, CameraPose, Intrinsics};
use crate::world::World;

/// Values of a pixel: red, green, blue.
const CHANNELS: usize = 3;
/// Faces remembered while a pixel is sampled finely; with more in one pixel, some are shaded again.
const FACES_KEPT: usize = 6;

/// A colour picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Red, green and blue, 0 to 255, row by row from the top left: `3 * width * height` bytes.
    pub rgb: Vec<u8>,
}

impl Picture {
    /// The picture as a binary portable pixmap (P6).
    pub fn to_ppm(&self) -> Vec<u8> {
        let mut bytes = format!("P6\n{} {}\n255\n", self.width, self.height).into_bytes();
        bytes.extend_from_slice(&self.rgb);
        bytes
    }
}

/// How a camera takes pictures.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CameraSettings {
    /// Size and pinhole.
    pub intrinsics: Intrinsics,
    /// A pixel on a contour is the mean of this many rays squared, 1 to 16. Other pixels take one ray.
    pub samples_per_axis: u32,
    /// Standard deviation of the lens's blur in pixels, 0 to 8.
    pub blur_sigma_px: f64,
    /// Standard deviation of the sensor's noise in grey levels, 0 to 100.
    pub noise_sigma: f64,
    /// Seed of the noise.
    pub seed: u64,
}

impl Default for CameraSettings {
    fn default() -> Self {
        Self {
            intrinsics: Intrinsics::default(),
            samples_per_axis: 4,
            blur_sigma_px: 0.5,
            noise_sigma: 1.5,
            seed: 1,
        }
    }
}

/// A camera with checked settings.
#[derive(Debug, Clone)]
pub struct Camera {
    settings: CameraSettings,
    blur: Vec<f32>,
    noise: Arc<NormalTable>,
}

/// A pixel's first look: which face, and its colour.
#[derive(Clone, Copy, PartialEq)]
struct Look {
    face: u32,
    colour: [f32; CHANNELS],
}

impl Camera {
    /// A camera with these settings.
    ///
    /// # Errors
    /// [`CameraError::OutOfRange`] names the first setting outside its documented limits.
    pub fn new(settings: CameraSettings) -> Result<Self, CameraError> {
        settings.intrinsics.check()?;
        within("the number of rays per axis", f64::from(settings.samples_per_axis), 1.0, 16.0)?;
        within("the blur (pixels)", settings.blur_sigma_px, 0.0, 8.0)?;
        within("the noise (grey levels)", settings.noise_sigma, 0.0, 100.0)?;
        let blur = gaussian(settings.blur_sigma_px);
        Ok(Self { settings, blur, noise: Arc::new(NormalTable::new()) })
    }

    /// The settings.
    pub fn settings(&self) -> &CameraSettings {
        &self.settings
    }

    /// Takes the picture number `frame` of the world from `pose`.
    ///
    /// The same world, pose, settings and frame number give the same bytes, whatever the number of threads.
    pub fn render(&self, world: &World, pose: &CameraPose, frame: u64) -> Picture {
        let Intrinsics { width, height, .. } = self.settings.intrinsics;
        let scene = Scene::new(world, self.settings.intrinsics, *pose);
        let shader = Shader::new(&scene);
        let looks = self.first_looks(&scene, &shader);
        let sharp = self.refined(&scene, &shader, &looks);
        let mut values = self.blurred(sharp);
        let mut rgb = vec![0; values.len()];
        let row_length = width as usize * CHANNELS;
        #[allow(clippy::cast_possible_truncation)] // a standard deviation of at most 100
        let sigma = self.settings.noise_sigma as f32;
        let rows = rgb.par_chunks_mut(row_length).zip(values.par_chunks_mut(row_length));
        rows.zip(0..height).for_each(|((bytes, values), row)| {
            if sigma > 0.0 {
                self.noise.add_to_row(values, sigma, self.settings.seed, frame, u64::from(row));
            }
            for (byte, value) in bytes.iter_mut().zip(values) {
                // The cast saturates, so values below 0 and above 255 are clipped as by a sensor.
                #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
                (*byte = (*value + 0.5) as u8);
            }
        });
        Picture { width, height, rgb }
    }

    /// One ray through the middle of every pixel.
    fn first_looks(&self, scene: &Scene<'_>, shader: &Shader<'_, '_>) -> Vec<Look> {
        let Intrinsics { width, height, .. } = self.settings.intrinsics;
        let mut looks =
            vec![Look { face: 0, colour: [0.0; CHANNELS] }; width as usize * height as usize];
        looks.par_chunks_mut(width as usize).zip(0..height).for_each(|(row, y)| {
            for (look, x) in row.iter_mut().zip(0..width) {
                let (x, y) = (f64::from(x), f64::from(y));
                let direction = scene.direction(x, y);
                let hit = scene.first_hit(x, y, &direction);
                *look = Look { face: face_number(hit), colour: shader.colour(&direction, hit) };
            }
        });
        looks
    }

    /// The picture with the pixels on contours sampled finely.
    fn refined(&self, scene: &Scene<'_>, shader: &Shader<'_, '_>, looks: &[Look]) -> Vec<f32> {
        let Intrinsics { width, height, .. } = self.settings.intrinsics;
        let width = width as usize;
        let same_face_around = |x: usize, y: usize| {
            let (top, bottom) = (y.saturating_sub(1), (y + 1).min(height as usize - 1));
            let (left, right) = (x.saturating_sub(1), (x + 1).min(width - 1));
            let face = looks[y * width + x].face;
            (top..=bottom).all(|y| {
                looks[y * width + left..=y * width + right].iter().all(|look| look.face == face)
            })
        };
        let mut values = vec![0.0; looks.len() * CHANNELS];
        values.par_chunks_mut(width * CHANNELS).enumerate().for_each(|(y, row)| {
            for (x, pixel) in row.chunks_exact_mut(CHANNELS).enumerate() {
                let colour = if same_face_around(x, y) {
                    looks[y * width + x].colour
                } else {
                    self.fine_look(scene, shader, looks[y * width + x], (x, y))
                };
                pixel.copy_from_slice(&colour);
            }
        });
        values
    }

    /// The mean over an even grid of rays through one pixel.
    ///
    /// Each face in the pixel is shaded once and weighs as many rays as meet it: the place of a contour is as exact
    /// as with every ray shaded, for the price of two or three.
    fn fine_look(
        &self,
        scene: &Scene<'_>,
        shader: &Shader<'_, '_>,
        middle: Look,
        (x, y): (usize, usize),
    ) -> [f32; CHANNELS] {
        let count = self.settings.samples_per_axis;
        let offset = |index: u32| (f64::from(index) + 0.5) / f64::from(count) - 0.5;
        #[allow(clippy::cast_precision_loss)] // at most 1920
        let (x, y) = (x as f64, y as f64);
        let (mut known, mut next) = ([middle; FACES_KEPT], 1);
        let mut sum = [0.0; CHANNELS];
        for (row, column) in (0..count).flat_map(|row| (0..count).map(move |column| (row, column)))
        {
            let (x, y) = (x + offset(column), y + offset(row));
            let direction = scene.direction(x, y);
            let hit = scene.first_hit(x, y, &direction);
            let face = face_number(hit);
            let look = known.iter().find(|look| look.face == face).copied();
            let look = look.unwrap_or_else(|| {
                let look = Look { face, colour: shader.colour(&direction, hit) };
                known[next % FACES_KEPT] = look;
                next += 1;
                look
            });
            for (sum, value) in sum.iter_mut().zip(look.colour) {
                *sum += value;
            }
        }
        #[allow(clippy::cast_precision_loss)] // at most 256
        let weight = 1.0 / (count * count) as f32;
        sum.map(|value| value * weight)
    }

    /// Blur along the rows, then along the columns; the edge pixels stand in for what is outside.
    fn blurred(&self, sharp: Vec<f32>) -> Vec<f32> {
        let reach = self.blur.len() / 2;
        if reach == 0 {
            return sharp;
        }
        let width = self.settings.intrinsics.width as usize;
        let height = self.settings.intrinsics.height as usize;
        let row_length = width * CHANNELS;
        let mut along = vec![0.0; sharp.len()];
        along.par_chunks_mut(row_length).zip(sharp.par_chunks(row_length)).for_each(
            |(target, source)| {
                for (x, pixel) in target.chunks_exact_mut(CHANNELS).enumerate() {
                    for (place, weight) in self.blur.iter().enumerate() {
                        let from = (x + place).saturating_sub(reach).min(width - 1) * CHANNELS;
                        for (value, other) in pixel.iter_mut().zip(&source[from..from + CHANNELS]) {
                            *value += weight * other;
                        }
                    }
                }
            },
        );
        let mut both = sharp;
        both.par_chunks_mut(row_length).enumerate().for_each(|(y, target)| {
            target.fill(0.0);
            for (place, weight) in self.blur.iter().enumerate() {
                let from = (y + place).saturating_sub(reach).min(height - 1) * row_length;
                for (value, other) in target.iter_mut().zip(&along[from..from + row_length]) {
                    *value += weight * other;
                }
            }
        });
        both
    }
}

/// A number for each face of each object, 0 for the backdrop.
fn face_number(hit: Option<Hit<'_, '_>>) -> u32 {
    hit.map_or(0, |hit| ((u32::from(hit.surface.index) + 1) << 8) | u32::from(hit.face as u8))
}

/// Weights of a Gaussian of this standard deviation, out to three of them.
fn gaussian(sigma: f64) -> Vec<f32> {
    /// Less blur than this changes no value by a grey level.
    const LEAST_SIGMA: f64 = 0.05;
    if sigma < LEAST_SIGMA {
        return vec![1.0];
    }
    // At most 24, for the largest blur allowed.
    #[allow(clippy::cast_possible_truncation)]
    let reach = (3.0 * sigma).ceil() as i32;
    let weights: Vec<f64> =
        (-reach..=reach).map(|x| (-0.5 * (f64::from(x) / sigma).powi(2)).exp()).collect();
    let sum: f64 = weights.iter().sum();
    #[allow(clippy::cast_possible_truncation)] // to the precision of a picture
    weights.iter().map(|weight| (weight / sum) as f32).collect()
}
