//! What ARCHITECTURE.md says of the tree, checked: who may know whom, what library code never does,
//! how large a file may grow, that links lead somewhere and that the commands of the README are the
//! ones that are tried.

use rsapien_tests::{files, is_test_module, read, without_tests, workspace};
use std::collections::BTreeSet;
use std::path::Path;

/// The workspace crates each crate may import, outside its tests (ARCHITECTURE.md, "Who may know whom").
const MAY_KNOW: [(&str, &[&str]); 7] = [
    ("protocol", &[]),
    ("firmware-model", &["rsapien-protocol"]),
    ("vision", &[]),
    ("registry", &["rsapien-protocol"]),
    ("sim", &["rsapien-protocol", "rsapien-firmware-model"]),
    ("host", &["rsapien-protocol", "rsapien-registry", "rsapien-sim", "rsapien-vision"]),
    (
        "python",
        &["rsapien", "rsapien-protocol", "rsapien-registry", "rsapien-sim", "rsapien-vision"],
    ),
];

#[test]
fn crates_know_only_whom_they_may() {
    for (folder, allowed) in MAY_KNOW {
        let path = workspace().join("crates").join(folder).join("Cargo.toml");
        let manifest: toml::Table = read(&path).parse().expect("a manifest is TOML");
        for table in ["dependencies", "build-dependencies"] {
            let Some(dependencies) = manifest.get(table).and_then(toml::Value::as_table) else {
                continue;
            };
            for name in dependencies.keys().filter(|name| name.starts_with("rsapien")) {
                assert!(allowed.contains(&name.as_str()), "{folder} must not know {name}");
            }
        }
    }
    let folders = std::fs::read_dir(workspace().join("crates")).unwrap();
    let folders: BTreeSet<String> =
        folders.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    let known: BTreeSet<String> = MAY_KNOW.iter().map(|(folder, _)| (*folder).to_owned()).collect();
    assert_eq!(folders, known, "a crate is missing from the table of this test");
}

#[test]
fn library_code_never_prints_exits_or_reads_the_environment() {
    const NEVER: [&str; 9] = [
        "println!(",
        "print!(",
        "eprintln!(",
        "eprint!(",
        "dbg!(",
        "process::exit",
        "process::abort",
        "env::var",
        "env::args",
    ];
    for (folder, _) in MAY_KNOW {
        let sources = workspace().join("crates").join(folder).join("src");
        for path in files(&sources, &[".rs"]) {
            let inside = path.strip_prefix(&sources).unwrap();
            if inside.starts_with("cli") || inside.starts_with("bin") || is_test_module(&path) {
                continue;
            }
            for (number, line) in without_tests(&read(&path)).lines().enumerate() {
                let is_comment = line.trim_start().starts_with("//");
                let found = NEVER.iter().find(|word| !is_comment && line.contains(**word));
                let place = (path.display(), number + 1);
                assert_eq!(found, None, "{}:{}: not in library code", place.0, place.1);
            }
        }
    }
}

#[test]
fn the_inner_rooms_have_no_clock_and_no_allocator() {
    for folder in ["protocol", "firmware-model"] {
        let sources = workspace().join("crates").join(folder).join("src");
        assert!(read(&sources.join("lib.rs")).contains("#![no_std]"), "{folder} is no_std");
        for path in files(&sources, &[".rs"]) {
            if is_test_module(&path) {
                continue;
            }
            let text = read(&path);
            for word in ["std::time", "Instant", "extern crate alloc", "alloc::"] {
                assert!(!without_tests(&text).contains(word), "{}: {word}", path.display());
            }
        }
    }
}

#[test]
fn a_byte_offset_is_known_in_one_place() {
    let sources = workspace().join("crates/protocol/src");
    for path in files(&sources, &[".rs"]) {
        if path.ends_with("frame.rs") || is_test_module(&path) {
            continue;
        }
        for (number, line) in without_tests(&read(&path)).lines().enumerate() {
            let indexes_by_number = ["content[", "bytes["].iter().any(|array| {
                line.split(array).skip(1).any(|rest| rest.starts_with(|c: char| c.is_ascii_digit()))
            });
            assert!(!indexes_by_number, "{}:{}: {line}", path.display(), number + 1);
        }
    }
}

