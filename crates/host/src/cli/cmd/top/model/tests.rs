use super::*;
use proptest::prelude::*;
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::crossterm::event::KeyModifiers;
use rsapien_protocol::{BumperMask, MotionReport, Position, StopCause};

use crate::Stamped;

fn top() -> Top {
    let named = |name: &str, description: &str| Named {
        name: name.to_owned(),
        description: description.to_owned(),
        duration_ms: 5000,
    };
    let actions = vec![
        named("bow", "Bows."),
        named("wave", "Waves with the right arm."),
        named("cheer", "Throws up the arms, as who waves at a friend."),
    ];
    let trips = Arc::new(Mutex::new(vec![8000; 30]));
    Top::new("/dev/ttyUSB0", actions, trips, Palette { is_colored: false })
}

fn report(mode: Mode) -> MotionReport {
    MotionReport {
        mode,
        bumpers: BumperMask::from_low_bits(0b10_0000),
        middle_switches: [true, false],
        presses: [0, 0, 3, 0, 0, 1],
        motors: 0b1,
        supply_low: false,
        pose_reached: Pose::MIDDLE.with(Joint::RightArm, None),
        queue_free: 31,
        steps_ended: 12,
        boot: 1,
        reception_errors: 0,
        cause: StopCause::PowerOn,
    }
}

fn state(mode: Mode) -> Event {
    let motion = Some(Stamped { time_ms: 100, report: report(mode) });
    Event::State(Box::new(RobotState { motion, ..RobotState::default() }), Vec::new())
}

fn key(code: KeyCode) -> Event {
    Event::Key(KeyEvent::new(code, KeyModifiers::NONE))
}

fn drawn(top: &Top, width: u16, height: u16) -> String {
    let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
    terminal.draw(|frame| top.draw(frame)).unwrap();
    terminal.backend().to_string()
}

#[test]
fn an_action_is_found_by_letters_and_played() {
    let mut top = top();
    assert!(top.update(key(KeyCode::Char('p'))).is_empty());
    for letter in "wav".chars() {
        top.update(key(KeyCode::Char(letter)));
    }
    let picture = drawn(&top, 80, 24);
    assert!(picture.contains("> wave") && picture.contains("  cheer"), "{picture}");
    assert!(!picture.contains("Bows."), "{picture}");
    assert_eq!(top.update(key(KeyCode::Enter)), [Effect::PlayNamed("wave".to_owned())]);
    assert_eq!(top.shown, Shown::Robot);
}

#[test]
fn joints_are_nudged_from_where_they_are_or_are_going() {
    let mut top = top();
    top.update(state(Mode::Idle));
    top.update(key(KeyCode::Down));
    assert_eq!(
        top.update(key(KeyCode::Left)),
        [Effect::Nudge(Joint::LeftArm, Position::First)],
        "it stands at its middle"
    );
    assert_eq!(top.update(key(KeyCode::Right)), [Effect::Nudge(Joint::LeftArm, Position::Middle)]);
    assert_eq!(top.update(key(KeyCode::Right)), [Effect::Nudge(Joint::LeftArm, Position::Last)]);
    assert_eq!(top.update(key(KeyCode::Right)), [Effect::Nudge(Joint::LeftArm, Position::Last)]);
}

#[test]
fn what_is_played_is_shown_paused_and_ended() {
    let mut top = top();
    let progress = Progress {
        steps_ended: 2,
        steps_total: 6,
        elapsed_ms: 1000,
        total_ms: 5000,
        label: None,
        waiting_for: BumperMask::NONE,
        is_paused: false,
        handler: None,
    };
    assert!(top.update(key(KeyCode::Char('r'))).is_empty(), "nothing is played");
    top.update(Event::Told(Told::Progress { action: "wave".to_owned(), progress }));
    assert_eq!(top.update(key(KeyCode::Char('r'))), [Effect::Pause(true)]);
    assert!(drawn(&top, 80, 24).contains("wave (paused): step 2 of 6"));
    assert_eq!(top.update(key(KeyCode::Char('r'))), [Effect::Pause(false)]);
    assert_eq!(top.update(key(KeyCode::Esc)), [Effect::End]);
    top.update(Event::Told(Told::Ended {
        action: "wave".to_owned(),
        how: "interrupted".to_owned(),
    }));
    assert!(top.playing.is_none() && drawn(&top, 80, 24).contains("wave: interrupted"));
}

#[test]
fn the_screen_shows_the_robot_and_is_the_one_of_the_manual() {
    let mut top = top();
    top.update(state(Mode::Executing));
    top.update(key(KeyCode::Right));
    top.remark("wave: done (6 of 6 steps, 5.0 s)");
    let picture = drawn(&top, 80, 24);
    let page = include_str!("../../../../../../../docs/screens.md");
    for line in picture.lines().map(|line| line.trim_matches('"').trim_end()) {
        assert!(page.contains(line), "docs/screens.md does not show:\n{picture}");
    }
    let small = drawn(&top, 40, 10);
    assert!(small.contains("78 columns") && small.contains("is STOP, q leaves"), "{small}");
}

proptest! {
    /// Whatever was typed before, space is STOP, and nothing is asked for together with it; and whatever was typed can
    /// be drawn, at any size.
    #[test]
    fn space_is_stop_whatever_is_shown(
        keys in proptest::collection::vec(0..13_usize, 0..40), width in 1..120_u16, height in 1..60_u16,
    ) {
        let codes = [
            KeyCode::Char('p'), KeyCode::Char('r'), KeyCode::Char('e'), KeyCode::Char('i'), KeyCode::Char('?'),
            KeyCode::Char('w'), KeyCode::Enter, KeyCode::Esc, KeyCode::Up, KeyCode::Down, KeyCode::Left,
            KeyCode::Right, KeyCode::Backspace,
        ];
        let mut top = top();
        for index in keys {
            top.update(key(codes[index]));
            drawn(&top, width, height);
        }
        prop_assert_eq!(top.update(key(KeyCode::Char(' '))), [Effect::Stop]);
    }
}
