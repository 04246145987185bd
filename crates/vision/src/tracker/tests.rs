//! A scripted scene instead of pictures: what the finder says is known, so what the tracks make of it can be judged.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::*;
use crate::detection::DetectedEllipse;
use crate::image::GrayImage;

const INTERVAL_S: f64 = 0.04;

/// Says what is in the scene now, near the predictions or anywhere.
struct Scene {
    now: Vec<Ellipse>,
    noise_px: f64,
    random: Pcg64Mcg,
    detection: Detection,
    fresh_looks: u32,
}

impl Scene {
    fn new(noise_px: f64) -> Self {
        Self {
            now: Vec::new(),
            noise_px,
            random: Pcg64Mcg::seed_from_u64(7),
            detection: Detection::default(),
            fresh_looks: 0,
        }
    }

    fn tell(&mut self, seen: &[Ellipse]) -> &Detection {
        self.detection.ellipses.clear();
        for ellipse in seen {
            // Evenly distributed with the standard deviation wanted.
            let reach = self.noise_px * 3.0_f64.sqrt();
            let mut noise = || reach * (2.0 * self.random.random::<f64>() - 1.0);
            let ellipse = Ellipse {
                center_x_px: ellipse.center_x_px + noise(),
                center_y_px: ellipse.center_y_px + noise(),
                semi_major_px: ellipse.semi_major_px + noise(),
                semi_minor_px: ellipse.semi_minor_px + noise(),
                ..*ellipse
            }
            .canonical();
            self.detection.ellipses.push(detected(ellipse));
        }
        &self.detection
    }
}

/// As it might come from a detector.
pub(super) fn detected(ellipse: Ellipse) -> DetectedEllipse {
    DetectedEllipse {
        ellipse,
        score: 0.9,
        support_share: 1.0,
        inside_share: 1.0,
        gap_share: 0.0,
        gradient_agreement: 0.9,
        log10_false_alarms: -20.0,
        residual_px: 0.3,
        stroke_width_px: None,
        support: 0..0,
        covariance: None,
    }
}

impl Finder for Scene {
    fn detect(&mut self, _: &GrayView<'_>) -> &Detection {
        self.fresh_looks += 1;
        let seen = self.now.clone();
        self.tell(&seen)
    }

    fn detect_near(&mut self, _: &GrayView<'_>, predictions: &[Ellipse]) -> &Detection {
        let near = |prediction: &Ellipse| {
            let best = self
                .now
                .iter()
                .max_by(|a, b| prediction.overlap(a).total_cmp(&prediction.overlap(b)));
            best.copied().filter(|best| prediction.overlap(best) > 0.3)
        };
        let seen: Vec<Ellipse> = predictions.iter().filter_map(near).collect();
        self.tell(&seen)
    }
}

/// A tracker over a scene.
struct Film {
    scene: Scene,
    tracks: Tracks,
    picture: GrayImage,
    pictures: u32,
}

impl Film {
    fn new(noise_px: f64) -> Self {
        Self {
            scene: Scene::new(noise_px),
            tracks: Tracks::new(TrackerOptions::default()),
            picture: GrayImage::new(vec![0; 640 * 480], 640, 480).unwrap(),
            pictures: 0,
        }
    }

    fn show(&mut self, now: &[Ellipse]) -> &[Track] {
        self.scene.now = now.to_vec();
        let time_s = f64::from(self.pictures) * INTERVAL_S;
        self.pictures += 1;
        self.tracks.advance(&mut self.scene, &self.picture.view(), time_s)
    }

    /// Identity of the confirmed track on each of these ellipses.
    fn ids(&self, ellipses: &[Ellipse]) -> Vec<Option<u64>> {
        let on = |ellipse: &Ellipse| {
            let mut tracks = self.tracks.all().iter();
            tracks
                .find(|t| t.state == TrackState::Confirmed && t.ellipse.overlap(ellipse) > 0.8)
                .map(|track| track.id)
        };
        ellipses.iter().map(on).collect()
    }
}

pub(super) fn ellipse(x: f64, y: f64, a: f64, b: f64, theta_rad: f64) -> Ellipse {
    Ellipse { center_x_px: x, center_y_px: y, semi_major_px: a, semi_minor_px: b, theta_rad }
}

