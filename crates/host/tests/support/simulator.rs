//! A simulator that runs as a process of its own.

use std::io::{BufRead, BufReader};
use std::process::Child;

use rsapien_sim::control::{BumperName, ControlClient, ControlRequest};

use super::{User, wait_until};

/// A running `rsapien sim`, ended with the test.
pub(crate) struct Simulator {
    pub(crate) child: Child,
    pub(crate) link: String,
}

#[allow(dead_code)]
impl Simulator {
    pub(crate) fn start(user: &User) -> Simulator {
        let link = user.path("robot").to_string_lossy().into_owned();
        let mut child = user.start(&["sim", "--pty", &link, "--tcp", "0", "--json"]);
        let mut text = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut text).unwrap();
        let answer: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(answer["links"][0], link.as_str());
        assert!(answer["links"][1].as_str().unwrap().starts_with("tcp://127.0.0.1:"));
        Simulator { child, link }
    }

    pub(crate) fn control(&self) -> ControlClient {
        ControlClient::connect(format!("{}.control", self.link)).unwrap()
    }

    pub(crate) fn press_left_foot(&self, held: bool) {
        let press = BumperName::new(0).unwrap();
        self.control().request(&ControlRequest::Press { press, held }).unwrap();
    }

    /// Waits until the robot executes a queue.
    pub(crate) fn wait_until_executing(&self) {
        let mut control = self.control();
        wait_until("the robot moves", || control.state().unwrap().motion_mode == "executing");
    }
}

impl Drop for Simulator {
    fn drop(&mut self) {
        // It has ended already where the test went through.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
