//! Whether this user may open the port.

use super::device::Device;
use super::machine::Machine;
use super::{Case, Finding};

pub(super) const NAME: &str = "permission";

/// What decides who may open a device.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Access {
    pub(super) is_there: bool,
    pub(super) is_permitted: bool,
    /// The group that owns the device.
    pub(super) group: Option<String>,
    /// The user, by name.
    pub(super) user: Option<String>,
    /// The user is in the group, but was not yet when this login began.
    pub(super) is_for_next_login: bool,
}

pub(super) fn check(case: &mut Case<'_>) {
    for device in case.devices.clone() {
        let access = access(&device, &case.machine);
        let finding = judge(&device, &access);
        if !access.is_there || !access.is_permitted {
            case.rule_out(&device.path);
        }
        case.tell(finding);
    }
}

/// Looks at the device below the machine's root.
#[cfg(unix)]
pub(super) fn access(device: &Device, machine: &Machine<'_>) -> Access {
    use rustix::fs::Access as Way;
    use std::os::unix::fs::MetadataExt;

    let file = machine.path(&device.file.to_string_lossy());
    let Ok(metadata) = std::fs::metadata(&file) else { return Access::default() };
    let user = machine.user();
    let group = machine.group_name(metadata.gid());
    let is_listed = match (&user.name, &group) {
        (Some(user), Some(group)) => machine.is_listed(user, group),
        _ => false,
    };
    Access {
        is_there: true,
        is_permitted: rustix::fs::access(&file, Way::READ_OK | Way::WRITE_OK).is_ok(),
        is_for_next_login: is_listed && !user.groups.contains(&metadata.gid()),
        user: user.name,
        group,
    }
}

/// Where files have no such owner, opening the port tells.
#[cfg(not(unix))]
pub(super) fn access(_device: &Device, _machine: &Machine<'_>) -> Access {
    Access { is_there: true, is_permitted: true, ..Access::default() }
}

pub(super) fn judge(device: &Device, access: &Access) -> Finding {
    let path = &device.path;
    if !access.is_there {
        let found = format!("there is no {path}");
        return Finding::problem(NAME, "no-device", found)
            .remedy("plug the adapter in, or look which name it has got: rsapien ports");
    }
    if access.is_permitted {
        return Finding::good(NAME, "permitted", format!("{path} may be read and written"));
    }
    let user = access.user.as_deref().unwrap_or("\"$USER\"");
    let finding = |group: &str| {
        let found = format!("no permission to open {path}, which belongs to the group {group}");
        Finding::problem(NAME, "no-permission", found)
    };
    let rule = format!(
        "or give it to everyone: echo 'SUBSYSTEM==\"tty\", {}, MODE=\"0666\"' | sudo tee \
         /etc/udev/rules.d/70-rsapien.rules && sudo udevadm control --reload && sudo udevadm trigger",
        device.udev_match()
    );
    match access.group.as_deref() {
        Some(group) if access.is_for_next_login => finding(group)
            .remedy(format!("log out and in again: {user} is in {group} since then only"))
            .remedy(rule),
        // The group of the superuser is nobody's to join.
        Some(group) if group != "root" => finding(group)
            .remedy(format!("sudo usermod -a -G {group} {user}, then log out and in again"))
            .remedy(rule),
        _ => finding("root").remedy(rule.trim_start_matches("or ").to_owned()),
    }
}
