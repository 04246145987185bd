//! The detector.

use std::time::Instant;

use crate::arc::Arcs;
use crate::candidate::Candidates;
use crate::chain::Chains;
use crate::detection::{Detection, StageCost, Statistics};
use crate::edges::EdgeMap;
use crate::ellipse::Ellipse;
use crate::image::GrayView;
use crate::options::{DetectorBuilder, Options, OptionsError, Region};
use crate::search::Search;
use crate::select::Selection;
use crate::shape::Shape;
use crate::stages::Stages;

/// Pixels around the predictions that [`Detector::detect_near`] looks at.
const MARGIN_PX: f64 = 16.0;
/// How far from a prediction, across its contour, [`Detector::detect_near`] begins to look, in pixels: at it, and at
/// either side, where the edges of a stroke are whose middle line it is.
const OFFSETS_PX: [f64; 5] = [0.0, 2.5, -2.5, 5.0, -5.0];
/// Least overlap of what is found with the prediction that it is found for.
const PREDICTION_OVERLAP_MIN: f64 = 0.3;

/// Finds ellipses. Keeps its buffers from picture to picture, so that in a series of pictures of one size nothing is
/// allocated once they have grown.
#[derive(Debug, Clone, Default)]
pub struct Detector {
    options: Options,
    edges: EdgeMap,
    chains: Chains,
    arcs: Arcs,
    search: Search,
    candidates: Candidates,
    selection: Selection,
    detection: Detection,
    /// Ellipses put in order.
    ordered: Vec<crate::detection::DetectedEllipse>,
    origin: (usize, usize),
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
        let region = whole(picture, self.options.region);
        self.begin(region);
        if let Some(part) = picture.part(region) {
            let start = Instant::now();
            self.edges.find(&part);
            let edges_at = Instant::now();
            self.chains.link(&self.edges);
            self.arcs.cut(&mut self.chains);
            let arcs_at = Instant::now();
            self.search.run(&self.edges, &self.arcs.all, &self.options, &mut self.candidates);
            let search_at = Instant::now();
            self.end();
            self.detection.cost = StageCost {
                edges: edges_at - start,
                arcs: arcs_at - edges_at,
                search: search_at - arcs_at,
                selection: search_at.elapsed(),
            };
        }
        &self.detection
    }

    /// Looks only for ellipses near `predictions`, such as those of the picture before: much quicker than
    /// [`detect`](Self::detect), and blind to anything else. A prediction may be off by some 7 px across its contour. The
    /// ellipses found are in the order of the predictions, and fewer where one is not there.
    pub fn detect_near(&mut self, picture: &GrayView<'_>, predictions: &[Ellipse]) -> &Detection {
        let region = whole(picture, self.options.region);
        let region = around(predictions, region).unwrap_or(Region { width: 0, ..region });
        self.begin(region);
        if let Some(part) = picture.part(region) {
            let start = Instant::now();
            self.edges.find(&part);
            let edges_at = Instant::now();
            for prediction in predictions {
                self.look_near(prediction);
            }
            let search_at = Instant::now();
            self.end();
            self.order_by(predictions);
            self.detection.cost = StageCost {
                edges: edges_at - start,
                search: search_at - edges_at,
                selection: search_at.elapsed(),
                ..StageCost::default()
            };
        }
        &self.detection
    }

    /// What lay between the stages of the last picture. Chains and arcs are missing after
    /// [`detect_near`](Self::detect_near), which does without them.
    pub fn stages(&self) -> Stages<'_> {
        Stages {
            edges: &self.edges,
            chains: &self.chains,
            arcs: &self.arcs.all,
            candidates: &self.candidates.all,
            origin: self.origin,
        }
    }

    /// Forgets the picture before.
    fn begin(&mut self, region: Region) {
        self.origin = (region.left, region.top);
        self.chains.clear();
        self.arcs.all.clear();
        self.search.clear();
        self.candidates.clear();
        let Detection { ellipses, support, .. } = &mut self.detection;
        ellipses.clear();
        support.clear();
        self.detection.truncated = false;
        self.detection.statistics = Statistics::default();
        self.detection.cost = StageCost::default();
    }

    /// Candidates for one prediction.
    fn look_near(&mut self, prediction: &Ellipse) {
        for offset_px in OFFSETS_PX {
            let ellipse = Ellipse {
                center_x_px: prediction.center_x_px - self.origin.0 as f64,
                center_y_px: prediction.center_y_px - self.origin.1 as f64,
                semi_major_px: prediction.semi_major_px + offset_px,
                semi_minor_px: prediction.semi_minor_px + offset_px,
                ..*prediction
            };
            // A shape that is none, or no longer an ellipse, is refused before anything else.
            if ellipse.semi_minor_px < self.options.semi_axis_min_px {
                continue;
            }
            let shape = Shape::from_ellipse(&ellipse);
            if shape.is_ellipse()
                && let Some(found) = self.candidates.far(&self.edges, &shape, &self.options)
            {
                self.candidates.all.push(found);
            }
        }
    }

    /// Selects, and tells where in the whole picture things are.
    fn end(&mut self) {
        let Self { selection, candidates, edges, options, detection, .. } = self;
        selection.run(candidates, edges, options, detection);
        for found in &mut detection.ellipses {
            found.ellipse = found.ellipse.shifted(self.origin);
        }
        for point in &mut detection.support {
            point.x_px += self.origin.0 as f32;
            point.y_px += self.origin.1 as f32;
        }
        detection.truncated = self.search.truncated || candidates.truncated;
        detection.statistics = Statistics {
            edge_points: edges.points.len(),
            chains: self.chains.all.len(),
            arcs: self.arcs.all.len(),
            pairs: self.search.pairs,
            candidates: candidates.tried,
            accepted: candidates.all.len(),
        };
    }

    /// Of what was found, the best for each prediction, in their order.
    fn order_by(&mut self, predictions: &[Ellipse]) {
        self.ordered.clear();
        for prediction in predictions {
            let overlaps = self.detection.ellipses.iter().enumerate();
            let best = overlaps
                .map(|(at, found)| (found.ellipse.overlap_star(prediction), at))
                .max_by(|a, b| a.0.total_cmp(&b.0));
            if let Some((overlap, at)) = best
                && overlap >= PREDICTION_OVERLAP_MIN
            {
                self.ordered.push(self.detection.ellipses.swap_remove(at));
            }
        }
        std::mem::swap(&mut self.detection.ellipses, &mut self.ordered);
    }
}

