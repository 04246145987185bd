//! Keeping a registry: backup while in use, restore, integrity, repair.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use rusqlite::backup::{Backup, Progress};
use rusqlite::{Connection, Error};
use serde::Serialize;

use super::{Registry, convert, read};
use crate::error::RegistryError;
use crate::language::parse_text;
use crate::store::known::Stored;

/// How many pages of the file are copied at once; other programs may write in between.
const BACKUP_PAGES: i32 = 256;
const BACKUP_PAUSE: Duration = Duration::from_millis(2);

const RESTORE: &str =
    "restore a backup, or export what can be read and import it into a new registry";
const REPAIR: &str = "repair makes it anew from the texts";

/// What an integrity check has found; nothing where all is well.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Integrity {
    /// How many actions in force were looked at.
    pub actions: usize,
    /// What is wrong, in the order in which it was found.
    pub problems: Vec<IntegrityProblem>,
}

/// Something that is wrong with a registry.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct IntegrityProblem {
    /// What.
    pub what: String,
    /// What to do.
    pub advice: String,
    /// Whether [`Registry::repair`] mends it.
    pub is_repairable: bool,
}

impl Registry {
    /// Copies the registry to the new file `to`, while it is in use; `progress` is told how many of how
    /// many pages are copied.
    ///
    /// # Errors
    /// [`RegistryError::FileExists`] where there is a file already; the database's.
    pub fn backup(
        &self,
        to: &Path,
        mut progress: impl FnMut(u32, u32),
    ) -> Result<(), RegistryError> {
        if to.exists() {
            return Err(RegistryError::FileExists { path: to.to_owned() });
        }
        let error = |error: Error| super::Place { path: to.to_owned() }.error(error);
        let mut copied = || -> Result<(), Error> {
            let mut copy = Connection::open(to)?;
            {
                let backup = Backup::new(&self.connection, &mut copy)?;
                while backup.step(BACKUP_PAGES)? != rusqlite::backup::StepResult::Done {
                    let Progress { remaining, pagecount } = backup.progress();
                    let count = |pages: i32| u32::try_from(pages).unwrap_or_default();
                    progress(count(pagecount - remaining), count(pagecount));
                    std::thread::sleep(BACKUP_PAUSE);
                }
            }
            // One file, without a log beside it.
            copy.pragma_update_and_check(None, "journal_mode", "DELETE", |_| Ok(()))
        };
        copied().map_err(|failure| {
            // Half a copy is no copy.
            let _ = fs::remove_file(to);
            error(failure)
        })
    }

    /// Puts the registry of the file `from` in the place of this one's content. What was there before is
    /// copied to a file beside it first, whose path is returned.
    ///
    /// # Errors
    /// Those of [`Registry::open_read_only`] for `from`, and of [`Registry::backup`].
    pub fn restore_from(&mut self, from: &Path) -> Result<PathBuf, RegistryError> {
        let source = Registry::open_read_only(from)?;
        let mut kept = None;
        for number in 1..10_000_u32 {
            let path = self.place.path.with_extension(format!("before-restore-{number}.sqlite"));
            match self.backup(&path, |_, _| {}) {
                Ok(()) => {
                    kept = Some(path);
                    break;
                }
                Err(RegistryError::FileExists { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        let Some(kept) = kept else {
            return Err(RegistryError::FileExists { path: self.place.path.clone() });
        };
        let mut copied = || -> Result<(), Error> {
            let backup = Backup::new(&source.connection, &mut self.connection)?;
            backup.run_to_completion(BACKUP_PAGES, BACKUP_PAUSE, None)
        };
        copied().map_err(|error| source.place.error(error))?;
        Ok(kept)
    }

    /// Looks at everything that is stored: the database's own checks, whether every text can be read
    /// and every action compiled, and whether what is derived agrees with the texts.
    ///
    /// # Errors
    /// The database's, where it cannot be read at all.
    pub fn integrity(&self) -> Result<Integrity, RegistryError> {
        let transaction = self.begin_read()?;
        integrity_of(&transaction).map_err(|error| self.place.error(error))
    }

    /// Makes anew what is derived of the texts: lengths, joints, content hashes, the index of words.
    /// Returns what is still wrong then.
    ///
    /// # Errors
    /// The database's.
    pub fn repair(&mut self) -> Result<Integrity, RegistryError> {
        let transaction = self.begin_write()?;
        convert::renew_all(&transaction).map_err(|error| self.place.error(error))?;
        self.commit(transaction)?;
        self.integrity()
    }
}

fn integrity_of(connection: &Connection) -> Result<Integrity, Error> {
    let mut found = Integrity::default();
    let mut tell = |what: String, advice: &str, is_repairable| {
        let advice = advice.to_owned();
        found.problems.push(IntegrityProblem { what, advice, is_repairable });
    };
    let mut statement = connection.prepare("PRAGMA integrity_check")?;
    let mut rows = statement.query([])?;
    while let Some(row) = rows.next()? {
        let told: String = row.get(0)?;
        if told != "ok" {
            tell(format!("the database: {told}"), RESTORE, false);
        }
    }
    let mut statement = connection.prepare("PRAGMA foreign_key_check")?;
    let mut rows = statement.query([])?;
    while let Some(row) = rows.next()? {
        let table: String = row.get(0)?;
        tell(format!("a row of {table} points to nothing"), RESTORE, false);
    }
    let stored = Stored::new(connection);
    let summaries = read::summaries(connection)?;
    let words: Vec<i64> = connection
        .prepare("SELECT rowid FROM action_words ORDER BY rowid")?
        .query_map([], |row| row.get(0))?
        .collect::<Result<_, _>>()?;
    for summary in &summaries {
        let name = &summary.name;
        let Some(row) = read::action_row(connection, name)? else { continue };
        let text = read::source(connection, row.id, row.latest_version)?;
        let parsed = parse_text(&text);
        let draft = match parsed.actions.first() {
            Some(action) if parsed.findings.is_empty() => &action.draft,
            _ => {
                tell(format!("the text of {name} cannot be read"), RESTORE, false);
                continue;
            }
        };
        match stored.derive(draft)? {
            Err(finding) => {
                let what = format!("{name} cannot be compiled: {}", finding.message);
                tell(what, "edit the action", false);
            }
            Ok(derived) => {
                let is_true = derived.content_hash == summary.content_hash
                    && derived.compiled.duration_ms == summary.duration_ms
                    && u32::try_from(derived.compiled.steps.len()) == Ok(summary.step_count);
                if !is_true {
                    tell(format!("length or content hash of {name} is out of date"), REPAIR, true);
                }
            }
        }
        if words.binary_search(&row.id).is_err() {
            tell(format!("{name} is missing in the index of words"), REPAIR, true);
        }
    }
    if words.len() > summaries.len() {
        tell("the index of words knows removed actions".to_owned(), REPAIR, true);
    }
    found.actions = summaries.len();
    Ok(found)
}
