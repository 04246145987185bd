//! What an import of a bundle does with what is here already.

use std::collections::{BTreeMap, BTreeSet};

use rusqlite::Connection;
use serde::Serialize;

use super::Bundle;
use crate::error::RegistryError;
use crate::language::{Span, parse_text};
use crate::store::{Place, read};

/// What an import does with an action that is here already and does something else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BundlePolicy {
    /// Nothing is imported, and the conflicts are told.
    Refuse,
    /// The one that is here stays; what is imported plays that one.
    KeepMine,
    /// The bundle's becomes a new version; the older ones are kept.
    TakeTheirs,
    /// The bundle's gets another name, and what is imported with it plays it by that.
    RenameTheirs,
}

/// An action that is here already and does something else.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Conflict {
    /// Its name.
    pub name: String,
    /// The content hash of the one that is here.
    pub here: String,
    /// The content hash of the bundle's.
    pub theirs: String,
}

/// What an import does. Each list is in the order of the bundle.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct BundlePlan {
    /// The text that is imported.
    #[serde(skip)]
    pub text: String,
    /// Actions that are not here.
    pub added: Vec<String>,
    /// Actions that are here and do the same; they stay as they are.
    pub unchanged: Vec<String>,
    /// Actions that are here and do something else.
    pub conflicts: Vec<Conflict>,
    /// Names of actions that are renamed, and the new ones.
    pub renamed: Vec<(String, String)>,
    /// Actions that are imported and play one that is kept instead of the bundle's, with the names of those.
    pub plays_mine: Vec<(String, Vec<String>)>,
}

pub(super) fn plan(
    connection: &Connection,
    place: &Place,
    bundle: &Bundle,
    policy: BundlePolicy,
) -> Result<BundlePlan, RegistryError> {
    let error = |error| place.error(error);
    let mut plan = BundlePlan::default();
    let mut imported: Vec<&str> = Vec::new();
    for action in &bundle.manifest.actions {
        let name = action.name.as_str();
        let found = read::action_row(connection, name).map_err(error)?;
        let Some(row) = found.filter(|row| !row.removed) else {
            plan.added.push(name.to_owned());
            imported.push(name);
            continue;
        };
        let here = read::one_summary(connection, row.id).map_err(error)?.content_hash;
        if here == action.content_hash {
            plan.unchanged.push(name.to_owned());
            continue;
        }
        let theirs = action.content_hash.clone();
        plan.conflicts.push(Conflict { name: name.to_owned(), here, theirs });
        if policy != BundlePolicy::KeepMine {
            imported.push(name);
        }
    }
    let mut names: BTreeMap<&str, String> = BTreeMap::new();
    if policy == BundlePolicy::RenameTheirs {
        for conflict in &plan.conflicts {
            let new = free_name(connection, bundle, &names, &conflict.name).map_err(error)?;
            plan.renamed.push((conflict.name.clone(), new.clone()));
            names.insert(&conflict.name, new);
        }
    }
    if policy == BundlePolicy::KeepMine {
        let kept: BTreeSet<&str> = plan.conflicts.iter().map(|it| it.name.as_str()).collect();
        for name in &imported {
            let played = bundle.texts.get(*name).map(|text| played_of(text, &kept));
            let played = played.filter(|played| !played.is_empty());
            plan.plays_mine.extend(played.map(|played| ((*name).to_owned(), played)));
        }
    }
    let texts = imported.iter().filter_map(|name| bundle.texts.get(*name));
    let texts: Vec<String> = texts.map(|text| renamed(text, &names)).collect();
    plan.text = texts.join("\n\n");
    Ok(plan)
}

/// Those of `names` that a text plays, in the order of the alphabet.
fn played_of(text: &str, names: &BTreeSet<&str>) -> Vec<String> {
    let mut played = BTreeSet::new();
    for action in parse_text(text).actions {
        action.draft.visit(&mut |statement| {
            let name = statement.played().map(|play| play.action.text.as_str());
            played.extend(name.and_then(|name| names.get(name)).map(|name| (*name).to_owned()));
        });
    }
    played.into_iter().collect()
}

/// `NAME-2`, or the first number above that is free here and in the bundle.
fn free_name(
    connection: &Connection,
    bundle: &Bundle,
    taken: &BTreeMap<&str, String>,
    name: &str,
) -> Result<String, rusqlite::Error> {
    let mut number = 2_u64;
    loop {
        let ending = format!("-{number}");
        let room = crate::language::NAME_LENGTH_MAX - ending.len();
        let stem = name.get(..name.len().min(room)).unwrap_or(name).trim_end_matches('-');
        let new = format!("{stem}{ending}");
        let is_free = read::action_row(connection, &new)?.is_none()
            && !bundle.texts.contains_key(&new)
            && !taken.values().any(|name| *name == new);
        if is_free {
            return Ok(new);
        }
        number += 1;
    }
}

/// A text with other names of actions, everything else word for word.
fn renamed(text: &str, names: &BTreeMap<&str, String>) -> String {
    let mut edits: Vec<(Span, &String)> = Vec::new();
    for action in parse_text(text).actions {
        let own = &action.draft.name;
        edits.extend(names.get(own.text.as_str()).map(|new| (own.span, new)));
        action.draft.visit(&mut |statement| {
            if let Some(play) = statement.played() {
                let played = &play.action;
                edits.extend(names.get(played.text.as_str()).map(|new| (played.span, new)));
            }
        });
    }
    edits.sort_by_key(|(span, _)| span.start);
    let mut renamed = text.to_owned();
    for (span, new) in edits.into_iter().rev() {
        renamed.replace_range(span.start..span.end, new);
    }
    renamed
}
