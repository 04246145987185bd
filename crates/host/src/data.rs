//! Where a user's data stands: the platform's data folder, one place a user.

use std::path::PathBuf;

use directories::ProjectDirs;

/// The data folder of this user, such as `~/.local/share/rsapien`; none when the system names no
/// home. It is not made by asking for it.
pub fn data_folder() -> Option<PathBuf> {
    let folders = ProjectDirs::from("", "", "rsapien")?;
    Some(folders.data_local_dir().to_path_buf())
}

/// Where `RoboRegistry` stands unless the user says otherwise.
pub fn registry_file() -> Option<PathBuf> {
    Some(data_folder()?.join("registry.sqlite"))
}

/// Where the locks between programs stand. Not in a runtime folder, which is there in one login
/// and missing in the next: two programs that look in different places would not see each other.
pub fn lock_folder() -> Option<PathBuf> {
    Some(data_folder()?.join("locks"))
}
