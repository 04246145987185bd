//! How `rsapien top` looks.

use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Modifier, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Clear, Gauge, List, ListState, Paragraph, Sparkline, Wrap};

use super::model::{Shown, Top};
use crate::LinkState;
use crate::cli::screen::parts;
use crate::cli::view::seconds;

/// The smallest terminal.
const WIDTH: u16 = 78;
const HEIGHT: u16 = 23;

const KEYS: &str = "p play  r pause  e end  arrows joints  i init  ? help  q quit";
const HELP: &str = "\
space        STOP: motors off at once, whatever the screen shows
p, Enter     play an action: type to search, Enter plays it, Esc goes back
r            pause what is played at the end of a step, and let it go on
e, Esc       end what is played
up, down     choose a joint
left, right  send it one position further: its first is left, its last right
i            initialise the robot: every joint to its middle position
q            quit; Ctrl-C, too. Motors off first

What moves other joints goes on beside what is played; other programs can
play on this robot meanwhile, and are shown.

Any key goes back.";

pub(super) fn draw(top: &Top, frame: &mut Frame<'_>) {
    if parts::is_too_small(frame, WIDTH, HEIGHT) {
        return;
    }
    let rows = [
        Constraint::Length(1),
        Constraint::Length(10),
        Constraint::Length(5),
        Constraint::Min(4),
        Constraint::Length(1),
    ];
    let [head, robot, work, remarks, keys] = Layout::vertical(rows).areas(frame.area());
    let [joints, body] =
        Layout::horizontal([Constraint::Min(48), Constraint::Length(28)]).areas(robot);
    let [queue, link] =
        Layout::horizontal([Constraint::Percentage(55), Constraint::Percentage(45)]).areas(work);
    draw_head(top, frame, head);
    let report = top.state.motion_report();
    let text = parts::joints(report.as_ref(), top.sent, Some(top.selected), top.palette);
    frame.render_widget(Paragraph::new(text).block(parts::block("joints")), joints);
    let picture = Paragraph::new(parts::body(report.as_ref()));
    frame.render_widget(picture.block(parts::block("bumpers")), body);
    draw_queue(top, frame, queue);
    draw_link(top, frame, link);
    draw_remarks(top, frame, remarks);
    parts::keys(frame, keys, KEYS, top.palette);
    match &top.shown {
        Shown::Robot => {}
        Shown::Help => draw_help(frame),
        Shown::Actions { letters, selected } => draw_actions(top, frame, letters, *selected),
    }
}

fn draw_head(top: &Top, frame: &mut Frame<'_>, area: Rect) {
    let palette = top.palette;
    let mut spans = vec![Span::styled(
        format!(" {} ", top.link),
        Style::new().add_modifier(Modifier::REVERSED),
    )];
    if let Some(report) = top.state.motion_information {
        let [major, minor, patch] = report.firmware;
        let dead_man = match report.dead_man_ms {
            0 => "no dead-man".to_owned(),
            ms => format!("dead-man {ms} ms"),
        };
        let clock_mhz = report.clock_mhz;
        spans.push(
            format!("  firmware {major}.{minor}.{patch}, {clock_mhz} MHz, {dead_man}").into(),
        );
    }
    match (&top.state.link, top.state.motion_report()) {
        (LinkState::Silent { .. }, _) => spans.push(Span::styled("  NO ANSWER", palette.bad())),
        (LinkState::Lost { .. }, _) => spans.push(Span::styled("  LINK LOST", palette.bad())),
        (LinkState::Up, Some(report)) => {
            let style = if top.state.is_moving() { palette.busy() } else { palette.good() };
            spans.push(Span::styled(format!("  {}", report.mode.name()), style));
            if report.supply_low {
                spans.push(Span::styled("  SUPPLY BELOW 5 V", palette.bad()));
            } else {
                spans.push("  supply 5 V".into());
            }
        }
        (LinkState::Up, None) => {}
    }
    frame.render_widget(Line::from(spans), area);
}

