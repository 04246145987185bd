//! The life of tracks: predicted, looked for, corrected, confirmed, lost.

use super::association::Association;
use super::filter::{Filter, Sighting};
use super::shift::ShiftSearch;
use super::{Finder, Look, Track, TrackState, TrackerOptions};
use crate::detection::Detection;
use crate::ellipse::Ellipse;
use crate::image::GrayView;

/// After a gap of more than these seconds the whole picture is looked at, and nothing is known of velocities.
const GAP_MAX_S: f64 = 0.5;
/// A longer interval counts as this one.
const INTERVAL_MAX_S: f64 = 10.0;

/// All tracks and the buffers of an update.
#[derive(Debug, Clone)]
pub(super) struct Tracks {
    options: TrackerOptions,
    all: Vec<Track>,
    next_id: u64,
    size_px: (usize, usize),
    time_s: Option<f64>,
    interval_s: f64,
    /// Pictures since the last fresh look.
    since_fresh: u32,
    /// Whether most of the confirmed tracks were lost in the last picture.
    is_unsettled: bool,
    look: Look,
    predictions: Vec<Ellipse>,
    sightings: Vec<Sighting>,
    association: Association,
    shift: ShiftSearch,
}

impl Tracks {
    pub(super) fn new(options: TrackerOptions) -> Self {
        Self {
            options,
            all: Vec::new(),
            next_id: 0,
            size_px: (0, 0),
            time_s: None,
            interval_s: 0.0,
            since_fresh: 0,
            is_unsettled: false,
            look: Look::default(),
            predictions: Vec::new(),
            sightings: Vec::new(),
            association: Association::default(),
            shift: ShiftSearch::default(),
        }
    }

    pub(super) fn all(&self) -> &[Track] {
        &self.all
    }

    pub(super) fn look(&self) -> Look {
        self.look
    }

    pub(super) fn options(&self) -> &TrackerOptions {
        &self.options
    }

    pub(super) fn clear(&mut self) {
        self.all.clear();
        self.time_s = None;
        self.is_unsettled = false;
    }

    /// One picture.
    pub(super) fn advance(
        &mut self,
        finder: &mut impl Finder,
        picture: &GrayView<'_>,
        time_s: f64,
    ) -> &[Track] {
        let size_px = (picture.width(), picture.height());
        if size_px != self.size_px {
            self.clear();
            self.size_px = size_px;
        }
        self.pass_time(time_s);
        self.predict();
        let is_confirmed = |track: &Track| track.state != TrackState::Tentative;
        let is_fresh_due = !self.all.iter().any(is_confirmed)
            || self.since_fresh + 1 >= self.options.fresh_every
            || self.is_unsettled
            || self.interval_s > GAP_MAX_S;
        self.look = Look::Fresh;
        if !is_fresh_due {
            self.predictions.clear();
            self.predictions.extend(self.all.iter().map(|track| track.ellipse));
            self.look = Look::Near;
            self.sight(finder.detect_near(picture, &self.predictions));
            if self.is_lost_in_bulk(|track| track.state == TrackState::Confirmed) {
                self.look = Look::NearThenFresh;
            }
        }
        if self.look == Look::Near {
            self.since_fresh += 1;
        } else {
            self.since_fresh = 0;
            self.sight(finder.detect(picture));
            if self.is_lost_in_bulk(|track| track.state != TrackState::Tentative) {
                self.follow_shift();
            }
        }
        self.correct();
        if self.look != Look::Near {
            self.begin();
        }
        &self.all
    }

    fn pass_time(&mut self, time_s: f64) {
        if let Some(last_s) = self.time_s {
            let interval_s = time_s - last_s;
            if interval_s >= 0.0 {
                self.interval_s = interval_s.min(INTERVAL_MAX_S);
            }
        } else {
            self.interval_s = 0.0;
        }
        if time_s.is_finite() {
            self.time_s = Some(time_s);
        }
    }

