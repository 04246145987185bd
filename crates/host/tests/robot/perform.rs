//! Compiled actions: waits for bumpers, what is done when one is met, labels, pauses.

use rsapien::protocol::BumperMask;
use rsapien::registry::check::check_text;
use rsapien::registry::{CompiledAction, NoActions};
use rsapien::{
    CancelToken, Error, Interruption, Outcome, PauseSwitch, PlayOptions, PlayReport, Progress,
};

use crate::common::{Shared, interrupted, lock, motors_are_off, open_initialised};

const RIGHT_HAND: usize = 5;

/// The last action of a text.
fn compiled(text: &str) -> CompiledAction {
    let checked = check_text(text, &NoActions);
    let errors = checked.findings.errors().count();
    assert_eq!(errors, 0, "{}", checked.findings);
    checked.actions.into_iter().last().unwrap().compiled.unwrap()
}

/// Plays an action; `fault` is called whenever the player tells of its progress.
fn perform(
    text: &str,
    fault: impl Fn(&Progress, &rsapien::link::virtual_robot::SharedVirtualRobot) + Send + Sync,
) -> (PlayReport, Vec<Progress>) {
    let (_robot, shared, mut motion) = open_initialised();
    let seen: Shared<Progress> = Shared::default();
    let mut options = PlayOptions {
        on_progress: Some(Box::new(|progress| {
            seen.lock().unwrap().push(*progress);
            fault(progress, &shared);
        })),
        ..PlayOptions::default()
    };
    let report = motion.perform(&compiled(text), &mut options).unwrap();
    drop(options);
    assert!(motors_are_off(&shared), "{report}");
    let seen = seen.lock().unwrap().clone();
    (report, seen)
}

const SHAKE: &str = "action rest { do right-arm-down }
    action shake {
        do right-arm-front
        label waiting
        wait for right-hand at most 3s else play rest
        label shaking
        do right-hand-in
        do right-hand-open
    }";

#[test]
fn a_wait_ends_with_a_press_however_short_and_the_action_goes_on() {
    let (report, seen) = perform(SHAKE, |progress, shared| {
        if !progress.waiting_for.is_empty() {
            lock(shared).press_bumper(RIGHT_HAND, true);
            let until_ms = lock(shared).now_ms() + 30;
            lock(shared).advance_to(until_ms);
            lock(shared).press_bumper(RIGHT_HAND, false);
        }
    });
    assert_eq!(report.outcome, Outcome::Done, "{report}");
    assert_eq!((report.steps_ended, report.steps_total), (3, 3));
    assert!(report.elapsed_ms < 1150 + 3000, "it waited to the end: {report}");
    assert!(report.before.is_some() && report.evidence.unwrap().steps_ended >= 3);
    let labels: Vec<Option<usize>> = seen.iter().map(|progress| progress.label).collect();
    assert!(labels.contains(&None) && labels.contains(&Some(1)), "{labels:?}");
    assert!(seen.is_sorted_by_key(|progress| progress.steps_ended));
}

#[test]
fn a_wait_in_vain_plays_the_other_action_and_says_so() {
    let (report, _) = perform(SHAKE, |_, _| {});
    let hand = BumperMask::from_low_bits(1 << RIGHT_HAND);
    assert_eq!(report.outcome, interrupted(Interruption::WaitInVain(hand)));
    let reached = report.reached.as_ref().unwrap();
    assert_eq!((&*reached.source.action, reached.source.step), ("shake", 2));
    let instead = report.instead.as_ref().unwrap();
    assert_eq!((instead.action.as_str(), &instead.outcome), ("rest", &Outcome::Done));
    assert!(report.elapsed_ms >= 3000 + 2 * 1150, "{report}");
    assert!(report.to_string().contains("in vain for bumper right-hand"), "{report}");
}

#[test]
fn a_wait_in_vain_may_go_on_or_end() {
    let wait = |otherwise: &str| {
        format!("action a {{ wait for any at most 500ms {otherwise} do tilt-left }}")
    };
    let (report, _) = perform(&wait(""), |_, _| {});
    assert_eq!(report.outcome, Outcome::Done);
    let (report, _) = perform(&wait("else end"), |_, _| {});
    assert_eq!(report.outcome, interrupted(Interruption::WaitInVain(BumperMask::ALL)));
    assert_eq!((report.steps_ended, report.instead), (0, None));
}

