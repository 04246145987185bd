//! Files that are no registry, are damaged, cannot be written, are newer, or are old.

use std::fs;
use std::path::{Path, PathBuf};

use rsapien_protocol::Primitive;
use rsapien_registry::{
    ActionDraft, CompileOptions, ImportPolicy, Registry, RegistryError, Statement, Trials,
};
use rusqlite::Connection;

fn fixture(schema: u32) -> PathBuf {
    let file = format!("tests/fixtures/registry-v{schema}.sqlite");
    Path::new(env!("CARGO_MANIFEST_DIR")).join(file)
}

/// The newest schema.
const NEWEST: u32 = 2;

fn refused(path: &Path) -> RegistryError {
    let error = Registry::open(path).expect_err("has to be refused");
    assert!(error.to_string().contains(path.to_str().unwrap()), "{error}");
    error
}

#[test]
fn a_file_that_is_no_database_is_refused_and_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("notes.txt");
    let text = "these are my notes, and no database at all\n".repeat(100);
    fs::write(&path, &text).unwrap();
    let error = refused(&path);
    assert!(matches!(error, RegistryError::NotARegistry { .. }), "{error}");
    assert_eq!(fs::read_to_string(&path).unwrap(), text);
}

#[test]
fn a_database_of_another_program_is_refused_and_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bookmarks.sqlite");
    Connection::open(&path).unwrap().execute_batch("CREATE TABLE bookmark (url TEXT)").unwrap();
    let before = fs::read(&path).unwrap();
    let error = refused(&path);
    assert!(matches!(error, RegistryError::NotARegistry { .. }), "{error}");
    assert_eq!(fs::read(&path).unwrap(), before);
}

#[test]
fn a_damaged_file_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("registry.sqlite");
    fs::copy(fixture(NEWEST), &path).unwrap();
    let mut bytes = fs::read(&path).unwrap();
    // The header stays, every other page is overwritten.
    bytes.iter_mut().skip(4096).for_each(|byte| *byte = 0xA5);
    fs::write(&path, bytes).unwrap();
    let told = Registry::open(&path).and_then(|registry| registry.list()).unwrap_err();
    assert!(matches!(told, RegistryError::Corrupt { .. }), "{told}");
    assert!(told.to_string().contains(path.to_str().unwrap()), "{told}");
}

#[test]
fn a_newer_file_is_refused_with_all_one_needs_to_know() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("registry.sqlite");
    drop(Registry::open(&path).unwrap());
    Connection::open(&path).unwrap().pragma_update(None, "user_version", 99).unwrap();
    let error = refused(&path);
    assert!(matches!(error, RegistryError::TooNew { file_schema: 99, program_schema: 2, .. }));
    assert_eq!(
        error.to_string(),
        format!(
            "the registry {} has schema 99, and rsapien-registry {} knows schemas up to 2: update \
             this program, or name another file",
            path.display(),
            env!("CARGO_PKG_VERSION")
        )
    );
}

#[test]
fn places_where_no_file_can_be() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing/registry.sqlite");
    assert!(matches!(refused(&missing), RegistryError::CannotOpen { .. }));
    assert!(matches!(refused(folder.path()), RegistryError::CannotOpen { .. }));
    assert!(matches!(Registry::open(""), Err(RegistryError::CannotOpen { .. })));
}

/// `/proc` takes no files, not even from the administrator, whom permissions do not stop.
#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_cannot_be_written() {
    let error = refused(Path::new("/proc/registry.sqlite"));
    let named =
        matches!(error, RegistryError::CannotOpen { .. } | RegistryError::Unwritable { .. });
    assert!(named, "{error}");
}

#[cfg(unix)]
#[test]
fn a_file_that_can_only_be_read() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("registry.sqlite");
    fs::copy(fixture(NEWEST), &path).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o444)).unwrap();
    let may_write_anyway = fs::OpenOptions::new().append(true).open(&path).is_ok();
    if may_write_anyway {
        // The administrator is not stopped by permissions, and neither is the registry then.
        Registry::open(&path).unwrap();
    } else {
        let error = refused(&path);
        assert!(matches!(error, RegistryError::Unwritable { .. }), "{error}");
    }
}

