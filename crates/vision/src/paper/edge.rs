//! From the binary picture to the list of edge points that the detector draws from.

use crate::image::GrayView;

/// One edge pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct EdgePoint {
    /// Column, 0 at the left.
    pub x: u16,
    /// Row, 0 at the top.
    pub y: u16,
}

/// The pixels of `binary` that are not 0, row by row from the top left.
pub fn edge_points(binary: &GrayView<'_>) -> Vec<EdgePoint> {
    let mut points = Vec::new();
    // A view is at most 16384 on a side, so both coordinates fit.
    for (y, row) in (0_u16..).zip(binary.rows()) {
        for (x, &value) in (0_u16..).zip(row) {
            if value != 0 {
                points.push(EdgePoint { x, y });
            }
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_come_row_by_row() {
        let data = [0, 255, 0, 1, 0, 7];
        let points = edge_points(&GrayView::new(&data, 3, 2, 3).unwrap());
        assert_eq!(
            points,
            [EdgePoint { x: 1, y: 0 }, EdgePoint { x: 0, y: 1 }, EdgePoint { x: 2, y: 1 }]
        );
    }
}
