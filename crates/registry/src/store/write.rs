//! The one writer of actions. Everything here runs inside a transaction of the caller's.

use std::collections::{BTreeMap, BTreeSet};
use std::time::{SystemTime, UNIX_EPOCH};

use rusqlite::{Connection, Error};

use super::known::{Derived, Stored};
use super::{ImportPolicy, ImportReport, Place, Trials, read};
use crate::check::{CheckedText, Finding, Findings, check_text};
use crate::error::RegistryError;
use crate::language::{ActionDraft, ParsedAction, StatementKind, parse_text};

/// A new version of an action, ready to be written.
struct NewVersion<'a> {
    draft: &'a ActionDraft,
    /// The action's part of the text.
    source: &'a str,
    warnings: Vec<String>,
    trial: Option<&'a str>,
}

/// Checks a text and stores its actions, each as a new version; on an error the caller drops the
/// transaction.
pub(super) fn import(
    connection: &Connection,
    place: &Place,
    text: &str,
    policy: ImportPolicy,
    trials: &Trials,
) -> Result<ImportReport, RegistryError> {
    let error = |error| place.error(error);
    let checked = check(connection, place, text)?;
    if checked.findings.has_errors() {
        return Err(RegistryError::Refused(checked.findings));
    }
    let mut report = ImportReport::default();
    let mut versions = Vec::new();
    for action in &checked.actions {
        let name = action.parsed.draft.name.text.clone();
        let source = source_of(text, &action.parsed);
        let found = read::action_row(connection, &name).map_err(error)?;
        match found {
            None => report.added.push(name.clone()),
            Some(row) if row.removed => report.added.push(name.clone()),
            Some(row) => {
                let stored = read::source(connection, row.id, row.latest_version).map_err(error)?;
                if stored == source {
                    report.unchanged.push(name);
                    continue;
                }
                report.replaced.push(name.clone());
            }
        }
        let warnings = checked.findings.warnings();
        let own = warnings.filter(|finding| finding.action.as_deref() == Some(name.as_str()));
        versions.push(NewVersion {
            draft: &action.parsed.draft,
            source,
            warnings: own.map(|finding| format!("{}: {}", finding.rule, finding.message)).collect(),
            trial: trials.get(&name).map(String::as_str),
        });
    }
    if policy == ImportPolicy::Refuse && !report.replaced.is_empty() {
        return Err(RegistryError::AlreadyExist { names: report.replaced });
    }
    store(connection, place, text, &versions)?;
    Ok(report)
}

/// Puts in those actions of the seed library `text` that are new here, and renews those among `renewed`
/// that are as the first library left them. What does not fit to what the user has made of the others
/// is left out.
pub(super) fn seed(
    connection: &Connection,
    place: &Place,
    text: &str,
    renewed: &[&str],
) -> Result<(), RegistryError> {
    let error = |error| place.error(error);
    let mut kept: BTreeMap<String, String> = BTreeMap::new();
    for action in parse_text(text).actions {
        let name = &action.draft.name.text;
        let found = read::action_row(connection, name).map_err(error)?;
        let is_wanted = found.is_none_or(|row| {
            row.latest_version == 1 && !row.removed && renewed.contains(&name.as_str())
        });
        if is_wanted {
            kept.insert(name.clone(), source_of(text, &action).to_owned());
        }
    }
    while !kept.is_empty() {
        let text = kept.values().cloned().collect::<Vec<_>>().join("\n\n");
        connection.execute_batch("SAVEPOINT seed").map_err(error)?;
        let imported = import(connection, place, &text, ImportPolicy::Replace, &Trials::new());
        let end = if imported.is_ok() { "RELEASE seed" } else { "ROLLBACK TO seed; RELEASE seed" };
        connection.execute_batch(end).map_err(error)?;
        match imported {
            Ok(_) => return Ok(()),
            Err(RegistryError::Refused(findings)) => {
                let refused: Vec<_> =
                    findings.errors().filter_map(|it| it.action.as_deref()).collect();
                let before = kept.len();
                kept.retain(|name, _| !refused.contains(&name.as_str()));
                if kept.len() == before {
                    return Ok(());
                }
            }
            Err(other) => return Err(other),
        }
    }
    Ok(())
}

