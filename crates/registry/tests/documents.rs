//! `docs/actions.md` says what the registry does.

use rsapien_protocol::Primitive;
use rsapien_registry::{ImportPolicy, Registry, Trials};

fn document() -> String {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/actions.md");
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn every_primitive_is_in_the_table() {
    let document = document();
    for primitive in Primitive::all() {
        let cell = format!("| {} | `{primitive}` |", primitive.number());
        assert!(document.contains(&cell), "{cell}");
    }
}

/// Each example stands in a registry of its own, in which those before it are stored, too.
#[test]
fn every_example_of_the_language_can_be_imported() {
    let document = document();
    let mut registry = Registry::open_in_memory().unwrap();
    let mut count = 0;
    for part in document.split("```rsa\n").skip(1) {
        let (text, _) = part.split_once("```").unwrap();
        let imported = registry.import_text(text, ImportPolicy::Replace, &Trials::new());
        assert!(imported.is_ok(), "{text}\n{}", imported.unwrap_err());
        count += 1;
    }
    assert!(count >= 6, "only {count} examples");
}
