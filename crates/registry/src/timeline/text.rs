//! The timeline in a terminal.

use rsapien_protocol::Joint;

use super::{Timeline, mark, target_name};
use crate::motion::{Movement, Sense};

/// The narrowest picture, in columns.
const WIDTH_MIN: usize = 40;
/// The columns of the joints' names.
const NAMES: usize = 11;

/// Where the action is now.
const NOW: char = '┃';

/// Colours of a terminal for the two senses.
const FIRST: &str = "\x1b[34m";
const LAST: &str = "\x1b[33m";
const QUIET: &str = "\x1b[2m";
const PLAIN: &str = "\x1b[0m";

impl Timeline {
    /// Seven rows with the motors' senses over time, below a ruler and the labels; `width` columns
    /// wide, at least 40. Ends with a new line.
    pub fn to_text(&self, width: usize, with_colour: bool) -> String {
        self.to_text_at(width, with_colour, None)
    }

    /// As [`to_text`](Timeline::to_text), with a bar in every row at `now_ms`, where the action is now.
    pub fn to_text_at(&self, width: usize, with_colour: bool, now_ms: Option<u64>) -> String {
        let columns = width.max(WIDTH_MIN) - NAMES;
        let mut lines = vec![self.ruler(columns)];
        if !self.labels.is_empty() {
            let flags = self.labels.iter().map(|(at_ms, name)| (*at_ms, format!("┌{name}")));
            lines.push(self.above(columns, flags));
        }
        for joint in Joint::ALL {
            let mut cells = self.row(joint, columns);
            if let Some(now_ms) = now_ms {
                cells[self.column(now_ms, columns)] = NOW;
            }
            lines.push(format!("{:<NAMES$}{}", joint.name(), painted(&cells, with_colour)));
        }
        if !self.endings.is_empty() {
            lines.push(self.ending_line(columns));
        }
        for (at_ms, bumpers, limit_ms) in &self.waits {
            let names: Vec<&str> = bumpers.names().collect();
            let (at, limit) = (mark(*at_ms), mark(u64::from(*limit_ms)));
            lines.push(format!("┆ at {at}: waits for {}, at most {limit}", names.join(" or ")));
        }
        lines.push(
            "▲ ◀ towards up, in, left, front   ▼ ▶ towards down, open, right, back   hollow: from an \
             unknown place, drawn from the middle"
                .to_owned(),
        );
        let lines: Vec<&str> = lines.iter().map(|line| line.trim_end()).collect();
        lines.join("\n") + "\n"
    }

    fn column(&self, at_ms: u64, columns: usize) -> usize {
        let column = u128::from(at_ms) * columns as u128 / u128::from(self.end_ms());
        usize::try_from(column).unwrap_or(columns).min(columns - 1)
    }

    fn ruler(&self, columns: usize) -> String {
        let step_ms = self.ruler_ms((columns / 9) as u64);
        let marks = (0..).map(|count| count * step_ms).take_while(|at_ms| *at_ms < self.end_ms());
        self.above(columns, marks.map(|at_ms| (at_ms, format!("|{}", mark(at_ms)))))
    }

    /// Texts at their times, each as far as the next allows.
    fn above(&self, columns: usize, texts: impl Iterator<Item = (u64, String)>) -> String {
        let mut cells = vec![' '; columns];
        for (at_ms, text) in texts {
            let from = self.column(at_ms, columns);
            let letters = text.chars().zip(cells.iter_mut().skip(from));
            letters.for_each(|(letter, cell)| *cell = letter);
            // What was written there before and is longer would be read as a part of it.
            let behind = from + text.chars().count();
            let rest = cells.iter_mut().skip(behind).take_while(|cell| **cell != ' ');
            rest.for_each(|cell| *cell = ' ');
        }
        format!("{:NAMES$}{}", "", cells.into_iter().collect::<String>())
    }

    fn row(&self, joint: Joint, columns: usize) -> Vec<char> {
        let mut cells = vec!['·'; columns];
        let row = &self.motion.rows[usize::from(joint.index())];
        for (index, movement) in row.iter().enumerate() {
            let from = self.column(movement.from_ms, columns);
            let until_ms = movement.motor_until_ms.max(movement.from_ms + 1);
            let to = self.column(until_ms - 1, columns).max(from);
            cells[from..=to].fill(sign(joint, movement));
            let next = row.get(index + 1);
            let room = next.map_or(columns, |next| self.column(next.from_ms, columns));
            let name = target_name(joint, movement);
            // A name is written where the joint rests, with a column left free before what follows.
            if movement.is_complete && to + 1 + name.len() < room + usize::from(next.is_none()) {
                for (letter, cell) in name.chars().zip(&mut cells[to + 1..]) {
                    *cell = letter;
                }
            }
        }
        for (at_ms, _, _) in &self.waits {
            cells[self.column(*at_ms, columns)] = '┆';
        }
        cells
    }

    fn ending_line(&self, columns: usize) -> String {
        let mut cells = vec![' '; columns];
        let mut names: Vec<&str> = Vec::new();
        for (from_ms, to_ms, bumpers) in &self.endings {
            let (from, to) = (self.column(*from_ms, columns), self.column(to_ms - 1, columns));
            cells[from..=to.max(from)].fill('━');
            names.extend(bumpers.names());
        }
        names.sort_unstable();
        names.dedup();
        let line: String = cells.into_iter().collect();
        let line = format!("{:<NAMES$}{line}", "bumpers");
        format!("{}\n{:NAMES$}━ here {} end it", line.trim_end(), "", names.join(", "))
    }
}

fn sign(joint: Joint, movement: &Movement) -> char {
    let is_arm = matches!(joint, Joint::RightArm | Joint::LeftArm);
    match (is_arm, movement.sense, movement.is_certain) {
        (true, Sense::First, true) => '▲',
        (true, Sense::First, false) => '△',
        (true, Sense::Last, true) => '▼',
        (true, Sense::Last, false) => '▽',
        (false, Sense::First, true) => '◀',
        (false, Sense::First, false) => '◁',
        (false, Sense::Last, true) => '▶',
        (false, Sense::Last, false) => '▷',
    }
}

fn painted(cells: &[char], with_colour: bool) -> String {
    let mut text = String::new();
    let mut last = PLAIN;
    for cell in cells {
        let colour = match cell {
            '▲' | '△' | '◀' | '◁' => FIRST,
            '▼' | '▽' | '▶' | '▷' => LAST,
            '·' | '┆' => QUIET,
            _ => PLAIN,
        };
        if with_colour && colour != last {
            text.push_str(PLAIN);
            text.push_str(colour);
        }
        last = colour;
        text.push(*cell);
    }
    if with_colour && last != PLAIN {
        text.push_str(PLAIN);
    }
    text
}
