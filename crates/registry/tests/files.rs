//! Files that are no registry, are damaged, cannot be written, are newer, or are old.

use std::fs;
use std::path::{Path, PathBuf};

use rsapien_protocol::Primitive;
use rsapien_registry::{ActionDraft, ActionStep, CompileOptions, Registry, RegistryError};
use rusqlite::Connection;

fn fixture() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/registry-v1.sqlite")
}

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
    fs::copy(fixture(), &path).unwrap();
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
    assert!(matches!(error, RegistryError::TooNew { file_schema: 99, program_schema: 1, .. }));
    assert_eq!(
        error.to_string(),
        format!(
            "the registry {} has schema 99, and rsapien-registry {} knows schemas up to 1: update \
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
    fs::copy(fixture(), &path).unwrap();
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

/// A file of schema 1, written by version 0.1.0: the seed library, with `wave` edited (version 2),
/// `bow` removed, `nod` in two versions, `hello` playing `nod` and `wave`, `old` removed.
#[test]
fn a_file_of_schema_1_opens_with_all_it_held() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("registry.sqlite");
    fs::copy(fixture(), &path).unwrap();
    let mut registry = Registry::open(&path).unwrap();

    let names: Vec<String> = registry.list().unwrap().into_iter().map(|it| it.name).collect();
    assert_eq!(
        names,
        [
            "dance",
            "grip-left",
            "grip-right",
            "hello",
            "nod",
            "pick-up",
            "release-left",
            "release-right",
            "stand",
            "stride-backward",
            "stride-forward",
            "throw",
            "turn-left",
            "turn-right",
            "walk-backward",
            "walk-forward",
            "wave",
        ]
    );
    assert_eq!(registry.get("wave").unwrap().draft.description, "My own wave.");
    assert_eq!(registry.history("bow").unwrap().len(), 1);
    assert_eq!(registry.history("old").unwrap().len(), 1);
    let nod = registry.get_version("nod", 1).unwrap().draft;
    assert_eq!(nod.steps, [ActionStep::parse_short("tilt-left:300").unwrap()]);
    assert_eq!(registry.get("nod").unwrap().draft.tags, ["head", "yes"]);
    let compiled = registry.compile("hello", CompileOptions::default()).unwrap();
    assert_eq!((compiled.steps.len(), compiled.duration_ms), (5, 2 * 600 + 900));
    assert!(registry.primitives().unwrap().into_iter().eq(Primitive::all()));
    assert_eq!(registry.save(&nod).unwrap(), 3);
}

/// Somebody else wrote into the file with its rules switched off.
#[test]
fn rows_that_break_the_rules_are_told_as_damage() {
    for damage in [
        "UPDATE action SET latest_version = 7 WHERE name = 'wave'",
        "DROP TRIGGER action_step_update; UPDATE action_step SET duration_ms = 70000",
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("registry.sqlite");
        fs::copy(fixture(), &path).unwrap();
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
    fs::copy(fixture(), &old).unwrap();
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
    registry.save(&ActionDraft::new("wave", vec![ActionStep::pause(1)])).unwrap();
    drop(registry);
    let registry = Registry::open(&path).unwrap();
    assert!(registry.get("bow").is_err());
    assert_eq!(registry.get("wave").unwrap().version, 2);
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
        "UPDATE action_step SET times = 2",
        "DELETE FROM action_step",
        "UPDATE step_primitive SET primitive = 1",
        "DELETE FROM step_primitive",
        "INSERT INTO action (name, created_ms, latest_version) VALUES ('no-version', 0, 1)",
        "UPDATE action SET name = 'Upper' WHERE id = 1",
        "UPDATE action SET latest_version = 9 WHERE id = 1",
        // No such primitive; a primitive of another joint; a second position of a joint.
        "INSERT INTO step_primitive VALUES (1, 1, 1, 7, 22)",
        "INSERT INTO step_primitive VALUES (1, 1, 1, 6, 1)",
        "INSERT INTO step_primitive VALUES (1, 1, 1, 4, 13)",
        "INSERT INTO action_step VALUES (1, 1, 2, 0, 0, NULL, 1)",
        "INSERT INTO action_step VALUES (1, 1, 2, 65536, 0, NULL, 1)",
        "INSERT INTO action_step VALUES (1, 1, 2, 5, 64, NULL, 1)",
        "INSERT INTO action_step VALUES (1, 1, 2, 5, 0, NULL, 0)",
        "INSERT INTO action_step VALUES (1, 1, 2, 5, 0, 2, 1)",
        "INSERT INTO action_step VALUES (1, 1, 2, NULL, NULL, NULL, 1)",
        "INSERT INTO action_step VALUES (1, 1, 2, NULL, NULL, 99, 1)",
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
    let path = fixture();
    assert!(!path.exists(), "{} is kept as it was written", path.display());
    let mut registry = Registry::open(&path).unwrap();
    let step = |text| ActionStep::parse_short(text).unwrap();
    let mut wave = ActionDraft::new("wave", vec![step("right-arm-up:900")]);
    wave.description = "My own wave.".into();
    registry.save(&wave).unwrap();
    registry.remove("bow").unwrap();
    let mut nod = ActionDraft::new("nod", vec![step("tilt-left:300")]);
    registry.save(&nod).unwrap();
    nod.steps.push(step("tilt-mid:300"));
    nod.tags = vec!["head".into(), "yes".into()];
    registry.save(&nod).unwrap();
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
