//! The stored actions as those that others can play, with what is derived of them.

use std::cell::{Cell, RefCell};
use std::collections::HashMap;
use std::sync::Arc;

use rusqlite::{Connection, Error};

use super::read;
use crate::check::Finding;
use crate::compiled::CompiledAction;
use crate::expand::{CompileOptions, KnownActions, compile};
use crate::hash::content_hash;
use crate::language::{ActionDraft, parse_text};

/// The actions in force behind a connection, each read once.
pub(super) struct Stored<'a> {
    connection: &'a Connection,
    drafts: RefCell<HashMap<String, Option<Arc<ActionDraft>>>>,
    hashes: RefCell<HashMap<String, String>>,
    /// What the database said when it could not be read; what was compiled then means nothing.
    error: Cell<Option<Error>>,
}

/// What is derived of an action and kept beside it.
pub(super) struct Derived {
    pub(super) compiled: CompiledAction,
    pub(super) content_hash: String,
}

impl<'a> Stored<'a> {
    pub(super) fn new(connection: &'a Connection) -> Stored<'a> {
        Stored {
            connection,
            drafts: RefCell::default(),
            hashes: RefCell::default(),
            error: Cell::new(None),
        }
    }

    /// The value, unless the database could not be read meanwhile.
    pub(super) fn sound<T>(&self, value: T) -> Result<T, Error> {
        match self.error.take() {
            Some(error) => Err(error),
            None => Ok(value),
        }
    }

    /// Compiles an action in force with its defaults.
    pub(super) fn derive(&self, draft: &ActionDraft) -> Result<Result<Derived, Finding>, Error> {
        let derived = compile(draft, self, &CompileOptions::default()).map(|compiled| {
            let content_hash = self.content_hash(draft);
            Derived { compiled, content_hash }
        });
        self.sound(derived)
    }

    /// Circles were refused when the action was compiled, so that this ends.
    fn content_hash(&self, draft: &ActionDraft) -> String {
        if let Some(hash) = self.hashes.borrow().get(&draft.name.text) {
            return hash.clone();
        }
        let hash = content_hash(draft, &mut |name| match self.draft(name) {
            Some(played) => self.content_hash(&played),
            None => name.to_owned(),
        });
        self.hashes.borrow_mut().insert(draft.name.text.clone(), hash.clone());
        hash
    }

    fn read(&self, name: &str) -> Result<Option<Arc<ActionDraft>>, Error> {
        let Some(row) = read::action_row(self.connection, name)?.filter(|row| !row.removed) else {
            return Ok(None);
        };
        let text = read::source(self.connection, row.id, row.latest_version)?;
        let parsed = parse_text(&text);
        if let Some(finding) = parsed.findings.first() {
            return Err(read::damaged(format!("the text of {name:?}: {}", finding.message)));
        }
        let first = parsed.actions.into_iter().next();
        Ok(first.map(|action| Arc::new(action.draft)))
    }

    fn note<T>(&self, result: Result<T, Error>) -> Option<T> {
        result.map_err(|error| self.error.set(Some(error))).ok()
    }
}

impl KnownActions for Stored<'_> {
    fn draft(&self, name: &str) -> Option<Arc<ActionDraft>> {
        if let Some(known) = self.drafts.borrow().get(name) {
            return known.clone();
        }
        let draft = self.note(self.read(name)).flatten();
        self.drafts.borrow_mut().insert(name.to_owned(), draft.clone());
        draft
    }

    fn names(&self) -> Vec<String> {
        self.note(read::live_names(self.connection)).unwrap_or_default()
    }
}
