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

/// A picture of grey 40 with an anti-aliased disc of grey 200 in each ellipse.
pub(crate) fn discs(width: usize, height: usize, ellipses: &[Ellipse]) -> GrayImage {
    picture(width, height, |x, y| {
        let distance = ellipses.iter().map(|ellipse| ellipse.distance_px(x, y));
        40.0 + 160.0 * (0.5 - distance.fold(f64::INFINITY, f64::min)).clamp(0.0, 1.0)
    })
}

/// A picture whose grey values are a function of the place.
pub(crate) fn picture(width: usize, height: usize, grey: impl Fn(f64, f64) -> f64) -> GrayImage {
    let places = (0..width * height).map(|i| ((i % width) as f64, (i / width) as f64));
    let data = places.map(|(x, y)| grey(x, y).round() as u8).collect();
    GrayImage::new(data, width, height).expect("a test picture is within the limits")
}

/// Squares of 5 px of random grey values: edges everywhere, unlike noise, whose edges the threshold keeps out.
pub(crate) fn patches(width: usize, height: usize, seed: u64) -> GrayImage {
    let columns = width / 5 + 1;
    let values = noise(columns * (height / 5 + 1), seed);
    picture(width, height, |x, y| f64::from(values[y as usize / 5 * columns + x as usize / 5]))
}

/// Centre, semi-axes and angle.
pub(crate) fn ellipse(x: f64, y: f64, a: f64, b: f64, theta_rad: f64) -> Ellipse {
    Ellipse { center_x_px: x, center_y_px: y, semi_major_px: a, semi_minor_px: b, theta_rad }
}

/// Bytes that look random and are the same in every run.
pub(crate) fn noise(length: usize, seed: u64) -> Vec<u8> {
    use rand::Rng;
    let mut random = rand_pcg::Pcg32::new(seed, 1);
    let mut data = vec![0; length];
    random.fill_bytes(&mut data);
    data
}
