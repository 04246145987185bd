//! Several actions on one robot: who may play, and that each is told the truth about its own.

use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::{Scope, ScopedJoinHandle};

use rsapien::link::virtual_robot::SharedVirtualRobot;
use rsapien::protocol::{Joint, Mode, Position};
use rsapien::registry::check::check_text;
use rsapien::registry::{CompiledAction, NoActions};
use rsapien::{
    Admission, CancelToken, Error, Interruption, Outcome, PauseSwitch, PlayOptions, PlayReport,
    Policy, Progress, Robot, Stage, Terms,
};

use crate::common::{BreakableConnector, interrupted, lock, motors_are_off, open_initialised};

/// The last action of a text.
fn compiled(text: &str) -> CompiledAction {
    let checked = check_text(text, &NoActions);
    assert_eq!(checked.findings.errors().count(), 0, "{}", checked.findings);
    checked.actions.into_iter().last().unwrap().compiled.unwrap()
}

fn arms() -> CompiledAction {
    compiled(
        "action arms { repeat 4 { do right-arm-up + left-arm-up for 1200ms do right-arm-down + left-arm-down for 1200ms } }",
    )
}

fn lean() -> CompiledAction {
    compiled(
        "action lean { repeat 3 { do tilt-left for 700ms do tilt-right for 700ms } do tilt-mid }",
    )
}

fn hand() -> CompiledAction {
    compiled("action hand { do right-hand-in do right-arm-front }")
}

fn stage() -> (Robot, SharedVirtualRobot, Stage) {
    let (robot, shared, motion) = open_initialised();
    (robot, shared, Stage::new(motion).unwrap())
}

fn terms(policy: Policy) -> Terms {
    Terms { policy, guest: None }
}

/// An action that another thread plays; it stands before its first step until it is let go.
struct Played<'scope> {
    thread: ScopedJoinHandle<'scope, Result<PlayReport, Error>>,
    gate: PauseSwitch,
    cancel: CancelToken,
    progress: Receiver<Progress>,
}

impl Played<'_> {
    fn end(self) -> PlayReport {
        self.gate.resume();
        self.thread.join().unwrap().unwrap()
    }

    /// Waits until so many steps have ended.
    fn after(&self, steps_ended: usize) {
        self.gate.resume();
        while self.progress.recv().unwrap().steps_ended < steps_ended {}
    }

    fn waits_at_the_gate(&self) {
        while !self.progress.recv().unwrap().is_paused {}
    }
}

fn start<'scope>(
    scope: &'scope Scope<'scope, '_>,
    stage: &Stage,
    action: CompiledAction,
    policy: Policy,
    told: Sender<Admission>,
) -> Played<'scope> {
    let (gate, cancel, stage) = (PauseSwitch::new(), CancelToken::new(), stage.clone());
    gate.pause();
    let (tell, progress) = channel();
    let (pause, token) = (gate.clone(), cancel.clone());
    let thread = scope.spawn(move || {
        let mut options = PlayOptions {
            pause: Some(pause),
            cancel: token,
            on_progress: Some(Box::new(move |now| {
                let _ = tell.send(*now);
            })),
            ..PlayOptions::default()
        };
        stage.play(&action, &terms(policy), &mut options, &mut |admission| {
            told.send(admission.clone()).unwrap();
        })
    });
    Played { thread, gate, cancel, progress }
}

fn position(shared: &SharedVirtualRobot, joint: Joint) -> Option<Position> {
    lock(shared).motion_report().position(joint)
}

#[test]
fn actions_of_different_joints_go_on_side_by_side_and_each_takes_its_own_time() {
    let (_robot, shared, stage) = stage();
    let (tell, told) = channel();
    std::thread::scope(|scope| {
        let arms = start(scope, &stage, arms(), Policy::Refuse, tell.clone());
        assert_eq!(told.recv().unwrap(), Admission::Begins);
        arms.waits_at_the_gate();
        let lean = start(scope, &stage, lean(), Policy::Merge, tell);
        let Admission::Beside { others } = told.recv().unwrap() else { panic!("beside") };
        assert_eq!((others[0].action.as_str(), others[0].joints), ("arms", 0b11));
        lean.waits_at_the_gate();
        let (playing, waiting) = stage.claims();
        assert_eq!((playing.len(), waiting.len()), (2, 0));
        arms.gate.resume();
        lean.gate.resume();
        let begun_ms = lock(&shared).now_ms();
        let (lean, arms) = (lean.end(), arms.end());
        assert_eq!((&lean.outcome, lean.steps_ended), (&Outcome::Done, 7));
        assert_eq!((&arms.outcome, arms.steps_ended), (&Outcome::Done, 8));
        let both_ms = lock(&shared).now_ms() - begun_ms;
        // The longer of both, not their sum; and each step's place is kept, so little is added.
        assert!((9600..11_500).contains(&both_ms), "{both_ms} ms");
        assert_eq!((lean.pauses, arms.pauses), (0, 0), "the queue never ran dry");
    });
    assert_eq!(position(&shared, Joint::Tilt), Some(Position::Middle));
    assert_eq!(position(&shared, Joint::LeftArm), Some(Position::Last));
    assert!(stage.claims().0.is_empty());
}

