//! Pages whose commands are run: their files are written, and what the commands print is what the page shows.
#![cfg(feature = "cli")]

mod support;

use support::User;

/// Runs a page in a folder of its own; tells how many commands it has.
fn run(page: &str) -> usize {
    let path = format!("{}/../../docs/{page}", env!("CARGO_MANIFEST_DIR"));
    let page = std::fs::read_to_string(path).unwrap();
    let user = User::new();
    let mut count = 0;
    for block in page.split("\n```").collect::<Vec<_>>().chunks(2) {
        let [_, block] = block else { continue };
        let (fence, text) = block.split_once('\n').unwrap();
        if let Some(name) = fence.strip_prefix("rsa file=") {
            std::fs::write(user.path(name), format!("{text}\n")).unwrap();
            continue;
        }
        let (status, is_compared) = match fence {
            "console" => (0, true),
            "console any" => (0, false),
            "console status=1" => (1, true),
            // Run by the module's own tests.
            "python" => continue,
            other => panic!("an unknown fence: {other}"),
        };
        for part in format!("\n{text}").split("\n$ rsapien ").skip(1) {
            let (command, shown) = part.split_once('\n').unwrap_or((part, ""));
            let arguments = words(command);
            let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
            let run = user.expect(status, &arguments);
            assert!(!run.stdout.is_empty(), "rsapien {command} says nothing");
            if is_compared {
                let (told, shown) = (run.stdout.trim_end(), shown.trim_end());
                assert_eq!(told, shown, "rsapien {command}\n{}", run.stderr);
            }
            count += 1;
        }
    }
    count
}

/// The words of a command line, of which some stand in quotation marks.
fn words(command: &str) -> Vec<String> {
    let mut words = Vec::new();
    for (index, part) in command.split('"').enumerate() {
        if index.is_multiple_of(2) {
            words.extend(part.split_whitespace().map(str::to_owned));
        } else {
            words.push(part.to_owned());
        }
    }
    words
}

#[test]
fn the_first_action_goes_as_the_page_says() {
    assert!(run("first-action.md") >= 9);
}

#[test]
fn the_recordings_are_as_the_page_says() {
    assert!(run("recording.md") >= 5);
}

#[test]
fn the_twenty_tasks_of_the_cookbook_are_done() {
    let page = include_str!("../../../docs/cookbook.md");
    assert_eq!(page.matches("\n## ").count(), 20);
    assert!(run("cookbook.md") >= 25);
}
