//! Findings as a compiler tells them: the line, the place underlined, and what to do.

use std::fmt::Write as _;

use super::{Finding, Findings, Severity};
use crate::language::Span;

/// Escape sequences of a terminal, or nothing.
struct Paint {
    with_colour: bool,
}

impl Paint {
    fn over(&self, code: &str, text: &str) -> String {
        if self.with_colour { format!("\x1b[{code}m{text}\x1b[0m") } else { text.to_owned() }
    }

    fn severity(&self, severity: Severity, text: &str) -> String {
        let code = match severity {
            Severity::Error => "1;31",
            Severity::Warning => "1;33",
        };
        self.over(code, text)
    }

    fn quiet(&self, text: &str) -> String {
        self.over("1;34", text)
    }
}

/// Every finding with its lines of the text, which is told as `file_name`, and a last line that counts
/// them. Ends with a new line; empty where nothing was found.
pub fn render(findings: &Findings, file_name: &str, with_colour: bool) -> String {
    let paint = Paint { with_colour };
    let mut text = String::new();
    for finding in &findings.list {
        one(&mut text, findings, finding, file_name, &paint);
        text.push('\n');
    }
    let (errors, warnings) = (findings.errors().count(), findings.warnings().count());
    let counted = |count: usize, what: &str| match count {
        0 => None,
        1 => Some(format!("1 {what}")),
        _ => Some(format!("{count} {what}s")),
    };
    let counts: Vec<String> =
        [counted(errors, "error"), counted(warnings, "warning")].into_iter().flatten().collect();
    if !counts.is_empty() {
        let _ = writeln!(text, "{file_name}: {}", counts.join(", "));
    }
    text
}

fn one(out: &mut String, findings: &Findings, finding: &Finding, file_name: &str, paint: &Paint) {
    // Writing to a string cannot fail.
    let severity = finding.severity();
    let head = format!("{}[{}]", severity.name(), finding.rule);
    let _ = writeln!(out, "{}: {}", paint.severity(severity, &head), finding.message);
    let mut marks: Vec<Mark> = vec![Mark::of(&findings.text, finding.span, &finding.label, true)];
    marks.extend(
        finding.also.iter().map(|(span, label)| Mark::of(&findings.text, *span, label, false)),
    );
    let gutter = marks.iter().map(|mark| mark.line.to_string().len()).max().unwrap_or(1);
    let margin = |number: &str| paint.quiet(&format!("{number:>gutter$} |"));
    let (line, column) = findings.place(finding.span);
    let arrow = paint.quiet(&format!("{:gutter$}-->", ""));
    let _ = writeln!(out, "{arrow} {file_name}:{line}:{column}");
    if !findings.text.is_empty() {
        marks.sort_by_key(|mark| (mark.line, mark.from));
        let _ = writeln!(out, "{}", margin(""));
        let mut last_line = None;
        for mark in &marks {
            if last_line.is_some_and(|last| mark.line > last + 1) {
                let _ = writeln!(out, "{}", paint.quiet("..."));
            }
            if last_line != Some(mark.line) {
                let shown = expanded(line_of(&findings.text, mark.line));
                let _ = writeln!(out, "{} {shown}", margin(&mark.line.to_string()));
            }
            last_line = Some(mark.line);
            let sign = if mark.is_primary { "^" } else { "-" };
            let under = format!("{} {}", sign.repeat(mark.to - mark.from), mark.label);
            let under = if mark.is_primary {
                paint.severity(severity, under.trim_end())
            } else {
                paint.quiet(under.trim_end())
            };
            let _ = writeln!(out, "{} {:indent$}{under}", margin(""), "", indent = mark.from);
        }
    }
    if let Some(help) = &finding.help {
        let _ = writeln!(out, "{}", margin(""));
        let sign = paint.quiet(&format!("{:gutter$} =", ""));
        let _ = writeln!(out, "{sign} help: {help}");
    }
}

/// A place in one line, in columns of what is shown.
struct Mark<'a> {
    line: usize,
    from: usize,
    to: usize,
    label: &'a str,
    is_primary: bool,
}

