//! The files in which Linux tells of devices and processes, below a root that tests choose.

use std::fs;
use std::path::{Path, PathBuf};

/// A running process.
pub(super) struct Process {
    pub(super) pid: u32,
    /// What it calls itself, at most 15 characters.
    pub(super) name: String,
    folder: PathBuf,
}

impl Process {
    /// The files it has open; none where this user may not look.
    pub(super) fn open_files(&self) -> Option<Vec<PathBuf>> {
        let entries = fs::read_dir(self.folder.join("fd")).ok()?;
        Some(entries.flatten().filter_map(|entry| fs::read_link(entry.path()).ok()).collect())
    }
}

/// The user that this process runs as.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct User {
    pub(super) name: Option<String>,
    /// The groups of this login, by number.
    pub(super) groups: Vec<u32>,
}

/// A computer's system files.
pub(super) struct Machine<'a> {
    root: &'a Path,
}

impl<'a> Machine<'a> {
    pub(super) fn new(root: &'a Path) -> Machine<'a> {
        Machine { root }
    }

    /// Where `absolute` stands below the root.
    pub(super) fn path(&self, absolute: &str) -> PathBuf {
        self.root.join(absolute.trim_start_matches('/'))
    }

    /// The text of a file, without white space around it.
    pub(super) fn text(&self, absolute: &str) -> Option<String> {
        let text = fs::read_to_string(self.path(absolute)).ok()?;
        Some(text.trim().to_owned())
    }

    /// Every process that can be seen, by number.
    pub(super) fn processes(&self) -> Vec<Process> {
        let Ok(entries) = fs::read_dir(self.path("/proc")) else { return Vec::new() };
        let mut processes: Vec<Process> = entries
            .flatten()
            .filter_map(|entry| {
                let pid = entry.file_name().to_str()?.parse().ok()?;
                let folder = entry.path();
                let name = fs::read_to_string(folder.join("comm")).ok()?;
                Some(Process { pid, name: name.trim().to_owned(), folder })
            })
            .collect();
        processes.sort_by_key(|process| process.pid);
        processes
    }

    /// Who this process runs as.
    pub(super) fn user(&self) -> User {
        let status = self.text("/proc/self/status").unwrap_or_default();
        let numbers = |field: &str| -> Vec<u32> {
            let line = status.lines().find_map(|line| line.strip_prefix(field));
            line.unwrap_or("").split_whitespace().filter_map(|word| word.parse().ok()).collect()
        };
        // The second number is the effective user.
        let id = numbers("Uid:").get(1).copied();
        let name = id.and_then(|id| self.name_of(id, "/etc/passwd"));
        User { name, groups: numbers("Groups:") }
    }

    /// The name of a group.
    pub(super) fn group_name(&self, id: u32) -> Option<String> {
        self.name_of(id, "/etc/group")
    }

    /// Whether the list of groups says that `user` is in `group`: from the next login on, that is.
    pub(super) fn is_listed(&self, user: &str, group: &str) -> bool {
        let groups = self.text("/etc/group").unwrap_or_default();
        let line = groups.lines().find(|line| line.split(':').next() == Some(group));
        let members = line.and_then(|line| line.split(':').nth(3)).unwrap_or("");
        members.split(',').any(|member| member == user)
    }

    /// The name in front of a number, in a file of lines such as `dialout:x:20:`.
    fn name_of(&self, id: u32, file: &str) -> Option<String> {
        let text = self.text(file)?;
        let id = id.to_string();
        text.lines().find_map(|line| {
            let mut fields = line.split(':');
            let name = fields.next()?;
            (fields.nth(1)? == id).then(|| name.to_owned())
        })
    }
}