/// Five ellipses, moved.
fn five(dx: f64, dy: f64) -> Vec<Ellipse> {
    [
        (100.0, 90.0, 40.0),
        (250.0, 120.0, 25.0),
        (400.0, 100.0, 30.0),
        (160.0, 300.0, 50.0),
        (420.0, 290.0, 25.0),
    ]
    .iter()
    .map(|&(x, y, a)| ellipse(x + dx, y + dy, a, 0.8 * a, 0.4))
    .collect()
}

#[test]
fn identities_last_through_a_crossing_and_missed_pictures() {
    let mut film = Film::new(0.2);
    for i in 0..60 {
        let x = f64::from(i) * 6.0;
        let going = ellipse(100.0 + x, 200.0, 30.0, 30.0, 0.0);
        let coming = ellipse(460.0 - x, 206.0, 30.0, 28.0, 0.0);
        // They meet at picture 30; the one behind is hidden for three pictures.
        let hidden = (29..32).contains(&i);
        let now = if hidden { vec![going] } else { vec![going, coming] };
        film.show(&now);
        if (1..29).contains(&i) || i > 34 {
            assert_eq!(film.ids(&now), [Some(0), Some(1)], "picture {i}: {:?}", film.tracks.all());
        }
    }
    assert_eq!(film.tracks.all().len(), 2);
}

#[test]
fn smoothed_is_nearer_to_the_truth_than_measured() {
    let mut film = Film::new(0.3);
    let mut squares = [[0.0; 2]; 3];
    for i in 0..100 {
        let t = f64::from(i);
        // Turning slowly, through the angle at which the axis has gone half a turn.
        let truth = ellipse(80.0 + 4.0 * t, 100.0 + 2.0 * t, 40.0 + 0.05 * t, 25.0, 2.8 + 0.01 * t);
        let track = film.show(&[truth])[0].clone();
        let measured = film.scene.detection.ellipses[0].ellipse;
        let errors = |e: &Ellipse| {
            [
                e.center_x_px - truth.center_x_px,
                e.center_y_px - truth.center_y_px,
                e.semi_minor_px - truth.semi_minor_px,
            ]
        };
        if i >= 10 {
            let both = errors(&track.ellipse).into_iter().zip(errors(&measured));
            for (sums, (smoothed, raw)) in squares.iter_mut().zip(both) {
                sums[0] += smoothed * smoothed;
                sums[1] += raw * raw;
            }
            let turn_rad =
                crate::ellipse::axis_difference_rad(truth.theta_rad, track.ellipse.theta_rad);
            assert!(turn_rad.abs() < 0.05, "picture {i}: {turn_rad}");
        }
    }
    for [smoothed, raw] in squares {
        assert!(smoothed < 0.75 * raw, "{squares:?}");
    }
    let [vx, vy] = film.tracks.all()[0].velocity_px_per_s;
    assert!((vx - 100.0).abs() < 10.0 && (vy - 50.0).abs() < 10.0, "{vx} {vy}");
}

#[test]
fn a_sudden_turn_is_followed() {
    let mut film = Film::new(0.2);
    for i in 0..60_i32 {
        // To the right at 10 pixels a picture, and at once back again.
        let x = 100.0 + 10.0 * f64::from(30 - (i - 30).abs());
        let truth = ellipse(x, 200.0, 25.0, 20.0, 0.3);
        film.show(&[truth]);
        if i > 1 {
            assert_eq!(film.ids(&[truth]), [Some(0)], "picture {i}: {:?}", film.tracks.all());
        }
    }
}

#[test]
fn a_moved_camera_keeps_the_identities() {
    let mut film = Film::new(0.2);
    let ids: Vec<Option<u64>> = (0..5).map(Some).collect();
    for _ in 0..11 {
        film.show(&five(0.0, 0.0));
    }
    assert_eq!(film.ids(&five(0.0, 0.0)), ids);
    film.show(&five(85.0, 60.0));
    assert_eq!(film.tracks.look(), Look::NearThenFresh);
    // Nothing for a picture while it moves on.
    film.show(&[]);
    film.show(&five(-60.0, 35.0));
    assert_eq!(film.ids(&five(-60.0, 35.0)), ids, "{:?}", film.tracks.all());
}

