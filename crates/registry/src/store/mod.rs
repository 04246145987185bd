//! RoboRegistry: primitives and actions in one SQLite file.

mod bundle;
mod convert;
mod keep;
mod known;
mod open;
mod read;
mod search;
mod write;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use rsapien_protocol::Primitive;
use rusqlite::{Connection, ErrorCode, Transaction, TransactionBehavior};
use serde::Serialize;

use crate::action::{Action, ActionSummary, VersionSummary};
use crate::check::{CheckedText, Findings};
use crate::compiled::CompiledAction;
use crate::error::RegistryError;
use crate::expand::{CompileOptions, compile};
use crate::language::{ActionDraft, print_action};

pub use bundle::{Bundle, BundlePlan, BundlePolicy, BundledAction, Conflict, Manifest};
pub use keep::{Integrity, IntegrityProblem};
pub use search::Query;

use known::Stored;
use read::ActionRow;

/// How long a call waits for another program that is writing, in milliseconds.
pub const BUSY_TIMEOUT_MS: u64 = 5000;

/// The fewest characters of a content hash that name an action.
pub const CONTENT_HASH_MIN: usize = 6;

/// The database of motion primitives and actions (paper, section 3: `RoboRegistry`).
///
/// Every call is one transaction: it happens wholly or not at all, and what it has reported as
/// done outlasts the death of the process and a power cut. Several processes may read and write
/// one file at once; a writer waits up to [`BUSY_TIMEOUT_MS`] for another. A value can be sent to
/// another thread; to share the file between threads, open it once in each.
///
/// Wherever an action is named, `#` and the beginning of its content hash name it, too, the same in
/// every registry: `#3fa94c1b`.
///
/// Times are those of the system clock, in milliseconds since 1970 (UTC).
#[derive(Debug)]
pub struct Registry {
    connection: Connection,
    place: Place,
}

