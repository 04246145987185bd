//! What can go wrong with a registry.

use std::path::PathBuf;

use rsapien_protocol::Primitive;

use crate::check::Findings;

/// Why a registry could not do what was asked. Nothing was changed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RegistryError {
    /// The file cannot be opened or made.
    #[error(
        "cannot open the registry {}: {reason}; check that the folder exists and that you may write \
         there, or name another file",
        path.display()
    )]
    CannotOpen {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: String,
    },
    /// The file or its folder cannot be written.
    #[error(
        "cannot write the registry {}: {reason}; check the permissions of the file and its folder \
         and the space left, or name another file",
        path.display()
    )]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: String,
    },
    /// The file is something else.
    #[error(
        "{} is no registry: {reason}; name another file, or move this one away and a new registry \
         is made in its place",
        path.display()
    )]
    NotARegistry {
        /// The file.
        path: PathBuf,
        /// What it seems to be.
        reason: String,
    },
    /// The file was a registry and is damaged.
    #[error(
        "the registry {} is damaged ({reason}); move it and its -wal and -shm files away and import \
         a saved export into a new one",
        path.display()
    )]
    Corrupt {
        /// The file.
        path: PathBuf,
        /// What is damaged.
        reason: String,
    },
    /// The file was written by a newer program.
    #[error(
        "the registry {} has schema {file_schema}, and rsapien-registry {program_version} knows \
         schemas up to {program_schema}: update this program, or name another file",
        path.display()
    )]
    TooNew {
        /// The file.
        path: PathBuf,
        /// The schema of the file.
        file_schema: i64,
        /// The newest schema this program knows.
        program_schema: i64,
        /// The version of this program.
        program_version: &'static str,
    },
    /// The file has to be brought up to date, and was opened to be read only.
    #[error(
        "the registry {} has the older schema {file_schema}: open it once for writing, which brings it \
         up to date",
        path.display()
    )]
    TooOld {
        /// The file.
        path: PathBuf,
        /// The schema of the file.
        file_schema: i64,
    },
    /// A file is there already, and nothing is written over it.
    #[error("{} is there already: choose another name, or move it away", path.display())]
    FileExists {
        /// The file.
        path: PathBuf,
    },
    /// Another program holds the file.
    #[error(
        "the registry {} was held by another program for {waited_ms} ms: try again when that has \
         finished",
        path.display()
    )]
    Busy {
        /// The file.
        path: PathBuf,
        /// How long was waited, in milliseconds.
        waited_ms: u64,
    },
    /// The database refused for a reason that has no name of its own here.
    #[error("the registry {}: {source}", path.display())]
    Database {
        /// The file.
        path: PathBuf,
        /// What the database says.
        source: rusqlite::Error,
    },
    /// There is no action of that name.
    #[error(
        "there is no action {name:?}{}",
        did_you_mean(suggestion.as_deref())
    )]
    UnknownAction {
        /// The name asked for.
        name: String,
        /// The action whose name comes nearest.
        suggestion: Option<String>,
    },
    /// The name is a primitive's, and an action was asked for.
    #[error("{primitive} is a motion primitive, not an action: do it in a step")]
    IsPrimitive {
        /// The primitive.
        primitive: Primitive,
    },
    /// The action has no such version.
    #[error("action {name:?} has no version {version}: its versions are 1 to {latest}")]
    UnknownVersion {
        /// The action.
        name: String,
        /// The version asked for.
        version: u32,
        /// The newest version it has.
        latest: u32,
    },
    /// One or more actions are not as they have to be.
    #[error("{0}")]
    Refused(Findings),
    /// An action cannot be removed because others play it.
    #[error(
        "action {name:?} is played by {}: remove it there first",
        users.join(", ")
    )]
    InUse {
        /// The action.
        name: String,
        /// The actions that play it, in alphabetical order.
        users: Vec<String>,
    },
    /// A bundle is not what it should be, or cannot be written.
    #[error("the bundle: {reason}")]
    Bundle {
        /// What is wrong.
        reason: String,
    },
    /// Actions of a bundle are here already and do something else.
    #[error(
        "these actions are here already and do something else: {}",
        conflicts.iter().map(|it| it.name.as_str()).collect::<Vec<_>>().join(", ")
    )]
    Conflicts {
        /// Each of them, with both content hashes.
        conflicts: Vec<crate::store::Conflict>,
    },
    /// Actions to import exist already, with other content.
    #[error(
        "these actions exist already: {}; import them as new versions or rename them",
        names.join(", ")
    )]
    AlreadyExist {
        /// Their names, in the order of the text.
        names: Vec<String>,
    },
}

fn did_you_mean(suggestion: Option<&str>) -> String {
    suggestion.map(|name| format!("; did you mean {name:?}?")).unwrap_or_default()
}
