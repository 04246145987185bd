//! What a detection gives.

use std::ops::Range;
use std::time::Duration;

use crate::ellipse::Ellipse;

/// One ellipse of a [`Detection`].
#[derive(Debug, Clone, PartialEq)]
pub struct DetectedEllipse {
    /// The ellipse, in canonical form.
    pub ellipse: Ellipse,
    /// The estimated probability that it is the contour of something elliptic, `0..=1`: a logistic regression on the
    /// evidence below, fitted to rendered scenes and photographs with truth (`docs/detector.md` tells which).
    pub score: f64,
    /// The share of the contour inside the picture along which an edge was found within 1.5 px and in its direction,
    /// in stretches of 7 px at least, `0..=1`.
    pub support_share: f64,
    /// The share of the contour that is inside the picture, `0..=1`.
    pub inside_share: f64,
    /// The longest stretch without an edge, as a share of the contour inside the picture, `0..=1`.
    pub gap_share: f64,
    /// Mean cosine of the angle between the gradient at those edges and the normal of the ellipse, `0..=1`.
    pub gradient_agreement: f64,
    /// Decimal logarithm of the number of ellipses as well supported as this that a picture of this size would show
    /// by chance, were its gradients independent and uniform (a-contrario: Desolneux, Moisan and Morel, "From
    /// Gestalt Theory to Image Analysis", 2008). The lower the better; above 0 means that chance explains it.
    pub log10_false_alarms: f64,
    /// Root mean square distance of the support points from the ellipse, in pixels.
    pub residual_px: f64,
    /// Width in pixels of the drawn stroke whose middle line this is; `None` for an edge.
    pub stroke_width_px: Option<f64>,
    /// Where in [`Detection::support`] the points on this contour are; empty unless
    /// [`Options::support_points`](crate::Options::support_points) asks for them.
    pub support: Range<usize>,
    /// Covariance of `[center_x_px, center_y_px, semi_major_px, semi_minor_px, theta_rad]`, in products of pixels
    /// and radians, from the support points' distances; `None` unless
    /// [`Options::covariance`](crate::Options::covariance) asks for it. The angle of a circle is undetermined and its
    /// variance large.
    pub covariance: Option<[[f64; 5]; 5]>,
}

/// An edge point on a contour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SupportPoint {
    /// Pixels from the centre of the leftmost column.
    pub x_px: f32,
    /// Pixels down from the centre of the topmost row.
    pub y_px: f32,
    /// Direction of the gradient, from dark to bright: radians from +x towards +y.
    pub gradient_rad: f32,
}

/// Wall time of each stage.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct StageCost {
    /// Smoothing, gradient and edge points.
    pub edges: Duration,
    /// Edge points to chains, chains to arcs.
    pub arcs: Duration,
    /// Candidates: single arcs, pairs and votes.
    pub search: Duration,
    /// Suppression of doubles, strokes, scores.
    pub selection: Duration,
}

impl StageCost {
    /// The stages by name in their order.
    pub fn by_stage(&self) -> [(&'static str, Duration); 4] {
        [
            ("edges", self.edges),
            ("arcs", self.arcs),
            ("search", self.search),
            ("selection", self.selection),
        ]
    }

    /// All stages together.
    pub fn total(&self) -> Duration {
        self.by_stage().iter().map(|(_, cost)| *cost).sum()
    }
}

/// What a detection did, in counts.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Edge points, with positions between pixels.
    pub edge_points: usize,
    /// Chains of edge points.
    pub chains: usize,
    /// Elliptic arcs.
    pub arcs: usize,
    /// Pairs of arcs that voted.
    pub pairs: usize,
    /// Candidates that were looked at along their contour.
    pub candidates: usize,
    /// Ellipses before doubles and strokes were put together.
    pub accepted: usize,
}

/// What a detection found.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Detection {
    /// The ellipses, best score first.
    pub ellipses: Vec<DetectedEllipse>,
    /// The edge points on the contours, ellipse by ellipse; see [`DetectedEllipse::support`].
    pub support: Vec<SupportPoint>,
    /// Whether the budget of a detection was used up, so that ellipses may be missing. Only crowded pictures (moiré,
    /// dense text, noise) meet it.
    pub truncated: bool,
    /// Counts of what was done.
    pub statistics: Statistics,
    /// Time spent.
    pub cost: StageCost,
}

impl Detection {
    /// Forgets the picture before, and keeps the buffers.
    pub(crate) fn begin(&mut self) {
        self.ellipses.clear();
        self.support.clear();
        self.truncated = false;
        self.statistics = Statistics::default();
        self.cost = StageCost::default();
    }

    /// Adds the counts of a part of the picture.
    pub(crate) fn add(&mut self, part: &Self) {
        self.truncated |= part.truncated;
        self.statistics.edge_points += part.statistics.edge_points;
        self.statistics.candidates += part.statistics.candidates;
        self.statistics.accepted += part.statistics.accepted;
    }

    /// The support points of one of the ellipses; empty for one of another detection.
    pub fn support_of(&self, detected: &DetectedEllipse) -> &[SupportPoint] {
        self.support.get(detected.support.clone()).unwrap_or_default()
    }
}
