//! Which sighting belongs to which track: the best pair first.

use super::Track;
use super::filter::Sighting;

/// Greatest distance in standard deviations at which a sighting beside the prediction is taken for it.
const DEVIATIONS_MAX: f64 = 3.0;

/// Pairs of tracks and sightings, with the buffers to find them.
#[derive(Debug, Clone, Default)]
pub(super) struct Association {
    /// For each track its sighting.
    pub(super) of_track: Vec<Option<usize>>,
    /// For each sighting whether a track has it.
    pub(super) is_taken: Vec<bool>,
    candidates: Vec<Candidate>,
}

#[derive(Debug, Clone, Copy)]
struct Candidate {
    /// The overlap, `0..=1`, or where that is too little the distance in standard deviations, negative.
    merit: f64,
    track: usize,
    sighting: usize,
}

impl Association {
    /// Starts with nothing paired.
    pub(super) fn clear(&mut self, tracks: usize, sightings: usize) {
        self.of_track.clear();
        self.of_track.resize(tracks, None);
        self.is_taken.clear();
        self.is_taken.resize(sightings, false);
    }

    /// Pairs a track with a sighting.
    pub(super) fn pair(&mut self, track: usize, sighting: usize) {
        self.of_track[track] = Some(sighting);
        self.is_taken[sighting] = true;
    }

    /// Pairs tracks, whose ellipses are the predicted ones, with sightings: those that overlap by at least `overlap_min`,
    /// most first, then those of the same shape beside the prediction, nearest first.
    pub(super) fn find(
        &mut self,
        tracks: &[Track],
        sightings: &[Sighting],
        overlap_min: f64,
        interval_s: f64,
    ) {
        self.clear(tracks.len(), sightings.len());
        self.candidates.clear();
        for (track, followed) in tracks.iter().enumerate() {
            for (index, sighting) in sightings.iter().enumerate() {
                let overlap = followed.ellipse.overlap_star(&sighting.ellipse);
                let merit = if overlap >= overlap_min {
                    Some(overlap)
                } else {
                    let deviations = followed.filter.center_deviations(sighting, interval_s);
                    (deviations <= DEVIATIONS_MAX && followed.filter.has_shape_of(sighting))
                        .then_some(-deviations)
                };
                let candidate = |merit| Candidate { merit, track, sighting: index };
                self.candidates.extend(merit.map(candidate));
            }
        }
        self.candidates.sort_unstable_by(|a, b| {
            b.merit.total_cmp(&a.merit).then((a.track, a.sighting).cmp(&(b.track, b.sighting)))
        });
        for index in 0..self.candidates.len() {
            let Candidate { track, sighting, .. } = self.candidates[index];
            if self.of_track[track].is_none() && !self.is_taken[sighting] {
                self.pair(track, sighting);
            }
        }
    }
}
