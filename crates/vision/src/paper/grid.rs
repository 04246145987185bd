//! Edge points sorted into small tiles, so that voting visits only those near a candidate.

use std::ops::Range;

use crate::paper::edge::EdgePoint;
use crate::paper::vote::Axis;

/// Side of a tile in pixels.
const TILE_PX: usize = 8;
/// Points that the voting loop takes at a time; a run may be read past its end up to a whole lane group.
pub(crate) const LANES: usize = 8;

/// The points tile by tile, tile rows from the top, tiles of a row from the left.
///
/// The tiles of one row that a circle touches lie side by side in memory: one run a tile row. Behind each tile row
/// stand `LANES` points that are not a number, so a run may be read on to the end of a lane group; what it reads too much is not counted.
pub(crate) struct PointGrid {
    pub(crate) xs: Vec<f32>,
    pub(crate) ys: Vec<f32>,
    /// Index of the first point of each tile; one more entry a row marks the end of the last tile.
    starts: Vec<u32>,
    tiles_x: usize,
    tiles_y: usize,
}

impl PointGrid {
    pub(crate) fn new(points: &[EdgePoint]) -> Self {
        let tile =
            |point: &EdgePoint| (usize::from(point.x) / TILE_PX, usize::from(point.y) / TILE_PX);
        let tiles_x = points.iter().map(|point| tile(point).0 + 1).max().unwrap_or(0);
        let tiles_y = points.iter().map(|point| tile(point).1 + 1).max().unwrap_or(0);
        let row_len = tiles_x + 1;
        let mut starts = vec![0_u32; row_len * tiles_y];
        for point in points {
            let (tx, ty) = tile(point);
            starts[ty * row_len + tx] += 1;
        }
        // Counts to starts; the entry behind a row's last tile holds the padding.
        let mut next = 0_u32;
        for row in starts.chunks_exact_mut(row_len.max(1)) {
            for start in row.iter_mut() {
                next += std::mem::replace(start, next);
            }
            next += LANES as u32;
        }
        let mut xs = vec![f32::NAN; next as usize];
        let mut ys = vec![f32::NAN; next as usize];
        let mut free = starts.clone();
        for point in points {
            let (tx, ty) = tile(point);
            let slot = &mut free[ty * row_len + tx];
            xs[*slot as usize] = f32::from(point.x);
            ys[*slot as usize] = f32::from(point.y);
            *slot += 1;
        }
        Self { xs, ys, starts, tiles_x, tiles_y }
    }

    /// The runs that together hold every point within `radius` of the centre of `axis`, split along the minor axis.
    #[allow(clippy::cast_possible_wrap)] // a picture has at most 2048 tiles on a side
    pub(crate) fn halves_around(&self, axis: Axis, radius: f32, halves: &mut Halves) {
        halves.clear();
        if self.tiles_x == 0 || self.tiles_y == 0 {
            return;
        }
        // All lengths in tiles from here on; the circle and the border between the halves are widened a little against
        // rounding.
        let per_tile = 1.0 / TILE_PX as f32;
        let (center_x, center_y) = (axis.center_x * per_tile, axis.center_y * per_tile);
        let radius = (radius + 0.01) * per_tile;
        let radius2 = radius * radius;
        // From the top to the lowest pixel row of a tile.
        let height = (TILE_PX - 1) as f32 * per_tile;
        let margin = 0.01 * per_tile;
        // Where the minor axis crosses a row: x = center_x - (y - center_y) slope. An almost upright major axis gives a
        // steep border that any finite slope bounds, since the widest picture ends within it.
        let slope = axis.half_y / axis.half_x.max(1e-6);
        // Casts cut down, and clip what is too large.
        let first = ((center_y - radius) as i32).max(0);
        let last = ((center_y + radius) as i32).min(self.tiles_y as i32 - 1);
        let tiles_x = self.tiles_x as i32;
        // First the tiles of each row, without a branch, then the points in them.
        halves.tiles.extend((first..=last).map(|tile_y| {
            let top = tile_y as f32 - center_y;
            let bottom = top + height;
            let nearest = top.max(-bottom).max(0.0);
            let reach = (radius2 - nearest * nearest).max(0.0).sqrt();
            let left = ((center_x - reach) as i32).max(0);
            let behind = (((center_x + reach) as i32) + 1).min(tiles_x).max(left);
            // The margin matters up and down too: of a row on the border of an upright axis, every point lies on it.
            let (one, other) =
                (center_x - (top - margin) * slope, center_x - (bottom + margin) * slope);
            // Tiles before `back_end` hold all that lies behind the minor axis, those from `front_start` on all before it.
            let back_end =
                ((one.max(other) + margin) as i32).saturating_add(1).max(left).min(behind);
            let front_start = ((one.min(other) - margin) as i32).max(left).min(behind);
            [left, front_start, back_end, behind]
        }));
        let rows = self.starts.chunks_exact(self.tiles_x + 1).skip(first as usize);
        for (row, tiles) in rows.zip(&halves.tiles) {
            // Each is at least 0 and at most `tiles_x`, but for rows that lie to the right of all tiles.
            let at = |tile: i32| row[(tile as usize).min(self.tiles_x)] as usize;
            let run = tiles.map(at);
            halves.back += run[2] - run[0];
            halves.front += run[3] - run[1];
            halves.rows.push(run);
        }
    }
}