/// What the checker finds in a text, with the actions that are stored.
pub(super) fn check(
    connection: &Connection,
    place: &Place,
    text: &str,
) -> Result<CheckedText, RegistryError> {
    let stored = Stored::new(connection);
    let checked = check_text(text, &stored);
    stored.sound(checked).map_err(|error| place.error(error))
}

/// The text of an action with the comments above it; it ends with a new line.
fn source_of<'a>(text: &'a str, action: &ParsedAction) -> &'a str {
    text.get(action.span.start..action.span.end).unwrap_or(text)
}

fn store(
    connection: &Connection,
    place: &Place,
    text: &str,
    versions: &[NewVersion<'_>],
) -> Result<(), RegistryError> {
    let error = |error| place.error(error);
    let now_ms = now_ms();
    // All names first: actions stored together may play each other in any order.
    let mut written = Vec::with_capacity(versions.len());
    for version in versions {
        written.push(next_version(connection, &version.draft.name.text, now_ms).map_err(error)?);
    }
    for (new, &(id, version)) in versions.iter().zip(&written) {
        write_version(connection, new, id, version, now_ms).map_err(error)?;
    }
    let ids: Vec<i64> = written.iter().map(|(id, _)| *id).collect();
    let refused = renew(connection, &ids).map_err(error)?;
    match refused {
        None => Ok(()),
        Some((name, finding)) => Err(refusal(text, versions, &name, finding)),
    }
}

/// The refusal of something that would no longer compile: one of what was to be stored, or an action
/// that plays it.
fn refusal(text: &str, versions: &[NewVersion<'_>], name: &str, finding: Finding) -> RegistryError {
    let own = versions.iter().any(|version| version.draft.name.text == name);
    let finding = if own {
        finding
    } else {
        let span = versions.first().map(|version| version.draft.name.span).unwrap_or_default();
        let message =
            format!("the action `{name}`, which plays it, would be wrong: {}", finding.message);
        Finding { message, span, also: Vec::new(), ..finding }.label("")
    };
    RegistryError::Refused(Findings::new(text, vec![finding]))
}

/// Renews what is derived of the actions of `ids` and of all that play them. The first that can no
/// longer be compiled, if any.
pub(super) fn renew(
    connection: &Connection,
    ids: &[i64],
) -> Result<Option<(String, Finding)>, Error> {
    let mut affected: BTreeMap<i64, String> = BTreeMap::new();
    let mut order = Vec::new();
    let mut waiting: Vec<(i64, String)> = Vec::new();
    for id in ids {
        let name = connection
            .prepare_cached("SELECT name FROM action WHERE id = ?")?
            .query_row([id], |row| row.get(0))?;
        waiting.push((*id, name));
    }
    let mut next = 0;
    while let Some((id, name)) = waiting.get(next).cloned() {
        next += 1;
        if affected.insert(id, name.clone()).is_none() {
            order.push((id, name));
            waiting.extend(read::users(connection, id)?);
        }
    }
    let stored = Stored::new(connection);
    for (id, name) in order {
        let Some(draft) = crate::expand::KnownActions::draft(&stored, &name) else {
            stored.sound(())?;
            continue;
        };
        match stored.derive(&draft)? {
            Ok(derived) => write_derived(connection, id, &derived)?,
            Err(finding) => return Ok(Some((name, finding))),
        }
    }
    Ok(None)
}

fn write_derived(connection: &Connection, id: i64, derived: &Derived) -> Result<(), Error> {
    let Derived { compiled, content_hash } = derived;
    let duration_ms = i64::try_from(compiled.duration_ms).unwrap_or(i64::MAX);
    let step_count = i64::try_from(compiled.steps.len()).unwrap_or(i64::MAX);
    connection
        .prepare_cached(
            "UPDATE action SET duration_ms = ?, step_count = ?, joints = ?, content_hash = ?
             WHERE id = ?",
        )?
        .execute((duration_ms, step_count, compiled.joints(), content_hash, id))
        .map(|_| ())
}

pub(super) fn remove(connection: &Connection, id: i64) -> Result<(), Error> {
    let mut statement =
        connection.prepare_cached("UPDATE action SET removed_ms = ? WHERE id = ?")?;
    statement.execute((now_ms(), id))?;
    forget_words(connection, id)
}

/// Makes or renews the row of an action; returns its id and the version to be written.
fn next_version(connection: &Connection, name: &str, now_ms: i64) -> Result<(i64, u32), Error> {
    if let Some(row) = read::action_row(connection, name)? {
        let version = row.latest_version.saturating_add(1);
        let mut statement = connection.prepare_cached(
            "UPDATE action SET latest_version = ?, removed_ms = NULL WHERE id = ?",
        )?;
        statement.execute((version, row.id))?;
        Ok((row.id, version))
    } else {
        let mut statement = connection.prepare_cached(
            "INSERT INTO action (name, created_ms, latest_version) VALUES (?, ?, 1)",
        )?;
        Ok((statement.insert((name, now_ms))?, 1))
    }
}

fn write_version(
    connection: &Connection,
    new: &NewVersion<'_>,
    id: i64,
    version: u32,
    now_ms: i64,
) -> Result<(), Error> {
    let NewVersion { draft, source, warnings, trial } = new;
    let warnings = serde_json::Value::from(warnings.as_slice()).to_string();
    let tags = tags_of(draft).join(" ");
    connection
        .prepare_cached(
            "INSERT INTO action_version
                 (action_id, version, saved_ms, description, tags, source, warnings, trial)
             VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
        )?
        .execute((id, version, now_ms, &draft.description, tags, source, warnings, trial))?;
    for played in draft.played() {
        // The check has found every one of them.
        if let Some(row) = read::action_row(connection, played)? {
            connection
                .prepare_cached(
                    "INSERT INTO action_play (action_id, version, played_action_id) VALUES (?, ?, ?)",
                )?
                .execute((id, version, row.id))?;
        }
    }
    index_words(connection, id, draft, source)
}

fn tags_of(draft: &ActionDraft) -> Vec<&str> {
    draft.tags.iter().map(|tag| tag.text.as_str()).collect()
}

fn forget_words(connection: &Connection, id: i64) -> Result<(), Error> {
    connection.prepare_cached("DELETE FROM action_tag WHERE action_id = ?")?.execute([id])?;
    connection.prepare_cached("DELETE FROM action_words WHERE rowid = ?")?.execute([id])?;
    Ok(())
}

/// Writes what an action in force is found by.
pub(super) fn index_words(
    connection: &Connection,
    id: i64,
    draft: &ActionDraft,
    source: &str,
) -> Result<(), Error> {
    forget_words(connection, id)?;
    for tag in tags_of(draft).into_iter().collect::<BTreeSet<_>>() {
        connection
            .prepare_cached("INSERT INTO action_tag (tag, action_id) VALUES (?, ?)")?
            .execute((tag, id))?;
    }
    let mut words: Vec<&str> = draft.played().into_iter().collect();
    draft.visit(&mut |statement| {
        if let StatementKind::Label { name } = &statement.kind {
            words.push(&name.text);
        }
    });
    words
        .extend(source.lines().filter_map(|line| line.split_once('#').map(|(_, comment)| comment)));
    connection
        .prepare_cached(
            "INSERT INTO action_words (rowid, name, description, tags, words) VALUES (?, ?, ?, ?, ?)",
        )?
        .execute((
            id,
            &draft.name.text,
            &draft.description,
            tags_of(draft).join(" "),
            words.join(" "),
        ))
        .map(|_| ())
}

/// Writes everything derived of an action in force anew.
pub(super) fn reindex(connection: &Connection, id: i64, source: &str) -> Result<(), Error> {
    let parsed = parse_text(source);
    match parsed.actions.first().filter(|_| parsed.findings.is_empty()) {
        Some(action) => index_words(connection, id, &action.draft, source),
        None => Ok(()),
    }
}

/// A clock before 1970 counts as 1970.
fn now_ms() -> i64 {
    let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    i64::try_from(since_1970.as_millis()).unwrap_or(i64::MAX)
}