/// The part of a picture that lies in `region`; all of it without one.
fn whole(picture: &GrayView<'_>, region: Option<Region>) -> Region {
    let (width, height) = (picture.width(), picture.height());
    let Some(region) = region else { return Region { left: 0, top: 0, width, height } };
    let (left, top) = (region.left.min(width), region.top.min(height));
    Region {
        left,
        top,
        width: region.width.min(width - left),
        height: region.height.min(height - top),
    }
}

/// The smallest part of `region` that holds the predictions and a margin; `None` where there is nothing to look at.
fn around(predictions: &[Ellipse], region: Region) -> Option<Region> {
    let (mut left, mut top) = (f64::INFINITY, f64::INFINITY);
    let (mut right, mut bottom) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
    for prediction in predictions {
        let (half_width, half_height) = prediction.half_extent_px();
        left = left.min(prediction.center_x_px - half_width - MARGIN_PX);
        right = right.max(prediction.center_x_px + half_width + MARGIN_PX);
        top = top.min(prediction.center_y_px - half_height - MARGIN_PX);
        bottom = bottom.max(prediction.center_y_px + half_height + MARGIN_PX);
    }
    // Casts clip at 0 and turn what is not a number into 0.
    let clip = |from: f64, to: f64, first: usize, length: usize| {
        let start = (from.floor() as usize).clamp(first, first + length);
        let end = (to.ceil() as usize).clamp(start, first + length);
        (start, end - start)
    };
    let (left, width) = clip(left, right, region.left, region.width);
    let (top, height) = clip(top, bottom, region.top, region.height);
    (width > 0 && height > 0).then_some(Region { left, top, width, height })
}
