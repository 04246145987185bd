//! Folders of pictures with truth: `images/`, and in `gt/` one JSON file a picture: `{"image": name, "ellipses":
//! [[cx, cy, a, b, theta], ...], "ignore": [...]}`.

use std::error::Error;
use std::path::Path;

use rsapien_vision::Ellipse;
use rsapien_vision::evaluate::Truth;

/// What there is to find in the pictures of a folder, by the names of the files.
pub(crate) fn read_truths(folder: &Path) -> Result<Vec<Truth>, Box<dyn Error>> {
    let mut files: Vec<_> = std::fs::read_dir(folder.join("gt"))
        .map_err(|error| format!("{}: {error}", folder.join("gt").display()))?
        .map(|entry| Ok(entry?.path()))
        .collect::<std::io::Result<_>>()?;
    files.retain(|file| file.extension().is_some_and(|extension| extension == "json"));
    files.sort();
    files.iter().map(|file| read_truth(file)).collect()
}

fn read_truth(file: &Path) -> Result<Truth, Box<dyn Error>> {
    let json: serde_json::Value = serde_json::from_slice(&std::fs::read(file)?)?;
    let ellipses = |key: &str| -> Vec<Ellipse> {
        let lists = json[key].as_array().map_or(&[][..], Vec::as_slice);
        let ellipse = |list: &serde_json::Value| {
            let value = |i: usize| list[i].as_f64().unwrap_or(f64::NAN);
            Ellipse {
                center_x_px: value(0),
                center_y_px: value(1),
                semi_major_px: value(2),
                semi_minor_px: value(3),
                theta_rad: value(4),
            }
        };
        lists.iter().map(ellipse).collect()
    };
    let image = json["image"].as_str().ok_or("a truth file names no image")?.to_owned();
    Ok(Truth { image, ellipses: ellipses("ellipses"), ignore: ellipses("ignore") })
}
