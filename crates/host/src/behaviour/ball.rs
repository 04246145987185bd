//! Looking for a ball and turning the head until it is centred.

use rsapien_vision::paper::{DetectedEllipse, Detection, Detector, Options};
use rsapien_vision::{GrayImage, OptionsError};

use super::{Direction, Head, Pinhole, contour_share};

/// A ball is the only thing that looks round from everywhere: plates and cups seen from the side are flatter.
const ROUNDNESS_MIN: f64 = 0.85;
/// Part of a contour that has to be one; see [`contour_share`].
const CONTOUR_SHARE_MIN: f64 = 0.7;
/// Edge points that a candidate needs for each pixel of the smallest contour looked for. A whole contour has 1.2 to 1.7,
/// since it is two pixels thick or more after the threshold; the ellipse that stands for a cluster may have fewer.
const POINTS_PER_PX_MIN: f64 = 0.8;

/// Narrower than the paper's 20: the outline of the ball and that of its shadow are clusters of their own.
const CLUSTER_DISTANCE_MAX: f64 = 8.0;

/// How a ball is looked for.
#[derive(Clone, Debug)]
pub struct BallSearch {
    /// The detector; see [`BallSearch::new`] for one that looks for balls of a size.
    pub detector: Detector,
    /// The camera.
    pub pinhole: Pinhole,
    /// Least ratio of the semi-axes of what is taken for a ball, `0..=1`.
    pub roundness_min: f64,
    /// Least share of its contour across which the brightness changes, `0..=1`: see [`contour_share`].
    pub contour_share_min: f64,
    /// The ball is centred when it is this near to the optical axis, in pixels.
    pub centered_px: f64,
    /// Most pictures taken to centre a ball once it is seen, before the scan goes on.
    pub centering_looks_max: u32,
    /// Where to look for it, in this order.
    pub scan: Vec<Direction>,
    /// Seed of the detector's search; picture number `n` is searched with `seed + n`.
    pub seed: u64,
}

/// One look: a picture and what was found in it.
#[derive(Clone, Debug)]
pub struct Sight {
    /// The number of the look, from 1.
    pub number: u32,
    /// Where the head looked.
    pub direction: Direction,
    /// Everything found.
    pub detection: Detection,
    /// What was taken for the ball.
    pub ball: Option<DetectedEllipse>,
}

/// How a search ended that saw the ball.
#[derive(Clone, Debug)]
pub struct BallFound {
    /// The look at which it was first seen, from 1.
    pub first_seen: u32,
    /// The last look, with the ball in it.
    pub sight: Sight,
    /// How far the ball's centre is from the optical axis in the last look, in pixels.
    pub offset_px: f64,
    /// Whether that is near enough.
    pub is_centered: bool,
}

impl BallSearch {
    /// A search on a low table for a ball whose radius in the picture is `radius_px` (least, greatest), in pixels.
    ///
    /// # Errors
    /// The detector's, for radii outside 1 to 2000 pixels or in the wrong order.
    pub fn new(pinhole: Pinhole, radius_px: (f32, f32)) -> Result<BallSearch, OptionsError> {
        let (least, greatest) = radius_px;
        let mut options = Options::paper();
        options.hough.semi_major_min_px = least;
        options.hough.semi_major_max_px = greatest;
        options.hough.semi_minor_min_px = least;
        options.hough.semi_minor_max_px = greatest;
        options.cluster.distance_max = CLUSTER_DISTANCE_MAX;
        let points = f64::from(least) * std::f64::consts::TAU * POINTS_PER_PX_MIN;
        // The cast clips at 0; the detector refuses a radius that is too large.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        (options.filter.quality_min = (points as u32).max(1));
        let pans = [0.0, 45.0, -45.0, 85.0, -85.0];
        let tilts = [-20.0, -42.0];
        let scan = tilts.iter().flat_map(|&tilt| pans.map(|pan| Direction::new(pan, tilt)));
        Ok(BallSearch {
            detector: Detector::new(options)?,
            pinhole,
            roundness_min: ROUNDNESS_MIN,
            contour_share_min: CONTOUR_SHARE_MIN,
            centered_px: 3.0,
            centering_looks_max: 8,
            scan: scan.collect(),
            seed: 1,
        })
    }

    /// Scans until a ball is seen and turns the head until it is centred; `on_sight` is told every look. Returns none
    /// when the whole scan shows no ball.
    ///
    /// A ball that stays lost while it is being centred is looked for along the rest of the scan.
    ///
    /// # Errors
    /// Those of `head`.
    pub fn run<H: Head>(
        &self,
        head: &mut H,
        mut on_sight: impl FnMut(&Sight),
    ) -> Result<Option<BallFound>, H::Error> {
        let mut number = 0;
        let mut look = |head: &mut H, to: Direction| {
            number += 1;
            let sight = self.look(head, to, number)?;
            on_sight(&sight);
            Ok(sight)
        };
        for &direction in &self.scan {
            let mut sight = look(head, direction)?;
            if sight.ball.is_none() {
                continue;
            }
            let first_seen = sight.number;
            for looks_left in (0..=self.centering_looks_max).rev() {
                // Where it was lost another picture is taken: noise and seed are new.
                let mut to = sight.direction;
                if let Some(ball) = sight.ball {
                    let (x, y) = (ball.ellipse.center_x_px, ball.ellipse.center_y_px);
                    let offset_px = self.pinhole.offset_px(x, y);
                    let is_centered = offset_px <= self.centered_px;
                    if is_centered || looks_left == 0 {
                        return Ok(Some(BallFound { first_seen, sight, offset_px, is_centered }));
                    }
                    to = self.pinhole.centering(sight.direction, x, y).within_reach();
                }
                sight = look(head, to)?;
            }
        }
        Ok(None)
    }

