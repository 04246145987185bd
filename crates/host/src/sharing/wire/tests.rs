use super::report::OutcomeTold;
use super::*;
use crate::player::StepReached;
use crate::{Interruption, Outcome, PlayReport};
use rsapien_protocol::{Mode, MotionReport, Position, Status, StopCause};
use rsapien_registry::NoActions;
use rsapien_registry::check::check_text;

const TEXT: &str = "action rest { do right-arm-down }
    action shake {
        on left-hand end
        do right-arm-front for 700ms
        label waiting
        wait for right-hand at most 3s else play rest
        on right-foot-front play rest
        repeat 2 { do right-hand-in do right-hand-open }
    }";

fn through<T: Serialize + for<'a> Deserialize<'a>>(value: &T) -> T {
    serde_json::from_slice(&line(value)).unwrap()
}

#[test]
fn an_action_arrives_as_it_was_handed_in() {
    let action = check_text(TEXT, &NoActions).actions.pop().unwrap().compiled.unwrap();
    assert!(!action.handlers.is_empty() && !action.waits.is_empty() && !action.labels.is_empty());
    assert_eq!(through(&Action::of(&action)).compiled(), Some(action));
}

#[test]
fn what_makes_no_sense_is_no_action() {
    let action = check_text(TEXT, &NoActions).actions.pop().unwrap().compiled.unwrap();
    let told = || Action::of(&action);
    let broken = [
        Action { steps: vec![(0xC000, 100, 0)], ..told() },
        Action { steps: vec![(0, 100, 0xFF)], ..told() },
        Action { labels: vec![("x".to_owned(), 99)], ..told() },
        Action { steps: Vec::new(), ..told() },
    ];
    assert!(broken.into_iter().all(|it| it.compiled().is_none()));
}

#[test]
fn every_outcome_arrives_as_it_was_told() {
    let mask = BumperMask::from_low_bits(0b10_0001);
    let interruptions = [
        Interruption::Bumper(mask),
        Interruption::Stop,
        Interruption::DeadMan,
        Interruption::Reset(StopCause::BrownOut),
        Interruption::LinkLost,
        Interruption::Cancelled,
        Interruption::Replaced,
        Interruption::WaitInVain(mask),
    ];
    let mut outcomes = vec![
        Outcome::Done,
        Outcome::Refused { status: Status::Held },
        Outcome::Unknown { why: "because".to_owned() },
    ];
    outcomes.extend(interruptions.map(|by| Outcome::Interrupted { by }));
    for outcome in outcomes {
        assert_eq!(through(&OutcomeTold::of(&outcome)).outcome(), outcome);
    }
    let other = OutcomeTold::Interrupted("meteor".to_owned(), 0).outcome();
    assert!(matches!(other, Outcome::Unknown { why } if why.contains("meteor")));
}

#[test]
fn a_report_arrives_with_its_evidence() {
    let evidence = MotionReport {
        mode: Mode::Held,
        bumpers: BumperMask::from_low_bits(1),
        middle_switches: [true, false],
        presses: [1, 2, 3, 4, 5, 15],
        motors: 0,
        supply_low: true,
        pose_reached: Pose::EMPTY.with(rsapien_protocol::Joint::Tilt, Some(Position::Last)),
        queue_free: 32,
        steps_ended: 65_535,
        boot: 9,
        reception_errors: 3,
        cause: StopCause::Bumper,
    };
    let mut report = PlayReport::unplayed("walk", 7, Interruption::Stop);
    report.evidence = Some(evidence);
    report.instead = Some(Box::new(PlayReport::unplayed("back", 2, Interruption::DeadMan)));
    report.reached = Some(StepReached {
        number: 3,
        source: StepSource { action: Arc::from("walk"), step: 2, outer_step: 2, round: 1 },
    });
    assert_eq!(through(&ReportTold::of(&report)).report(), report);
}

#[test]
fn lines_are_put_together_however_they_come() {
    let mut lines = Lines::default();
    let mut seen = Vec::new();
    for byte in b"one\ntwo\n\nthree" {
        assert!(lines.take(&[*byte]));
        seen.extend(lines.next());
    }
    assert_eq!(seen, [b"one\n".to_vec(), b"two\n".to_vec(), b"\n".to_vec()]);
    assert!(!Lines::default().take(&vec![0; LINE_LENGTH_MAX + 1]));
}