/// Files of each schema, written when it was the newest: the seed library of that time, with `wave`
/// edited (version 2), `bow` removed, `nod` in two versions, `hello` playing `nod` and `wave`, `old`
/// removed.
#[test]
fn files_of_every_schema_open_with_all_they_held() {
    for schema in 1..=NEWEST {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("registry.sqlite");
        fs::copy(fixture(schema), &path).unwrap();
        let mut registry = Registry::open(&path).unwrap();
        let names: Vec<String> = registry.list().unwrap().into_iter().map(|it| it.name).collect();
        for name in ["dance", "hello", "nod", "walk-forward", "wave"] {
            assert!(names.iter().any(|known| known == name), "{name}");
        }
        assert!(registry.get("bow").is_err(), "a seed that was removed stays so");
        assert_eq!(registry.get("wave").unwrap().description, "My own wave.");
        assert_eq!(registry.history("bow").unwrap().len(), 1);
        assert_eq!(registry.history("old").unwrap().len(), 1);
        let nod = registry.get_version("nod", 1).unwrap().draft().unwrap();
        assert_eq!(nod.body, [Statement::parse_short("tilt-left:300").unwrap()]);
        assert_eq!(registry.get("nod").unwrap().tags, ["head", "yes"]);
        let compiled = registry.compile("hello", &CompileOptions::default()).unwrap();
        assert_eq!((compiled.steps.len(), compiled.duration_ms), (5, 2 * 600 + 900));
        assert!(registry.primitives().unwrap().into_iter().eq(Primitive::all()));
        assert_eq!(registry.integrity().unwrap().problems, []);
        assert_eq!(registry.save(&nod).unwrap(), 3);
    }
}

/// Steps with `until`, repeats and plays of schema 1 do the same as texts.
#[test]
fn what_schema_1_held_as_rows_does_the_same_as_text() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("registry.sqlite");
    fs::copy(fixture(1), &path).unwrap();
    let registry = Registry::open(&path).unwrap();
    let compiled = registry.compile("walk-forward", &CompileOptions::default()).unwrap();
    let front = 0b0101;
    let steps: Vec<(u16, u8)> =
        compiled.steps.iter().map(|step| (step.duration_ms, step.ending_bumpers.bits())).collect();
    let stride = [(575, front), (700, front), (575, front), (700, front)];
    let end = [(575, front), (350, front), (300, front)];
    assert_eq!(steps, [&stride[..], &stride, &end].concat());
    // Each is what the seed of today is, which was written by hand.
    let today = Registry::open_in_memory().unwrap();
    for summary in registry.list().unwrap() {
        let same = |registry: &Registry| {
            registry.compile(&summary.name, &CompileOptions::default()).ok().map(|it| it.steps)
        };
        if !["wave", "hello", "nod", "dance"].contains(&summary.name.as_str()) {
            assert_eq!(same(&registry), same(&today), "{}", summary.name);
        }
    }
}

#[test]
fn a_registry_that_is_only_read_is_left_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("registry.sqlite");
    assert!(matches!(Registry::open_read_only(&path), Err(RegistryError::CannotOpen { .. })));
    fs::copy(fixture(1), &path).unwrap();
    let before = fs::read(&path).unwrap();
    let error = Registry::open_read_only(&path).unwrap_err();
    assert!(matches!(error, RegistryError::TooOld { file_schema: 1, .. }), "{error}");
    assert_eq!(fs::read(&path).unwrap(), before);
    drop(Registry::open(&path).unwrap());
    let mut reader = Registry::open_read_only(&path).unwrap();
    assert!(reader.compile("dance", &CompileOptions::default()).is_ok());
    let error = reader.remove("dance").unwrap_err();
    assert!(matches!(error, RegistryError::Unwritable { .. }), "{error}");
}

/// Somebody else wrote into the file with its rules switched off.
#[test]
fn rows_that_break_the_rules_are_told_as_damage() {
    for damage in [
        "UPDATE action SET latest_version = 7 WHERE name = 'wave'",
        "DROP TRIGGER action_version_update; UPDATE action_version SET warnings = '?'",
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("registry.sqlite");
        fs::copy(fixture(NEWEST), &path).unwrap();
        let connection = Connection::open(&path).unwrap();
        connection.pragma_update(None, "ignore_check_constraints", "ON").unwrap();
        connection.pragma_update(None, "foreign_keys", "OFF").unwrap();
        connection.execute_batch(damage).unwrap();
        let told = Registry::open(&path).unwrap().get("wave").unwrap_err();
        assert!(matches!(told, RegistryError::Corrupt { .. }), "{damage}: {told}");
    }
}

