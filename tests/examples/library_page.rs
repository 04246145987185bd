//! Writes the part of `docs/actions.md` that shows the library of a new registry, and the picture of an action.

use std::fs;

use rsapien_tests::library::{MARKS, PICTURE, library, picture};
use rsapien_tests::workspace;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = workspace().join("docs/actions.md");
    let page = fs::read_to_string(&path)?;
    let [begin, end] = MARKS;
    let (before, rest) = page.split_once(begin).ok_or("the page has no beginning mark")?;
    let (_, after) = rest.split_once(end).ok_or("the page has no end mark")?;
    fs::write(&path, format!("{before}{begin}{}{end}{after}", library()))?;
    let (name, picture_path) = PICTURE;
    fs::write(workspace().join(picture_path), picture(name))?;
    Ok(())
}
