//! Names of pictures and of the files written for them.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::cli::diagnostics::{Failure, Result};

/// Stands for each picture's own name in `--annotate`.
const NAME_MARK: &str = "{}";

/// Where everything goes that is written about each of the pictures.
#[derive(Debug)]
pub(super) struct Places {
    /// What each picture is called in answers: its file name, or its path where two have the same file name.
    names: Vec<String>,
    /// What each picture's files are called: unique, without an extension.
    stems: Vec<String>,
    annotated: Option<Annotated>,
    stages: Option<PathBuf>,
}

#[derive(Debug)]
enum Annotated {
    File(PathBuf),
    Folder(PathBuf),
    Pattern(String),
}

impl Places {
    /// Decides every place and makes the folders, before any long work.
    pub(super) fn new(
        images: &[PathBuf],
        annotated: Option<&Path>,
        stages: Option<&Path>,
    ) -> Result<Self> {
        let annotated = annotated.map(|place| Annotated::new(place, images.len())).transpose()?;
        let folder = match &annotated {
            Some(Annotated::Folder(folder)) => Some(folder.as_path()),
            Some(Annotated::File(file)) => file.parent(),
            Some(Annotated::Pattern(pattern)) => Path::new(pattern).parent(),
            None => None,
        };
        if let Some(Annotated::File(file)) = &annotated {
            let whole = |path: &Path| fs::canonicalize(path).ok();
            if let (Some(out), [image]) = (whole(file), images)
                && whole(image) == Some(out)
            {
                return Err(Failure::new(format!("{} is the picture itself", file.display()))
                    .hint("give --annotate another name, such as found.png"));
            }
        }
        for folder in folder.into_iter().chain(stages) {
            fs::create_dir_all(folder).map_err(|error| Failure::file("make", folder, &error))?;
        }
        Ok(Self {
            names: names(images),
            stems: stems(images),
            annotated,
            stages: stages.map(Path::to_owned),
        })
    }

    /// What the picture is called in answers.
    pub(super) fn name(&self, index: usize) -> &str {
        self.names.get(index).map_or("", String::as_str)
    }

    fn stem(&self, index: usize) -> &str {
        self.stems.get(index).map_or("", String::as_str)
    }

    /// Where the picture with its ellipses goes.
    pub(super) fn annotated(&self, index: usize) -> Option<PathBuf> {
        let stem = self.stem(index);
        Some(match self.annotated.as_ref()? {
            Annotated::File(file) => file.clone(),
            Annotated::Folder(folder) => folder.join(format!("{stem}-ellipses.png")),
            Annotated::Pattern(pattern) => PathBuf::from(pattern.replace(NAME_MARK, stem)),
        })
    }

    /// Where the picture of a stage goes.
    pub(super) fn stage(&self, index: usize, stage: &str) -> PathBuf {
        let folder = self.stages.as_deref().unwrap_or(Path::new(""));
        folder.join(format!("{}-{stage}.png", self.stem(index)))
    }
}

impl Annotated {
    fn new(place: &Path, images: usize) -> Result<Self> {
        let text = place.to_string_lossy();
        if place.is_dir() || text.ends_with('/') {
            return Ok(Self::Folder(place.to_owned()));
        }
        if text.contains(NAME_MARK) {
            return Ok(Self::Pattern(text.into_owned()));
        }
        if images == 1 {
            return Ok(Self::File(place.to_owned()));
        }
        if place.extension().is_none() {
            return Ok(Self::Folder(place.to_owned()));
        }
        Err(Failure::new(format!("{text} is one file, and there are {images} pictures")).hint(
            "give --annotate a folder, or a name with {} for each picture's own, as in found-{}.png",
        ))
    }
}

fn names(images: &[PathBuf]) -> Vec<String> {
    let file_name = |path: &Path| {
        path.file_name()
            .map_or_else(|| path.to_string_lossy(), |name| name.to_string_lossy())
            .into_owned()
    };
    let times = count(images.iter().map(|path| file_name(path)));
    let name = |path: &PathBuf| {
        let name = file_name(path);
        if times.get(&name) == Some(&1) { name } else { path.to_string_lossy().into_owned() }
    };
    images.iter().map(name).collect()
}

fn stems(images: &[PathBuf]) -> Vec<String> {
    let stem = |path: &Path| match path.file_stem() {
        Some(stem) if stem != "-" => stem.to_string_lossy().into_owned(),
        _ => "picture".to_owned(),
    };
    let times = count(images.iter().map(|path| stem(path)));
    let unique = |(index, path): (usize, &PathBuf)| {
        let stem = stem(path);
        if times.get(&stem) == Some(&1) { stem } else { format!("{stem}-{}", index + 1) }
    };
    images.iter().enumerate().map(unique).collect()
}

fn count(names: impl Iterator<Item = String>) -> BTreeMap<String, usize> {
    let mut times = BTreeMap::new();
    for name in names {
        *times.entry(name).or_default() += 1;
    }
    times
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paths(names: &[&str]) -> Vec<PathBuf> {
        names.iter().map(PathBuf::from).collect()
    }

    #[test]
    fn pictures_of_the_same_name_are_told_apart() {
        let images = paths(&["a/cup.png", "b/cup.png", "ball.png", "ball.jpg", "-"]);
        assert_eq!(names(&images), ["a/cup.png", "b/cup.png", "ball.png", "ball.jpg", "-"]);
        assert_eq!(stems(&images), ["cup-1", "cup-2", "ball-3", "ball-4", "picture"]);
        assert_eq!(names(&paths(&["deep/in/cup.png"])), ["cup.png"]);
    }

    #[test]
    fn annotated_pictures_go_to_a_file_a_folder_or_a_pattern() {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        let (one, two) = (paths(&["a/cup.png"]), paths(&["cup.png", "ball.png"]));
        let annotated = |images: &[PathBuf], to: &str| {
            Places::new(images, Some(&place(to)), None).unwrap().annotated(0).unwrap()
        };
        assert_eq!(annotated(&one, "deep/out.png"), place("deep/out.png"));
        assert_eq!(annotated(&one, "new/"), place("new/cup-ellipses.png"));
        assert_eq!(annotated(&two, "found"), place("found/cup-ellipses.png"));
        assert_eq!(annotated(&two, "found-{}.png"), place("found-cup.png"));
        assert!(place("deep").is_dir() && place("new").is_dir() && place("found").is_dir());
        let refused = Places::new(&two, Some(&place("out.png")), None).unwrap_err().to_string();
        assert!(refused.contains("out.png") && refused.contains('2'), "{refused}");
    }
}
