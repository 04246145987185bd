//! Opening: what the file is, settings, migrations, the seed library.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use rusqlite::{Connection, OpenFlags, Transaction, TransactionBehavior};
use rusqlite_migration::{HookError, M, Migrations};

use super::{BUSY_TIMEOUT_MS, Place, Registry, convert, write};
use crate::error::RegistryError;

/// Set in the header by the first migration: `RSRR`.
const APPLICATION_ID: i64 = 0x5253_5252;

/// How many schemas there are; the newest is in force.
const SCHEMA: i64 = 2;

/// The seed library, in the form that is imported.
const SEED: &str = include_str!("../../seed/actions.rsa");
/// The actions of the first seed library, which had no parameters yet: where the user has not edited
/// them, a later library renews them.
const FIRST_SEEDS: [&str; 16] = [
    "stand",
    "stride-forward",
    "walk-forward",
    "stride-backward",
    "walk-backward",
    "turn-left",
    "turn-right",
    "wave",
    "bow",
    "grip-right",
    "release-right",
    "grip-left",
    "release-left",
    "pick-up",
    "throw",
    "dance",
];
/// Which seed library this is: one more with each that brings new actions.
const SEED_GENERATION: i64 = 2;

fn migrations() -> Migrations<'static> {
    Migrations::new(vec![
        M::up_with_hook(
            include_str!("../../migrations/0001_actions.sql"),
            not_done_by_another::<1>,
        ),
        M::up_with_hook(include_str!("../../migrations/0002_language.sql"), |transaction| {
            not_done_by_another::<2>(transaction)?;
            convert::write_texts(transaction)?;
            transaction.execute_batch(include_str!("../../migrations/0002_language_end.sql"))?;
            Ok(())
        }),
    ])
}

/// Fails a migration that another process did between our look at the schema number and our turn
/// to write; the number is read again then.
fn not_done_by_another<const NUMBER: i64>(transaction: &Transaction) -> Result<(), HookError> {
    let schema: i64 = transaction.query_row("PRAGMA user_version", [], |row| row.get(0))?;
    if schema < NUMBER {
        Ok(())
    } else {
        Err(HookError::Hook(format!("schema {NUMBER} was made by another process meanwhile")))
    }
}

pub(super) fn open(path: &Path) -> Result<Registry, RegistryError> {
    // Absolute, so that no name has a special meaning (`:memory:`, the empty name) and errors
    // name the file wherever they are read.
    let path = std::path::absolute(path).map_err(|error| RegistryError::CannotOpen {
        path: path.to_owned(),
        reason: error.to_string(),
    })?;
    if path.is_dir() {
        return Err(RegistryError::CannotOpen { path, reason: "it is a folder".to_owned() });
    }
    let flags = OpenFlags::SQLITE_OPEN_READ_WRITE
        | OpenFlags::SQLITE_OPEN_CREATE
        | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let place = Place { path };
    let connection = Connection::open_with_flags(&place.path, flags);
    prepare(connection.map_err(|error| place.error(error))?, place)
}

pub(super) fn open_read_only(path: &Path) -> Result<Registry, RegistryError> {
    let path = std::path::absolute(path).map_err(|error| RegistryError::CannotOpen {
        path: path.to_owned(),
        reason: error.to_string(),
    })?;
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let place = Place { path };
    let connection = Connection::open_with_flags(&place.path, flags);
    let connection = connection.map_err(|error| place.error(error))?;
    let error = |error| place.error(error);
    connection.busy_timeout(Duration::from_millis(BUSY_TIMEOUT_MS)).map_err(error)?;
    connection.pragma_update(None, "trusted_schema", "OFF").map_err(error)?;
    let schema = schema_of(&connection, &place)?;
    if schema < SCHEMA {
        return Err(RegistryError::TooOld { path: place.path, file_schema: schema });
    }
    Ok(Registry { connection, place })
}

pub(super) fn open_in_memory() -> Result<Registry, RegistryError> {
    let place = Place { path: PathBuf::from(":memory:") };
    prepare(Connection::open_in_memory().map_err(|error| place.error(error))?, place)
}

fn prepare(mut connection: Connection, place: Place) -> Result<Registry, RegistryError> {
    let begun = Instant::now();
    let patience = Duration::from_millis(BUSY_TIMEOUT_MS);
    connection.busy_timeout(patience).map_err(|error| place.error(error))?;
    connection.set_prepared_statement_cache_capacity(32);
    // Migrations take the right to write before they look.
    connection.set_transaction_behavior(TransactionBehavior::Immediate);
    loop {
        match establish(&mut connection, &place) {
            Ok(()) => return Ok(Registry { connection, place }),
            // Turning on WAL and making the first schema do not wait for another process that
            // does the same; it is soon done.
            Err(RegistryError::Busy { .. }) if begun.elapsed() < patience => {
                std::thread::sleep(Duration::from_millis(10));
            }
            Err(error) => return Err(error),
        }
    }
}

