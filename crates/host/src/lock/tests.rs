use super::*;

#[test]
fn the_second_taker_is_told_who_holds_the_line() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().join("made/when/needed");
    let holder = Holder::this_process("first\nprogram");
    let lock = LineLock::take(&folder, "/dev/ttyUSB0", &holder).unwrap();
    let refused = LineLock::take(&folder, "/dev/ttyUSB0", &Holder::this_process("second"));
    let Err(Error::Held { what, by }) = refused else { panic!("{refused:?}") };
    assert!(what.contains("/dev/ttyUSB0"));
    assert_eq!((by.pid, by.program.as_str()), (std::process::id(), "first program"));
    assert_eq!(LineLock::holder(&folder, "/dev/ttyUSB0"), Some(by));
    assert_eq!(LineLock::holder(&folder, "/dev/ttyUSB1"), None);

    let other = LineLock::take(&folder, "/dev/ttyUSB1", &holder).unwrap();
    drop(lock);
    assert_eq!(LineLock::holder(&folder, "/dev/ttyUSB0"), None);
    LineLock::take(&folder, "/dev/ttyUSB0", &Holder::this_process("second")).unwrap();
    drop(other);
}

#[test]
fn a_holder_that_does_not_tell_its_name_is_still_a_holder() {
    let folder = tempfile::tempdir().unwrap();
    let lock = LineLock::take(folder.path(), "key", &Holder::this_process("first")).unwrap();
    fs::write(holder_path(folder.path(), "key"), "rubbish").unwrap();
    let by = LineLock::holder(folder.path(), "key").unwrap();
    assert_eq!((by.pid, by.to_string().as_str()), (0, "another program"));
    drop(lock);
}

#[test]
fn different_keys_have_different_files() {
    let keys = ["a/b", "a_b", "a_2fb", "a:b", "A:b", "tcp://[::1]:1"];
    let stems: std::collections::BTreeSet<String> = keys.map(file_stem).into_iter().collect();
    assert_eq!(stems.len(), keys.len());
}