    /// Moves every track to where it should be now. Those that left the picture end.
    fn predict(&mut self) {
        let (width, height) = (self.size_px.0 as f64, self.size_px.1 as f64);
        let (interval_s, options) = (self.interval_s, self.options);
        self.all.retain_mut(|track| {
            if interval_s > GAP_MAX_S {
                track.filter.rest(&options);
            }
            track.filter.predict(interval_s, &options);
            track.ellipse = track.filter.ellipse();
            track.age = track.age.saturating_add(1);
            let (half_width, half_height) = track.ellipse.half_extent_px();
            let (x, y) = (track.ellipse.center_x_px, track.ellipse.center_y_px);
            x + half_width > 0.0
                && x - half_width < width
                && y + half_height > 0.0
                && y - half_height < height
        });
    }

    /// Takes over what was found, each contour once, and gives it to the tracks.
    fn sight(&mut self, detection: &Detection) {
        self.sightings.clear();
        for detected in &detection.ellipses {
            let sighting = Sighting::new(detected, self.options.noise_px);
            // Two predictions may lead to the same contour.
            match self.sightings.iter_mut().find(|other| other.is_same(&sighting)) {
                Some(other) if other.score < sighting.score => *other = sighting,
                Some(_) => {}
                None => self.sightings.push(sighting),
            }
        }
        self.association.find(
            &self.all,
            &self.sightings,
            self.options.overlap_min,
            self.interval_s,
        );
    }

    /// Whether fewer than half of the tracks that should be seen are.
    fn is_lost_in_bulk(&self, should_be_seen: impl Fn(&Track) -> bool) -> bool {
        let (mut expected, mut seen) = (0, 0);
        for (track, sighting) in self.all.iter().zip(&self.association.of_track) {
            if should_be_seen(track) {
                expected += 1;
                seen += usize::from(sighting.is_some());
            }
        }
        seen * 2 < expected
    }

    /// Where one shift of all explains more than half of the established tracks, these get the sightings that it gives
    /// them. What lies near a prediction does so by chance then.
    fn follow_shift(&mut self) {
        let pairs = self.shift.find(&self.all, &self.sightings);
        if pairs.is_empty() {
            return;
        }
        self.association.clear(self.all.len(), self.sightings.len());
        for &(track, sighting) in pairs {
            self.association.pair(track, sighting);
            self.all[track].filter.jump(&self.sightings[sighting]);
        }
    }

    /// Corrects the tracks that are seen and counts the misses of the others.
    fn correct(&mut self) {
        let (mut established, mut seen) = (0, 0);
        for (track, sighting) in self.all.iter_mut().zip(&self.association.of_track) {
            let was_established = track.state != TrackState::Tentative;
            established += usize::from(was_established);
            if let Some(index) = *sighting {
                seen += usize::from(was_established);
                let sighting = &self.sightings[index];
                track.filter.correct(sighting, self.interval_s);
                track.ellipse = track.filter.ellipse();
                track.score = sighting.score;
                track.sightings = track.sightings.saturating_add(1);
                track.misses = 0;
                if was_established || track.sightings >= self.options.confirmations {
                    track.state = TrackState::Confirmed;
                }
            } else {
                track.misses = track.misses.saturating_add(1);
                if was_established {
                    track.state = TrackState::Predicted;
                }
            }
            track.velocity_px_per_s = track.filter.velocity_px_per_s();
        }
        self.is_unsettled = seen * 2 < established;
        let misses_max = self.options.misses_max;
        self.all.retain(|track| match track.state {
            TrackState::Tentative => track.misses == 0,
            TrackState::Confirmed => true,
            TrackState::Predicted => track.misses <= misses_max,
        });
    }

    /// Every sighting that is nobody's begins a track.
    fn begin(&mut self) {
        let state = if self.options.confirmations <= 1 {
            TrackState::Confirmed
        } else {
            TrackState::Tentative
        };
        for (sighting, is_taken) in self.sightings.iter().zip(&self.association.is_taken) {
            if *is_taken {
                continue;
            }
            let filter = Filter::new(sighting, &self.options);
            self.all.push(Track {
                id: self.next_id,
                ellipse: filter.ellipse(),
                velocity_px_per_s: [0.0; 2],
                score: sighting.score,
                age: 1,
                sightings: 1,
                misses: 0,
                state,
                filter,
            });
            self.next_id += 1;
        }
    }
}
