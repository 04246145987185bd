//! The timeline as a picture for a report.

use std::fmt::Write as _;

use rsapien_protocol::Joint;

use super::{Timeline, mark, target_name};
use crate::motion::{Movement, Sense};

/// How the picture is made.
#[derive(Clone, Debug, PartialEq)]
pub struct SvgOptions {
    /// What stands above it; the action's name where empty.
    pub title: String,
    /// What stands below the title.
    pub description: String,
    /// Width in pixels, at least 400.
    pub width: u32,
}

impl Default for SvgOptions {
    /// The action's name, without a description, 900 pixels wide.
    fn default() -> SvgOptions {
        SvgOptions { title: String::new(), description: String::new(), width: 900 }
    }
}

const LEFT: f64 = 128.0;
const RIGHT: f64 = 20.0;
const ROW: f64 = 46.0;
const LANE: f64 = 26.0;
/// Colours that are told apart by people who see few, and differ in lightness, too (Okabe and Ito).
const FIRST: &str = "#0072b2";
const LAST: &str = "#e69f00";
const REST: &str = "#9aa0a6";
const BUMPERS: &str = "#cc79a7";

impl Timeline {
    /// A picture that stands by itself: each joint's place over time, from its first position at the top
    /// of its row to its last at the bottom. Motion towards the one is blue, towards the other orange; it
    /// is told apart by its slope, too. The same timeline gives the same bytes.
    pub fn to_svg(&self, options: &SvgOptions) -> String {
        let mut picture = Picture::new(self, options);
        picture.head(options);
        picture.ruler();
        for joint in Joint::ALL {
            picture.joint(joint);
        }
        picture.bumpers();
        picture.labels();
        picture.waits();
        picture.legend();
        picture.end()
    }
}

struct Picture<'a> {
    timeline: &'a Timeline,
    svg: String,
    width: f64,
    height: f64,
    top: f64,
}

