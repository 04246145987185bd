//! The check of a whole text.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::allow::silence;
use super::form::form_findings;
use super::motion::motion_findings;
use super::{Finding, Findings, Rule, Severity};
use crate::compiled::CompiledAction;
use crate::expand::{CompileOptions, KnownActions, compile};
use crate::language::{ActionDraft, ParsedAction, parse_text};

/// A text that was checked.
#[derive(Clone, Debug, Default)]
pub struct CheckedText {
    /// Its actions, in the order of the text, as far as they could be read.
    pub actions: Vec<CheckedAction>,
    /// Everything that was found.
    pub findings: Findings,
    /// What the actions silence.
    pub silenced: Vec<Finding>,
}

/// An action that was checked.
#[derive(Clone, Debug)]
pub struct CheckedAction {
    /// The action and where it stands.
    pub parsed: ParsedAction,
    /// Compiled with its defaults, where nothing is wrong with it.
    pub compiled: Option<CompiledAction>,
}

/// Checks a text: reads it, looks at each of its actions, and compiles it. They may play each other in
/// any order, and those of `known`, of which they hide the ones with the same names.
pub fn check_text(text: &str, known: &dyn KnownActions) -> CheckedText {
    let parsed = parse_text(text);
    let mut findings = parsed.findings;
    let is_whole = findings.is_empty();
    let mut own: BTreeMap<String, Arc<ActionDraft>> = BTreeMap::new();
    for action in &parsed.actions {
        let name = &action.draft.name;
        // What could not be read is missing, and that is no fault of its own.
        let of_form = form_findings(&action.draft).into_iter();
        findings.extend(of_form.filter(|finding| is_whole || finding.rule != Rule::Empty));
        if let Some(first) = own.get(&name.text) {
            let message = format!("the action `{}` is there twice", name.text);
            let finding = Finding::new(Rule::DefinedTwice, name.span, message)
                .and(first.name.span, "first here")
                .help("give one of them another name")
                .within(&name.text);
            findings.push(finding);
        } else {
            own.insert(name.text.clone(), Arc::new(action.draft.clone()));
        }
    }
    // What is wrong by itself cannot be compiled, and would be told a second time.
    let is_sound = findings.iter().all(|finding| finding.severity() != Severity::Error);
    let mut silenced = Vec::new();
    let overlay = Overlay { own: &own, known };
    let actions = parsed
        .actions
        .into_iter()
        .map(|parsed| {
            if !is_sound {
                return CheckedAction { parsed, compiled: None };
            }
            let compiled = compile(&parsed.draft, &overlay, &CompileOptions::default());
            let compiled = compiled.map_err(|finding| findings.push(finding)).ok();
            if let Some(compiled) = &compiled {
                let found = motion_findings(&parsed.draft, compiled, &overlay);
                let (remaining, own_silenced) = silence(&parsed.draft, found);
                findings.extend(remaining);
                silenced.extend(own_silenced);
            }
            CheckedAction { parsed, compiled }
        })
        .collect();
    CheckedText { actions, findings: Findings::new(text, findings), silenced }
}

/// The actions of a text before those that are stored.
struct Overlay<'a> {
    own: &'a BTreeMap<String, Arc<ActionDraft>>,
    known: &'a dyn KnownActions,
}

impl KnownActions for Overlay<'_> {
    fn draft(&self, name: &str) -> Option<Arc<ActionDraft>> {
        self.own.get(name).cloned().or_else(|| self.known.draft(name))
    }

    fn names(&self) -> Vec<String> {
        self.own.keys().cloned().chain(self.known.names()).collect()
    }
}