#[test]
fn no_unsafe_code_anywhere() {
    for path in files(&workspace().join("crates"), &[".rs"]) {
        for (number, line) in read(&path).lines().enumerate() {
            let code = line.split("//").next().unwrap_or("");
            let has_unsafe = code.contains("unsafe {")
                || code.contains("unsafe fn")
                || code.contains("unsafe impl");
            assert!(!has_unsafe, "{}:{}", path.display(), number + 1);
        }
    }
    let manifests = files(&workspace().join("crates"), &["Cargo.toml"]);
    for path in manifests.iter().filter(|path| !path.to_string_lossy().contains("fuzz")) {
        let manifest: toml::Table = read(path).parse().unwrap();
        let inherits = manifest.get("lints").and_then(|lints| lints.get("workspace"));
        // PyO3's macros expand to unsafe code, so the module's crate cannot forbid it.
        let is_python = path.parent().is_some_and(|folder| folder.ends_with("python"));
        assert!(
            is_python || inherits.and_then(toml::Value::as_bool) == Some(true),
            "{}",
            path.display()
        );
    }
}

#[test]
fn files_stay_readable() {
    const LINES_MAX: usize = 600;
    const BYTES_MAX: u64 = 1 << 20;
    for path in files(&workspace(), &[".rs", ".py", ".c", ".h", ".cc"]) {
        let lines = read(&path).lines().count();
        assert!(lines <= LINES_MAX, "{} has {lines} lines: it wants a wall", path.display());
    }
    for path in files(&workspace(), &[""]) {
        let bytes = path.metadata().unwrap().len();
        assert!(bytes <= BYTES_MAX, "{} has {bytes} bytes", path.display());
    }
}

#[test]
fn nothing_is_left_to_do_in_the_sources() {
    let this_file = Path::new(file!()).file_name().unwrap();
    for path in files(&workspace(), &[".rs", ".py", ".sh"]) {
        if path.file_name() == Some(this_file) {
            continue;
        }
        let text = read(&path);
        for word in ["TODO", "FIXME", "XXX", "todo!(", "unimplemented!(", "#[ignore]"] {
            assert!(!text.contains(word), "{}: {word}", path.display());
        }
    }
}

#[test]
fn links_between_documents_lead_somewhere() {
    for path in files(&workspace(), &[".md"]) {
        let folder = path.parent().unwrap();
        let text = read(&path);
        for target in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let target = target.split('#').next().unwrap_or("");
            if target.is_empty() || target.contains("://") || target.contains(char::is_whitespace) {
                continue;
            }
            assert!(folder.join(target).exists(), "{}: {target} leads nowhere", path.display());
        }
    }
}

#[test]
fn the_commands_of_the_readme_are_tried() {
    let readme = read(&workspace().join("README.md"));
    let run = read(&workspace().join(".ci/run"));
    for command in ["cargo rsapien demo", "scripts/test"] {
        assert!(readme.lines().any(|line| line.trim() == command), "README.md says: {command}");
        assert!(run.lines().any(|line| line.trim() == command), ".ci/run does: {command}");
    }
}

#[test]
fn documents_tell_the_numbers_of_the_preset() {
    let options = rsapien_vision::paper::Options::paper();
    let (hough, quality) = (options.hough, options.filter.quality_min);
    let major = format!("{} to {}", hough.semi_major_min_px, hough.semi_major_max_px);
    let (both, points) = (
        format!("{major} and {} to {}", hough.semi_minor_min_px, hough.semi_minor_max_px),
        format!("{quality} edge points"),
    );
    for (document, told) in [
        ("crates/vision/README.md", [&major, &points]),
        ("docs/detector-paper.md", [&both, &points]),
        ("docs/troubleshooting.md", [&both, &points]),
        ("docs/first-robot.md", [&major, &major]),
    ] {
        let text = read(&workspace().join(document)).replace('\n', " ");
        for words in told {
            assert!(text.contains(words.as_str()), "{document} does not say {words:?}");
        }
    }
}

#[test]
fn documents_tell_the_defaults_of_the_detector() {
    let options = rsapien_vision::Options::default();
    let detector = read(&workspace().join("docs/detector.md"));
    for (field, value) in [
        ("semi_axis_min_px", options.semi_axis_min_px),
        ("semi_axis_max_px", options.semi_axis_max_px),
        ("axis_ratio_min", options.axis_ratio_min),
        ("score_min", options.score_min),
    ] {
        let told = detector.lines().find(|line| line.starts_with(&format!("| `{field}` |")));
        let told = told.unwrap_or_else(|| panic!("docs/detector.md has no row for {field}"));
        assert!(told.contains(&format!("| {value} |")), "docs/detector.md: {told}, not {value}");
    }
    let python = read(&workspace().join("docs/python.md"));
    let told = format!("| `score_min` | least score, 0 to 1 | {} |", options.score_min);
    assert!(python.contains(&told), "docs/python.md does not say {told:?}");
}
