use super::*;
use proptest::prelude::*;
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::crossterm::event::KeyModifiers;
use rsapien_protocol::{Mode, MotionReport, Position, StopCause};
use rsapien_registry::NoActions;
use rsapien_registry::check::{check_text, render};

use crate::Stamped;

fn check(text: &str) -> Checked {
    let checked = check_text(text, &NoActions);
    Checked {
        lines: render(&checked.findings, "greet.rsa", false).lines().map(str::to_owned).collect(),
        has_errors: checked.findings.has_errors(),
        compiled: checked.actions.into_iter().last().and_then(|action| action.compiled),
    }
}

fn teach() -> Teach<'static> {
    let hands = BumperMask::from_low_bits(0b11_0000);
    Teach::new("greet", hands, &check, Palette { is_colored: false })
}

fn state(time_ms: u64, presses: [u8; 6]) -> Event {
    let report = MotionReport {
        mode: Mode::Idle,
        bumpers: BumperMask::NONE,
        middle_switches: [false; 2],
        presses,
        motors: 0,
        supply_low: false,
        pose_reached: Pose::MIDDLE,
        queue_free: 32,
        steps_ended: 0,
        boot: 1,
        reception_errors: 0,
        cause: StopCause::PowerOn,
    };
    let motion = Some(Stamped { time_ms, report });
    Event::State(Box::new(RobotState { time_ms, motion, ..RobotState::default() }), Vec::new())
}

fn key(code: KeyCode) -> Event {
    Event::Key(KeyEvent::new(code, KeyModifiers::NONE))
}

fn drawn(teach: &Teach<'_>, width: u16, height: u16) -> String {
    let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
    terminal.draw(|frame| teach.draw(frame)).unwrap();
    terminal.backend().to_string()
}

/// Both arms up and marked after 1.4 s, then 0.8 s of nothing marked by the left hand, then the trunk.
fn greeting() -> Teach<'static> {
    let mut teach = teach();
    teach.update(state(1000, [0; 6]));
    assert_eq!(teach.update(key(KeyCode::Left)), [Effect::Nudge(Joint::RightArm, Position::First)]);
    teach.update(key(KeyCode::Down));
    teach.update(state(1600, [0; 6]));
    teach.update(key(KeyCode::Left));
    teach.update(state(2420, [0; 6]));
    teach.update(key(KeyCode::Enter));
    teach.update(state(3200, [0, 0, 0, 0, 1, 0]));
    for _ in 0..3 {
        teach.update(key(KeyCode::Down));
    }
    teach.update(key(KeyCode::Right));
    teach
}

const TEXT: &str = "action greet {
    do right-arm-up + left-arm-up for 1400ms
    wait 800ms
    do tilt-right for 500ms
}
";

#[test]
fn what_is_moved_and_marked_becomes_the_text_of_an_action() {
    let teach = greeting();
    assert_eq!(teach.text(), TEXT);
    assert!(!check(&teach.text()).has_errors);
}

#[test]
fn a_step_lasts_at_least_until_its_joints_can_have_arrived() {
    let mut teach = teach();
    teach.update(state(0, [0; 6]));
    teach.update(key(KeyCode::Left));
    teach.update(key(KeyCode::Enter));
    assert_eq!(teach.steps[0].duration_ms, 1000, "an arm's full travel");
    teach.update(key(KeyCode::Char('-')));
    assert_eq!(teach.steps[0].duration_ms, 950);
    teach.update(key(KeyCode::Char('u')));
    assert_eq!(teach.taught(), None);
    teach.update(key(KeyCode::Enter));
    assert_eq!(teach.taught(), None, "there was nothing to mark");
}

#[test]
fn presses_of_other_bumpers_mark_nothing() {
    let mut teach = teach();
    teach.update(state(0, [0; 6]));
    teach.update(key(KeyCode::Left));
    teach.update(state(1500, [1, 1, 1, 1, 0, 0]));
    assert!(teach.steps.is_empty());
    teach.update(state(1600, [1, 1, 1, 1, 0, 1]));
    assert_eq!(teach.steps.len(), 1);
}

#[test]
fn what_the_checker_refuses_is_not_saved_and_told() {
    let mut teach = greeting();
    teach.update(key(KeyCode::Enter));
    // The trunk back before it can have arrived.
    for _ in 0..9 {
        teach.update(key(KeyCode::Char('-')));
    }
    teach.update(key(KeyCode::Left));
    teach.update(key(KeyCode::Enter));
    assert!(teach.update(key(KeyCode::Char('w'))).is_empty());
    let picture = drawn(&teach, 100, 30);
    assert!(picture.contains("error[too-short]"), "{picture}");
    assert!(teach.taught().is_some_and(|(_, is_to_be_saved)| !is_to_be_saved));
    teach.update(key(KeyCode::Char('u')));
    assert_eq!(teach.update(key(KeyCode::Char('w'))), [Effect::Leave]);
    assert!(teach.taught().is_some_and(|(_, is_to_be_saved)| is_to_be_saved));
}

#[test]
fn leaving_asks_once_and_trying_plays_it() {
    let mut teach = greeting();
    assert!(teach.update(key(KeyCode::Char('q'))).is_empty());
    assert!(drawn(&teach, 80, 24).contains("not saved"));
    teach.update(key(KeyCode::Char('n')));
    let effects = teach.update(key(KeyCode::Char('t')));
    let [Effect::Play(action)] = effects.as_slice() else { panic!("it is played") };
    assert_eq!(action.steps.len(), 3);
    assert!(teach.update(key(KeyCode::Left)).is_empty(), "not while it is played");
    teach.update(Event::Told(Told::Ended { action: "greet".to_owned(), how: "done".to_owned() }));
    teach.update(key(KeyCode::Char('q')));
    assert_eq!(teach.update(key(KeyCode::Char('y'))), [Effect::Leave]);
    assert!(self::teach().update(key(KeyCode::Char('q'))) == [Effect::Leave], "nothing was taught");
}

#[test]
fn the_screen_is_the_one_of_the_manual() {
    let teach = greeting();
    let picture = drawn(&teach, 80, 22);
    let page = include_str!("../../../../../../../docs/screens.md");
    for line in picture.lines().map(|line| line.trim_matches('"').trim_end()) {
        assert!(page.contains(line), "docs/screens.md does not show:\n{picture}");
    }
}

proptest! {
    /// Whatever was pressed, space is STOP, the text can be read, and the screen can be drawn at any size.
    #[test]
    fn space_is_stop_and_the_text_is_always_one(
        keys in proptest::collection::vec(0..14_usize, 0..60), width in 1..120_u16, height in 1..60_u16,
    ) {
        let codes = [
            KeyCode::Up, KeyCode::Down, KeyCode::Left, KeyCode::Right, KeyCode::Enter, KeyCode::Char('u'),
            KeyCode::Char('+'), KeyCode::Char('-'), KeyCode::Char('t'), KeyCode::Char('w'), KeyCode::Char('q'),
            KeyCode::Char('?'), KeyCode::Esc, KeyCode::Char('n'),
        ];
        let mut teach = teach();
        for (index, time_ms) in keys.into_iter().zip((0..).step_by(130)) {
            teach.update(state(time_ms, [0; 6]));
            teach.update(key(codes[index]));
            drawn(&teach, width, height);
        }
        if let Some((text, _)) = teach.taught() {
            let checked = check_text(&text, &NoActions);
            prop_assert_eq!(checked.actions.len(), 1, "{}", text);
        }
        prop_assert_eq!(teach.update(key(KeyCode::Char(' '))), [Effect::Stop]);
    }
}
