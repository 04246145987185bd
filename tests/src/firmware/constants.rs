//! The numbers of the C headers and of the Rust sources, read as a person reads them.

use crate::{files, read, workspace};
use std::collections::BTreeMap;

/// Numbers by their names.
pub type Numbers = BTreeMap<String, i64>;

/// A number as C and Rust write it: decimal or hexadecimal, with `u` behind it or `_` inside.
fn number(text: &str) -> Option<i64> {
    let text = text.trim().trim_end_matches(['u', 'U', 'L']).replace('_', "");
    match text.strip_prefix("0x") {
        Some(digits) => i64::from_str_radix(digits, 16).ok(),
        None => text.parse().ok(),
    }
}

/// What stands between `/*` and `*/` left out.
fn without_comments(text: &str) -> String {
    let mut rest = text;
    let mut code = String::new();
    while let Some((before, comment)) = rest.split_once("/*") {
        code.push_str(before);
        rest = comment.split_once("*/").map_or("", |(_, behind)| behind);
    }
    code + rest
}

/// Every `#define NAME NUMBER` and every member of an enum in the C core's headers. A name that stands in
/// more than one header, under different conditions, is left out.
///
/// # Panics
/// When the headers cannot be read.
pub fn of_the_c_core() -> Numbers {
    let mut numbers = Numbers::new();
    let mut ambiguous = Vec::new();
    for path in files(&workspace().join("firmware-pic/core"), &[".h"]) {
        let code = without_comments(&read(&path));
        let mut found = enum_members(&code);
        found.extend(code.lines().filter_map(|line| {
            let (name, value) = line.trim().strip_prefix("#define ")?.split_once(' ')?;
            Some((name.to_owned(), number(value)?))
        }));
        for (name, value) in found {
            if numbers.insert(name.clone(), value).is_some_and(|other| other != value) {
                ambiguous.push(name);
            }
        }
    }
    numbers.retain(|name, _| !ambiguous.contains(name));
    numbers
}

fn enum_members(code: &str) -> Vec<(String, i64)> {
    let mut members = Vec::new();
    for part in code.split("enum ").skip(1) {
        let Some((head, behind)) = part.split_once('{') else { continue };
        if head.contains([';', '(', ')', ',', '=']) {
            continue;
        }
        let body = behind.split('}').next().unwrap_or("");
        let mut next = 0;
        for member in body.split(',').map(str::trim).filter(|member| !member.is_empty()) {
            let (name, value) = match member.split_once('=') {
                Some((name, value)) => (name.trim(), number(value)),
                None => (member, Some(next)),
            };
            if let Some(value) = value {
                members.push((name.to_owned(), value));
                next = value + 1;
            }
        }
    }
    members
}

/// The constants of a module of `crates/protocol/src/frame.rs`: the offsets in a content, which nobody
/// outside the protocol's crate may know.
///
/// # Panics
/// When the file cannot be read.
pub fn offsets(module: &str) -> Numbers {
    let text = read(&workspace().join("crates/protocol/src/frame.rs"));
    let begin = format!("pub(crate) mod {module} {{");
    let behind = text.split_once(&begin).map_or("", |(_, behind)| behind);
    let body = behind.split("\n}").next().unwrap_or("");
    body.lines()
        .filter_map(|line| {
            let (name, value) =
                line.trim().strip_prefix("pub(crate) const ")?.split_once(": usize = ")?;
            Some((name.to_owned(), number(value.trim_end_matches(';'))?))
        })
        .collect()
}

/// A pin of `firmware-pic/port/pic18/pins.h`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pin {
    /// As the data sheets call it: `RD0`.
    pub name: String,
    /// Whether the chip listens to it.
    pub is_input: bool,
    /// What it is for, in words.
    pub purpose: String,
}

/// The pins of a list of `pins.h`, `MOTION_PINS` or `CAMERA_PINS`.
///
/// # Panics
/// When the file cannot be read.
pub fn pins(list: &str) -> Vec<Pin> {
    let text = read(&workspace().join("firmware-pic/port/pic18/pins.h"));
    let begin = format!("#define {list}(PIN)");
    let behind = text.split_once(&begin).map_or("", |(_, behind)| behind);
    let pin = |line: &str| {
        let arguments = line.trim().strip_prefix("PIN(")?.split_once(')')?.0;
        let (first, purpose) = arguments.split_once('"')?;
        let mut first = first.split(',').map(str::trim);
        Some(Pin {
            name: format!("R{}{}", first.next()?, first.next()?),
            is_input: first.next()? == "INPUT",
            purpose: purpose.trim_end_matches('"').to_owned(),
        })
    };
    behind.lines().skip(1).map_while(pin).collect()
}

/// The pins of the wiring table behind a heading of `docs/firmware.md`, and those of them that nobody uses.
///
/// # Panics
/// When the file cannot be read.
pub fn wired_pins(heading: &str) -> (Vec<Pin>, Vec<Pin>) {
    let text = read(&workspace().join("docs/firmware.md"));
    let behind = text.split_once(heading).map_or("", |(_, behind)| behind);
    let table = behind.split("\n#").next().unwrap_or("");
    let pin = |line: &str| {
        let mut cells = line.split('|').skip(2).map(str::trim);
        let (name, direction, purpose) = (cells.next()?, cells.next()?, cells.next()?);
        let letters: Vec<char> = name.chars().collect();
        let is_port = matches!(letters[..], ['R', 'A'..='E', '0'..='7']);
        let (name, purpose) = (name.to_owned(), purpose.to_owned());
        is_port.then_some(Pin { name, is_input: direction == "in", purpose })
    };
    table.lines().filter_map(pin).partition(|pin| pin.purpose != "not used, 0")
}
