//! Whether the file of the actions is whole. It is opened to be read only: looking neither makes one nor brings an old
//! one up to date.

use std::path::Path;

use rsapien_registry::{Registry, RegistryError};

use super::{Case, Finding};

pub(super) const NAME: &str = "registry";

pub(super) fn check(case: &mut Case<'_>) {
    if let Some(path) = &case.options.registry_file {
        let finding = judge(path);
        case.tell(finding);
    }
}

fn judge(path: &Path) -> Finding {
    let shown = path.display();
    if !path.exists() {
        let found = format!("there is no {shown} yet; it is made when it is first needed");
        return Finding::good(NAME, "no-registry", found);
    }
    let integrity = Registry::open_read_only(path).and_then(|registry| registry.integrity());
    let integrity = match integrity {
        Ok(integrity) => integrity,
        Err(error) => return unreadable(path, &error),
    };
    let Some(first) = integrity.problems.first() else {
        let found = format!("{shown}: {} actions, nothing wrong", integrity.actions);
        return Finding::good(NAME, "registry-whole", found);
    };
    let found = match integrity.problems.len() {
        1 => format!("{shown}: {}", first.what),
        count => format!("{shown}: {count} things are wrong, first: {}", first.what),
    };
    let finding = Finding::problem(NAME, "registry-damaged", found);
    if integrity.problems.iter().all(|problem| problem.is_repairable) {
        return finding.remedy(format!("rsapien actions verify --repair --registry '{shown}'"));
    }
    let advice = integrity.problems.iter().find(|problem| !problem.is_repairable);
    let finding = finding.remedy(advice.map_or_else(String::new, |it| it.advice.clone()));
    finding.remedy(format!("everything that is wrong: rsapien actions verify --registry '{shown}'"))
}

/// What keeps the file from being read; its text says what to do as well.
fn unreadable(path: &Path, error: &RegistryError) -> Finding {
    let shown = path.display();
    match error {
        RegistryError::TooOld { file_schema, .. } => {
            let found = format!("{shown} has the older schema {file_schema}");
            Finding::advice(NAME, "registry-old", found).remedy(format!(
                "the next command that uses it brings it up to date: rsapien actions list --registry '{shown}'"
            ))
        }
        RegistryError::Busy { .. } => Finding::advice(NAME, "registry-busy", error.to_string()),
        _ => {
            let finding = Finding::problem(NAME, "registry-unreadable", error.to_string());
            finding.remedy(format!(
                "move {shown} away, or name another file with --registry; a new one is made when it is first needed"
            ))
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::doctor::Severity;

    #[test]
    fn looking_at_a_registry_neither_makes_nor_mends_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("registry.sqlite");
        assert_eq!(judge(&path).code, "no-registry");
        assert!(!path.exists());
        drop(Registry::open(&path).unwrap());
        let whole = judge(&path);
        assert_eq!((whole.code, whole.severity), ("registry-whole", Severity::Good));
        fs::write(&path, "this is no database, whatever its name says").unwrap();
        let broken = judge(&path);
        assert_eq!((broken.code, broken.severity), ("registry-unreadable", Severity::Problem));
        assert!(broken.remedies[0].starts_with("move "), "{broken:?}");
    }

    #[test]
    fn an_old_registry_stays_old() {
        let error = RegistryError::TooOld { path: "old.sqlite".into(), file_schema: 1 };
        let found = unreadable(Path::new("old.sqlite"), &error);
        assert_eq!((found.code, found.severity), ("registry-old", Severity::Advice));
        assert!(found.remedies[0].contains("rsapien actions list --registry 'old.sqlite'"));
    }
}
