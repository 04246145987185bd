//! The one writer of actions. Everything here runs inside a transaction of the caller's.

use std::collections::BTreeSet;
use std::time::{SystemTime, UNIX_EPOCH};

use rusqlite::{Connection, Error};

use super::{ImportPolicy, ImportReport, Place, read};
use crate::action::{ActionDraft, ActionStep};
use crate::draft_check::check_draft;
use crate::error::RegistryError;
use crate::problem::{Finding, Findings, Problem};
use crate::suggest::closest;
use crate::text::TomlActions;

/// Stores each of `drafts` as a new version, checks the whole, and returns the versions.
///
/// On an error the caller drops the transaction.
pub(super) fn store(
    connection: &Connection,
    place: &Place,
    drafts: &[&ActionDraft],
) -> Result<Vec<u32>, RegistryError> {
    let findings: Vec<Finding> = drafts.iter().flat_map(|draft| check_draft(draft)).collect();
    refuse(findings)?;
    let error = |error| place.error(error);
    let now_ms = now_ms();
    // All names first: actions stored together may play each other in any order.
    let mut written = Vec::with_capacity(drafts.len());
    for draft in drafts {
        written.push(next_version(connection, draft, now_ms).map_err(error)?);
    }
    let mut findings = Vec::new();
    for (draft, (id, version)) in drafts.iter().zip(&written) {
        let unknown = write_version(connection, draft, *id, *version, now_ms).map_err(error)?;
        findings.extend(unknown);
    }
    if findings.iter().any(|finding| matches!(finding.problem, Problem::UnknownAction { .. })) {
        suggest(connection, place, &mut findings)?;
    }
    refuse(findings)?;
    check_whole(connection, place, drafts)?;
    Ok(written.into_iter().map(|(_, version)| version).collect())
}

/// As of [`Registry::import_toml`](super::Registry::import_toml), without the commit.
pub(super) fn import(
    connection: &Connection,
    place: &Place,
    actions: &TomlActions,
    policy: ImportPolicy,
) -> Result<ImportReport, RegistryError> {
    let error = |error| place.error(error);
    let mut report = ImportReport::default();
    let mut drafts = Vec::new();
    for draft in &actions.drafts {
        let found = read::action_row(connection, &draft.name).map_err(error)?;
        let name = draft.name.clone();
        match found.filter(|row| !row.removed) {
            None => report.added.push(name),
            Some(row) => {
                let stored = read::action(connection, &row, row.latest_version).map_err(error)?;
                if stored.draft == *draft {
                    report.unchanged.push(name);
                    continue;
                }
                report.replaced.push(name);
            }
        }
        drafts.push(draft);
    }
    if policy == ImportPolicy::Refuse && !report.replaced.is_empty() {
        return Err(RegistryError::AlreadyExist { names: report.replaced });
    }
    store_located(connection, place, actions, &drafts)?;
    Ok(report)
}

/// Stores those of `actions` whose names were never used, removed or not.
pub(super) fn add_unknown(
    connection: &Connection,
    place: &Place,
    actions: &TomlActions,
) -> Result<(), RegistryError> {
    let mut drafts = Vec::new();
    for draft in &actions.drafts {
        let found =
            read::action_row(connection, &draft.name).map_err(|error| place.error(error))?;
        if found.is_none() {
            drafts.push(draft);
        }
    }
    store_located(connection, place, actions, &drafts)
}

pub(super) fn remove(connection: &Connection, id: i64) -> Result<(), Error> {
    let mut statement =
        connection.prepare_cached("UPDATE action SET removed_ms = ? WHERE id = ?")?;
    statement.execute((now_ms(), id)).map(|_| ())
}

fn store_located(
    connection: &Connection,
    place: &Place,
    actions: &TomlActions,
    drafts: &[&ActionDraft],
) -> Result<(), RegistryError> {
    match store(connection, place, drafts) {
        Err(RegistryError::Refused(Findings(mut findings))) => {
            actions.locate(&mut findings);
            Err(RegistryError::Refused(Findings(findings)))
        }
        other => other.map(|_| ()),
    }
}

