//! The times over the pixels as an SVG picture, both axes logarithmic.

use std::fmt::Write as _;

use super::Cost;

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 500.0;
/// The frame of the axes: left, right, top and bottom.
const FRAME: (f64, f64, f64, f64) = (80.0, 610.0, 50.0, 430.0);
/// A colour for each line, told apart by the colour-blind too (Okabe and Ito).
const COLORS: [&str; 4] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7"];

/// A logarithmic axis between two places of the picture.
struct Axis {
    least: f64,
    greatest: f64,
    from: f64,
    to: f64,
}

impl Axis {
    /// An axis from the power of ten below the least value to that above the greatest.
    fn over(values: impl Iterator<Item = f64> + Clone, from: f64, to: f64) -> Self {
        let least = values.clone().filter(|value| *value > 0.0).fold(f64::INFINITY, f64::min);
        let greatest = values.fold(0.0, f64::max);
        let (least, greatest) = if least.is_finite() { (least, greatest) } else { (1.0, 10.0) };
        let least = 10_f64.powf(least.log10().floor());
        // A power of ten by itself still needs an axis with a length.
        let greatest = 10_f64.powf(greatest.log10().ceil()).max(least * 10.0);
        Self { least, greatest, from, to }
    }

    /// Where a value stands; what the axis does not reach stands at its ends.
    fn place(&self, value: f64) -> f64 {
        let share = (value / self.least).log10() / (self.greatest / self.least).log10();
        self.from + (self.to - self.from) * share.clamp(0.0, 1.0)
    }

    /// 1, 2, ... 9 of every power of ten on the axis, each with whether it is the power itself.
    fn ticks(&self) -> Vec<(f64, bool)> {
        let mut ticks = Vec::new();
        let mut power = self.least;
        while power <= self.greatest * 1.001 {
            for digit in 1..10 {
                let value = power * f64::from(digit);
                if value <= self.greatest * 1.001 {
                    ticks.push((value, digit == 1));
                }
            }
            power *= 10.0;
        }
        ticks
    }
}

/// The plot of these costs, a line for each preset.
pub(super) fn draw(costs: &[Cost]) -> String {
    let (left, right, top, bottom) = FRAME;
    let x = Axis::over(costs.iter().map(pixels), left, right);
    let y = Axis::over(costs.iter().map(|cost| cost.ms), bottom, top);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" width=\"{WIDTH}\" height=\"{HEIGHT}\" \
         font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"white\"/>\n\
         <text x=\"{left}\" y=\"28\" font-size=\"16\">What a detection costs, by the size of the picture</text>\n"
    );
    axes(&mut svg, &x, &y);
    let mut presets: Vec<&str> = Vec::new();
    for cost in costs {
        if !presets.contains(&cost.preset) {
            presets.push(cost.preset);
        }
    }
    for (preset, color) in presets.into_iter().zip(COLORS.iter().cycle()) {
        let mut line: Vec<&Cost> = costs.iter().filter(|cost| cost.preset == preset).collect();
        line.sort_by(|one, other| pixels(one).total_cmp(&pixels(other)));
        curve(&mut svg, &x, &y, &line, color);
    }
    svg.push_str("</svg>\n");
    svg
}

/// Pixels of the picture.
fn pixels(cost: &Cost) -> f64 {
    // At most 2^28.
    #[expect(clippy::cast_precision_loss)]
    let pixels = (cost.width * cost.height) as f64;
    pixels
}

/// Grid, frame, numbers and names. Writing to a text does not fail.
fn axes(svg: &mut String, x: &Axis, y: &Axis) {
    let (left, right, top, bottom) = FRAME;
    for (value, is_power) in x.ticks() {
        let (place, color) = (x.place(value), if is_power { "#bbbbbb" } else { "#eeeeee" });
        let _ = writeln!(svg, "<path d=\"M{place:.1} {top}V{bottom}\" stroke=\"{color}\"/>");
        if is_power {
            let _ = writeln!(
                svg,
                "<text x=\"{place:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                bottom + 20.0,
                count(value)
            );
        }
    }
    for (value, is_power) in y.ticks() {
        let (place, color) = (y.place(value), if is_power { "#bbbbbb" } else { "#eeeeee" });
        let _ = writeln!(svg, "<path d=\"M{left} {place:.1}H{right}\" stroke=\"{color}\"/>");
        if is_power {
            let _ = writeln!(
                svg,
                "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                left - 8.0,
                place + 4.5,
                count(value)
            );
        }
    }
    let (middle_x, middle_y) = (f64::midpoint(left, right), f64::midpoint(top, bottom));
    let _ = writeln!(
        svg,
        "<path d=\"M{left} {top}H{right}V{bottom}H{left}Z\" fill=\"none\" stroke=\"black\"/>\n\
         <text x=\"{middle_x}\" y=\"{}\" text-anchor=\"middle\">pixels of the picture</text>\n\
         <text transform=\"translate(24 {middle_y}) rotate(-90)\" text-anchor=\"middle\">time of a detection, ms</text>",
        bottom + 48.0
    );
}

/// A power of ten as people write it.
fn count(value: f64) -> String {
    // Powers of ten are computed, and a little off.
    let power = value.log10().round();
    match power {
        power if power >= 6.0 => format!("{:.0} million", 10_f64.powf(power - 6.0)),
        power if power >= 3.0 => format!("{:.0} 000", 10_f64.powf(power - 3.0)),
        power if power >= 0.0 => format!("{:.0}", 10_f64.powf(power)),
        power => format!("{:.*}", digits(power), 10_f64.powf(power)),
    }
}

/// Digits behind the point of a negative power of ten.
fn digits(power: f64) -> usize {
    // A time of 10^-9 ms is shorter than a clock tells.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let digits = -power.max(-9.0) as usize;
    digits
}

/// A line with a point at each size, and the preset's name at its end.
fn curve(svg: &mut String, x: &Axis, y: &Axis, line: &[&Cost], color: &str) {
    let places: Vec<(f64, f64)> =
        line.iter().map(|cost| (x.place(pixels(cost)), y.place(cost.ms))).collect();
    let points: Vec<String> = places.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
    let _ = writeln!(
        svg,
        "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2\"/>",
        points.join(" ")
    );
    for (cost, (x, y)) in line.iter().zip(&places) {
        let _ = writeln!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"{color}\"><title>{} x {}: {:.2} ms</title></circle>",
            cost.width, cost.height, cost.ms
        );
    }
    if let (Some(cost), Some((x, y))) = (line.last(), places.last()) {
        let _ = writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" fill=\"{color}\">{}</text>",
            x + 9.0,
            y + 4.5,
            cost.preset
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_reaches_from_power_to_power_and_keeps_everything_on_it() {
        let axis = Axis::over([76_800.0, 8_294_400.0].into_iter(), 0.0, 300.0);
        assert!((axis.place(100_000.0) - 100.0).abs() < 1e-6);
        assert_eq!(axis.ticks().iter().filter(|(_, is_power)| *is_power).count(), 4);
        assert!((axis.place(0.0) - 0.0).abs() < 1e-6 && (axis.place(1e9) - 300.0).abs() < 1e-6);
        assert_eq!(Axis::over([10.0].into_iter(), 0.0, 1.0).ticks().len(), 10);
        assert_eq!(Axis::over([0.0].into_iter(), 0.0, 1.0).ticks().len(), 10);
        assert_eq!([1e7, 1e4, 1.0, 1e-3].map(count), ["10 million", "10 000", "1", "0.001"]);
    }
}
