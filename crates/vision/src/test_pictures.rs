//! Pictures drawn by the tests.

use crate::ellipse::Ellipse;
use crate::image::GrayImage;

/// A picture of grey 200 with a dark anti-aliased ring of `width_px` along each ellipse.
pub(crate) fn rings(width: usize, height: usize, ellipses: &[Ellipse], width_px: f64) -> GrayImage {
    let mut data = Vec::with_capacity(width * height);
    for y in 0..height {
        for x in 0..width {
            let distance =
                ellipses.iter().map(|ellipse| ellipse.distance_px(x as f64, y as f64).abs());
            let nearest = distance.fold(f64::INFINITY, f64::min);
            let cover = (width_px / 2.0 + 0.5 - nearest).clamp(0.0, 1.0);
            data.push((200.0 - 170.0 * cover).round() as u8);
        }
    }
    GrayImage::new(data, width, height).expect("a test picture is within the limits")
}

/// Bytes that look random and are the same in every run.
pub(crate) fn noise(length: usize, seed: u64) -> Vec<u8> {
    use rand::Rng;
    let mut random = rand_pcg::Pcg32::new(seed, 1);
    let mut data = vec![0; length];
    random.fill_bytes(&mut data);
    data
}