/// The stored file brought up to date has the tables of a new one, word for word: a released
/// migration was never edited.
#[test]
fn an_old_file_gets_the_schema_of_a_new_one() {
    let folder = tempfile::tempdir().unwrap();
    let (old, new) = (folder.path().join("old.sqlite"), folder.path().join("new.sqlite"));
    fs::copy(fixture(1), &old).unwrap();
    let schema = |path: &Path| -> Vec<(String, Option<String>)> {
        drop(Registry::open(path).unwrap());
        let connection = Connection::open(path).unwrap();
        let mut statement =
            connection.prepare("SELECT name, sql FROM sqlite_schema ORDER BY name").unwrap();
        let rows = statement.query_map([], |row| Ok((row.get(0)?, row.get(1)?))).unwrap();
        rows.map(Result::unwrap).collect()
    };
    assert_eq!(schema(&old), schema(&new));
}

#[test]
fn seeds_come_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("registry.sqlite");
    let mut registry = Registry::open(&path).unwrap();
    registry.remove("bow").unwrap();
    registry.save(&ActionDraft::new("shrug", vec![Statement::wait(1)])).unwrap();
    drop(registry);
    let registry = Registry::open(&path).unwrap();
    assert!(registry.get("bow").is_err());
    assert_eq!(registry.get("shrug").unwrap().version, 2);
    assert_eq!(registry.history("stand").unwrap().len(), 1);
}

/// The tables themselves refuse what the one writer never writes.
#[test]
fn the_database_protects_what_it_holds() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("registry.sqlite");
    drop(Registry::open(&path).unwrap());
    let connection = Connection::open(&path).unwrap();
    connection.pragma_update(None, "foreign_keys", "ON").unwrap();
    for statement in [
        "INSERT INTO primitive (number, name, joint, position) VALUES (22, 'head-up', 7, 1)",
        "UPDATE primitive SET name = 'x' WHERE number = 1",
        "DELETE FROM primitive WHERE number = 1",
        "DELETE FROM action",
        "UPDATE action_version SET description = 'x'",
        "DELETE FROM action_version",
        "UPDATE action_version SET source = 'x'",
        "UPDATE action_play SET version = 2",
        "DELETE FROM action_play",
        "INSERT INTO action (name, created_ms, latest_version) VALUES ('no-version', 0, 1)",
        "UPDATE action SET name = 'Upper' WHERE id = 1",
        "UPDATE action SET latest_version = 9 WHERE id = 1",
        "INSERT INTO action_play VALUES (1, 1, 999)",
        "INSERT INTO action_play VALUES (1, 9, 1)",
        "UPDATE action SET joints = 128 WHERE id = 1",
    ] {
        let error = connection.execute(statement, []).expect_err(statement);
        assert_eq!(
            error.sqlite_error_code(),
            Some(rusqlite::ErrorCode::ConstraintViolation),
            "{statement}: {error}"
        );
    }
}

/// Writes the stored file of the newest schema. Run once for each schema, by hand:
/// `cargo test -p rsapien-registry --test files -- --ignored write_the_fixture`.
#[test]
#[ignore = "writes tests/fixtures"]
fn write_the_fixture() {
    let path = fixture(NEWEST);
    assert!(!path.exists(), "{} is kept as it was written", path.display());
    let mut registry = Registry::open(&path).unwrap();
    let step = |text| Statement::parse_short(text).unwrap();
    // Others give it rounds.
    let wave = "action wave(rounds = 1) { description \"My own wave.\" do right-arm-up for 900ms }";
    registry.import_text(wave, ImportPolicy::Replace, &Trials::new()).unwrap();
    registry.remove("bow").unwrap();
    registry.save(&ActionDraft::new("nod", vec![step("tilt-left:300")])).unwrap();
    let nod = "action nod { tags head, yes allow too-short \"it nods\" do tilt-left for 300ms do tilt-mid for 300ms }";
    registry.import_text(nod, ImportPolicy::Replace, &Trials::new()).unwrap();
    let hello = ActionDraft::new("hello", vec![step("nod*2"), step("wave")]);
    registry.save(&hello).unwrap();
    registry.save(&ActionDraft::new("old", vec![step("pause:5")])).unwrap();
    registry.remove("old").unwrap();
    drop(registry);
    // One file, without a log beside it.
    let connection = Connection::open(&path).unwrap();
    connection.pragma_update_and_check(None, "journal_mode", "DELETE", |_| Ok(())).unwrap();
    connection.execute_batch("VACUUM").unwrap();
}