#[test]
fn stop_during_a_wait_ends_it_and_nothing_is_played_after_it() {
    let (robot, shared, mut motion) = open_initialised();
    let stop = robot.stop_handle();
    let (ask, asked) = std::sync::mpsc::channel();
    let stopper = std::thread::spawn(move || {
        asked.recv().unwrap();
        stop.stop()
    });
    let mut options = PlayOptions {
        on_progress: Some(Box::new(move |progress| {
            if !progress.waiting_for.is_empty() {
                ask.send(()).unwrap();
                // The other thread's STOP is asked for before the player goes on.
                std::thread::sleep(std::time::Duration::from_millis(50));
            }
        })),
        ..PlayOptions::default()
    };
    let report = motion.perform(&compiled(SHAKE), &mut options).unwrap();
    stopper.join().unwrap().unwrap();
    assert_eq!(report.outcome, interrupted(Interruption::Stop), "{report}");
    assert_eq!(report.instead, None);
    assert!(motors_are_off(&shared));
}

const CAREFUL: &str = "action back { do left-leg-front do left-leg-mid }
    action walk {
        do tilt-left
        on left-foot-front play back
        on right-foot-front end
        do left-leg-back
        do tilt-mid
    }";

#[test]
fn a_bumper_that_is_met_plays_the_other_action_instead_of_the_rest() {
    let (report, _) = perform(CAREFUL, |progress, shared| {
        if progress.steps_ended == 1 {
            lock(shared).press_bumper(0, true);
        }
    });
    let toe = BumperMask::from_low_bits(1);
    assert_eq!(report.outcome, interrupted(Interruption::Bumper(toe)), "{report}");
    let reached = report.reached.as_ref().unwrap();
    assert_eq!((reached.number, reached.source.step), (2, 2));
    let instead = report.instead.unwrap();
    assert_eq!((instead.outcome, instead.steps_ended), (Outcome::Done, 2));
}

#[test]
fn a_bumper_without_a_reaction_does_nothing_and_another_ends() {
    let press = |index: usize| {
        perform(CAREFUL, move |progress, shared| {
            if progress.steps_ended == 1 {
                lock(shared).press_bumper(index, true);
            }
        })
        .0
    };
    assert_eq!(press(4).outcome, Outcome::Done);
    let ended = press(2);
    let toe = BumperMask::from_low_bits(1 << 2);
    assert_eq!((ended.outcome, ended.instead), (interrupted(Interruption::Bumper(toe)), None));
}

#[test]
fn an_action_is_played_from_a_label_on() {
    let (_robot, _shared, mut motion) = open_initialised();
    let action = compiled("action a { do tilt-left label half do tilt-mid do tilt-right }");
    let from =
        |label: &str| PlayOptions { from_label: Some(label.to_owned()), ..PlayOptions::default() };
    let report = motion.perform(&action, &mut from("half")).unwrap();
    assert_eq!((report.outcome, report.steps_ended, report.steps_total), (Outcome::Done, 2, 2));
    let error = motion.perform(&action, &mut from("third")).unwrap_err();
    assert!(matches!(error, Error::UnknownLabel { .. }) && error.to_string().contains("half"));
}

#[test]
fn a_pause_holds_at_the_end_of_a_step_until_it_is_resumed() {
    let (_robot, shared, mut motion) = open_initialised();
    let action = compiled("action a { repeat 3 { do tilt-left do tilt-right } }");
    let switch = PauseSwitch::new();
    let (pauser, resumer) = (switch.clone(), switch.clone());
    let paused_at: Shared<usize> = Shared::default();
    let mut options = PlayOptions {
        pause: Some(switch),
        on_progress: Some(Box::new(|progress| {
            if progress.steps_ended == 2 && !progress.is_paused {
                pauser.pause();
            }
            if progress.is_paused {
                assert!(motors_are_off(&shared));
                paused_at.lock().unwrap().push(progress.steps_ended);
                resumer.resume();
            }
        })),
        ..PlayOptions::default()
    };
    let report = motion.perform(&action, &mut options).unwrap();
    drop(options);
    assert_eq!((&report.outcome, report.steps_ended), (&Outcome::Done, 6), "{report}");
    let paused_at = paused_at.lock().unwrap();
    // The step under way and at most the one queued behind it.
    assert!(matches!(paused_at.as_slice(), [2..=4]), "{paused_at:?}");
}

#[test]
fn a_paused_action_can_be_cancelled() {
    let (_robot, shared, mut motion) = open_initialised();
    let (switch, cancel) = (PauseSwitch::new(), CancelToken::new());
    switch.pause();
    let token = cancel.clone();
    let mut options = PlayOptions {
        pause: Some(switch),
        cancel,
        on_progress: Some(Box::new(move |progress| {
            if progress.is_paused {
                token.cancel();
            }
        })),
        ..PlayOptions::default()
    };
    let report = motion.perform(&compiled("action a { do tilt-left }"), &mut options).unwrap();
    assert_eq!(report.outcome, interrupted(Interruption::Cancelled));
    assert_eq!(report.steps_ended, 0);
    assert!(motors_are_off(&shared));
}
