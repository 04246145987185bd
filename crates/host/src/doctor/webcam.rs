//! Which webcams there are, whether this user may read them, and who has one open (Linux: `/sys`, `/proc`).

use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::PathBuf;

use rustix::fs::Access as Way;

use super::machine::Machine;
use super::{Case, Finding};
use crate::LinkAddress;

pub(super) const NAME: &str = "webcam";

pub(super) fn check(case: &mut Case<'_>) {
    if *case.address == LinkAddress::Virtual {
        let found = "the virtual robot has a camera of its own: rsapien --link virtual snapshot";
        case.tell(Finding::good(NAME, "virtual-camera", found));
        return;
    }
    let names = devices(&case.machine);
    if names.is_empty() {
        let found = "no webcam: pictures, films and streams can be looked at all the same";
        case.tell(Finding::good(NAME, "no-webcam", found));
    }
    for name in names {
        let finding = judge(&name, &case.machine);
        case.tell(finding);
    }
}

/// `video0` and so on, by number.
fn devices(machine: &Machine<'_>) -> Vec<String> {
    let Ok(entries) = fs::read_dir(machine.path("/sys/class/video4linux")) else {
        return Vec::new();
    };
    let names = entries.flatten().filter_map(|entry| entry.file_name().into_string().ok());
    let mut names: Vec<String> = names.filter(|name| name.starts_with("video")).collect();
    names.sort_by_key(|name| (name.len(), name.clone()));
    names
}

fn judge(name: &str, machine: &Machine<'_>) -> Finding {
    let path = format!("/dev/{name}");
    let model = machine.text(&format!("/sys/class/video4linux/{name}/name"));
    let model = model.unwrap_or_else(|| "unnamed".to_owned());
    let file = machine.path(&path);
    let Ok(metadata) = fs::metadata(&file) else {
        let found = format!("the system knows {path} ({model}), but the file is not there");
        return Finding::advice(NAME, "webcam-gone", found).remedy("plug the webcam in again");
    };
    if rustix::fs::access(&file, Way::READ_OK | Way::WRITE_OK).is_err() {
        return not_permitted(&path, &model, metadata.gid(), machine);
    }
    let wanted = PathBuf::from(&path);
    let holder = machine.processes().into_iter().find(|process| {
        process.pid != std::process::id()
            && process.open_files().is_some_and(|files| files.contains(&wanted))
    });
    if let Some(holder) = holder {
        let found = format!("{path} ({model}) is open in {} (pid {})", holder.name, holder.pid);
        return Finding::advice(NAME, "webcam-held", found)
            .remedy(format!("end {} before rsapien watch {path}", holder.name));
    }
    Finding::good(NAME, "webcam", format!("{path} ({model}) may be read"))
}

/// The robot works without a webcam, so this is advice.
fn not_permitted(path: &str, model: &str, group_id: u32, machine: &Machine<'_>) -> Finding {
    let user = machine.user().name;
    let user = user.as_deref().unwrap_or("\"$USER\"");
    let rule = "echo 'SUBSYSTEM==\"video4linux\", GROUP=\"video\", MODE=\"0660\"' | sudo tee \
         /etc/udev/rules.d/70-rsapien-webcam.rules && sudo udevadm control --reload && sudo udevadm trigger";
    let finding = |group: &str| {
        let found =
            format!("no permission to read {path} ({model}), which belongs to the group {group}");
        Finding::advice(NAME, "webcam-no-permission", found)
    };
    match machine.group_name(group_id).as_deref() {
        Some(group) if group != "root" => finding(group)
            .remedy(format!("sudo usermod -a -G {group} {user}, then log out and in again")),
        _ => finding("root").remedy(format!("give it to the group video: {rule}")),
    }
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::symlink;

    use super::*;

    #[test]
    fn webcams_are_found_by_number_and_the_one_in_use_names_its_program() {
        let root = tempfile::tempdir().unwrap();
        let machine = Machine::new(root.path());
        assert!(devices(&machine).is_empty());
        for (name, model) in [("video10", "Cheap"), ("video2", "Logitech")] {
            let folder = root.path().join("sys/class/video4linux").join(name);
            fs::create_dir_all(&folder).unwrap();
            fs::write(folder.join("name"), model).unwrap();
        }
        fs::create_dir_all(root.path().join("dev")).unwrap();
        fs::write(root.path().join("dev/video2"), "").unwrap();
        assert_eq!(devices(&machine), ["video2", "video10"]);
        assert_eq!(judge("video10", &machine).code, "webcam-gone");
        assert_eq!(judge("video2", &machine).code, "webcam");

        let process = root.path().join("proc/4711");
        fs::create_dir_all(process.join("fd")).unwrap();
        fs::write(process.join("comm"), "cheese\n").unwrap();
        symlink("/dev/video2", process.join("fd/3")).unwrap();
        let held = judge("video2", &machine);
        assert_eq!(held.code, "webcam-held");
        assert!(held.found.contains("Logitech") && held.found.contains("cheese (pid 4711)"));
    }

    #[test]
    fn without_permission_the_group_that_owns_the_webcam_is_named() {
        let root = tempfile::tempdir().unwrap();
        fs::create_dir_all(root.path().join("etc")).unwrap();
        fs::write(root.path().join("etc/group"), "root:x:0:\nvideo:x:44:\n").unwrap();
        let machine = Machine::new(root.path());
        let found = not_permitted("/dev/video0", "Logitech", 44, &machine);
        assert!(found.remedies[0].starts_with("sudo usermod -a -G video "), "{found:?}");
        let nobodys = not_permitted("/dev/video0", "Logitech", 0, &machine);
        assert!(nobodys.remedies[0].contains("/etc/udev/rules.d/70-rsapien-webcam.rules"));
    }
}