#[test]
fn equal_discs_in_disorder_keep_their_identities_too() {
    let mut film = Film::new(0.2);
    let discs = |shift_px: f64| -> Vec<Ellipse> {
        let mut random = Pcg64Mcg::seed_from_u64(3);
        let cell = |i: u32| {
            let (column, row) = (f64::from(i % 8), f64::from(i / 8));
            let (x, y) = (70.0 * column + 35.0, 70.0 * row + 35.0);
            let mut stray = || 40.0 * random.random::<f64>();
            ellipse(x + stray() + shift_px, y + stray(), 12.0, 12.0, 0.0)
        };
        (0..48).map(cell).collect()
    };
    for _ in 0..4 {
        film.show(&discs(0.0));
    }
    film.show(&discs(47.0));
    assert_eq!(film.ids(&discs(47.0)), (0..48).map(Some).collect::<Vec<_>>());
}

#[test]
fn another_scene_is_followed_within_three_pictures() {
    let mut film = Film::new(0.2);
    for _ in 0..11 {
        film.show(&five(0.0, 0.0));
    }
    let other: Vec<Ellipse> =
        (0..4).map(|i| ellipse(90.0 + 130.0 * f64::from(i), 400.0, 45.0, 15.0, 1.2)).collect();
    for _ in 0..3 {
        film.show(&other);
    }
    let found = film.ids(&other);
    assert!(found.iter().all(|id| id.is_some_and(|id| id >= 5)), "{found:?}");
    for _ in 0..6 {
        film.show(&other);
    }
    assert_eq!(film.tracks.all().len(), 4, "the old ones are gone");
}

#[test]
fn a_calm_scene_is_looked_at_afresh_every_eighth_picture() {
    let mut film = Film::new(0.2);
    for i in 0..64 {
        film.show(&five(f64::from(i), 0.0));
    }
    assert_eq!(film.scene.fresh_looks, 8);
    // One more comes in and is found by the next of these.
    let mut more = five(63.0, 0.0);
    more.push(ellipse(320.0, 420.0, 30.0, 20.0, 0.0));
    for _ in 0..9 {
        film.show(&more);
    }
    assert_eq!(film.ids(&more).last(), Some(&Some(5)));
}

#[test]
fn nothing_found_is_no_track_and_one_that_leaves_ends() {
    let mut film = Film::new(0.2);
    for _ in 0..5 {
        assert!(film.show(&[]).is_empty());
    }
    for i in 0..60 {
        let x = 560.0 + 5.0 * f64::from(i);
        let ball = [ellipse(x, 200.0, 20.0, 20.0, 0.0)];
        film.show(if x < 640.0 { &ball } else { &[] });
    }
    assert!(film.tracks.all().is_empty(), "{:?}", film.tracks.all());
    // Who comes next is somebody else.
    for _ in 0..2 {
        film.show(&five(0.0, 0.0)[..1]);
    }
    assert_eq!(film.ids(&five(0.0, 0.0)[..1]), [Some(1)]);
}

#[test]
fn two_tracks_do_not_settle_on_one_ellipse() {
    let mut film = Film::new(0.1);
    for i in 0..40_i32 {
        // The right one comes near the left one and disappears behind it for good.
        let left = ellipse(200.0, 200.0, 30.0, 30.0, 0.0);
        let right = ellipse(290.0 - 5.0 * f64::from(i), 200.0, 30.0, 30.0, 0.0);
        let both = [left, right];
        film.show(if i < 16 { &both } else { &both[..1] });
    }
    assert_eq!(film.tracks.all().iter().map(|track| track.id).collect::<Vec<_>>(), [0]);
}

#[test]
fn strange_times_and_another_size_do_no_harm() {
    let mut film = Film::new(0.2);
    for time_s in [0.0, 0.04, f64::NAN, 0.08, -5.0, -4.96, f64::INFINITY, -4.9, 1e300, 0.0] {
        film.scene.now = five(0.0, 0.0);
        film.tracks.advance(&mut film.scene, &film.picture.view(), time_s);
    }
    assert_eq!(film.tracks.all().len(), 5);
    let small = GrayImage::new(vec![0; 320 * 240], 320, 240).unwrap();
    let tracks = film.tracks.advance(&mut film.scene, &small.view(), 0.04);
    assert!(tracks.iter().all(|track| track.age == 1), "{tracks:?}");
}

#[test]
fn options_are_checked_by_name() {
    let refused =
        |options| Tracker::new(Detector::default(), options).map(|_| ()).unwrap_err().to_string();
    let options = TrackerOptions { fresh_every: 0, ..TrackerOptions::default() };
    assert_eq!(refused(options), "option tracker.fresh_every is 0, allowed is 1 to 1000");
    let options = TrackerOptions { noise_px: f64::NAN, ..TrackerOptions::default() };
    assert!(refused(options).contains("tracker.noise_px"));
}
