//! What several screens show: the joints, the bumpers where they sit, a line of keys.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::{Line, Span, Text};
use ratatui::widgets::{Block, Paragraph};
use rsapien_protocol::{BumperMask, Joint, MotionReport, Pose, Position};

/// How things are drawn with colours, or without.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Palette {
    pub(crate) is_colored: bool,
}

impl Palette {
    fn style(self, color: Color) -> Style {
        if self.is_colored { Style::new().fg(color) } else { Style::new() }
    }

    /// What is well.
    pub(crate) fn good(self) -> Style {
        self.style(Color::Green)
    }

    /// What moves or is pressed.
    pub(crate) fn busy(self) -> Style {
        self.style(Color::Yellow).add_modifier(Modifier::BOLD)
    }

    /// What is wrong.
    pub(crate) fn bad(self) -> Style {
        self.style(Color::Red).add_modifier(Modifier::BOLD)
    }

    /// What is only said once.
    pub(crate) fn faint(self) -> Style {
        if self.is_colored { Style::new().fg(Color::DarkGray) } else { Style::new() }
    }
}

/// A frame with a title.
pub(crate) fn block(title: &str) -> Block<'_> {
    Block::bordered().title(format!(" {title} "))
}

/// Says how large the terminal has to be, where it is too small: then nothing else is drawn.
pub(crate) fn is_too_small(frame: &mut Frame<'_>, width: u16, height: u16) -> bool {
    let area = frame.area();
    if area.width >= width && area.height >= height {
        return false;
    }
    let (has_width, has_height) = (area.width, area.height);
    let text = format!(
        "this screen needs {width} columns and {height} lines; the terminal has {has_width} and {has_height}. Space is STOP, q leaves."
    );
    frame.render_widget(Paragraph::new(text).wrap(ratatui::widgets::Wrap { trim: true }), area);
    true
}

/// The position of `joint` before or behind the one it is at or was sent to.
pub(crate) fn neighbour(
    report: Option<&MotionReport>,
    sent: Pose,
    joint: Joint,
    is_next: bool,
) -> Position {
    let at = sent.get(joint).or(report.and_then(|report| report.position(joint)));
    let number = at.map_or(2, Position::number);
    let number = if is_next { (number + 1).min(3) } else { (number - 1).max(1) };
    Position::from_number(number).unwrap_or(Position::Middle)
}

/// The joints, a line each: `> right-arm   up  [front]  down   moving`. Where it stands is in brackets, where it was
/// sent has an arrow.
pub(crate) fn joints(
    report: Option<&MotionReport>,
    sent: Pose,
    selected: Option<usize>,
    palette: Palette,
) -> Text<'static> {
    let line = |(index, joint): (usize, Joint)| {
        let mark = if selected == Some(index) { "> " } else { "  " };
        let style = if selected == Some(index) {
            Style::new().add_modifier(Modifier::BOLD)
        } else {
            Style::new()
        };
        let mut spans = vec![Span::styled(format!("{mark}{:<11}", joint.name()), style)];
        let at = report.and_then(|report| report.position(joint));
        let is_running = report.is_some_and(|report| report.is_running(joint));
        for (number, name) in (1..).zip(joint.position_names()) {
            let is_at = at.is_some_and(|at| at.number() == number);
            let is_goal = sent.get(joint).is_some_and(|goal| goal.number() == number);
            let cell = match (is_at, is_goal) {
                (true, _) => format!("[{name}]"),
                (false, true) => format!("→{name} "),
                (false, false) => format!(" {name} "),
            };
            let style = if is_at {
                palette.good()
            } else if is_goal {
                palette.busy()
            } else {
                palette.faint()
            };
            spans.push(Span::styled(format!("{cell:<8}"), style));
        }
        let (word, style) = match (is_running, at) {
            (true, _) => ("moving", palette.busy()),
            (false, Some(_)) => ("", Style::new()),
            (false, None) => ("?", palette.faint()),
        };
        spans.push(Span::styled(word, style));
        Line::from(spans)
    };
    Joint::ALL.into_iter().enumerate().map(line).collect::<Vec<Line<'static>>>().into()
}

/// The robot from the front, its left at the right; a pressed bumper is `#`, a closed mid-arm switch `*`. Each has the
/// count of its presses (modulo 16) beside it.
pub(crate) fn body(report: Option<&MotionReport>) -> Text<'static> {
    let pressed = report.map_or(BumperMask::NONE, |report| report.bumpers);
    let count = |index: usize| {
        let count = report.and_then(|report| report.presses.get(index).copied());
        count.map_or("-".to_owned(), |count| count.to_string())
    };
    let mark = |index: usize| if pressed.contains(index) { '#' } else { 'o' };
    let [left_middle, right_middle] = report.map_or([false; 2], |report| report.middle_switches);
    let middle = |is_closed| if is_closed { '*' } else { '.' };
    let lines = [
        "            ___".to_owned(),
        "           (o o)".to_owned(),
        format!("     .--{}--[===]--{}--.", middle(right_middle), middle(left_middle)),
        "     |     |   |     |".to_owned(),
        format!(" {:>2} {}     |___|     {} {}", count(5), mark(5), mark(4), count(4)),
        "           /   \\".to_owned(),
        format!(" front {:>2} {}     {} {}", count(2), mark(2), mark(0), count(0)),
        format!(" back  {:>2} {}     {} {}", count(3), mark(3), mark(1), count(1)),
    ];
    lines.into_iter().map(Line::from).collect::<Vec<_>>().into()
}

/// The line of keys at the bottom.
pub(crate) fn keys(frame: &mut Frame<'_>, area: Rect, text: &str, palette: Palette) {
    let line = Line::from(vec![
        Span::styled(" space STOP ", palette.bad().add_modifier(Modifier::REVERSED)),
        Span::raw(format!("  {text}")),
    ]);
    frame.render_widget(line, area);
}