impl<'a> Mark<'a> {
    /// Of a place that goes over several lines its first line is marked, to the line's end.
    fn of(text: &str, span: Span, label: &'a str, is_primary: bool) -> Mark<'a> {
        let start = span.start.min(text.len());
        let before = text.get(..start).unwrap_or_default();
        let line = before.matches('\n').count() + 1;
        let begin = before.rfind('\n').map_or(0, |end| end + 1);
        let content = line_of(text, line);
        let width = |bytes: usize| {
            expanded(content.get(..bytes.min(content.len())).unwrap_or(content)).chars().count()
        };
        let from = width(start - begin);
        let to = width(span.end.saturating_sub(begin).max(start - begin));
        Mark { line, from, to: to.max(from + 1), label, is_primary }
    }
}

/// A line of the text, from 1, without what ends it.
fn line_of(text: &str, line: usize) -> &str {
    text.split('\n').nth(line - 1).unwrap_or_default().trim_end_matches('\r')
}

/// With four columns for each tab.
fn expanded(line: &str) -> String {
    line.replace('\t', "    ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::{Rule, check_text};
    use crate::expand::NoActions;

    #[track_caller]
    fn rendered(text: &str, expected: &str) {
        let checked = check_text(text, &NoActions);
        assert_eq!(render(&checked.findings, "nod.rsa", false), expected);
    }

    #[test]
    fn a_place_is_underlined_and_its_counterpart_marked() {
        rendered(
            "action nod {\n    do tilt-left + tilt-right for 1s\n}\n",
            "\
error[joint-two-ways]: the joint tilt is sent two ways at once
 --> nod.rsa:2:20
  |
2 |     do tilt-left + tilt-right for 1s
  |        --------- left here
  |                    ^^^^^^^^^^ right here
  |
  = help: make two steps of it, one behind the other

nod.rsa: 1 error
",
        );
    }

    #[test]
    fn tabs_wide_letters_and_other_line_ends_keep_the_place() {
        rendered(
            "# é\r\naction nod {\r\n\tdescription \"übt\" do tilt-lefd\r\n}\r\n",
            "\
error[unknown-name]: there is no motion primitive `tilt-lefd`
 --> nod.rsa:3:23
  |
3 |     description \"übt\" do tilt-lefd
  |                          ^^^^^^^^^
  |
  = help: did you mean `tilt-left`?

nod.rsa: 1 error
",
        );
    }

    #[test]
    fn several_places_far_apart_and_several_findings() {
        rendered(
            "action nod { wait 1s }\n\n\n\n\n\n\n\n\naction nod { wait 0s }\n",
            "\
error[defined-twice]: the action `nod` is there twice
  --> nod.rsa:10:8
   |
 1 | action nod { wait 1s }
   |        --- first here
...
10 | action nod { wait 0s }
   |        ^^^
   |
   = help: give one of them another name

error[out-of-range]: `0ms` is out of range
  --> nod.rsa:10:19
   |
10 | action nod { wait 0s }
   |                   ^^
   |
   = help: a step lasts 1ms to 65535ms

nod.rsa: 2 errors
",
        );
    }

    #[test]
    fn a_place_over_several_lines_or_at_the_end_is_marked_where_it_begins() {
        let text = "action nod {\n  repeat 2 {\n    label x\n  }\n  wait 1s\n}";
        let checked = check_text(text, &NoActions);
        let told = render(&checked.findings, "-", false);
        assert!(told.contains("2 |   repeat 2 {\n  |   ^^^^^^^^^^\n"), "{told}");
        let empty = Findings::new("", vec![Finding::new(Rule::Syntax, Span::default(), "empty")]);
        assert_eq!(render(&empty, "-", false), "error[syntax]: empty\n --> -:1:1\n\n-: 1 error\n");
        assert_eq!(render(&Findings::default(), "-", false), "");
        assert!(render(&empty, "-", true).contains("\x1b[1;31merror[syntax]\x1b[0m"));
    }
}
