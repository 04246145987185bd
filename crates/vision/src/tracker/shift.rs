//! The one shift by which a camera's jump moves everything: each pair of an established track and a sighting of its
//! shape votes for one, and the one that brings most tracks to a sighting wins.

use super::filter::Sighting;
use super::{Track, TrackState};

/// Distance in pixels, and beside it as a share of the semi-major axis, within which a shifted track meets a sighting.
const TOLERANCE_PX: f64 = 3.0;
const TOLERANCE_SHARE: f64 = 0.15;
/// One track alone would vouch for any shift.
const TRACKS_MIN: usize = 2;
/// Pairs that are looked at, and how many of them, evenly taken, propose a shift: enough for 200 equal discs.
const PAIRS_MAX: usize = 40_000;
const PROPOSALS_MAX: usize = 200;

/// Buffers of the search.
#[derive(Debug, Clone, Default)]
pub(super) struct ShiftSearch {
    pairs: Vec<Pair>,
    met: Vec<(usize, usize)>,
    best: Vec<(usize, usize)>,
}

#[derive(Debug, Clone, Copy)]
struct Pair {
    track: usize,
    sighting: usize,
    shift_px: (f64, f64),
    tolerance_px: f64,
}

impl ShiftSearch {
    /// The pairs of established tracks and sightings, as (track, sighting), that one shift explains: empty unless these
    /// are at least two and more than half of the tracks.
    pub(super) fn find(&mut self, tracks: &[Track], sightings: &[Sighting]) -> &[(usize, usize)] {
        self.best.clear();
        self.pairs.clear();
        let mut established = 0;
        for (track, followed) in tracks.iter().enumerate() {
            if followed.state == TrackState::Tentative {
                continue;
            }
            established += 1;
            let here = &followed.ellipse;
            for (sighting, seen) in sightings.iter().enumerate() {
                let there = &seen.ellipse;
                if self.pairs.len() < PAIRS_MAX && followed.filter.has_shape_of(seen) {
                    self.pairs.push(Pair {
                        track,
                        sighting,
                        shift_px: (
                            there.center_x_px - here.center_x_px,
                            there.center_y_px - here.center_y_px,
                        ),
                        tolerance_px: TOLERANCE_PX.max(TOLERANCE_SHARE * here.semi_major_px),
                    });
                }
            }
        }
        let stride = self.pairs.len().div_ceil(PROPOSALS_MAX).max(1);
        for proposal in (0..self.pairs.len()).step_by(stride) {
            self.meet(self.pairs[proposal].shift_px);
            if self.met.len() > self.best.len() {
                std::mem::swap(&mut self.met, &mut self.best);
            }
        }
        if self.best.len() < TRACKS_MIN || self.best.len() * 2 <= established {
            self.best.clear();
        }
        &self.best
    }

    /// The pairs that a shift brings together, each track and each sighting once.
    fn meet(&mut self, shift_px: (f64, f64)) {
        self.met.clear();
        for pair in &self.pairs {
            let off_px = (pair.shift_px.0 - shift_px.0).hypot(pair.shift_px.1 - shift_px.1);
            let is_free = |&(track, sighting): &(usize, usize)| {
                track != pair.track && sighting != pair.sighting
            };
            if off_px <= pair.tolerance_px && self.met.iter().all(is_free) {
                self.met.push((pair.track, pair.sighting));
            }
        }
    }
}
