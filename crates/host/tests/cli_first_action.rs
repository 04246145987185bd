//! `docs/first-action.md`: its files are written, its commands run, and what they print is what the page shows.
#![cfg(feature = "cli")]

mod support;

use support::User;

#[test]
fn the_first_action_goes_as_the_page_says() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/first-action.md");
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
        let status = match fence {
            "console" => 0,
            "console status=1" => 1,
            other => panic!("an unknown fence: {other}"),
        };
        for part in format!("\n{text}").split("\n$ rsapien ").skip(1) {
            let (command, shown) = part.split_once('\n').unwrap();
            let arguments: Vec<&str> = command.split_whitespace().collect();
            let run = user.expect(status, &arguments);
            assert_eq!(
                run.stdout.trim_end(),
                shown.trim_end(),
                "rsapien {command}\n{}",
                run.stderr
            );
            count += 1;
        }
    }
    assert!(count >= 9, "only {count} commands");
}
