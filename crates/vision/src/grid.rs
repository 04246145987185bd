//! Edge points sorted into small tiles, so that voting visits only those near a candidate.

use crate::edge::EdgePoint;

/// Side of a tile in pixels.
const TILE_PX: usize = 8;
/// Points that the voting loop takes at a time; a run may be read past its end up to a whole lane group.
pub(crate) const LANES: usize = 8;

/// The points tile by tile, tile rows from the top, tiles of a row from the left.
///
/// The tiles of one row that a circle touches lie side by side in memory: one run a tile row. Behind each tile row
/// stand `LANES` points that are not a number and never vote, so a run may be rounded up to whole lane groups: what
/// it reads too much lies outside the circle or is not a number.
pub(crate) struct PointGrid {
    pub(crate) xs: Vec<f32>,
    pub(crate) ys: Vec<f32>,
    /// Index of the first point of each tile; one more entry a row marks the end of the last tile.
    starts: Vec<u32>,
    tiles_x: usize,
    tiles_y: usize,
}

/// Points `start..end` of the grid's arrays.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Run {
    pub(crate) start: usize,
    pub(crate) end: usize,
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

    /// Writes to `runs` the runs that together hold every point within `radius` of (`x`, `y`), and returns how many
    /// points that are.
    pub(crate) fn runs_around(&self, x: f32, y: f32, radius: f32, runs: &mut Vec<Run>) -> usize {
        runs.clear();
        if self.tiles_x == 0 || self.tiles_y == 0 {
            return 0;
        }
        let tile_px = TILE_PX as f32;
        // Casts cut down and clip at 0; the circle is widened a little against rounding.
        let radius = radius + 0.01;
        let first = ((y - radius) / tile_px) as usize;
        let last = (((y + radius) / tile_px) as usize).min(self.tiles_y - 1);
        let mut total = 0;
        for tile_y in first..=last {
            let top = (tile_y * TILE_PX) as f32;
            let nearest = (top - y).max(y - (top + tile_px - 1.0)).max(0.0);
            let half = (radius * radius - nearest * nearest).max(0.0).sqrt();
            let left = ((x - half) / tile_px) as usize;
            let right = (((x + half) / tile_px) as usize).min(self.tiles_x - 1);
            if left > right {
                continue;
            }
            let row = tile_y * (self.tiles_x + 1);
            let (start, end) =
                (self.starts[row + left] as usize, self.starts[row + right + 1] as usize);
            if start < end {
                runs.push(Run { start, end });
                total += end - start;
            }
        }
        total
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
            x in 0.0..60.0_f32, y in 0.0..60.0_f32, radius in 1.0..40.0_f32,
        ) {
            let points: Vec<_> = coordinates.iter().map(|&(x, y)| EdgePoint { x, y }).collect();
            let grid = PointGrid::new(&points);
            let mut runs = Vec::new();
            let total = grid.runs_around(x, y, radius, &mut runs);
            let mut visited: Vec<_> = runs.iter().flat_map(|run| run.start..run.end).collect();
            prop_assert_eq!(visited.len(), total);
            visited.dedup();
            prop_assert_eq!(visited.len(), total, "runs overlap");
            let near = |px: f32, py: f32| (px - x).hypot(py - y) <= radius;
            let found = visited.iter().filter(|&&i| near(grid.xs[i], grid.ys[i])).count();
            let wanted = points.iter().filter(|point| near(f32::from(point.x), f32::from(point.y))).count();
            prop_assert_eq!(found, wanted);
            // Reading past a run's end up to whole lane groups meets no point within the radius.
            for run in &runs {
                let padded = run.start + (run.end - run.start).next_multiple_of(LANES);
                prop_assert!((run.end..padded).all(|i| !near(grid.xs[i], grid.ys[i])));
            }
        }
    }
}
