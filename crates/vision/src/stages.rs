//! What lies between the stages of a detection, for teaching and for looking into it.

use crate::arc::Arc;
use crate::candidate::Candidate;
use crate::chain::Chains;
use crate::detection::SupportPoint;
use crate::edges::{EdgeMap, EdgePoint};
use crate::ellipse::Ellipse;

/// The stages of the last detection of a [`Detector`](crate::Detector). Coordinates are those of the whole picture.
#[derive(Debug, Clone, Copy)]
pub struct Stages<'a> {
    pub(crate) edges: &'a EdgeMap,
    pub(crate) chains: &'a Chains,
    pub(crate) arcs: &'a [Arc],
    pub(crate) candidates: &'a [Candidate],
    /// Where the part that was looked at begins, in pixels.
    pub(crate) origin: (usize, usize),
}

/// An arc, as the search sees it.
#[derive(Debug, Clone, PartialEq)]
pub struct ArcStage {
    /// Twelve points along it, `(x, y)` in pixels.
    pub points: [(f32, f32); crate::arc::SAMPLES],
    /// How far it turns, in radians.
    pub turn_rad: f32,
    /// The ellipse through it, where it turns enough to tell.
    pub ellipse: Option<Ellipse>,
}

impl<'a> Stages<'a> {
    /// The edge points, row by row.
    pub fn edge_points(self) -> impl Iterator<Item = SupportPoint> + 'a {
        self.edges.points.iter().map(move |point| self.moved(point))
    }

    /// The chains: runs of edge points, each with whether it is closed.
    pub fn chains(
        self,
    ) -> impl Iterator<Item = (impl Iterator<Item = SupportPoint> + 'a, bool)> + 'a {
        self.chains.all.iter().map(move |chain| {
            let points = &self.chains.points[chain.range.clone()];
            (points.iter().map(move |point| self.moved(point)), chain.is_ring)
        })
    }

    /// The arcs that the chains were cut to.
    pub fn arcs(self) -> impl Iterator<Item = ArcStage> + 'a {
        let (left, top) = (self.origin.0 as f32, self.origin.1 as f32);
        self.arcs.iter().map(move |arc| ArcStage {
            points: std::array::from_fn(|i| (arc.x[i] + left, arc.y[i] + top)),
            turn_rad: arc.turn_rad,
            ellipse: arc.shape.map(|shape| shape.ellipse().shifted(self.origin)),
        })
    }

    /// The candidates, best first, with their scores: before doubles and low scores are dropped and strokes put together.
    pub fn candidates(self) -> impl Iterator<Item = (Ellipse, f64)> + 'a {
        self.candidates
            .iter()
            .map(move |found| (found.shape.ellipse().shifted(self.origin), found.score))
    }

    fn moved(self, point: &EdgePoint) -> SupportPoint {
        SupportPoint {
            x_px: point.x + self.origin.0 as f32,
            y_px: point.y + self.origin.1 as f32,
            gradient_rad: point.gradient_y.atan2(point.gradient_x),
        }
    }
}
