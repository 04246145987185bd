//! From schema 1 to schema 2: the texts of actions that were stored as rows.

use rsapien_protocol::{BumperMask, Joint, Primitive};
use rusqlite::{Connection, Error, OptionalExtension};

use super::{read, write};
use crate::language::{
    ActionDraft, Quantity, Response, Statement, StatementKind, Word, print_action,
};

/// Writes the text of every version, and everything derived of the actions in force.
pub(super) fn write_texts(connection: &Connection) -> Result<(), Error> {
    let mut versions: Vec<(i64, u32, String, String, String)> = Vec::new();
    {
        let mut statement = connection.prepare(
            "SELECT v.action_id, v.version, a.name, v.description, v.tags
             FROM action_version AS v JOIN action AS a ON a.id = v.action_id",
        )?;
        let mut rows = statement.query([])?;
        while let Some(row) = rows.next()? {
            versions.push((row.get(0)?, row.get(1)?, row.get(2)?, row.get(3)?, row.get(4)?));
        }
    }
    for (id, version, name, description, tags) in versions {
        let mut draft = ActionDraft::new(name, body(connection, id, version)?);
        draft.description = description;
        draft.tags = tags.split(' ').filter(|tag| !tag.is_empty()).map(Word::new).collect();
        // Without the new line at the end, as the part of a text that an action is.
        let text = print_action(&draft);
        connection
            .prepare_cached(
                "UPDATE action_version SET source = ? WHERE action_id = ? AND version = ?",
            )?
            .execute((text.trim_end(), id, version))?;
    }
    renew_all(connection)
}

/// Writes everything derived of the actions in force anew.
pub(super) fn renew_all(connection: &Connection) -> Result<(), Error> {
    let mut statement =
        connection.prepare("SELECT id, latest_version FROM action WHERE removed_ms IS NULL")?;
    let rows = statement.query_map([], |row| Ok((row.get::<_, i64>(0)?, row.get::<_, u32>(1)?)))?;
    let live: Vec<(i64, u32)> = rows.collect::<Result<_, _>>()?;
    for (id, version) in &live {
        write::reindex(connection, *id, &read::source(connection, *id, *version)?)?;
    }
    let ids: Vec<i64> = live.into_iter().map(|(id, _)| id).collect();
    match write::renew(connection, &ids)? {
        None => Ok(()),
        Some((name, finding)) => {
            Err(read::damaged(format!("the action {name:?}: {}", finding.message)))
        }
    }
}

/// The statements of a version of schema 1. There `until` held for one step alone, and not in what was
/// played; `on` holds from where it stands, so it is taken back where it does not hold.
fn body(connection: &Connection, id: i64, version: u32) -> Result<Vec<Statement>, Error> {
    let mut statement = connection.prepare_cached(
        "SELECT step.place, step.times, played.name, step.duration_ms, step.ending_bumpers
         FROM action_step AS step
         LEFT JOIN action AS played ON played.id = step.played_action_id
         WHERE step.action_id = ? AND step.version = ? ORDER BY step.place",
    )?;
    let mut rows = statement.query((id, version))?;
    let mut body = Vec::new();
    let mut ending = 0_u8;
    while let Some(row) = rows.next()? {
        let (place, times): (i64, u16) = (row.get(0)?, row.get(1)?);
        let played: Option<String> = row.get(2)?;
        let wanted: u8 = row.get::<_, Option<u8>>(4)?.unwrap_or(0);
        for (bits, response) in
            [(ending & !wanted, Response::GoOn), (wanted & !ending, Response::End)]
        {
            let bumpers = BumperMask::from_low_bits(bits);
            if !bumpers.is_empty() {
                body.push(StatementKind::On { bumpers, response }.into());
            }
        }
        ending = wanted;
        if let Some(action) = played {
            body.push(Statement::play(action, times));
            continue;
        }
        let duration_ms: u16 = row.get(3)?;
        let pose = pose(connection, id, version, place)?;
        let step = if pose.is_empty() {
            Statement::wait(duration_ms)
        } else {
            Statement::moving(pose, duration_ms)
        };
        body.push(if times == 1 {
            step
        } else {
            let count = Some(Quantity::count(u32::from(times)));
            StatementKind::Repeat { count, body: vec![step] }.into()
        });
    }
    Ok(body)
}

fn pose(
    connection: &Connection,
    id: i64,
    version: u32,
    place: i64,
) -> Result<rsapien_protocol::Pose, Error> {
    let mut pose = rsapien_protocol::Pose::EMPTY;
    for joint in Joint::ALL {
        let mut statement = connection.prepare_cached(
            "SELECT primitive FROM step_primitive
             WHERE action_id = ? AND version = ? AND place = ? AND joint = ?",
        )?;
        let number: Option<u8> = statement
            .query_row((id, version, place, joint.index()), |row| row.get(0))
            .optional()?;
        if let Some(primitive) = number.and_then(Primitive::from_number) {
            pose = pose.with(joint, Some(primitive.position()));
        }
    }
    Ok(pose)
}