impl<'a> Picture<'a> {
    fn new(timeline: &'a Timeline, options: &SvgOptions) -> Picture<'a> {
        let described = if options.description.is_empty() { 0.0 } else { 20.0 };
        let labelled = if timeline.labels.is_empty() { 0.0 } else { 18.0 };
        let top = 62.0 + described + labelled;
        let rows = 7.0 * ROW + if timeline.endings.is_empty() { 0.0 } else { 28.0 };
        Picture {
            timeline,
            svg: String::new(),
            width: f64::from(options.width.max(400)),
            height: top + rows + 46.0,
            top,
        }
    }

    fn put(&mut self, element: &str) {
        self.svg.push_str(element);
        self.svg.push('\n');
    }

    fn x(&self, at_ms: u64) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "times of an action are exact in f64")]
        let share = at_ms as f64 / self.timeline.end_ms() as f64;
        LEFT + share * (self.width - LEFT - RIGHT)
    }

    /// Below the last row of joints.
    fn bottom(&self) -> f64 {
        self.top + 7.0 * ROW
    }

    fn head(&mut self, options: &SvgOptions) {
        let title = if options.title.is_empty() { &self.timeline.name } else { &options.title };
        let (width, height) = (self.width, self.height);
        self.put(&format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"Helvetica, Arial, sans-serif\" \
             font-size=\"12\" role=\"img\">"
        ));
        let lasts = mark_exact(self.timeline.duration_ms());
        self.put(&format!("<title>{}</title>", escaped(title)));
        self.put(&format!(
            "<desc>Timeline of the seven joints over {lasts}. {}</desc>",
            escaped(&options.description)
        ));
        self.put(&format!("<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>"));
        self.put(&format!(
            "<text x=\"16\" y=\"26\" font-size=\"18\" font-weight=\"bold\" fill=\"#202124\">{}</text>",
            escaped(title)
        ));
        let right = width - RIGHT;
        self.put(&format!(
            "<text x=\"{right}\" y=\"26\" text-anchor=\"end\" fill=\"#5f6368\">{} steps, {lasts}</text>",
            self.timeline.motion.step_begins_ms.len().saturating_sub(1)
        ));
        if !options.description.is_empty() {
            let line = options.description.lines().next().unwrap_or_default();
            self.put(&format!("<text x=\"16\" y=\"46\" fill=\"#5f6368\">{}</text>", escaped(line)));
        }
    }

    fn ruler(&mut self) {
        let (top, bottom) = (self.top, self.bottom());
        // Of a thousand steps the grid would be a grey area.
        let begins = self.timeline.motion.step_begins_ms.clone();
        if begins.len() <= 200 {
            for at_ms in begins {
                let x = self.x(at_ms);
                self.put(&format!(
                    "<line x1=\"{x:.1}\" y1=\"{top}\" x2=\"{x:.1}\" y2=\"{bottom}\" stroke=\"#e8eaed\"/>"
                ));
            }
        }
        let step_ms = self.timeline.ruler_ms(10);
        let mut at_ms = 0;
        while at_ms <= self.timeline.end_ms() {
            let x = self.x(at_ms);
            self.put(&format!(
                "<line x1=\"{x:.1}\" y1=\"{:.1}\" x2=\"{x:.1}\" y2=\"{top}\" stroke=\"#80868b\"/>",
                top - 5.0
            ));
            self.put(&format!(
                "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\" font-size=\"11\" \
                 fill=\"#5f6368\">{}</text>",
                top - 9.0,
                mark(at_ms)
            ));
            at_ms += step_ms;
        }
    }

    fn joint(&mut self, joint: Joint) {
        let row_top = self.top + f64::from(joint.index()) * ROW;
        let lane_top = row_top + (ROW - LANE) / 2.0;
        let y = |place: f64| lane_top + place * LANE;
        if joint.index().is_multiple_of(2) {
            self.put(&format!(
                "<rect x=\"0\" y=\"{row_top:.1}\" width=\"{}\" height=\"{ROW}\" fill=\"#000000\" \
                 fill-opacity=\"0.03\"/>",
                self.width
            ));
        }
        self.put(&format!(
            "<text x=\"16\" y=\"{:.1}\" fill=\"#202124\">{}</text>",
            row_top + ROW / 2.0 + 4.0,
            joint.name()
        ));
        for (name, place) in joint.position_names().into_iter().zip([0.0, 0.5, 1.0]) {
            self.put(&format!(
                "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\" font-size=\"9\" \
                 fill=\"#80868b\">{name}</text>",
                LEFT - 8.0,
                y(place) + 3.0
            ));
        }
        let row = self.timeline.motion.rows[usize::from(joint.index())].clone();
        let mut rests_since = (0, 0.5);
        for movement in &row {
            self.rest(rests_since, movement.from_ms, &y);
            self.movement(joint, movement, &y);
            rests_since = (movement.motor_until_ms.max(movement.to_ms), movement.to);
        }
        self.rest(rests_since, self.timeline.end_ms(), &y);
    }

    fn rest(&mut self, (from_ms, place): (u64, f64), to_ms: u64, y: &impl Fn(f64) -> f64) {
        if to_ms > from_ms {
            let (from, to, y) = (self.x(from_ms), self.x(to_ms), y(place));
            self.put(&format!(
                "<line x1=\"{from:.1}\" y1=\"{y:.1}\" x2=\"{to:.1}\" y2=\"{y:.1}\" stroke=\"{REST}\" \
                 stroke-width=\"1.5\"/>"
            ));
        }
    }

    fn movement(&mut self, joint: Joint, movement: &Movement, y: &impl Fn(f64) -> f64) {
        let colour = if movement.sense == Sense::First { FIRST } else { LAST };
        let ends = if movement.is_certain {
            "stroke-linecap=\"round\""
        } else {
            "stroke-dasharray=\"4 3\""
        };
        let [from, to, until] =
            [movement.from_ms, movement.to_ms, movement.motor_until_ms].map(|ms| self.x(ms));
        let (from_y, to_y) = (y(movement.from), y(movement.to));
        let mut points = format!("{from:.1},{from_y:.1} {to:.1},{to_y:.1}");
        if until > to {
            let _ = write!(points, " {until:.1},{to_y:.1}");
        }
        self.put(&format!(
            "<polyline points=\"{points}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"4\" \
             stroke-linejoin=\"round\" {ends}><title>{} to {}, {} ms to {} \
             ms</title></polyline>",
            joint.name(),
            target_name(joint, movement),
            movement.from_ms,
            movement.to_ms
        ));
    }

    fn bumpers(&mut self) {
        let y = self.bottom() + 8.0;
        let endings = self.timeline.endings.clone();
        if endings.is_empty() {
            return;
        }
        self.put(&format!("<text x=\"16\" y=\"{:.1}\" fill=\"#202124\">ended by</text>", y + 10.0));
        for (from_ms, to_ms, bumpers) in endings {
            let (from, to) = (self.x(from_ms), self.x(to_ms));
            let names: Vec<&str> = bumpers.names().collect();
            let names = names.join(", ");
            self.put(&format!(
                "<rect x=\"{from:.1}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"5\" \
                 fill=\"{BUMPERS}\"><title>{names}</title></rect>",
                to - from
            ));
            // About six pixels a letter.
            if f64::from(u32::try_from(names.len()).unwrap_or(u32::MAX)) * 5.0 < to - from {
                self.put(&format!(
                    "<text x=\"{from:.1}\" y=\"{:.1}\" font-size=\"9\" fill=\"#5f6368\">{names}</text>",
                    y + 15.0
                ));
            }
        }
    }

    fn labels(&mut self) {
        for (at_ms, name) in self.timeline.labels.clone() {
            let x = self.x(at_ms);
            let (flag, bottom) = (self.top - 36.0, self.bottom());
            self.put(&format!(
                "<line x1=\"{x:.1}\" y1=\"{flag:.1}\" x2=\"{x:.1}\" y2=\"{bottom:.1}\" \
                 stroke=\"#202124\" stroke-dasharray=\"2 3\"/>"
            ));
            // Near the right edge the flag points to the left.
            let (anchor, shift) =
                if x > self.width - 90.0 { ("end", -4.0) } else { ("start", 4.0) };
            self.put(&format!(
                "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\" font-size=\"11\" \
                 font-style=\"italic\" fill=\"#202124\">{}</text>",
                x + shift,
                flag + 9.0,
                escaped(&name)
            ));
        }
    }

    fn waits(&mut self) {
        for (at_ms, bumpers, limit_ms) in self.timeline.waits.clone() {
            let x = self.x(at_ms);
            let (top, bottom) = (self.top, self.bottom());
            let names: Vec<&str> = bumpers.names().collect();
            let limit = mark_exact(u64::from(limit_ms));
            let text = format!("waits for {}, at most {limit}", names.join(" or "));
            self.put(&format!(
                "<rect x=\"{:.1}\" y=\"{top:.1}\" width=\"14\" height=\"{:.1}\" fill=\"#ffffff\" \
                 stroke=\"{BUMPERS}\" stroke-dasharray=\"4 3\"><title>{text}</title></rect>",
                x - 7.0,
                bottom - top
            ));
            let y = f64::midpoint(top, bottom);
            self.put(&format!(
                "<text x=\"{:.1}\" y=\"{y:.1}\" font-size=\"9\" fill=\"#202124\" \
                 text-anchor=\"middle\" transform=\"rotate(-90 {:.1} {y:.1})\">{text}</text>",
                x + 3.0,
                x + 3.0
            ));
        }
    }

    fn legend(&mut self) {
        let y = self.height - 16.0;
        let towards = [
            (FIRST, "towards up, in, left, front"),
            (LAST, "towards down, open, right, back"),
            (REST, "at rest"),
        ];
        let mut x = 16.0;
        for (colour, words) in towards {
            self.put(&format!(
                "<line x1=\"{x}\" y1=\"{:.1}\" x2=\"{}\" y2=\"{:.1}\" stroke=\"{colour}\" \
                 stroke-width=\"4\"/><text x=\"{}\" y=\"{y:.1}\" font-size=\"11\" \
                 fill=\"#5f6368\">{words}</text>",
                y - 4.0,
                x + 18.0,
                y - 4.0,
                x + 24.0
            ));
            x += 36.0 + 6.0 * f64::from(u32::try_from(words.len()).unwrap_or(0));
        }
        self.put(&format!(
            "<text x=\"{x}\" y=\"{y:.1}\" font-size=\"11\" fill=\"#5f6368\">dashed: from an unknown \
             place, drawn from the middle</text>"
        ));
    }

    fn end(mut self) -> String {
        self.svg.push_str("</svg>\n");
        self.svg
    }
}

fn mark_exact(ms: u64) -> String {
    if ms < 60_000 { format!("{}.{} s", ms / 1000, ms % 1000 / 100) } else { mark(ms) }
}

/// A text in XML; what no XML can hold becomes a space.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\u{fffe}' | '\u{ffff}' => escaped.push(' '),
            other if other.is_control() => escaped.push(' '),
            other => escaped.push(other),
        }
    }
    escaped
}
