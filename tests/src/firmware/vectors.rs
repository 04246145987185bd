//! The vectors of `tests/vectors`, as the comparison needs them.

use crate::{read, workspace};
use rsapien_protocol::{Address, LineError};
use serde_json::Value;

/// A worked package.
#[derive(Clone, Debug)]
pub struct Package {
    /// Its name.
    pub name: String,
    /// The controller it goes to or comes from.
    pub address: Address,
    /// Its line bytes.
    pub line: Vec<u8>,
    /// The status that a controller answers it with whatever its state, if there is one.
    pub refused_status: Option<u8>,
}

/// What a stream brings at a time.
#[derive(Clone, Debug)]
pub enum Brought {
    /// Bytes.
    Bytes(Vec<u8>),
    /// A byte that cannot be received.
    LineError(LineError),
}

/// A stream for a controller.
#[derive(Clone, Debug)]
pub struct Stream {
    /// Its name.
    pub name: String,
    /// Whose reception it is for.
    pub address: Address,
    /// What comes, with the time in ms.
    pub events: Vec<(u64, Brought)>,
    /// What must be counted: accepted, resets, check errors, framing errors, overruns, errors.
    pub counts: [u16; 6],
}

fn vectors(file: &str, key: &str) -> Vec<Value> {
    let path = workspace().join("tests/vectors").join(format!("{file}.json"));
    let value: Value = serde_json::from_str(&read(&path)).expect("vectors are JSON");
    value[key].as_array().cloned().expect("vectors are a list")
}

fn bytes(value: &Value) -> Vec<u8> {
    let text = value.as_str().expect("bytes are text");
    let byte = |byte| u8::from_str_radix(byte, 16).expect("bytes are hexadecimal");
    text.split_whitespace().map(byte).collect()
}

fn address(value: &Value) -> Option<Address> {
    Address::ALL.into_iter().find(|address| Some(address.name()) == value.as_str())
}

fn text(value: &Value) -> String {
    value.as_str().expect("a name is text").to_owned()
}

/// The packages of `action_packages` or `synchronization_packages`.
///
/// # Panics
/// When the file is not what its description says.
pub fn packages(file: &str) -> Vec<Package> {
    let package = |vector: &Value| Package {
        name: text(&vector["name"]),
        address: address(&vector["address"]).expect("an address"),
        line: bytes(&vector["line"]),
        refused_status: vector["refused_status"].as_u64().and_then(|status| status.try_into().ok()),
    };
    vectors(file, "packages").iter().map(package).collect()
}

/// The streams of `reception` for a controller.
///
/// # Panics
/// When the file is not what its description says.
pub fn streams() -> Vec<Stream> {
    let event = |event: &Value| {
        let brought = match event["line_error"].as_str() {
            Some("framing") => Brought::LineError(LineError::Framing),
            Some("overrun") => Brought::LineError(LineError::Overrun),
            Some(other) => panic!("no such line error: {other}"),
            None => Brought::Bytes(bytes(&event["bytes"])),
        };
        (event["at_ms"].as_u64().expect("a time"), brought)
    };
    let stream = |vector: &Value| {
        let names = ["accepted", "resets", "crc_errors", "framing_errors", "overruns", "errors"];
        let count = |name| {
            let count = vector["counts"][name].as_u64().expect("a count");
            u16::try_from(count).expect("a count of 16 bits")
        };
        Some(Stream {
            name: text(&vector["name"]),
            address: address(&vector["receiver"])?,
            events: vector["events"].as_array().expect("events").iter().map(event).collect(),
            counts: names.map(count),
        })
    };
    vectors("reception", "streams").iter().filter_map(stream).collect()
}
