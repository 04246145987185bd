//! RoboRegistry: primitives and actions in one SQLite file.

mod open;
mod read;
mod write;

use std::path::{Path, PathBuf};

use rsapien_protocol::Primitive;
use rusqlite::{Connection, ErrorCode, Transaction, TransactionBehavior};
use serde::Serialize;

use crate::action::{Action, ActionDraft, ActionSummary, VersionSummary};
use crate::compile::{CompileOptions, compile};
use crate::compiled::CompiledAction;
use crate::error::RegistryError;
use crate::problem::{Finding, Findings};
use crate::text::{TomlActions, write_toml};

/// How long a call waits for another program that is writing, in milliseconds.
pub const BUSY_TIMEOUT_MS: u64 = 5000;

/// The database of motion primitives and actions (paper, section 3: `RoboRegistry`).
///
/// Every call is one transaction: it happens wholly or not at all, and what it has reported as
/// done outlasts the death of the process and a power cut. Several processes may read and write
/// one file at once; a writer waits up to [`BUSY_TIMEOUT_MS`] for another. A value can be sent to
/// another thread; to share the file between threads, open it once in each.
///
/// Times are those of the system clock, in milliseconds since 1970 (UTC).
#[derive(Debug)]
pub struct Registry {
    connection: Connection,
    place: Place,
}

/// What an import does with an action that exists with other content.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImportPolicy {
    /// Nothing is imported and the actions are named.
    Refuse,
    /// What is imported becomes a new version; the older ones are kept.
    Replace,
}

/// What an import did. Each list is in the order of the text.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ImportReport {
    /// Actions that did not exist.
    pub added: Vec<String>,
    /// Actions that got a new version.
    pub replaced: Vec<String>,
    /// Actions that were the same already; they got no new version.
    pub unchanged: Vec<String>,
}

impl Registry {
    /// Opens the registry in the file `path`, which is made if it is not there; its folder has to
    /// be. A new registry knows the seed library.
    ///
    /// # Errors
    /// [`RegistryError::CannotOpen`], [`Unwritable`](RegistryError::Unwritable),
    /// [`NotARegistry`](RegistryError::NotARegistry), [`Corrupt`](RegistryError::Corrupt),
    /// [`TooNew`](RegistryError::TooNew) and [`Busy`](RegistryError::Busy), each naming the path.
    /// The file is then as it was.
    pub fn open(path: impl AsRef<Path>) -> Result<Registry, RegistryError> {
        open::open(path.as_ref())
    }

    /// A registry in memory that knows the seed library and is gone when dropped.
    ///
    /// # Errors
    /// As of [`Registry::open`], where memory does not suffice.
    pub fn open_in_memory() -> Result<Registry, RegistryError> {
        open::open_in_memory()
    }

    /// The file, as an absolute path; `:memory:` for a registry in memory.
    pub fn path(&self) -> &Path {
        &self.place.path
    }

    /// The 21 motion primitives, in the order of the paper's Table 1.
    ///
    /// # Errors
    /// The database's, naming the path.
    pub fn primitives(&self) -> Result<Vec<Primitive>, RegistryError> {
        read::primitives(&self.connection).map_err(|error| self.place.error(error))
    }

    /// Every action, in alphabetical order.
    ///
    /// # Errors
    /// The database's, naming the path.
    pub fn list(&self) -> Result<Vec<ActionSummary>, RegistryError> {
        let transaction = self.begin_read()?;
        let known = read::known_actions(&transaction).map_err(|error| self.place.error(error))?;
        let everyone: Vec<usize> = (0..known.rows.len()).collect();
        let sizes = known.graph.measure(&everyone).map_err(|circle| self.place.corrupt(&circle))?;
        let summaries = known
            .rows
            .into_iter()
            .zip(sizes)
            .map(|(row, size)| ActionSummary { duration_ms: size.duration_ms, ..row.summary });
        Ok(summaries.collect())
    }

    /// The action of a name, in the version in force.
    ///
    /// # Errors
    /// [`RegistryError::UnknownAction`] with the name that comes nearest,
    /// [`RegistryError::IsPrimitive`] for a primitive's name, or the database's.
    pub fn get(&self, name: &str) -> Result<Action, RegistryError> {
        let transaction = self.begin_read()?;
        self.live_action(&transaction, name)
    }

    /// A version of an action, also of a removed one.
    ///
    /// # Errors
    /// As of [`Registry::get`], and [`RegistryError::UnknownVersion`].
    pub fn get_version(&self, name: &str, version: u32) -> Result<Action, RegistryError> {
        let transaction = self.begin_read()?;
        let found =
            read::action_row(&transaction, name).map_err(|error| self.place.error(error))?;
        let row = found.ok_or_else(|| self.unknown(&transaction, name, true))?;
        if !(1..=row.latest_version).contains(&version) {
            let latest = row.latest_version;
            return Err(RegistryError::UnknownVersion { name: name.to_owned(), version, latest });
        }
        read::action(&transaction, &row, version).map_err(|error| self.place.error(error))
    }