/// How the motions of actions went on the virtual body, as JSON, by the actions' names.
pub type Trials = BTreeMap<String, String>;

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

    /// Opens a registry that is there, to read from it only: the file is not made, not brought up to
    /// date, and every change is refused.
    ///
    /// # Errors
    /// As of [`Registry::open`], and [`RegistryError::TooOld`] for a file that [`Registry::open`] would
    /// bring up to date first.
    pub fn open_read_only(path: impl AsRef<Path>) -> Result<Registry, RegistryError> {
        open::open_read_only(path.as_ref())
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
        read::summaries(&self.connection).map_err(|error| self.place.error(error))
    }

    /// What a list shows of one action.
    ///
    /// # Errors
    /// As of [`Registry::get`].
    pub fn summary(&self, name: &str) -> Result<ActionSummary, RegistryError> {
        let transaction = self.begin_read()?;
        let row = self.live_row(&transaction, name)?;
        read::one_summary(&transaction, row.id).map_err(|error| self.place.error(error))
    }

    /// The actions that a query finds: by how well its words fit, or by name where it has no words.
    ///
    /// # Errors
    /// The database's, naming the path.
    pub fn search(&self, query: &Query) -> Result<Vec<ActionSummary>, RegistryError> {
        search::search(&self.connection, query).map_err(|error| self.place.error(error))
    }

    /// The action of a name, in the version in force.
    ///
    /// # Errors
    /// [`RegistryError::UnknownAction`] with the name that comes nearest,
    /// [`RegistryError::IsPrimitive`] for a primitive's name, or the database's.
    pub fn get(&self, name: &str) -> Result<Action, RegistryError> {
        let transaction = self.begin_read()?;
        let row = self.live_row(&transaction, name)?;
        self.action(&transaction, &row, row.latest_version)
    }

    /// A version of an action, also of a removed one.
    ///
    /// # Errors
    /// As of [`Registry::get`], and [`RegistryError::UnknownVersion`].
    pub fn get_version(&self, name: &str, version: u32) -> Result<Action, RegistryError> {
        let transaction = self.begin_read()?;
        let row = self.row(&transaction, name)?;
        if !(1..=row.latest_version).contains(&version) {
            let (name, latest) = (row.name, row.latest_version);
            return Err(RegistryError::UnknownVersion { name, version, latest });
        }
        self.action(&transaction, &row, version)
    }

    /// Every version of an action, the first first, also of a removed one.
    ///
    /// # Errors
    /// As of [`Registry::get`].
    pub fn history(&self, name: &str) -> Result<Vec<VersionSummary>, RegistryError> {
        let transaction = self.begin_read()?;
        let row = self.row(&transaction, name)?;
        read::versions(&transaction, &row).map_err(|error| self.place.error(error))
    }

    /// Brings an older version back, as a new one; also of a removed action. Returns its number.
    ///
    /// # Errors
    /// As of [`Registry::get_version`], and [`RegistryError::Refused`] where what it plays has changed
    /// so that it is wrong now.
    pub fn restore(&mut self, name: &str, version: u32) -> Result<u32, RegistryError> {
        let old = self.get_version(name, version)?;
        let trials = old.trial.map(|trial| (old.name.clone(), trial)).into_iter().collect();
        self.import_text(&old.text, ImportPolicy::Replace, &trials)?;
        Ok(self.get(&old.name)?.version)
    }

    /// Saves an action as a new version and returns its number: 1 for a new name, one more than
    /// ever before for a name that exists or was removed.
    ///
    /// # Errors
    /// [`RegistryError::Refused`] with everything wrong with it, also when an action that plays it
    /// would become wrong by it; or the database's.
    pub fn save(&mut self, draft: &ActionDraft) -> Result<u32, RegistryError> {
        self.import_text(&print_action(draft), ImportPolicy::Replace, &Trials::new())?;
        Ok(self.get(&draft.name.text)?.version)
    }

    /// Removes an action. Its versions are kept ([`Registry::history`]), and restoring one of them
    /// brings it back.
    ///
    /// # Errors
    /// [`RegistryError::InUse`] when other actions play it; as of [`Registry::get`] otherwise.
    pub fn remove(&mut self, name: &str) -> Result<(), RegistryError> {
        let transaction = self.begin_write()?;
        let error = |error| self.place.error(error);
        let row = self.live_row(&transaction, name)?;
        let users = read::users(&transaction, row.id).map_err(error)?;
        if !users.is_empty() {
            let users = users.into_iter().map(|(_, name)| name).collect();
            return Err(RegistryError::InUse { name: row.name, users });
        }
        write::remove(&transaction, row.id).map_err(error)?;
        self.commit(transaction)
    }

    /// Compiles an action, with all it plays, to the steps of the robot's queue.
    ///
    /// # Errors
    /// As of [`Registry::get`], and [`RegistryError::Refused`] for options that are not allowed.
    pub fn compile(
        &self,
        name: &str,
        options: &CompileOptions,
    ) -> Result<CompiledAction, RegistryError> {
        let transaction = self.begin_read()?;
        let row = self.live_row(&transaction, name)?;
        let action = self.action(&transaction, &row, row.latest_version)?;
        let draft =
            action.draft().ok_or_else(|| self.place.corrupt(&"a text without an action"))?;
        self.compile_with(&transaction, &draft, options, &action.text)
    }

    /// Compiles an action that is not stored; what it plays is.
    ///
    /// # Errors
    /// [`RegistryError::Refused`] with the first thing that is wrong, or the database's.
    pub fn compile_draft(
        &self,
        draft: &ActionDraft,
        options: &CompileOptions,
    ) -> Result<CompiledAction, RegistryError> {
        let transaction = self.begin_read()?;
        self.compile_with(&transaction, draft, options, "")
    }

    /// Imports the actions of a text, all or none, word for word. They may play each other in any
    /// order, and actions that are stored already. `trials` are kept with those they belong to.
    ///
    /// # Errors
    /// [`RegistryError::Refused`] with everything found wrong and its places,
    /// [`RegistryError::AlreadyExist`] with [`ImportPolicy::Refuse`], or the database's.
    pub fn import_text(
        &mut self,
        text: &str,
        policy: ImportPolicy,
        trials: &Trials,
    ) -> Result<ImportReport, RegistryError> {
        let transaction = self.begin_write()?;
        let report = write::import(&transaction, &self.place, text, policy, trials)?;
        self.commit(transaction)?;
        Ok(report)
    }

    /// Checks a text as an import would, warnings included, and compiles its actions. Nothing is
    /// stored, and actions that exist already are no finding.
    ///
    /// # Errors
    /// The database's only.
    pub fn check_text(&self, text: &str) -> Result<CheckedText, RegistryError> {
        let transaction = self.begin_read()?;
        write::check(&transaction, &self.place, text)
    }

    /// The texts of the actions of `names`, in that order, each once; `with_played` adds behind them
    /// whatever they play, so that another registry can import the text.
    ///
    /// # Errors
    /// As of [`Registry::get`].
    pub fn export_text(&self, names: &[&str], with_played: bool) -> Result<String, RegistryError> {
        let texts = self.export(names, with_played)?.into_iter().map(|action| action.text);
        Ok(texts.map(|text| text + "\n").collect::<Vec<_>>().join("\n"))
    }

    /// The text of every action, in alphabetical order.
    ///
    /// # Errors
    /// The database's, naming the path.
    pub fn export_all_text(&self) -> Result<String, RegistryError> {
        let names = read::live_names(&self.connection).map_err(|error| self.place.error(error))?;
        self.export_text(&names.iter().map(String::as_str).collect::<Vec<_>>(), false)
    }

    /// The actions of `names`, in that order, each once, and behind them in alphabetical order what
    /// they play, where asked for.
    fn export(&self, names: &[&str], with_played: bool) -> Result<Vec<Action>, RegistryError> {
        let transaction = self.begin_read()?;
        let mut actions: Vec<Action> = Vec::with_capacity(names.len());
        for name in names {
            let row = self.live_row(&transaction, name)?;
            if actions.iter().all(|action| action.name != row.name) {
                actions.push(self.action(&transaction, &row, row.latest_version)?);
            }
        }
        if with_played {
            let mut played: BTreeMap<String, Action> = BTreeMap::new();
            let mut waiting: Vec<String> = actions.iter().flat_map(played_by).collect();
            while let Some(name) = waiting.pop() {
                if played.contains_key(&name) || actions.iter().any(|action| action.name == name) {
                    continue;
                }
                let row = self.live_row(&transaction, &name)?;
                let action = self.action(&transaction, &row, row.latest_version)?;
                waiting.extend(played_by(&action));
                played.insert(name, action);
            }
            actions.extend(played.into_values());
        }
        Ok(actions)
    }

    fn compile_with(
        &self,
        connection: &Connection,
        draft: &ActionDraft,
        options: &CompileOptions,
        text: &str,
    ) -> Result<CompiledAction, RegistryError> {
        let stored = Stored::new(connection);
        let compiled = compile(draft, &stored, options);
        let compiled = stored.sound(compiled).map_err(|error| self.place.error(error))?;
        compiled.map_err(|finding| RegistryError::Refused(Findings::new(text, vec![finding])))
    }

    fn action(
        &self,
        connection: &Connection,
        row: &ActionRow,
        version: u32,
    ) -> Result<Action, RegistryError> {
        read::action(connection, row, version).map_err(|error| self.place.error(error))
    }

    /// The row of an action in force.
    fn live_row(&self, connection: &Connection, name: &str) -> Result<ActionRow, RegistryError> {
        match self.named(connection, name)? {
            Some(row) if !row.removed => Ok(row),
            _ => Err(self.unknown(connection, name, false)),
        }
    }

    /// The row of an action, removed or not.
    fn row(&self, connection: &Connection, name: &str) -> Result<ActionRow, RegistryError> {
        self.named(connection, name)?.ok_or_else(|| self.unknown(connection, name, true))
    }

    fn named(
        &self,
        connection: &Connection,
        name: &str,
    ) -> Result<Option<ActionRow>, RegistryError> {
        let error = |error| self.place.error(error);
        let Some(hash) = name.strip_prefix('#') else {
            return read::action_row(connection, name).map_err(error);
        };
        let is_hash = hash.len() >= CONTENT_HASH_MIN
            && hash.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'));
        if !is_hash {
            return Ok(None);
        }
        // Several actions may do the same; the first by name stands for them.
        match read::names_of_hash(connection, hash).map_err(error)?.first() {
            Some(name) => read::action_row(connection, name).map_err(error),
            None => Ok(None),
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

fn played_by(action: &Action) -> Vec<String> {
    let draft = action.draft().unwrap_or_default();
    draft.played().into_iter().map(str::to_owned).collect()
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
