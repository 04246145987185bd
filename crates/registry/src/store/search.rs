//! Search: by words, tags, joints and length.

use rsapien_protocol::Joint;
use rusqlite::types::Value;
use rusqlite::{Connection, Error, params_from_iter};

use super::read::{SUMMARY, summary};
use crate::action::ActionSummary;

/// What is searched for; everything given has to hold.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Query {
    /// Words of the name, the description, the tags, the labels, the comments, and the names of actions
    /// that are played. The last one may be the beginning of a word.
    pub text: String,
    /// Tags that the action bears.
    pub tags: Vec<String>,
    /// Joints that it moves.
    pub joints: Vec<Joint>,
    /// How long it lasts at least, in milliseconds.
    pub duration_ms_min: Option<u64>,
    /// How long it lasts at most, in milliseconds.
    pub duration_ms_max: Option<u64>,
    /// How many are told at most.
    pub limit: u32,
    /// How many of the first are left out.
    pub offset: u32,
}

impl Default for Query {
    /// The first 50 of all actions.
    fn default() -> Query {
        Query {
            text: String::new(),
            tags: Vec::new(),
            joints: Vec::new(),
            duration_ms_min: None,
            duration_ms_max: None,
            limit: 50,
            offset: 0,
        }
    }
}

/// The actions found: by how well the words fit where words are given, else by name.
pub(super) fn search(connection: &Connection, query: &Query) -> Result<Vec<ActionSummary>, Error> {
    let mut sql = format!("SELECT {SUMMARY} FROM action AS a ");
    let mut values: Vec<Value> = Vec::new();
    let words = match_expression(&query.text);
    if words.is_some() {
        sql.push_str("JOIN action_words AS w ON w.rowid = a.id ");
    }
    sql.push_str(
        "JOIN action_version AS v ON v.action_id = a.id AND v.version = a.latest_version
         WHERE a.removed_ms IS NULL ",
    );
    if let Some(words) = &words {
        sql.push_str("AND action_words MATCH ? ");
        values.push(words.clone().into());
    }
    for tag in &query.tags {
        sql.push_str(
            "AND EXISTS (SELECT 1 FROM action_tag AS t WHERE t.tag = ? AND t.action_id = a.id) ",
        );
        values.push(tag.clone().into());
    }
    if !query.joints.is_empty() {
        let bits = query.joints.iter().fold(0_i64, |bits, joint| bits | (1 << joint.index()));
        sql.push_str("AND a.joints & ? = ? ");
        values.extend([bits.into(), bits.into()]);
    }
    let bounds = [
        ("AND a.duration_ms >= ? ", query.duration_ms_min),
        ("AND a.duration_ms <= ? ", query.duration_ms_max),
    ];
    for (condition, bound_ms) in bounds {
        if let Some(bound_ms) = bound_ms {
            sql.push_str(condition);
            values.push(i64::try_from(bound_ms).unwrap_or(i64::MAX).into());
        }
    }
    // The name counts most, then the tags; equal ones keep the order of the names.
    sql.push_str(if words.is_some() {
        "ORDER BY bm25(action_words, 10.0, 2.0, 5.0, 1.0), a.name LIMIT ? OFFSET ?"
    } else {
        "ORDER BY a.name LIMIT ? OFFSET ?"
    });
    values.extend([i64::from(query.limit).into(), i64::from(query.offset).into()]);
    let mut statement = connection.prepare_cached(&sql)?;
    let rows = statement.query_map(params_from_iter(values), summary)?;
    rows.collect()
}

/// The words of a text as the index takes them, none of them a word of its language; none where there
/// are no words.
fn match_expression(text: &str) -> Option<String> {
    let words: Vec<String> = text
        .split(|letter: char| !letter.is_alphanumeric())
        .filter(|word| !word.is_empty())
        .map(|word| format!("\"{word}\""))
        .collect();
    (!words.is_empty()).then(|| words.join(" ") + "*")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_text_is_taken_for_a_word_of_the_index() {
        assert_eq!(match_expression(" walk-forw "), Some("\"walk\" \"forw\"*".into()));
        assert_eq!(match_expression("a\"b OR (NEAR"), Some("\"a\" \"b\" \"OR\" \"NEAR\"*".into()));
        assert_eq!(match_expression("*:^-"), None);
    }
}
