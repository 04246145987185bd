//! The detector.

use std::time::Instant;

use crate::arc::Arcs;
use crate::chain::Chains;
use crate::detection::{Detection, StageCost, Statistics};
use crate::edges::EdgeMap;
use crate::ellipse::Ellipse;
use crate::image::GrayView;
use crate::options::{DetectorBuilder, Options, OptionsError};
use crate::search::Search;
use crate::select::{Selection, select};

/// Finds ellipses. Keeps its buffers from picture to picture, so that in a series of pictures of one size nothing is
/// allocated once they have grown.
#[derive(Debug, Clone, Default)]
pub struct Detector {
    options: Options,
    edges: EdgeMap,
    chains: Chains,
    arcs: Arcs,
    search: Search,
    selection: Selection,
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
        let start = Instant::now();
        self.edges.find(picture);
        let edges_at = Instant::now();
        self.chains.link(&self.edges);
        self.arcs.cut(&mut self.chains, 0.8);
        let arcs_at = Instant::now();
        self.search.run(&self.edges, &self.arcs.arcs, &self.options);
        let search_at = Instant::now();
        select(
            &mut self.selection,
            &mut self.search,
            &self.edges,
            &self.options,
            &mut self.detection,
        );
        let detection = &mut self.detection;
        detection.truncated = self.search.truncated;
        detection.statistics = Statistics {
            edge_points: self.edges.points.len(),
            chains: self.chains.chains.len(),
            arcs: self.arcs.arcs.len(),
            pairs: self.search.pairs,
            candidates: self.search.tried,
            accepted: self.search.candidates.len(),
        };
        detection.cost = StageCost {
            edges: edges_at - start,
            arcs: arcs_at - edges_at,
            search: search_at - arcs_at,
            selection: search_at.elapsed(),
        };
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