/// The runs around a pair, a tile row each, with two ways to cut them.
#[derive(Debug, Default)]
pub(crate) struct Halves {
    /// Start of the run, start of what lies before the minor axis, end of what lies behind it, end of the run. The tiles
    /// that the minor axis crosses belong to both.
    rows: Vec<[usize; 4]>,
    /// The same as tiles of their row.
    tiles: Vec<[i32; 4]>,
    back: usize,
    front: usize,
}

impl Halves {
    fn clear(&mut self) {
        self.rows.clear();
        self.tiles.clear();
        (self.back, self.front) = (0, 0);
    }

    /// Points in [`first`](Self::first).
    pub(crate) fn first_len(&self) -> usize {
        self.back.min(self.front)
    }

    /// Runs with every point on the emptier side of the minor axis, and some of the other side.
    pub(crate) fn first(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        let back = self.back <= self.front;
        self.rows.iter().map(
            move |&[start, front, back_end, end]| if back { start..back_end } else { front..end },
        )
    }

    /// The runs that [`first`](Self::first) left out.
    pub(crate) fn rest(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        let back = self.back <= self.front;
        self.rows.iter().map(
            move |&[start, front, back_end, end]| if back { back_end..end } else { start..front },
        )
    }

    /// Whether [`first`](Self::first) covers the side behind the minor axis, against the direction of the axis.
    pub(crate) fn first_is_back(&self) -> bool {
        self.back <= self.front
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_point_within_the_radius_is_in_exactly_one_run(
            coordinates in prop::collection::btree_set((0_u16..60, 0_u16..60), 0..200),
            x in 0_u16..120, y in 0_u16..120, half_x in 0_u16..80, half_y in -80_i16..80,
            radius in 1.0..60.0_f32,
        ) {
            let points: Vec<_> = coordinates.iter().map(|&(x, y)| EdgePoint { x, y }).collect();
            let grid = PointGrid::new(&points);
            // A pair is at least twice the least semi-major axis apart, and its axis points to the right or down.
            let half_y = if half_x == 0 { half_y.abs().max(1) } else { half_y };
            let half = |value: f32| value / 2.0;
            let axis = Axis {
                center_x: half(x.into()), center_y: half(y.into()), half_x: half(half_x.into()), half_y: half(half_y.into()),
            };
            let mut halves = Halves::default();
            grid.halves_around(axis, radius, &mut halves);
            let first: Vec<_> = halves.first().flatten().collect();
            let mut all: Vec<_> = first.iter().copied().chain(halves.rest().flatten()).collect();
            prop_assert_eq!(first.len(), halves.first_len());
            let visited = all.len();
            all.sort_unstable();
            all.dedup();
            prop_assert_eq!(all.len(), visited, "runs overlap");
            let near = |i: &&usize| (grid.xs[**i] - axis.center_x).hypot(grid.ys[**i] - axis.center_y)
                <= radius;
            let wanted = (0..grid.xs.len()).collect::<Vec<_>>().iter().filter(near).count();
            prop_assert_eq!(all.iter().filter(near).count(), wanted);
            // The first half holds all near points of its side.
            let on_side = |i: &&usize| {
                let along = (grid.xs[**i] - axis.center_x) * axis.half_x + (grid.ys[**i] - axis.center_y) * axis.half_y;
                near(i) && (along.is_sign_negative() == halves.first_is_back())
            };
            prop_assert_eq!(first.iter().filter(on_side).count(), all.iter().filter(on_side).count());
        }
    }
}
