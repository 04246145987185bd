//! Actions as TOML: what a person writes, and what is exported.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::ops::Range;

use serde::Deserialize;
use toml::Spanned;

use crate::action::{ActionDraft, ActionStep};
use crate::draft_check::check_draft;
use crate::form::{StepForm, Words};
use crate::problem::{Finding, Findings, Problem};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileForm {
    #[serde(default)]
    action: Vec<ActionForm>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ActionForm {
    name: Spanned<String>,
    #[serde(default)]
    description: String,
    #[serde(default)]
    tags: Vec<String>,
    steps: Vec<Spanned<StepForm>>,
}

/// The actions of a text, in its order, each checked by itself.
///
/// Which other actions they play is not looked at: a registry does that
/// ([`Registry::check_toml`](crate::Registry::check_toml)).
///
/// # Errors
/// Everything found wrong, with lines, actions and steps. A text that is no TOML or not of the
/// form gives the first thing that is wrong.
pub fn read_toml(text: &str) -> Result<Vec<ActionDraft>, Findings> {
    TomlActions::read(text).map(|actions| actions.drafts)
}

/// The text of `drafts`, in their order; reading it gives them again.
///
/// Each of them has to pass [`check_draft`].
pub fn write_toml(drafts: &[ActionDraft]) -> String {
    let mut text = String::new();
    for draft in drafts {
        if !text.is_empty() {
            text.push('\n');
        }
        write_action(&mut text, draft);
    }
    text
}

/// Actions read from a text, with the lines they stand in.
pub(crate) struct TomlActions {
    pub(crate) drafts: Vec<ActionDraft>,
    /// By action name: the line of the name and the line of each step.
    lines: BTreeMap<String, (usize, Vec<usize>)>,
}

impl TomlActions {
    /// As of [`read_toml`].
    pub(crate) fn read(text: &str) -> Result<TomlActions, Findings> {
        let text_lines = Lines::of(text);
        let file: FileForm = toml::from_str(text).map_err(|error| {
            // Where something is missing at the end, the place is the end of the text.
            let line = error.span().map(|span| text_lines.line_of(&span));
            let message = error.message().trim().replace('\n', "; ");
            let problem = Problem::Toml { message };
            Findings(vec![Finding { line, action: None, step: None, problem }])
        })?;
        let mut actions = TomlActions { drafts: Vec::new(), lines: BTreeMap::new() };
        let mut findings = Vec::new();
        for mut form in file.action {
            let line = text_lines.line_of(&form.name.span());
            let name = form.name.get_ref().clone();
            let mut steps = Vec::new();
            let mut step_lines = Vec::new();
            let mut own_findings = Vec::new();
            for (number, step) in (1..).zip(std::mem::take(&mut form.steps)) {
                step_lines.push(text_lines.line_of(&step.span()));
                steps.push(step.into_inner().read().unwrap_or_else(|problem| {
                    own_findings.push(Finding::of(&name, Some(number), problem));
                    // Stands in for the step so that the others keep their numbers.
                    ActionStep::pause(1)
                }));
            }
            if let Some((first_line, _)) = actions.lines.get(&name) {
                let problem = Problem::DefinedTwice { name: name.clone(), first_line: *first_line };
                findings.push(Finding { line: Some(line), ..Finding::of(&name, None, problem) });
                continue;
            }
            let ActionForm { description, tags, .. } = form;
            let draft = ActionDraft { name: name.clone(), description, tags, steps };
            own_findings.extend(check_draft(&draft));
            own_findings.sort_by_key(|finding| finding.step);
            actions.lines.insert(name, (line, step_lines));
            actions.locate(&mut own_findings);
            findings.append(&mut own_findings);
            actions.drafts.push(draft);
        }
        if findings.is_empty() { Ok(actions) } else { Err(Findings(findings)) }
    }

    /// Gives findings the lines of the actions and steps they speak of.
    pub(crate) fn locate(&self, findings: &mut [Finding]) {
        for finding in findings {
            let lines = finding.action.as_ref().and_then(|action| self.lines.get(action));
            let Some((action_line, step_lines)) = lines else { continue };
            let step = finding.step.and_then(|step| step_lines.get(step.checked_sub(1)?));
            finding.line = finding.line.or(Some(*step.unwrap_or(action_line)));
        }
    }
}

/// Where the lines of a text begin.
struct Lines {
    begins: Vec<usize>,
}

impl Lines {
    fn of(text: &str) -> Lines {
        let behind_ends = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        let begins = std::iter::once(0).chain(behind_ends.map(|(end, _)| end + 1));
        Lines { begins: begins.collect() }
    }

    /// The line in which `span` begins, from 1.
    fn line_of(&self, span: &Range<usize>) -> usize {
        self.begins.partition_point(|begin| *begin <= span.start)
    }
}

fn write_action(text: &mut String, draft: &ActionDraft) {
    let ActionDraft { name, description, tags, steps } = draft;
    text.push_str("[[action]]\n");
    // Writing to a string cannot fail.
    let _ = writeln!(text, "name = {}", quoted(name));
    if !description.is_empty() {
        let _ = writeln!(text, "description = {}", quoted(description));
    }
    if !tags.is_empty() {
        let _ = writeln!(text, "tags = {}", list(tags));
    }
    text.push_str("steps = [\n");
    for step in steps {
        let StepForm { primitives, pause, play, ms, until, times } = StepForm::of(step);
        let words = |words: Words| match words.0.as_slice() {
            [word] => quoted(word),
            words => list(words),
        };
        let pairs = [
            ("do", primitives.map(words)),
            ("pause", pause.map(|pause| pause.to_string())),
            ("play", play.map(|play| quoted(&play))),
            ("ms", ms.map(|ms| ms.to_string())),
            ("until", until.map(words)),
            ("times", times.map(|times| times.to_string())),
        ];
        let pairs: Vec<String> = pairs
            .into_iter()
            .filter_map(|(key, value)| Some(format!("{key} = {}", value?)))
            .collect();
        let _ = writeln!(text, "  {{ {} }},", pairs.join(", "));
    }
    text.push_str("]\n");
}

fn list(words: &[String]) -> String {
    let words: Vec<String> = words.iter().map(|word| quoted(word)).collect();
    format!("[{}]", words.join(", "))
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

#[cfg(test)]
mod tests;
