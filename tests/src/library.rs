//! The part of `docs/actions.md` that shows the library of a new registry.

use std::fmt::Write as _;

use rsapien::CancelToken;
use rsapien::registry::timeline::SvgOptions;
use rsapien::registry::{ActionDraft, CompileOptions, Registry, Timeline};
use rsapien::trial::try_on_virtual_body;

/// Where the part begins and ends in the page.
pub const MARKS: [&str; 2] = ["<!-- library: begin -->\n", "<!-- library: end -->\n"];

/// The action whose picture is in the documents, and where.
pub const PICTURE: (&str, &str) = ("shake-hands", "docs/images/shake-hands.svg");

/// Columns of a timeline in the page.
const COLUMNS: usize = 96;

/// A table of all actions, then each with its text, what the virtual body did, and its timeline.
///
/// # Panics
/// When an action of the library cannot be played.
pub fn library() -> String {
    let registry = Registry::open_in_memory().expect("a registry in memory");
    let list = registry.list().expect("a list");
    let mut page = format!(
        "{} actions. Each was checked without a finding, and tried on the virtual body after the initialisation; a \
         bumper that it waits for was pressed at once. (`cargo run -p rsapien-tests --example library-page` writes \
         this part.)\n\n| action | lasts | moves | does |\n|---|---|---|---|\n",
        list.len()
    );
    for summary in &list {
        let (name, does) = (&summary.name, &summary.description);
        let (lasts, joints) = (seconds(summary.duration_ms), summary.joints.join(", "));
        // Writing to a string cannot fail.
        let _ = writeln!(page, "| [`{name}`](#{name}) | {lasts} | {joints} | {does} |");
    }
    for summary in &list {
        let name = summary.name.as_str();
        let action = registry.get(name).expect(name);
        let draft: ActionDraft = action.draft().expect(name);
        let compiled = registry.compile_draft(&draft, &CompileOptions::default()).expect(name);
        let trial = try_on_virtual_body(&compiled, &CancelToken::new()).expect(name);
        let timeline = Timeline::of(&compiled).to_text(COLUMNS, false);
        // The legend is the same below all of them.
        let timeline = timeline.trim_end().rsplit_once('\n').map_or("", |(rows, _)| rows);
        let _ = write!(
            page,
            "\n### {name}\n\nTags: {}. On the virtual body: {trial}.\n\n```text\n{timeline}\n```\n\n\
             ```text\n{}\n```\n",
            action.tags.join(", "),
            action.text
        );
    }
    page
}

/// The picture of an action of the library, as `rsapien actions show NAME --svg` draws it.
///
/// # Panics
/// When the library has no such action.
pub fn picture(name: &str) -> String {
    let registry = Registry::open_in_memory().expect("a registry in memory");
    let action = registry.get(name).expect(name);
    let compiled = registry.compile(name, &CompileOptions::default()).expect(name);
    let (title, description) = (action.name, action.description);
    Timeline::of(&compiled).to_svg(&SvgOptions { title, description, ..SvgOptions::default() })
}

fn seconds(ms: u64) -> String {
    format!("{}.{:02} s", ms / 1000, ms % 1000 / 10)
}