#[test]
fn what_is_refused_is_told_who_has_which_joint_and_nothing_moves() {
    let (_robot, shared, stage) = stage();
    let (tell, _told) = channel();
    std::thread::scope(|scope| {
        let arms = start(scope, &stage, arms(), Policy::Refuse, tell);
        arms.waits_at_the_gate();
        let mut options = PlayOptions::default();
        let mut play = |action: CompiledAction, policy| {
            stage.play(&action, &terms(policy), &mut options, &mut |it| panic!("{it}")).unwrap_err()
        };
        let error = play(hand(), Policy::Merge);
        assert!(error.is_refusal());
        let text = error.to_string();
        assert!(
            text.contains("hand was not played: arms of test") && text.contains("right-arm"),
            "{text}"
        );
        assert!(
            matches!(play(lean(), Policy::Refuse), Error::Claimed { joints, .. } if joints.is_empty())
        );
        assert!(matches!(stage.alone("init", |_| Ok(())), Err(Error::Claimed { .. })));
        assert!(motors_are_off(&shared));
        assert!(arms.end().outcome.is_done());
    });
    assert!(stage.alone("init", rsapien::MotionController::init).is_ok());
}

#[test]
fn what_waits_begins_when_all_before_it_have_ended() {
    let (_robot, _shared, stage) = stage();
    let (tell, told) = channel();
    std::thread::scope(|scope| {
        let first = start(scope, &stage, arms(), Policy::Refuse, tell.clone());
        assert_eq!(told.recv().unwrap(), Admission::Begins);
        first.waits_at_the_gate();
        let second = start(scope, &stage, hand(), Policy::Queue, tell.clone());
        let Admission::Waits { behind } = told.recv().unwrap() else { panic!("it waits") };
        assert_eq!(behind.len(), 1);
        let third = start(scope, &stage, lean(), Policy::Queue, tell);
        let Admission::Waits { behind } = told.recv().unwrap() else { panic!("it waits") };
        assert_eq!(behind.len(), 2);
        third.cancel.cancel();
        let never = third.end();
        assert_eq!(never.outcome, interrupted(Interruption::Cancelled));
        assert_eq!((never.steps_accepted, never.before), (0, None));
        assert!(first.end().outcome.is_done());
        assert_eq!(told.recv().unwrap(), Admission::Begins);
        assert!(second.end().outcome.is_done());
    });
}

#[test]
fn what_replaces_ends_the_other_and_both_are_told() {
    let (_robot, shared, stage) = stage();
    let (tell, told) = channel();
    std::thread::scope(|scope| {
        let first = start(scope, &stage, arms(), Policy::Refuse, tell.clone());
        assert_eq!(told.recv().unwrap(), Admission::Begins);
        first.after(1);
        first.gate.pause();
        let second = start(scope, &stage, hand(), Policy::Replace, tell);
        let Admission::Replaces { ended } = told.recv().unwrap() else { panic!("it replaces") };
        assert_eq!(ended[0].action, "arms");
        let first = first.thread.join().unwrap().unwrap();
        assert_eq!(first.outcome, interrupted(Interruption::Replaced));
        assert!(first.steps_ended >= 1 && first.reached.is_some());
        assert!(second.end().outcome.is_done());
    });
    assert_eq!(position(&shared, Joint::RightArm), Some(Position::Middle));
}

