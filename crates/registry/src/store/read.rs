//! Queries.

use std::collections::{BTreeSet, HashMap};

use rsapien_protocol::{BumperMask, Pose, Primitive};
use rusqlite::types::Type;
use rusqlite::{Connection, Error, OptionalExtension, Row};

use crate::action::{Action, ActionDraft, ActionStep, ActionSummary, VersionSummary};
use crate::graph::{Graph, Node, Play, Size};
use crate::suggest::closest;

/// The row of an action, removed or not.
pub(super) struct ActionRow {
    pub(super) id: i64,
    pub(super) name: String,
    pub(super) created_ms: i64,
    pub(super) removed: bool,
    pub(super) latest_version: u32,
}

/// Every action in force, in alphabetical order, and who plays whom by the same index.
pub(super) struct KnownActions {
    pub(super) rows: Vec<KnownRow>,
    pub(super) graph: Graph,
}

pub(super) struct KnownRow {
    pub(super) id: i64,
    /// Without its duration, which is measured in the graph.
    pub(super) summary: ActionSummary,
}

pub(super) fn primitives(connection: &Connection) -> Result<Vec<Primitive>, Error> {
    let mut statement =
        connection.prepare_cached("SELECT number FROM primitive ORDER BY number")?;
    let rows = statement.query_map([], |row| primitive_of(row, 0))?;
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

pub(super) fn action(
    connection: &Connection,
    action: &ActionRow,
    version: u32,
) -> Result<Action, Error> {
    let mut statement = connection.prepare_cached(
        "SELECT saved_ms, description, tags FROM action_version WHERE action_id = ? AND version = ?",
    )?;
    let (changed_ms, description, tags) = statement
        .query_row((action.id, version), |row| Ok((row.get(0)?, row.get(1)?, tags_of(row, 2)?)))?;
    let steps = steps(connection, action.id, version)?;
    let draft = ActionDraft { name: action.name.clone(), description, tags, steps };
    Ok(Action { draft, version, created_ms: action.created_ms, changed_ms })
}

fn steps(connection: &Connection, id: i64, version: u32) -> Result<Vec<ActionStep>, Error> {
    // One row for each primitive; a pause and a played action have one row without.
    let mut statement = connection.prepare_cached(
        "SELECT step.place, step.times, played.name, step.duration_ms, step.ending_bumpers,
                step_primitive.primitive
         FROM action_step AS step
         LEFT JOIN action AS played ON played.id = step.played_action_id
         LEFT JOIN step_primitive USING (action_id, version, place)
         WHERE step.action_id = ? AND step.version = ?
         ORDER BY step.place, step_primitive.joint",
    )?;
    let mut rows = statement.query((id, version))?;
    let mut steps = Vec::new();
    let mut last_place = 0;
    while let Some(row) = rows.next()? {
        let place: i64 = row.get(0)?;
        if place != last_place {
            last_place = place;
            let times = row.get(1)?;
            steps.push(match row.get(2)? {
                Some(action) => ActionStep::Play { action, times },
                None => ActionStep::Move {
                    pose: Pose::EMPTY,
                    duration_ms: row.get(3)?,
                    ending_bumpers: BumperMask::from_low_bits(row.get(4)?),
                    times,
                },
            });
        }
        if row.get_ref(5)? != rusqlite::types::ValueRef::Null
            && let Some(ActionStep::Move { pose, .. }) = steps.last_mut()
        {
            let primitive = primitive_of(row, 5)?;
            *pose = pose.with(primitive.joint(), Some(primitive.position()));
        }
    }
    Ok(steps)
}

pub(super) fn versions(
    connection: &Connection,
    action: &ActionRow,
) -> Result<Vec<VersionSummary>, Error> {
    let mut statement = connection.prepare_cached(
        "SELECT version, saved_ms, description,
                (SELECT COUNT(*) FROM action_step AS step
                 WHERE step.action_id = v.action_id AND step.version = v.version)
         FROM action_version AS v WHERE action_id = ? ORDER BY version",
    )?;
    let rows = statement.query_map([action.id], |row| {
        Ok(VersionSummary {
            version: row.get(0)?,
            changed_ms: row.get(1)?,
            description: row.get(2)?,
            step_count: row.get(3)?,
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

/// The names of the actions in force that play the action of `id`.
pub(super) fn users(connection: &Connection, id: i64) -> Result<Vec<String>, Error> {
    let mut statement = connection.prepare_cached(
        "SELECT DISTINCT action.name
         FROM action_step AS step
         JOIN action ON action.id = step.action_id AND action.latest_version = step.version
         WHERE step.played_action_id = ? AND action.removed_ms IS NULL
         ORDER BY action.name",
    )?;
    let rows = statement.query_map([id], |row| row.get(0))?;
    rows.collect()
}

/// Whatever `drafts` play, directly or not, except themselves and what is not stored.
pub(super) fn all_played(
    connection: &Connection,
    drafts: &[ActionDraft],
) -> Result<Vec<ActionDraft>, Error> {
    let mut met: BTreeSet<String> = drafts.iter().map(|draft| draft.name.clone()).collect();
    let played_by = |draft: &ActionDraft| -> Vec<String> {
        draft.played().into_iter().map(str::to_owned).collect()
    };
    let mut waiting: Vec<String> = drafts.iter().flat_map(played_by).collect();
    let mut played = Vec::new();
    while let Some(name) = waiting.pop() {
        if !met.insert(name.clone()) {
            continue;
        }
        let Some(row) = action_row(connection, &name)?.filter(|row| !row.removed) else { continue };
        let found = action(connection, &row, row.latest_version)?;
        waiting.extend(played_by(&found.draft));
        played.push(found.draft);
    }
    played.sort_by(|left, right| left.name.cmp(&right.name));
    Ok(played)
}

pub(super) fn known_actions(connection: &Connection) -> Result<KnownActions, Error> {
    let mut rows = known_rows(connection)?;
    // Only looked up, never gone through.
    let indices: HashMap<i64, usize> =
        (0..).zip(&rows).map(|(index, row)| (row.id, index)).collect();
    let mut nodes: Vec<Node> =
        rows.iter().map(|row| Node { name: row.summary.name.clone(), ..Node::default() }).collect();

    // Apart from the query of names and descriptions, which would be read again for every step.
    let mut statement = connection.prepare_cached(
        "SELECT a.id, COUNT(*), SUM(IIF(s.duration_ms IS NULL, 0, s.times)),
                SUM(IFNULL(s.duration_ms, 0) * s.times)
         FROM action AS a
         JOIN action_step AS s ON s.action_id = a.id AND s.version = a.latest_version
         WHERE a.removed_ms IS NULL
         GROUP BY a.id",
    )?;
    let mut sums = statement.query([])?;
    while let Some(sum) = sums.next()? {
        let Some(index) = indices.get(&sum.get(0)?) else { continue };
        rows[*index].summary.step_count = sum.get(1)?;
        let (steps, duration_ms): (i64, i64) = (sum.get(2)?, sum.get(3)?);
        nodes[*index].own =
            Size { steps: steps.unsigned_abs(), duration_ms: duration_ms.unsigned_abs(), depth: 0 };
    }

    let mut statement = connection.prepare_cached(
        "SELECT s.action_id, s.played_action_id, s.times, s.place
         FROM action_step AS s
         JOIN action AS a ON a.id = s.action_id AND a.latest_version = s.version
         WHERE s.played_action_id IS NOT NULL AND a.removed_ms IS NULL
         ORDER BY s.action_id, s.place",
    )?;
    let mut plays = statement.query([])?;
    while let Some(play) = plays.next()? {
        let (user, played): (i64, i64) = (play.get(0)?, play.get(1)?);
        // What plays a removed action cannot be stored, so both are known.
        if let (Some(user), Some(node)) = (indices.get(&user), indices.get(&played)) {
            let step = usize::from(play.get::<_, u16>(3)?);
            nodes[*user].plays.push(Play { node: *node, times: play.get(2)?, step });
        }
    }
    Ok(KnownActions { rows, graph: Graph { nodes } })
}

/// Actions in force in alphabetical order, without what their steps tell.
fn known_rows(connection: &Connection) -> Result<Vec<KnownRow>, Error> {
    let mut statement = connection.prepare_cached(
        "SELECT a.id, a.name, a.latest_version, a.created_ms, v.saved_ms, v.description, v.tags
         FROM action AS a
         JOIN action_version AS v ON v.action_id = a.id AND v.version = a.latest_version
         WHERE a.removed_ms IS NULL
         ORDER BY a.name",
    )?;
    let rows = statement.query_map([], |row| {
        let summary = ActionSummary {
            name: row.get(1)?,
            version: row.get(2)?,
            created_ms: row.get(3)?,
            changed_ms: row.get(4)?,
            description: row.get(5)?,
            tags: tags_of(row, 6)?,
            step_count: 0,
            duration_ms: 0,
        };
        Ok(KnownRow { id: row.get(0)?, summary })
    })?;
    rows.collect()
}

fn tags_of(row: &Row, column: usize) -> Result<Vec<String>, Error> {
    let tags = row.get_ref(column)?.as_str().map_err(Error::from)?;
    Ok(tags.split(' ').filter(|tag| !tag.is_empty()).map(str::to_owned).collect())
}

fn primitive_of(row: &Row, column: usize) -> Result<Primitive, Error> {
    let number: u8 = row.get(column)?;
    Primitive::from_number(number).ok_or_else(|| {
        Error::FromSqlConversionFailure(
            column,
            Type::Integer,
            format!("{number} is no primitive").into(),
        )
    })
}
