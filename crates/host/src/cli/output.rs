//! What stands on the standard output: text for people, or one line of JSON an answer for programs.

use std::fmt;
use std::io::Write;

use serde::Serialize;

use super::diagnostics::Result;

/// What a stream can show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Screen {
    /// It is no terminal: a file, a pipe.
    None,
    /// A terminal without colours.
    Plain,
    /// A terminal with colours.
    Color,
}

impl Screen {
    /// Whether it is a terminal.
    pub(crate) fn is_terminal(self) -> bool {
        self != Self::None
    }
}

/// How answers are written, and what the terminals can show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Style {
    /// JSON instead of text.
    pub(crate) json: bool,
    /// The standard output.
    pub(crate) output: Screen,
    /// The standard error, where progress and failures are drawn.
    pub(crate) error: Screen,
}

impl Style {
    /// Writes an answer: `json` as one line where JSON is asked for, `text` and a new line otherwise.
    pub(crate) fn answer(
        self,
        out: &mut impl Write,
        json: &impl Serialize,
        text: impl fmt::Display,
    ) -> Result<()> {
        if self.json {
            json_line(out, json)
        } else {
            writeln!(out, "{text}")?;
            Ok(out.flush()?)
        }
    }

    /// Writes a remark that only people read; with JSON asked for it is left out.
    pub(crate) fn remark(self, out: &mut impl Write, text: impl fmt::Display) -> Result<()> {
        if !self.json {
            writeln!(out, "{text}")?;
            out.flush()?;
        }
        Ok(())
    }
}

/// One value as one line, at once, so that a reader at the other end of a pipe sees it when it happens.
pub(crate) fn json_line(out: &mut impl Write, value: &impl Serialize) -> Result<()> {
    serde_json::to_writer(&mut *out, value)?;
    writeln!(out)?;
    Ok(out.flush()?)
}

/// Columns of text, each as wide as its widest cell, numbers at the right.
#[derive(Debug, Default)]
pub(crate) struct Table {
    head: Vec<&'static str>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with these columns.
    pub(crate) fn new(head: &[&'static str]) -> Self {
        Self { head: head.to_vec(), rows: Vec::new() }
    }

    /// Adds a row.
    pub(crate) fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// Whether it has no rows.
    pub(crate) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }
}

/// Without the last new line.
impl fmt::Display for Table {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let head: Vec<String> = self.head.iter().map(ToString::to_string).collect();
        let column = |index: usize| self.rows.iter().filter_map(move |row| row.get(index));
        let widths: Vec<(usize, bool)> = (head.iter().enumerate())
            .map(|(index, name)| {
                let width = column(index).map(|cell| cell.chars().count()).max().unwrap_or(0);
                let numbers = column(index)
                    .all(|cell| cell.is_empty() || cell == "-" || cell.parse::<f64>().is_ok());
                (width.max(name.chars().count()), numbers && !self.rows.is_empty())
            })
            .collect();
        for (count, row) in std::iter::once(&head).chain(&self.rows).enumerate() {
            if count > 0 {
                formatter.write_str("\n")?;
            }
            let cells = row.iter().zip(&widths).map(|(cell, &(width, number))| {
                if number { format!("{cell:>width$}") } else { format!("{cell:<width$}") }
            });
            formatter.write_str(cells.collect::<Vec<_>>().join("  ").trim_end())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_aligns_words_left_and_numbers_right() {
        let mut table = Table::new(&["name", "steps"]);
        table.row(["wave".to_owned(), "4".to_owned()]);
        table.row(["walk-forward".to_owned(), "12".to_owned()]);
        assert_eq!(
            table.to_string(),
            "name          steps\nwave              4\nwalk-forward     12"
        );
    }

    #[test]
    fn with_json_remarks_are_left_out_and_answers_are_one_line() {
        let style = Style { json: true, output: Screen::Color, error: Screen::Color };
        let mut out = Vec::new();
        style.remark(&mut out, "for people").unwrap();
        style.answer(&mut out, &serde_json::json!({"ports": ["a\nb"]}), "for people").unwrap();
        assert_eq!(String::from_utf8(out).unwrap(), "{\"ports\":[\"a\\nb\"]}\n");
    }
}