fn draw_queue(top: &Top, frame: &mut Frame<'_>, area: Rect) {
    let block = parts::block("queue");
    let inner = block.inner(area);
    frame.render_widget(block, area);
    let [first, second, third] = Layout::vertical([Constraint::Length(1); 3]).areas(inner);
    let line = top.state.motion_report().map_or("nothing is known of it".to_owned(), |report| {
        format!("{} places free, {} steps ended", report.queue_free, report.steps_ended)
    });
    frame.render_widget(Line::from(line), first);
    if let Some((name, progress)) = &top.playing {
        let paused = if top.is_paused { " (paused)" } else { "" };
        let (ended, total) = (progress.steps_ended, progress.steps_total);
        let waiting: Vec<&str> = progress.waiting_for.names().collect();
        let what = if waiting.is_empty() {
            format!("{name}{paused}: step {ended} of {total}")
        } else {
            format!("{name} waits for {}", waiting.join(" or "))
        };
        #[allow(clippy::cast_precision_loss)] // a bar of a few dozen cells
        let ratio = ended as f64 / total.max(1) as f64;
        let style = if top.is_paused { Style::new() } else { top.palette.good() };
        let gauge = Gauge::default().gauge_style(style).ratio(ratio.clamp(0.0, 1.0)).label(what);
        frame.render_widget(gauge, second);
    }
    let others: Vec<String> = top
        .claims
        .iter()
        .filter(|claim| claim.pid != std::process::id())
        .map(ToString::to_string)
        .collect();
    if !others.is_empty() {
        frame.render_widget(Line::from(others.join(", ")), third);
    }
}

fn draw_link(top: &Top, frame: &mut Frame<'_>, area: Rect) {
    let block = parts::block("link");
    let inner = block.inner(area);
    frame.render_widget(block, area);
    let [first, second, third] = Layout::vertical([Constraint::Length(1); 3]).areas(inner);
    let counts = top.state.counts;
    let line = format!("{} sent, {} answered", counts.sent, counts.answered);
    frame.render_widget(Line::from(line), first);
    let troubles = counts.resent + counts.unanswered + u64::from(counts.reception_errors);
    let line = format!(
        "{} again, {} in vain, {} errors",
        counts.resent, counts.unanswered, counts.reception_errors
    );
    let style = if troubles == 0 { top.palette.good() } else { top.palette.busy() };
    frame.render_widget(Line::styled(line, style), second);
    let trips = top.trips_us();
    let latest_ms = trips.last().map_or(0, |us| us / 1000);
    let [word, picture] =
        Layout::horizontal([Constraint::Length(9), Constraint::Min(1)]).areas(third);
    frame.render_widget(Line::from(format!("{latest_ms:>3} ms ")), word);
    let shown = trips.len().saturating_sub(usize::from(picture.width));
    let line = Sparkline::default().data(trips.get(shown..).unwrap_or_default());
    frame.render_widget(line.style(top.palette.faint()), picture);
}

fn draw_remarks(top: &Top, frame: &mut Frame<'_>, area: Rect) {
    let height = usize::from(area.height.saturating_sub(2));
    let first = top.remarks.len().saturating_sub(height);
    let lines: Vec<Line<'_>> =
        top.remarks.iter().skip(first).map(|text| Line::from(text.as_str())).collect();
    frame.render_widget(Paragraph::new(lines).block(parts::block("what happened")), area);
}

/// A place in the middle.
fn middle(frame: &Frame<'_>, width: u16, height: u16) -> Rect {
    let area = frame.area();
    let (width, height) = (width.min(area.width), height.min(area.height));
    Rect::new((area.width - width) / 2, (area.height - height) / 2, width, height)
}

fn draw_help(frame: &mut Frame<'_>) {
    let area = middle(frame, 76, 17);
    frame.render_widget(Clear, area);
    let text = Paragraph::new(HELP).wrap(Wrap { trim: false }).block(parts::block("keys"));
    frame.render_widget(text, area);
}

fn draw_actions(top: &Top, frame: &mut Frame<'_>, letters: &str, selected: usize) {
    let area = middle(frame, 74, 18);
    frame.render_widget(Clear, area);
    let found = top.found(letters);
    let rows = found.iter().map(|named| {
        format!("{:<18} {:>8}  {}", named.name, seconds(named.duration_ms), named.description)
    });
    let title = format!("play: {letters}_  (Enter plays, Esc goes back)");
    let list = List::new(rows)
        .block(parts::block(&title))
        .highlight_symbol("> ")
        .highlight_style(Style::new().add_modifier(Modifier::REVERSED));
    let mut state = ListState::default().with_selected((!found.is_empty()).then_some(selected));
    frame.render_stateful_widget(list, area, &mut state);
}
