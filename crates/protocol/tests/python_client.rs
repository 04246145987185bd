//! The page for beginners is true: its bytes are those of the vectors, and its Python client encodes
//! and decodes every one of them.
#![cfg(unix)] // The client uses POSIX terminals.

use std::process::Command;

const PAGE: &str = include_str!("../../../docs/protocol.md");

const CHECK: &str = r"
import json
for name in ('action_packages', 'synchronization_packages'):
    with open(f'{sys.argv[1]}/{name}.json') as file:
        packages = json.load(file)['packages']
    for package in packages:
        line, content = bytes.fromhex(package['line']), bytes.fromhex(package['content'])
        assert encode(line[0], content) == line, package
        assert decode(line) == content, package
        for bit in range(8 * len(line)):
            damaged = bytearray(line)
            damaged[bit // 8] ^= 1 << bit % 8
            assert decode(bytes(damaged)) is None, package
    print(name, len(packages))
";

fn vectors() -> String {
    format!("{}/../../tests/vectors", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn the_client_of_the_page_reads_and_writes_every_vector() {
    let (_, rest) = PAGE.split_once("```python\n").expect("a Python client");
    let (client, _) = rest.split_once("```").expect("the end of the client");
    let definitions = client.split("if __name__").next().unwrap_or_default();
    let output = Command::new("python3")
        .args(["-c", &format!("{definitions}{CHECK}"), &vectors()])
        .output()
        .expect("python3, which CONTRIBUTING.md asks for");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    assert_eq!(output.stdout.split(|byte| *byte == b'\n').count(), 3);
}

#[test]
fn the_exchange_of_the_page_is_that_of_the_vectors() {
    for (file, name) in [("action_packages", "hello"), ("synchronization_packages", "hello-answer")]
    {
        let text = std::fs::read_to_string(format!("{}/{file}.json", vectors())).unwrap();
        let vectors: serde_json::Value = serde_json::from_str(&text).unwrap();
        let packages = vectors["packages"].as_array().unwrap();
        let package = packages.iter().find(|package| package["name"] == name).unwrap();
        for key in ["content", "line"] {
            let bytes = package[key].as_str().unwrap();
            assert!(PAGE.contains(&format!("\n    {bytes}\n")), "{key} of {name}");
        }
    }
}
