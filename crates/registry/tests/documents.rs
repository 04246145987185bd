//! `docs/actions.md` says what the registry does.

use std::fmt::Write as _;

use rsapien_protocol::Primitive;
use rsapien_registry::{ImportPolicy, Registry};

fn document() -> String {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/actions.md");
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn the_table_of_seeded_actions_is_that_of_the_registry() {
    let mut table = String::from("| action | lasts (ms) | does |\n|---|---|---|\n");
    for seed in Registry::open_in_memory().unwrap().list().unwrap() {
        let description = seed.description;
        writeln!(table, "| `{}` | {} | {description} |", seed.name, seed.duration_ms).unwrap();
    }
    assert!(document().contains(&table), "put this into docs/actions.md:\n{table}");
}

#[test]
fn every_primitive_is_in_the_table() {
    let document = document();
    for primitive in Primitive::all() {
        let cell = format!("| {} | `{primitive}` |", primitive.number());
        assert!(document.contains(&cell), "{cell}");
    }
}

#[test]
fn the_first_action_can_be_imported() {
    let document = document();
    let (_, rest) = document.split_once("```toml\n").unwrap();
    let (text, _) = rest.split_once("```").unwrap();
    let report = Registry::open_in_memory().unwrap().import_toml(text, ImportPolicy::Refuse);
    assert_eq!(report.unwrap().added, ["hello"]);
}
