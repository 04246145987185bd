//! How `rsapien teach` looks.

use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Modifier, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Clear, Paragraph, Wrap};

use super::model::{Shown, Teach, arrival_ms};
use crate::LinkState;
use crate::cli::screen::parts;

/// The smallest terminal.
const WIDTH: u16 = 78;
const HEIGHT: u16 = 20;

const KEYS: &str = "arrows move  Enter mark  u undo  t try  w save  ? help  q quit";
const HELP: &str = "\
space        STOP: motors off at once; what was not marked is forgotten
up, down     choose a joint
left, right  send it one position further; the robot moves at once
Enter        mark the step, as a press of a hand bumper does; where nothing
             was moved, a wait
u            forget what was not marked, or the last step
+, -         make the last step 50 ms longer or shorter
t            try it: play it from its beginning; e ends it
i            initialise the robot
w            check it, try it on the virtual body and save it
q            quit; what is not saved is kept in a file

Any key goes back.";

pub(super) fn draw(teach: &Teach<'_>, frame: &mut Frame<'_>) {
    if parts::is_too_small(frame, WIDTH, HEIGHT) {
        return;
    }
    let rows = [
        Constraint::Length(1),
        Constraint::Length(9),
        Constraint::Min(5),
        Constraint::Length(1),
        Constraint::Length(1),
    ];
    let [head, robot, below, remark, keys] = Layout::vertical(rows).areas(frame.area());
    let mut line = vec![
        Span::styled(
            format!(" teach {} ", teach.name),
            Style::new().add_modifier(Modifier::REVERSED),
        ),
        Span::raw(format!("  {} steps", teach.steps.len())),
    ];
    if teach.state.link != LinkState::Up {
        line.push(Span::styled("  NO ANSWER FROM THE ROBOT", teach.palette.bad()));
    }
    frame.render_widget(Line::from(line), head);
    let report = teach.state.motion_report();
    let text = parts::joints(report.as_ref(), teach.sent, Some(teach.selected), teach.palette);
    let joints = Paragraph::new(text).block(parts::block("joints"));
    let [left, right] =
        Layout::horizontal([Constraint::Min(48), Constraint::Length(28)]).areas(robot);
    frame.render_widget(joints, left);
    draw_open(teach, frame, right);
    if teach.findings.is_empty() {
        draw_text(teach, frame, below);
    } else {
        let [text, found] =
            Layout::horizontal([Constraint::Percentage(40), Constraint::Percentage(60)])
                .areas(below);
        draw_text(teach, frame, text);
        let lines: Vec<Line<'_>> =
            teach.findings.iter().map(|it| Line::from(it.as_str())).collect();
        frame.render_widget(Paragraph::new(lines).block(parts::block("the checker says")), found);
    }
    frame.render_widget(Line::styled(format!(" {}", teach.remark), teach.palette.busy()), remark);
    parts::keys(frame, keys, KEYS, teach.palette);
    match teach.shown {
        Shown::Robot => {}
        Shown::Help => draw_over(frame, "keys", HELP, 76, 16),
        Shown::Leaving => {
            let text = "It is not saved. w saves it, y leaves and keeps it in a file, any other key goes on.";
            draw_over(frame, "leave?", text, 60, 4);
        }
    }
}

/// What was moved since the last mark.
fn draw_open(teach: &Teach<'_>, frame: &mut Frame<'_>, area: Rect) {
    let mut lines: Vec<Line<'_>> =
        teach.open.primitives().map(|it| Line::from(it.to_string())).collect();
    if lines.is_empty() {
        lines.push(Line::styled("nothing yet", teach.palette.faint()));
    } else {
        let ms = arrival_ms(teach.open);
        lines.push(Line::styled(format!("for {ms} ms at least"), teach.palette.faint()));
    }
    frame.render_widget(Paragraph::new(lines).block(parts::block("not marked yet")), area);
}

/// The action, its end where it is longer than the place.
fn draw_text(teach: &Teach<'_>, frame: &mut Frame<'_>, area: Rect) {
    let text = teach.text();
    let lines: Vec<&str> = text.lines().collect();
    let height = usize::from(area.height.saturating_sub(2));
    let first = lines.len().saturating_sub(height);
    let shown = lines.get(first..).unwrap_or_default().join("\n");
    frame.render_widget(Paragraph::new(shown).block(parts::block("the action")), area);
}

fn draw_over(frame: &mut Frame<'_>, title: &str, text: &str, width: u16, height: u16) {
    let area = frame.area();
    let (width, height) = (width.min(area.width), height.min(area.height));
    let area = Rect::new((area.width - width) / 2, (area.height - height) / 2, width, height);
    frame.render_widget(Clear, area);
    let text = Paragraph::new(text).wrap(Wrap { trim: false }).block(parts::block(title));
    frame.render_widget(text, area);
}