    /// Every version of an action, the first first, also of a removed one.
    ///
    /// # Errors
    /// As of [`Registry::get`].
    pub fn history(&self, name: &str) -> Result<Vec<VersionSummary>, RegistryError> {
        let transaction = self.begin_read()?;
        let found =
            read::action_row(&transaction, name).map_err(|error| self.place.error(error))?;
        let row = found.ok_or_else(|| self.unknown(&transaction, name, true))?;
        read::versions(&transaction, &row).map_err(|error| self.place.error(error))
    }

    /// Saves an action as a new version and returns its number: 1 for a new name, one more than
    /// ever before for a name that exists or was removed.
    ///
    /// # Errors
    /// [`RegistryError::Refused`] with everything wrong with it, also when an action that plays it
    /// would become too long by it; or the database's.
    pub fn save(&mut self, draft: &ActionDraft) -> Result<u32, RegistryError> {
        let transaction = self.begin_write()?;
        let versions = write::store(&transaction, &self.place, &[draft])?;
        self.commit(transaction)?;
        Ok(versions.first().copied().unwrap_or_default())
    }

    /// Removes an action. Its versions are kept ([`Registry::history`]), and saving one of them
    /// again brings it back.
    ///
    /// # Errors
    /// [`RegistryError::InUse`] when other actions play it; as of [`Registry::get`] otherwise.
    pub fn remove(&mut self, name: &str) -> Result<(), RegistryError> {
        let transaction = self.begin_write()?;
        let error = |error| self.place.error(error);
        let found = read::action_row(&transaction, name).map_err(error)?;
        let Some(row) = found.filter(|row| !row.removed) else {
            return Err(self.unknown(&transaction, name, false));
        };
        let users = read::users(&transaction, row.id).map_err(error)?;
        if !users.is_empty() {
            return Err(RegistryError::InUse { name: name.to_owned(), users });
        }
        write::remove(&transaction, row.id).map_err(error)?;
        self.commit(transaction)
    }

    /// Compiles an action, with all it plays, to the steps of the robot's queue.
    ///
    /// # Errors
    /// As of [`Registry::get`] and [`compile`].
    pub fn compile(
        &self,
        name: &str,
        options: CompileOptions,
    ) -> Result<CompiledAction, RegistryError> {
        let transaction = self.begin_read()?;
        let action = self.live_action(&transaction, name)?;
        let played = self.all_played(&transaction, std::slice::from_ref(&action.draft))?;
        compile(&action.draft, &played, options)
    }

    /// Compiles an action that is not stored; what it plays is.
    ///
    /// # Errors
    /// As of [`compile`], and the database's.
    pub fn compile_draft(
        &self,
        draft: &ActionDraft,
        options: CompileOptions,
    ) -> Result<CompiledAction, RegistryError> {
        let transaction = self.begin_read()?;
        let played = self.all_played(&transaction, std::slice::from_ref(draft))?;
        compile(draft, &played, options)
    }

    /// Imports the actions of a TOML text, all or none. They may play each other in any order,
    /// and actions that are stored already.
    ///
    /// # Errors
    /// [`RegistryError::Refused`] with everything found wrong and its lines,
    /// [`RegistryError::AlreadyExist`] with [`ImportPolicy::Refuse`], or the database's.
    pub fn import_toml(
        &mut self,
        text: &str,
        policy: ImportPolicy,
    ) -> Result<ImportReport, RegistryError> {
        let actions = TomlActions::read(text).map_err(RegistryError::Refused)?;
        let transaction = self.begin_write()?;
        let report = write::import(&transaction, &self.place, &actions, policy)?;
        self.commit(transaction)?;
        Ok(report)
    }

    /// What [`Registry::import_toml`] would find wrong with a text; nothing is stored, and
    /// actions that exist already are no finding.
    ///
    /// # Errors
    /// The database's only.
    pub fn check_toml(&self, text: &str) -> Result<Vec<Finding>, RegistryError> {
        let actions = match TomlActions::read(text) {
            Ok(actions) => actions,
            Err(Findings(findings)) => return Ok(findings),
        };
        // Never committed: the same code that imports tells what is wrong.
        let transaction = self.begin_write()?;
        match write::import(&transaction, &self.place, &actions, ImportPolicy::Replace) {
            Ok(_) => Ok(Vec::new()),
            Err(RegistryError::Refused(Findings(findings))) => Ok(findings),
            Err(other) => Err(other),
        }
    }