    fn look<H: Head>(&self, head: &mut H, to: Direction, number: u32) -> Result<Sight, H::Error> {
        let direction = head.look(to)?;
        let picture = head.see()?;
        let seed = self.seed.wrapping_add(u64::from(number));
        let detection = self.detector.detect(&picture.view(), seed);
        let ball = self.ball_of(&picture, &detection);
        Ok(Sight { number, direction, detection, ball })
    }

    /// The round ellipse that is a contour most of all.
    fn ball_of(&self, picture: &GrayImage, detection: &Detection) -> Option<DetectedEllipse> {
        let is_round = |found: &&DetectedEllipse| {
            found.ellipse.semi_minor_px >= self.roundness_min * found.ellipse.semi_major_px
        };
        let with_share = |found: &DetectedEllipse| (contour_share(picture, &found.ellipse), *found);
        let round = detection.ellipses.iter().filter(is_round).map(with_share);
        let (share, ball) = round.max_by(|one, other| one.0.total_cmp(&other.0))?;
        (share >= self.contour_share_min).then_some(ball)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A head whose camera sees one bright disc on a dark ground, in the direction `disc`.
    struct DiscWorld {
        disc: Direction,
        looks_at: Direction,
        turns: Vec<Direction>,
    }

    const RADIUS_PX: f64 = 30.0;

    impl DiscWorld {
        fn with_disc_at(pan_deg: f64, tilt_deg: f64) -> DiscWorld {
            let disc = Direction::new(pan_deg, tilt_deg);
            DiscWorld { disc, looks_at: Direction::default(), turns: Vec::new() }
        }
    }

    impl Head for DiscWorld {
        type Error = std::convert::Infallible;

        fn look(&mut self, to: Direction) -> Result<Direction, Self::Error> {
            self.looks_at = to;
            self.turns.push(to);
            Ok(to)
        }

        #[allow(clippy::cast_precision_loss)]
        fn see(&mut self) -> Result<GrayImage, Self::Error> {
            let focal = pinhole().focal_px.0;
            let pan = (self.disc.pan_deg - self.looks_at.pan_deg).to_radians();
            let tilt = (self.looks_at.tilt_deg - self.disc.tilt_deg).to_radians();
            let (x, y) = (159.5 + focal * pan.tan(), 119.5 + focal * tilt.tan());
            let pixel = |index: usize| {
                let (px, py) = ((index % 320) as f64, (index / 320) as f64);
                if pan.abs() < 1.2 && (px - x).hypot(py - y) < RADIUS_PX { 220 } else { 60 }
            };
            Ok(GrayImage::new((0..320 * 240).map(pixel).collect(), 320, 240).unwrap())
        }
    }

    fn pinhole() -> Pinhole {
        Pinhole::with_field_of_view(320, 240, 60.0)
    }

    fn search() -> BallSearch {
        BallSearch::new(pinhole(), (20.0, 60.0)).unwrap()
    }

    #[test]
    fn a_ball_at_the_side_is_found_and_centred() {
        let mut world = DiscWorld::with_disc_at(35.0, -14.0);
        let mut looks = 0;
        let found = search().run(&mut world, |_| looks += 1).unwrap().unwrap();
        assert!(found.is_centered && found.offset_px <= 3.0, "{found:?}");
        assert_eq!((found.first_seen, looks), (2, found.sight.number));
        let at = found.sight.direction;
        assert!((at.pan_deg - 35.0).abs() < 0.7 && (at.tilt_deg + 14.0).abs() < 0.7, "{at:?}");
    }

    #[test]
    fn a_ball_beyond_the_heads_reach_ends_the_search_uncentred() {
        let mut world = DiscWorld::with_disc_at(105.0, -20.0);
        let found = search().run(&mut world, |_| ()).unwrap().unwrap();
        assert!(!found.is_centered && found.offset_px > 50.0, "{found:?}");
        assert_eq!((found.first_seen, found.sight.number), (4, 12));
        assert!(world.turns.iter().all(|to| *to == to.within_reach()));
    }

    #[test]
    fn without_a_ball_every_direction_is_looked_at_once() {
        let mut world = DiscWorld::with_disc_at(180.0, 0.0);
        assert!(search().run(&mut world, |_| ()).unwrap().is_none());
        assert_eq!(world.turns, search().scan);
    }
}
