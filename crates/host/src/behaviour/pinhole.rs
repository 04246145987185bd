//! From a picture point to the angles that centre it.

/// Where the head looks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Direction {
    /// Degrees right of straight ahead, -90 to 90 within the head's reach.
    pub pan_deg: f64,
    /// Degrees above straight ahead, -45 to 45 within the head's reach.
    pub tilt_deg: f64,
}

impl Direction {
    /// A direction by its angles in degrees.
    pub const fn new(pan_deg: f64, tilt_deg: f64) -> Direction {
        Direction { pan_deg, tilt_deg }
    }

    /// The nearest direction within the head's reach.
    #[must_use]
    pub fn within_reach(self) -> Direction {
        Direction {
            pan_deg: self.pan_deg.clamp(-90.0, 90.0),
            tilt_deg: self.tilt_deg.clamp(-45.0, 45.0),
        }
    }
}

/// A camera without distortion, whose optical axis is where the head looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pinhole {
    /// Focal length in pixels along x and y.
    pub focal_px: (f64, f64),
    /// Where the optical axis meets the picture: pixels, the centre of the top left one at (0, 0), y down.
    pub center_px: (f64, f64),
}

impl Pinhole {
    /// A camera of square pixels with its optical axis in the middle of the picture, whose width covers
    /// `horizontal_deg` degrees (above 0, below 180).
    pub fn with_field_of_view(width_px: usize, height_px: usize, horizontal_deg: f64) -> Pinhole {
        // Pictures have at most some thousand pixels a side, which a float holds exactly.
        #[allow(clippy::cast_precision_loss)]
        let (width, height) = (width_px as f64, height_px as f64);
        let focal = width / 2.0 / (horizontal_deg / 2.0).to_radians().tan();
        Pinhole { focal_px: (focal, focal), center_px: ((width - 1.0) / 2.0, (height - 1.0) / 2.0) }
    }

    /// How far the picture point (`x_px`, `y_px`) is from the optical axis, in pixels.
    pub fn offset_px(&self, x_px: f64, y_px: f64) -> f64 {
        (x_px - self.center_px.0).hypot(y_px - self.center_px.1)
    }

    /// Where the head has to look to bring to the optical axis what it sees at (`x_px`, `y_px`) while it looks at
    /// `head`. Exact where both axes of the head pass through the lens.
    pub fn centering(&self, head: Direction, x_px: f64, y_px: f64) -> Direction {
        let right = (x_px - self.center_px.0) / self.focal_px.0;
        let up = (self.center_px.1 - y_px) / self.focal_px.1;
        let (pan_sin, pan_cos) = head.pan_deg.to_radians().sin_cos();
        let (tilt_sin, tilt_cos) = head.tilt_deg.to_radians().sin_cos();
        // The ray, of length 1 along the optical axis, turned by the tilt and then by the pan.
        let level = tilt_cos - up * tilt_sin;
        let up = tilt_sin + up * tilt_cos;
        let forward = level * pan_cos - right * pan_sin;
        let right = level * pan_sin + right * pan_cos;
        Direction {
            pan_deg: right.atan2(forward).to_degrees(),
            tilt_deg: up.atan2(right.hypot(forward)).to_degrees(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_on_the_axis_stays_and_the_edge_is_half_the_field_away() {
        let pinhole = Pinhole::with_field_of_view(320, 240, 60.0);
        let head = Direction::new(20.0, -15.0);
        let same = pinhole.centering(head, 159.5, 119.5);
        assert!((same.pan_deg - 20.0).abs() < 1e-9 && (same.tilt_deg + 15.0).abs() < 1e-9);
        let edge = pinhole.centering(Direction::default(), 319.5, 119.5);
        assert!((edge.pan_deg - 30.0).abs() < 1e-9 && edge.tilt_deg.abs() < 1e-9, "{edge:?}");
        assert!(pinhole.centering(Direction::default(), 159.5, 0.0).tilt_deg > 0.0);
    }

    #[cfg(feature = "virtual")]
    #[test]
    fn it_agrees_with_the_geometry_of_the_virtual_head() {
        use rsapien_sim::camera::{HeadAngles, Intrinsics};
        let intrinsics = Intrinsics::default();
        let pinhole = Pinhole::with_field_of_view(320, 240, 60.0);
        for (pan, tilt, x, y) in
            [(0, 0, 10.0, 200.0), (3000, -2000, 250.0, 40.0), (-4500, 1500, 300.0, 239.0)]
        {
            let head = HeadAngles { pan_centideg: pan, tilt_centideg: tilt };
            let expected = head.centering(&intrinsics, x, y).unwrap();
            let direction = Direction::new(f64::from(pan) / 100.0, f64::from(tilt) / 100.0);
            let found = pinhole.centering(direction, x, y);
            assert!((found.pan_deg * 100.0 - f64::from(expected.pan_centideg)).abs() < 0.51);
            assert!((found.tilt_deg * 100.0 - f64::from(expected.tilt_centideg)).abs() < 0.51);
        }
    }
}