/// Makes or renews the row of an action; returns its id and the version to be written.
fn next_version(
    connection: &Connection,
    draft: &ActionDraft,
    now_ms: i64,
) -> Result<(i64, u32), Error> {
    if let Some(row) = read::action_row(connection, &draft.name)? {
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
        Ok((statement.insert((&draft.name, now_ms))?, 1))
    }
}

/// Writes a version with its steps; returns what it plays that cannot be played.
fn write_version(
    connection: &Connection,
    draft: &ActionDraft,
    id: i64,
    version: u32,
    now_ms: i64,
) -> Result<Vec<Finding>, Error> {
    let mut findings = Vec::new();
    connection
        .prepare_cached(
            "INSERT INTO action_version (action_id, version, saved_ms, description, tags)
             VALUES (?, ?, ?, ?, ?)",
        )?
        .execute((id, version, now_ms, &draft.description, draft.tags.join(" ")))?;
    let mut insert_step = connection.prepare_cached(
        "INSERT INTO action_step
             (action_id, version, place, times, duration_ms, ending_bumpers, played_action_id)
         VALUES (?, ?, ?, ?, ?, ?, ?)",
    )?;
    let mut insert_primitive = connection.prepare_cached(
        "INSERT INTO step_primitive (action_id, version, place, joint, primitive)
         VALUES (?, ?, ?, ?, ?)",
    )?;
    for (place, step) in (1_u16..).zip(&draft.steps) {
        match step {
            ActionStep::Move { pose, duration_ms, ending_bumpers, times } => {
                let bumpers = ending_bumpers.bits();
                let step = (id, version, place, times, duration_ms, bumpers, None::<i64>);
                insert_step.execute(step)?;
                for primitive in pose.primitives() {
                    let joint = primitive.joint().index();
                    insert_primitive.execute((id, version, place, joint, primitive.number()))?;
                }
            }
            ActionStep::Play { action, times } => {
                let played = read::action_row(connection, action)?.filter(|row| !row.removed);
                let problem = match played {
                    Some(row) if row.id != id => {
                        let none = None::<i64>;
                        insert_step.execute((id, version, place, times, none, none, row.id))?;
                        continue;
                    }
                    Some(_) => Problem::Cycle { path: vec![action.clone(); 2] },
                    None => Problem::UnknownAction { name: action.clone(), suggestion: None },
                };
                findings.push(Finding::of(&draft.name, Some(usize::from(place)), problem));
            }
        }
    }
    Ok(findings)
}

/// Refuses circles and actions beyond bounds, also those that play what was stored.
fn check_whole(
    connection: &Connection,
    place: &Place,
    drafts: &[&ActionDraft],
) -> Result<(), RegistryError> {
    let known = read::known_actions(connection).map_err(|error| place.error(error))?;
    let stored: BTreeSet<&str> = drafts.iter().map(|draft| draft.name.as_str()).collect();
    // What was stored goes first, so that a circle is told as seen from there.
    let (mut roots, others): (Vec<usize>, Vec<usize>) = (0..known.rows.len())
        .partition(|index| stored.contains(known.rows[*index].summary.name.as_str()));
    roots.extend(others);
    let sizes = known.graph.measure(&roots).map_err(|finding| refusal(vec![finding]))?;
    refuse(known.graph.beyond_bounds(&sizes))
}

fn suggest(
    connection: &Connection,
    place: &Place,
    findings: &mut [Finding],
) -> Result<(), RegistryError> {
    let names = read::live_names(connection).map_err(|error| place.error(error))?;
    for finding in findings {
        if let Problem::UnknownAction { name, suggestion } = &mut finding.problem {
            *suggestion = closest(name, names.iter().map(String::as_str));
        }
    }
    Ok(())
}

fn refuse(findings: Vec<Finding>) -> Result<(), RegistryError> {
    if findings.is_empty() { Ok(()) } else { Err(refusal(findings)) }
}

fn refusal(findings: Vec<Finding>) -> RegistryError {
    RegistryError::Refused(Findings(findings))
}

/// A clock before 1970 counts as 1970.
fn now_ms() -> i64 {
    let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    i64::try_from(since_1970.as_millis()).unwrap_or(i64::MAX)
}