    /// The actions of `names` as TOML, in that order, each once; `with_played` adds behind them
    /// whatever they play, so that another registry can import the text.
    ///
    /// # Errors
    /// As of [`Registry::get`].
    pub fn export_toml(&self, names: &[&str], with_played: bool) -> Result<String, RegistryError> {
        let transaction = self.begin_read()?;
        let mut drafts: Vec<ActionDraft> = Vec::with_capacity(names.len());
        for name in names {
            if drafts.iter().all(|draft| draft.name != **name) {
                drafts.push(self.live_action(&transaction, name)?.draft);
            }
        }
        if with_played {
            let played = self.all_played(&transaction, &drafts)?;
            drafts.extend(played);
        }
        Ok(write_toml(&drafts))
    }

    /// Every action as TOML, in alphabetical order.
    ///
    /// # Errors
    /// The database's, naming the path.
    pub fn export_all_toml(&self) -> Result<String, RegistryError> {
        let transaction = self.begin_read()?;
        let names = read::live_names(&transaction).map_err(|error| self.place.error(error))?;
        let mut drafts = Vec::with_capacity(names.len());
        for name in &names {
            drafts.push(self.live_action(&transaction, name)?.draft);
        }
        Ok(write_toml(&drafts))
    }

    fn live_action(&self, connection: &Connection, name: &str) -> Result<Action, RegistryError> {
        let found = read::action_row(connection, name).map_err(|error| self.place.error(error))?;
        match found.filter(|row| !row.removed) {
            Some(row) => read::action(connection, &row, row.latest_version)
                .map_err(|error| self.place.error(error)),
            None => Err(self.unknown(connection, name, false)),
        }
    }

    fn unknown(&self, connection: &Connection, name: &str, with_removed: bool) -> RegistryError {
        if let Ok(primitive) = Primitive::parse(name) {
            return RegistryError::IsPrimitive { primitive };
        }
        match read::suggestion(connection, name, with_removed) {
            Ok(suggestion) => RegistryError::UnknownAction { name: name.to_owned(), suggestion },
            Err(error) => self.place.error(error),
        }
    }

    /// Whatever `drafts` play, directly or not, except themselves. What is not stored is left out:
    /// compiling tells who plays it.
    fn all_played(
        &self,
        connection: &Connection,
        drafts: &[ActionDraft],
    ) -> Result<Vec<ActionDraft>, RegistryError> {
        read::all_played(connection, drafts).map_err(|error| self.place.error(error))
    }

    /// One snapshot for all that a call reads.
    fn begin_read(&self) -> Result<Transaction<'_>, RegistryError> {
        Transaction::new_unchecked(&self.connection, TransactionBehavior::Deferred)
            .map_err(|error| self.place.error(error))
    }

    /// The right to write from the start, so that what was read stays true until the commit.
    fn begin_write(&self) -> Result<Transaction<'_>, RegistryError> {
        Transaction::new_unchecked(&self.connection, TransactionBehavior::Immediate)
            .map_err(|error| self.place.error(error))
    }

    fn commit(&self, transaction: Transaction<'_>) -> Result<(), RegistryError> {
        transaction.commit().map_err(|error| self.place.error(error))
    }
}

/// The file, for errors that name it.
#[derive(Debug)]
struct Place {
    path: PathBuf,
}

impl Place {
    /// The situation behind a database's error.
    fn error(&self, error: rusqlite::Error) -> RegistryError {
        let path = self.path.clone();
        let reason = error.to_string();
        // A row that is missing or holds what no writer of ours writes.
        if let rusqlite::Error::FromSqlConversionFailure(..)
        | rusqlite::Error::IntegralValueOutOfRange(..)
        | rusqlite::Error::InvalidColumnType(..)
        | rusqlite::Error::QueryReturnedNoRows = error
        {
            return RegistryError::Corrupt { path, reason };
        }
        match error.sqlite_error_code() {
            Some(ErrorCode::NotADatabase) => {
                RegistryError::NotARegistry { path, reason: "it is no SQLite database".to_owned() }
            }
            Some(ErrorCode::DatabaseCorrupt) => RegistryError::Corrupt { path, reason },
            Some(ErrorCode::CannotOpen) => RegistryError::CannotOpen { path, reason },
            Some(
                ErrorCode::ReadOnly
                | ErrorCode::PermissionDenied
                | ErrorCode::DiskFull
                | ErrorCode::SystemIoFailure,
            ) => RegistryError::Unwritable { path, reason },
            Some(
                ErrorCode::DatabaseBusy
                | ErrorCode::DatabaseLocked
                | ErrorCode::FileLockingProtocolFailed,
            ) => RegistryError::Busy { path, waited_ms: BUSY_TIMEOUT_MS },
            _ => RegistryError::Database { path, source: error },
        }
    }

    /// What is stored breaks a rule that everything passed when it was stored.
    fn corrupt(&self, reason: &impl ToString) -> RegistryError {
        RegistryError::Corrupt { path: self.path.clone(), reason: reason.to_string() }
    }
}
