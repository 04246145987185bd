//! A serial program that shares no code with this project: the client of `docs/protocol.md`, in plain
//! Python, against the simulator on a pseudo-terminal.

use rsapien_sim::server::{Simulator, SimulatorConfig};
use rsapien_tests::{read, workspace};
use std::process::Command;

#[test]
fn the_client_of_the_protocol_page_talks_to_the_simulator() {
    let page = read(&workspace().join("docs/protocol.md"));
    let program = page.split("```python\n").nth(1).and_then(|rest| rest.split("```").next());
    let program = program.expect("the page has a Python program");
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("client.py");
    std::fs::write(&file, program).unwrap();
    let link = folder.path().join("robot");
    let config = SimulatorConfig { pty: Some(link.clone()), ..SimulatorConfig::default() };
    let simulator = Simulator::start(config).unwrap();
    let output = Command::new("python3").arg(&file).arg(&link).output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
    assert!(said.contains("steps ended: 1"), "{said}");
    let right_arm = simulator.robot().lock().joints()[0];
    assert!(
        right_arm < 0.01,
        "the arm it sent up is at {right_arm} of its travel; it said: {said}"
    );
    simulator.stop();
}
