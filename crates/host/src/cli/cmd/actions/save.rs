//! Saving texts of actions: checked, and told what was found.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

use rsapien_registry::check::CheckedAction;
use rsapien_registry::{
    Findings, ImportPolicy, ImportReport, Registry, RegistryError, Trials, check,
};

use super::text;
use crate::CancelToken;
use crate::cli::context::Context;
use crate::cli::diagnostics::{Failure, Result};
use crate::cli::exit::Status;
use crate::cli::output::Screen;
use crate::cli::progress::Progress;
use crate::trial::{Trial, try_on_virtual_body};

/// Saves the actions of a file and tells what was done.
pub(super) fn save(
    context: &Context,
    registry: &mut Registry,
    out: &mut impl Write,
    file: &Path,
    policy: ImportPolicy,
) -> Result<Status> {
    let file_name = file.display().to_string();
    let report = save_text(context, registry, &text::read(file)?, &file_name, policy)?;
    tell_import(context, out, &report)
}

/// Saves the actions of a text; warnings go to the standard error.
pub(crate) fn save_text(
    context: &Context,
    registry: &mut Registry,
    text: &str,
    file_name: &str,
    policy: ImportPolicy,
) -> Result<ImportReport> {
    let checked = registry.check_text(text)?;
    if checked.findings.has_errors() {
        return Err(refused(checked.findings, file_name));
    }
    let trials = try_all(context, &checked.actions)?;
    let kept = kept(&trials)?;
    let report = registry.import_text(text, policy, &kept).map_err(|error| match error {
        RegistryError::Refused(findings) => refused(findings, file_name),
        other => other.into(),
    })?;
    warn(context, &checked.findings, &trials, file_name);
    Ok(report)
}

/// What is wrong with a text that was to be saved.
fn refused(findings: Findings, file_name: &str) -> Failure {
    Failure::findings(findings, file_name).hint("nothing was stored")
}

/// How the actions of a text go on the virtual body, as it is kept with them.
pub(super) fn try_text(
    context: &Context,
    registry: &Registry,
    text: &str,
    file_name: &str,
) -> Result<Trials> {
    let checked = registry.check_text(text)?;
    if checked.findings.has_errors() {
        return Err(refused(checked.findings, file_name));
    }
    kept(&try_all(context, &checked.actions)?)
}

fn kept(trials: &BTreeMap<String, Trial>) -> Result<Trials> {
    let texts =
        trials.iter().map(|(name, trial)| Ok((name.clone(), serde_json::to_string(trial)?)));
    texts.collect()
}

/// Every action on the virtual body; Ctrl-C ends the command, and nothing is stored.
fn try_all(context: &Context, actions: &[CheckedAction]) -> Result<BTreeMap<String, Trial>> {
    let mut progress = Progress::new(context.style, actions.len());
    let mut trials = BTreeMap::new();
    for compiled in actions.iter().filter_map(|action| action.compiled.as_ref()) {
        progress.next(&compiled.name);
        let trial = try_on_virtual_body(compiled, &CancelToken::new())?;
        trials.insert(compiled.name.clone(), trial);
    }
    Ok(trials)
}

/// Shows warnings, and trials that did not go well; a reader of JSON finds them with the action.
fn warn(context: &Context, findings: &Findings, trials: &BTreeMap<String, Trial>, file_name: &str) {
    if !context.style.json {
        let with_colour = context.style.error == Screen::Color;
        let mut text = check::render(findings, file_name, with_colour);
        let failed = trials.iter().filter(|(_, trial)| !trial.is_done);
        text.extend(
            failed.map(|(name, trial)| {
                format!("warning: {name}, tried on the virtual body: {trial}\n")
            }),
        );
        // When even the standard error is gone, the action is stored all the same.
        let _ = std::io::stderr().write_all(text.as_bytes());
    }
}

/// What an import did.
fn tell_import(context: &Context, out: &mut impl Write, report: &ImportReport) -> Result<Status> {
    let parts = [
        ("added", &report.added),
        ("new version of", &report.replaced),
        ("unchanged", &report.unchanged),
    ];
    let lines: Vec<String> = parts
        .iter()
        .filter(|(_, names)| !names.is_empty())
        .map(|(what, names)| format!("{what} {}", names.join(", ")))
        .collect();
    let text =
        if lines.is_empty() { "the text has no action".to_owned() } else { lines.join("\n") };
    context.style.answer(out, report, text)?;
    Ok(if lines.is_empty() { Status::Refused } else { Status::Done })
}
