//! `docs/rules.md` tells every rule as it is: its examples break it, or do not, and its messages are those of the
//! checker.

use std::collections::BTreeMap;

use rsapien_registry::check::{check_text, render};
use rsapien_registry::{NoActions, Rule};

/// Set, the messages in the page are written anew.
const RENEW_VARIABLE: &str = "RENEW";

fn path() -> &'static str {
    concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/rules.md")
}

/// The page, cut into what stands between fences and outside: the fence's words, and the text.
fn parts(page: &str) -> Vec<(Option<String>, String)> {
    let mut parts = vec![(None, String::new())];
    for line in page.split_inclusive('\n') {
        let is_open = parts.last().is_some_and(|(fence, _)| fence.is_some());
        match line.strip_prefix("```") {
            Some(words) if !is_open => parts.push((Some(words.trim().to_owned()), String::new())),
            Some(_) => parts.push((None, String::new())),
            None => parts.last_mut().unwrap().1.push_str(line),
        }
    }
    parts
}

#[test]
fn the_page_of_rules_is_true() {
    let page = std::fs::read_to_string(path()).unwrap();
    let mut seen: BTreeMap<String, [usize; 2]> = BTreeMap::new();
    let mut renewed = String::new();
    let mut message = None;
    let mut section = String::new();
    for (fence, text) in parts(&page) {
        let mut text = text;
        match fence.as_deref() {
            None => {
                if let Some((_, heading)) = text.rsplit_once("## `") {
                    section = heading.split('`').next().unwrap_or_default().to_owned();
                }
                renewed.push_str(&text);
                continue;
            }
            Some("text") => {
                let told: String = message.take().expect("a bad example stands before its message");
                if std::env::var_os(RENEW_VARIABLE).is_some() {
                    text = told;
                } else {
                    assert_eq!(text, told, "RENEW=1 writes the messages anew");
                }
            }
            Some("rsa good") => {
                let found = check_text(&text, &NoActions).findings;
                assert!(found.list.is_empty(), "{section}: {found}\n{text}");
                seen.entry(section.clone()).or_default()[1] += 1;
            }
            Some(words) => {
                let rule = words.strip_prefix("rsa bad ").expect(words);
                assert_eq!(rule, section);
                let found = check_text(&text, &NoActions).findings;
                assert!(!found.list.is_empty(), "{rule} is not broken by\n{text}");
                for finding in &found.list {
                    assert_eq!(finding.rule.name(), rule, "{found}\n{text}");
                }
                let told = render(&found, "example.rsa", false);
                message = Some(told.rsplit_once("\n\n").unwrap().0.to_owned() + "\n");
                seen.entry(section.clone()).or_default()[0] += 1;
            }
        }
        for part in ["```", fence.as_deref().unwrap_or_default(), "\n", &text, "```\n"] {
            renewed.push_str(part);
        }
    }
    for rule in Rule::ALL {
        let counts = seen.get(rule.name()).unwrap_or_else(|| panic!("no section on {rule}"));
        assert!(counts.iter().all(|count| *count > 0), "{rule}: {counts:?}");
        let begin = page.find(&format!("## `{rule}`")).unwrap();
        let says = page[begin..].lines().nth(2).unwrap_or_default().to_owned();
        let severity = rule.severity().name();
        assert!(says.to_lowercase().starts_with(severity), "{rule}: {says}");
        assert_eq!(says.contains("can be silenced"), rule.is_silenceable(), "{rule}: {says}");
    }
    if std::env::var_os(RENEW_VARIABLE).is_some() {
        std::fs::write(path(), renewed).unwrap();
    }
}
