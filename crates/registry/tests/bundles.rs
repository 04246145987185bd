//! Bundles: whole, verified, and never replacing anything silently.

use std::io::{Cursor, Read, Write};

use rsapien_registry::timeline::SvgOptions;
use rsapien_registry::{
    Bundle, BundlePolicy, CompileOptions, ImportPolicy, Registry, RegistryError, Timeline, Trials,
};

const TEXT: &str = "# Mine.\naction hello { play nod times 2  play wave }\n\
                    action nod { do tilt-left for 600ms  do tilt-mid for 300ms }";

fn registry(text: &str) -> Registry {
    let mut registry = Registry::open_in_memory().unwrap();
    let trials = Trials::from([("nod".to_owned(), "{\"outcome\":\"done\"}".to_owned())]);
    registry.import_text(text, ImportPolicy::Replace, &trials).unwrap();
    registry
}

fn exported(registry: &Registry) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let picture = |_: &_, compiled: &_| Timeline::of(compiled).to_svg(&SvgOptions::default());
    let manifest = registry.export_bundle(&["hello"], &mut bytes, picture).unwrap();
    let names: Vec<&str> = manifest.actions.iter().map(|it| it.name.as_str()).collect();
    assert_eq!(names, ["hello", "nod", "wave"]);
    bytes.into_inner()
}

fn read(bytes: &[u8]) -> Result<Bundle, RegistryError> {
    Bundle::read(Cursor::new(bytes))
}

/// The bundle with one of its files changed.
fn changed(bytes: &[u8], name: &str, change: impl Fn(String) -> String) -> Vec<u8> {
    let mut from = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
    let mut to = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for index in 0..from.len() {
        let mut file = from.by_index(index).unwrap();
        let mut text = String::new();
        file.read_to_string(&mut text).unwrap();
        let own_name = file.name().to_owned();
        let options = zip::write::SimpleFileOptions::default();
        to.start_file(own_name.as_str(), options).unwrap();
        let text = if own_name == name { change(text) } else { text };
        to.write_all(text.as_bytes()).unwrap();
    }
    to.finish().unwrap().into_inner()
}

#[test]
fn a_bundle_brings_actions_with_all_they_play_and_their_pictures() {
    let here = registry(TEXT);
    let bytes = exported(&here);
    assert_eq!(bytes, exported(&here), "the same actions make the same file");
    let mut zip = zip::ZipArchive::new(Cursor::new(&bytes)).unwrap();
    for name in ["actions/hello.rsa", "checks/nod.json", "pictures/wave.svg", "manifest.json"] {
        assert!(zip.by_name(name).is_ok(), "{name}");
    }
    let bundle = read(&bytes).unwrap();
    let mut there = Registry::open_in_memory().unwrap();
    let plan = there.import_bundle(&bundle, BundlePolicy::Refuse, &Trials::new()).unwrap();
    assert_eq!(
        (plan.added, plan.unchanged),
        (vec!["hello".into(), "nod".into()], vec!["wave".into()])
    );
    assert_eq!(there.get("hello").unwrap().text, here.get("hello").unwrap().text);
    let again = there.import_bundle(&bundle, BundlePolicy::Refuse, &Trials::new()).unwrap();
    assert_eq!(again.unchanged, ["hello", "nod", "wave"]);
    assert_eq!(there.history("hello").unwrap().len(), 1);
}

#[test]
fn conflicts_are_shown_and_merged_as_is_said() {
    let bundle = read(&exported(&registry(TEXT))).unwrap();
    // Another nod; and a hello that does the same, written otherwise.
    let other = "action nod { do tilt-right for 700ms }";
    let length = |registry: &Registry, name: &str| {
        registry.compile(name, &CompileOptions::default()).unwrap().duration_ms
    };
    let there = || registry(other);
    match there().import_bundle(&bundle, BundlePolicy::Refuse, &Trials::new()).unwrap_err() {
        RegistryError::Conflicts { conflicts } => {
            assert_eq!(conflicts.len(), 1);
            assert_eq!(conflicts[0].name, "nod");
            assert_ne!(conflicts[0].here, conflicts[0].theirs);
        }
        error => panic!("{error}"),
    }
    let mut mine = there();
    let plan = mine.import_bundle(&bundle, BundlePolicy::KeepMine, &Trials::new()).unwrap();
    assert_eq!(plan.plays_mine, [("hello".to_owned(), vec!["nod".to_owned()])]);
    assert_eq!((length(&mine, "nod"), length(&mine, "hello")), (700, 1400 + 5000));
    let mut theirs = there();
    theirs.import_bundle(&bundle, BundlePolicy::TakeTheirs, &Trials::new()).unwrap();
    assert_eq!((length(&theirs, "nod"), length(&theirs, "hello")), (900, 1800 + 5000));
    let plan = there().plan_bundle(&bundle, BundlePolicy::TakeTheirs).unwrap();
    assert!(plan.plays_mine.is_empty(), "the bundle's nod is what is played");
    assert_eq!(theirs.get_version("nod", 1).unwrap().text, other);
    let mut both = there();
    let plan = both.import_bundle(&bundle, BundlePolicy::RenameTheirs, &Trials::new()).unwrap();
    assert_eq!(plan.renamed, [("nod".to_owned(), "nod-2".to_owned())]);
    assert_eq!((length(&both, "nod"), length(&both, "nod-2")), (700, 900));
    assert_eq!(length(&both, "hello"), 1800 + 5000);
    assert_eq!(
        both.get("hello").unwrap().text,
        "# Mine.\naction hello { play nod-2 times 2  play wave }"
    );
}

#[test]
fn what_was_damaged_or_made_up_is_refused_with_its_place() {
    let bytes = exported(&registry(TEXT));
    let refused = |bytes: &[u8], told: &str| {
        let error = read(bytes).unwrap_err();
        assert!(matches!(error, RegistryError::Bundle { .. }), "{error}");
        assert!(error.to_string().contains(told), "{told}: {error}");
    };
    refused(b"no zip file", "no bundle");
    refused(&bytes[..bytes.len() / 2], "no bundle");
    let nod = "actions/nod.rsa";
    refused(&changed(&bytes, nod, |text| text.replace("600", "900")), "actions/nod.rsa");
    refused(&changed(&bytes, nod, |text| text.repeat(100_000)), "longer than");
    let manifest = |from: &'static str, to: &'static str| {
        changed(&bytes, "manifest.json", move |text| text.replace(from, to))
    };
    refused(&manifest("\"rsapien-bundle\"", "\"another\""), "something else");
    refused(&manifest("\"format_version\": 1", "\"format_version\": 2"), "update");
    refused(&manifest("\"name\": \"nod\"", "\"name\": \"../nod\""), "no name");
    refused(&manifest("\"name\": \"nod\"", "\"name\": \"dance\""), "actions/dance.rsa");
    refused(&changed(&bytes, "manifest.json", |text| text[..40].to_owned()), "manifest.json");
    // The checksum is right, and the action does something else than its content hash says.
    let hash = read(&bytes).unwrap().manifest.actions[1].content_hash.clone();
    let made_up = changed(&bytes, "manifest.json", |text| text.replace(&hash, &"0".repeat(64)));
    refused(&made_up, "content hash");
}
