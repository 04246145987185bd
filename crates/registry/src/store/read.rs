//! Queries.

use rsapien_protocol::{Joint, Primitive};
use rusqlite::types::Type;
use rusqlite::{Connection, Error, OptionalExtension, Row};

use crate::action::{Action, ActionSummary, VersionSummary};
use crate::suggest::closest;

/// The row of an action, removed or not.
pub(super) struct ActionRow {
    pub(super) id: i64,
    pub(super) name: String,
    pub(super) created_ms: i64,
    pub(super) removed: bool,
    pub(super) latest_version: u32,
}

pub(super) fn primitives(connection: &Connection) -> Result<Vec<Primitive>, Error> {
    let mut statement =
        connection.prepare_cached("SELECT number FROM primitive ORDER BY number")?;
    let rows = statement.query_map([], |row| {
        let number: u8 = row.get(0)?;
        Primitive::from_number(number).ok_or_else(|| damaged(format!("{number} is no primitive")))
    })?;
    rows.collect()
}

pub(super) fn action_row(connection: &Connection, name: &str) -> Result<Option<ActionRow>, Error> {
    let mut statement = connection.prepare_cached(
        "SELECT id, name, created_ms, removed_ms IS NOT NULL, latest_version
         FROM action WHERE name = ?",
    )?;
    let row = |row: &Row| {
        Ok(ActionRow {
            id: row.get(0)?,
            name: row.get(1)?,
            created_ms: row.get(2)?,
            removed: row.get(3)?,
            latest_version: row.get(4)?,
        })
    };
    statement.query_row([name], row).optional()
}

/// The names of actions in force whose content hashes begin so, at most two.
pub(super) fn names_of_hash(connection: &Connection, prefix: &str) -> Result<Vec<String>, Error> {
    let mut statement = connection.prepare_cached(
        "SELECT name FROM action
         WHERE content_hash >= ?1 AND content_hash < ?1 || 'g' AND removed_ms IS NULL
         ORDER BY name LIMIT 2",
    )?;
    let rows = statement.query_map([prefix], |row| row.get(0))?;
    rows.collect()
}

pub(super) fn action(
    connection: &Connection,
    action: &ActionRow,
    version: u32,
) -> Result<Action, Error> {
    let mut statement = connection.prepare_cached(
        "SELECT saved_ms, description, tags, source, warnings, trial
         FROM action_version WHERE action_id = ? AND version = ?",
    )?;
    statement.query_row((action.id, version), |row| {
        let warnings: String = row.get(4)?;
        Ok(Action {
            name: action.name.clone(),
            changed_ms: row.get(0)?,
            description: row.get(1)?,
            tags: words_of(row, 2)?,
            text: row.get(3)?,
            warnings: serde_json::from_str(&warnings)
                .map_err(|error| damaged(error.to_string()))?,
            trial: row.get(5)?,
            version,
            created_ms: action.created_ms,
        })
    })
}

pub(super) fn source(connection: &Connection, id: i64, version: u32) -> Result<String, Error> {
    let mut statement = connection
        .prepare_cached("SELECT source FROM action_version WHERE action_id = ? AND version = ?")?;
    statement.query_row((id, version), |row| row.get(0))
}

pub(super) fn versions(
    connection: &Connection,
    action: &ActionRow,
) -> Result<Vec<VersionSummary>, Error> {
    let mut statement = connection.prepare_cached(
        "SELECT version, saved_ms, description FROM action_version
         WHERE action_id = ? ORDER BY version",
    )?;
    let rows = statement.query_map([action.id], |row| {
        Ok(VersionSummary {
            version: row.get(0)?,
            changed_ms: row.get(1)?,
            description: row.get(2)?,
        })
    })?;
    rows.collect()
}

pub(super) fn live_names(connection: &Connection) -> Result<Vec<String>, Error> {
    names(connection, "SELECT name FROM action WHERE removed_ms IS NULL ORDER BY name")
}

/// The name nearest to `name`, also among removed actions if asked for.
pub(super) fn suggestion(
    connection: &Connection,
    name: &str,
    with_removed: bool,
) -> Result<Option<String>, Error> {
    let names = if with_removed {
        names(connection, "SELECT name FROM action ORDER BY name")?
    } else {
        live_names(connection)?
    };
    Ok(closest(name, names.iter().map(String::as_str)))
}

fn names(connection: &Connection, query: &str) -> Result<Vec<String>, Error> {
    let mut statement = connection.prepare_cached(query)?;
    let rows = statement.query_map([], |row| row.get(0))?;
    rows.collect()
}

/// Ids and names of the actions in force that play the action of `id`.
pub(super) fn users(connection: &Connection, id: i64) -> Result<Vec<(i64, String)>, Error> {
    let mut statement = connection.prepare_cached(
        "SELECT action.id, action.name
         FROM action_play AS play
         JOIN action ON action.id = play.action_id AND action.latest_version = play.version
         WHERE play.played_action_id = ? AND action.removed_ms IS NULL
         ORDER BY action.name",
    )?;
    let rows = statement.query_map([id], |row| Ok((row.get(0)?, row.get(1)?)))?;
    rows.collect()
}

/// The columns of a summary, of `a`, the action, and `v`, its version in force.
pub(super) const SUMMARY: &str = "a.name, a.latest_version, a.created_ms, v.saved_ms, \
     v.description, v.tags, a.step_count, a.duration_ms, a.joints, a.content_hash";

pub(super) fn summary(row: &Row) -> Result<ActionSummary, Error> {
    let joints: u8 = row.get(8)?;
    Ok(ActionSummary {
        name: row.get(0)?,
        version: row.get(1)?,
        created_ms: row.get(2)?,
        changed_ms: row.get(3)?,
        description: row.get(4)?,
        tags: words_of(row, 5)?,
        step_count: row.get(6)?,
        duration_ms: row.get::<_, i64>(7)?.unsigned_abs(),
        joints: Joint::ALL
            .into_iter()
            .filter(|joint| joints & (1 << joint.index()) != 0)
            .map(Joint::name)
            .collect(),
        content_hash: row.get(9)?,
    })
}

pub(super) fn summaries(connection: &Connection) -> Result<Vec<ActionSummary>, Error> {
    let mut statement = connection.prepare_cached(&format!(
        "SELECT {SUMMARY} FROM action AS a
         JOIN action_version AS v ON v.action_id = a.id AND v.version = a.latest_version
         WHERE a.removed_ms IS NULL ORDER BY a.name"
    ))?;
    let rows = statement.query_map([], summary)?;
    rows.collect()
}

pub(super) fn one_summary(connection: &Connection, id: i64) -> Result<ActionSummary, Error> {
    let mut statement = connection.prepare_cached(&format!(
        "SELECT {SUMMARY} FROM action AS a
         JOIN action_version AS v ON v.action_id = a.id AND v.version = a.latest_version
         WHERE a.id = ?"
    ))?;
    statement.query_row([id], summary)
}

fn words_of(row: &Row, column: usize) -> Result<Vec<String>, Error> {
    let words = row.get_ref(column)?.as_str().map_err(Error::from)?;
    Ok(words.split(' ').filter(|word| !word.is_empty()).map(str::to_owned).collect())
}

/// What is stored is not what any writer of ours writes.
pub(super) fn damaged(why: String) -> Error {
    Error::FromSqlConversionFailure(0, Type::Text, why.into())
}
