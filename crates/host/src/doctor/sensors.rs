//! What the motion controller senses at rest: supply, bumpers, mid-arm switches, and its dead-man time.

use rsapien_protocol::{Address, HelloReport, Joint, MotionReport, Report, Request};

use super::{Case, Finding};

pub(super) const NAME: &str = "sensors";

/// The arms with the index of their switch in the report.
const ARMS: [(&str, Joint, usize); 2] =
    [("left", Joint::LeftArm, 0), ("right", Joint::RightArm, 1)];

pub(super) fn check(case: &mut Case<'_>) {
    let Some(line) = case.line.as_mut() else { return };
    let asked = match line.ask(Address::Motion, Request::State) {
        Ok(asked) => asked,
        Err(error) => return case.lose_line(NAME, &error),
    };
    let Some((_, Report::Motion(report))) = asked.answer else {
        case.tell(
            Finding::problem(
                NAME,
                "no-state",
                "the motion controller answered HELLO, but not STATE",
            )
            .remedy("ask again; a line that loses packages shows below"),
        );
        return;
    };
    case.tell(supply(&report));
    case.tell(bumpers(&report));
    case.tell(switches(&report));
    if let Some(hello) = case.motion {
        case.tell(dead_man(&hello));
    }
}

fn supply(report: &MotionReport) -> Finding {
    if report.supply_low {
        return Finding::problem(NAME, "supply-low", "the controllers' supply is below 5 V")
            .remedy("charge or change the batteries; below 5 V a controller at 40 MHz is out of its range")
            .remedy("with fresh batteries, look at the supply detector (docs/firmware.md, Wiring)");
    }
    Finding::good(NAME, "supply", "the controllers' supply is 5 V")
}

fn bumpers(report: &MotionReport) -> Finding {
    let pressed: Vec<&str> = report.bumpers.names().collect();
    if pressed.is_empty() {
        return Finding::good(NAME, "bumpers", "no bumper is pressed");
    }
    Finding::problem(NAME, "bumper-pressed", format!("pressed at rest: {}", pressed.join(", ")))
        .remedy("free the robot's feet and hands; if it stays, a switch sticks or its wire touches ground")
}

fn switches(report: &MotionReport) -> Finding {
    let mut closed = Vec::new();
    for (name, arm, index) in ARMS {
        let is_closed = report.middle_switches.get(index).copied().unwrap_or(false);
        // The middle position of Table 1 is number 2.
        let is_elsewhere = report.position(arm).is_some_and(|position| position.number() != 2);
        if is_closed && is_elsewhere {
            let found =
                format!("the {name} mid-arm switch is closed, but the arm is not in its middle");
            return Finding::problem(NAME, "switch-stuck", found).remedy(
                "look at the switch and its wire: it closes in the middle of the arm's way only",
            );
        }
        if is_closed {
            closed.push(name);
        }
    }
    let found = match closed.as_slice() {
        [] => "no mid-arm switch is closed".to_owned(),
        [name] => {
            format!("the {name} mid-arm switch is closed, as it is with the arm in its middle")
        }
        _ => {
            "both mid-arm switches are closed, as they are with the arms in their middle".to_owned()
        }
    };
    Finding::good(NAME, "switches", found)
}

fn dead_man(hello: &HelloReport) -> Finding {
    match hello.dead_man_ms {
        0 => Finding::advice(
            NAME,
            "dead-man-off",
            "the dead-man is off: silence does not stop the motors",
        )
        .remedy("switch the robot off and on: it is on at each start, at 500 ms"),
        ms => Finding::good(
            NAME,
            "dead-man",
            format!("the dead-man stops the motors after {ms} ms of silence"),
        ),
    }
}
