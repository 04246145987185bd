//! How often the controllers started, and why they stopped last.

use rsapien_protocol::{HelloReport, StopCause};

use super::{Case, Finding};

pub(super) const NAME: &str = "resets";

/// What the cause of the last reset or hold means, in words that follow "boot 3,".
pub const fn cause_in_words(cause: StopCause) -> &'static str {
    match cause {
        StopCause::Nothing => "nothing told of the last reset",
        StopCause::DeadMan => "held last by the dead-man: it heard nothing while it moved",
        StopCause::Bumper => "held last by a bumper that ended its action",
        StopCause::PowerOn => "started by power-on",
        StopCause::BrownOut => "restarted by a brown-out: its supply sagged",
        StopCause::Watchdog => "restarted by the watchdog: its program hung",
    }
}

pub(super) fn check(case: &mut Case<'_>) {
    for (name, report) in [("motion", case.motion), ("camera", case.camera)] {
        if let Some(report) = report {
            case.tell(judge(name, &report));
        }
    }
}

fn judge(name: &str, report: &HelloReport) -> Finding {
    let found =
        format!("the {name} controller: boot {}, {}", report.boot, cause_in_words(report.cause));
    match report.cause {
        StopCause::BrownOut => Finding::problem(NAME, "brown-out", found)
            .remedy("charge or change the batteries, then switch the robot off and on")
            .remedy("if it comes back: a motor supply of its own, joined to ground at one point, and 100 nF at each controller"),
        StopCause::Watchdog => Finding::problem(NAME, "watchdog", found)
            .remedy("switch the robot off and on, and look whether it comes back when motors start")
            .remedy("if it does: spikes of the motors reach the controller's supply, ground or reset; see docs/firmware.md, Wiring"),
        StopCause::DeadMan => Finding::advice(NAME, "dead-man", found)
            .remedy("rsapien stop releases it; a cable that comes out or a program that hangs does this"),
        StopCause::Bumper => {
            Finding::advice(NAME, "bumper", found).remedy("rsapien stop releases it")
        }
        StopCause::PowerOn | StopCause::Nothing => Finding::good(NAME, "boot", found),
    }
}