#[test]
fn one_that_is_cancelled_ends_alone() {
    let (_robot, shared, stage) = stage();
    let (tell, _told) = channel();
    std::thread::scope(|scope| {
        let arms = start(scope, &stage, arms(), Policy::Refuse, tell.clone());
        arms.waits_at_the_gate();
        let lean = start(scope, &stage, lean(), Policy::Merge, tell);
        lean.waits_at_the_gate();
        arms.gate.resume();
        lean.after(1);
        lean.cancel.cancel();
        let lean = lean.end();
        assert_eq!(lean.outcome, interrupted(Interruption::Cancelled));
        let arms = arms.end();
        assert_eq!((&arms.outcome, arms.steps_ended), (&Outcome::Done, 8));
    });
    assert_eq!(position(&shared, Joint::LeftArm), Some(Position::Last));
    assert!(motors_are_off(&shared));
}

#[test]
fn one_that_is_paused_stands_while_the_other_goes_on() {
    let (_robot, _shared, stage) = stage();
    let (tell, _told) = channel();
    std::thread::scope(|scope| {
        let arms = start(scope, &stage, arms(), Policy::Refuse, tell.clone());
        arms.waits_at_the_gate();
        let lean = start(scope, &stage, lean(), Policy::Merge, tell);
        // Lean stands at its gate all the time.
        assert!(arms.end().outcome.is_done());
        lean.waits_at_the_gate();
        let lean = lean.end();
        assert_eq!((&lean.outcome, lean.steps_ended), (&Outcome::Done, 7));
    });
}

#[test]
fn stop_ends_everything_and_what_waits_is_not_begun() {
    let (robot, shared, stage) = stage();
    let (tell, _told) = channel();
    std::thread::scope(|scope| {
        let arms = start(scope, &stage, arms(), Policy::Refuse, tell.clone());
        arms.waits_at_the_gate();
        let lean = start(scope, &stage, lean(), Policy::Merge, tell.clone());
        lean.waits_at_the_gate();
        let (waits, told) = channel();
        let waiting = start(scope, &stage, hand(), Policy::Queue, waits);
        assert!(matches!(told.recv().unwrap(), Admission::Waits { .. }));
        robot.stop().unwrap();
        for played in [arms, lean, waiting] {
            assert_eq!(played.end().outcome, interrupted(Interruption::Stop));
        }
    });
    assert!(motors_are_off(&shared));
    assert_eq!(lock(&shared).motion_report().mode, Mode::Stopped);
}

#[test]
fn a_bumper_that_ends_one_ends_both_and_its_own_reaction_follows() {
    let (_robot, shared, stage) = stage();
    let (tell, _told) = channel();
    let careful = compiled(
        "action back { do tilt-right do tilt-mid }
         action careful { on left-hand play back repeat 5 { do tilt-left for 700ms do tilt-right for 700ms } }",
    );
    std::thread::scope(|scope| {
        let arms = start(scope, &stage, arms(), Policy::Refuse, tell.clone());
        arms.waits_at_the_gate();
        let careful = start(scope, &stage, careful, Policy::Merge, tell);
        careful.waits_at_the_gate();
        lock(&shared).press_bumper(4, true);
        arms.gate.resume();
        let careful = careful.end();
        assert!(
            matches!(careful.outcome, Outcome::Interrupted { by: Interruption::Bumper(mask) } if mask.contains(4))
        );
        assert_eq!(careful.instead.unwrap().outcome, Outcome::Done);
        let arms = arms.end();
        assert!(
            matches!(arms.outcome, Outcome::Interrupted { by: Interruption::Bumper(_) }),
            "{arms}"
        );
    });
}

#[test]
fn a_lost_link_is_told_to_each() {
    let (robot, shared, broken) = BreakableConnector::open();
    let mut motion = robot.motion().unwrap();
    motion.init().unwrap();
    let stage = Stage::new(motion).unwrap();
    let (tell, _told) = channel();
    std::thread::scope(|scope| {
        let arms = start(scope, &stage, arms(), Policy::Refuse, tell.clone());
        arms.waits_at_the_gate();
        let lean = start(scope, &stage, lean(), Policy::Merge, tell);
        lean.waits_at_the_gate();
        arms.gate.resume();
        lean.after(1);
        broken.store(true, Ordering::SeqCst);
        for played in [arms, lean] {
            assert_eq!(played.end().outcome, interrupted(Interruption::LinkLost));
        }
    });
    let until_ms = lock(&shared).now_ms() + 600;
    lock(&shared).advance_to(until_ms);
    assert!(motors_are_off(&shared), "the dead-man");
}

#[test]
fn a_stage_that_goes_lets_the_motion_controller_go() {
    let (robot, _shared, stage) = stage();
    assert!(matches!(robot.motion(), Err(Error::Held { .. })));
    drop(stage);
    assert!(robot.motion().is_ok());
}