/// Everything that has to be so before a registry is used; does nothing where it is so already.
fn establish(connection: &mut Connection, place: &Place) -> Result<(), RegistryError> {
    let schema = schema_of(connection, place)?;
    let error = |error| place.error(error);
    if connection.is_readonly(rusqlite::MAIN_DB).map_err(error)? {
        let reason = "it can only be read".to_owned();
        return Err(RegistryError::Unwritable { path: place.path.clone(), reason });
    }
    // WAL: readers and a writer at once. FULL: a commit is on the disk before it is reported.
    let set = |name, value: &str| connection.pragma_update_and_check(None, name, value, |_| Ok(()));
    set("journal_mode", "WAL").map_err(error)?;
    connection.pragma_update(None, "synchronous", "FULL").map_err(error)?;
    connection.pragma_update(None, "foreign_keys", "ON").map_err(error)?;
    connection.pragma_update(None, "trusted_schema", "OFF").map_err(error)?;
    if schema < SCHEMA {
        migrate(connection, place)?;
    }
    seed(connection, place)
}

/// The schema number of a file that is a registry, or is empty (0).
fn schema_of(connection: &Connection, place: &Place) -> Result<i64, RegistryError> {
    let header = || -> Result<(i64, i64, i64), rusqlite::Error> {
        let snapshot = Transaction::new_unchecked(connection, TransactionBehavior::Deferred)?;
        let number = |query| snapshot.query_row(query, [], |row| row.get(0));
        Ok((
            number("SELECT COUNT(*) FROM sqlite_schema")?,
            number("PRAGMA application_id")?,
            number("PRAGMA user_version")?,
        ))
    };
    let path = || place.path.clone();
    match header().map_err(|error| place.error(error))? {
        (0, 0, 0) => Ok(0),
        (_, APPLICATION_ID, schema) if schema > SCHEMA => Err(RegistryError::TooNew {
            path: path(),
            file_schema: schema,
            program_schema: SCHEMA,
            program_version: env!("CARGO_PKG_VERSION"),
        }),
        (_, APPLICATION_ID, schema) if schema >= 1 => Ok(schema),
        (_, APPLICATION_ID, schema) => {
            Err(place.corrupt(&format!("its schema number is {schema}")))
        }
        _ => Err(RegistryError::NotARegistry {
            path: path(),
            reason: "it is an SQLite database of another program".to_owned(),
        }),
    }
}

fn migrate(connection: &mut Connection, place: &Place) -> Result<(), RegistryError> {
    migrations().to_latest(connection).map_err(|error| match error {
        rusqlite_migration::Error::RusqliteError { err, .. } => {
            // A schema made by another process meanwhile shows as "already exists", too.
            match schema_of(connection, place) {
                Ok(SCHEMA) => busy(place),
                _ => place.error(err),
            }
        }
        rusqlite_migration::Error::Hook(_) => busy(place),
        other => place.corrupt(&other),
    })
}

fn busy(place: &Place) -> RegistryError {
    RegistryError::Busy { path: place.path.clone(), waited_ms: BUSY_TIMEOUT_MS }
}

/// Puts the seed library in, once: a seed the user has removed or edited stays so.
fn seed(connection: &Connection, place: &Place) -> Result<(), RegistryError> {
    let error = |error| place.error(error);
    let generation = |connection: &Connection| -> Result<i64, rusqlite::Error> {
        connection.query_row("SELECT seed_generation FROM registry", [], |row| row.get(0))
    };
    if generation(connection).map_err(error)? >= SEED_GENERATION {
        return Ok(());
    }
    let transaction =
        Transaction::new_unchecked(connection, TransactionBehavior::Immediate).map_err(error)?;
    if generation(&transaction).map_err(error)? < SEED_GENERATION {
        write::seed(&transaction, place, SEED, &FIRST_SEEDS)?;
        transaction
            .execute("UPDATE registry SET seed_generation = ?", [SEED_GENERATION])
            .map_err(error)?;
    }
    transaction.commit().map_err(error)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn migrations_are_valid_and_counted() {
        migrations().validate().unwrap();
        let mut connection = Connection::open_in_memory().unwrap();
        migrations().to_latest(&mut connection).unwrap();
        let number = |query| connection.query_row(query, [], |row| row.get::<_, i64>(0)).unwrap();
        assert_eq!(number("PRAGMA user_version"), SCHEMA);
        assert_eq!(number("PRAGMA application_id"), APPLICATION_ID);
    }

    #[test]
    fn a_migration_done_by_another_process_is_not_done_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("registry.sqlite");
        let mut late = Connection::open(&path).unwrap();
        late.set_transaction_behavior(TransactionBehavior::Immediate);
        drop(open(&path).unwrap());
        late.pragma_update(None, "user_version", 1).unwrap();
        let transaction = late.transaction().unwrap();
        assert!(not_done_by_another::<1>(&transaction).is_err());
        assert!(not_done_by_another::<2>(&transaction).is_ok());
    }
}
