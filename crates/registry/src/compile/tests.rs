use rsapien_protocol::{BumperMask, Joint, Position};

use super::*;
use crate::problem::Problem;

fn up() -> Pose {
    Pose::EMPTY.with(Joint::RightArm, Some(Position::First))
}

fn compiled(
    draft: &ActionDraft,
    played: &[ActionDraft],
    times: u16,
    speed: f64,
) -> Result<CompiledAction, RegistryError> {
    compile(draft, played, CompileOptions { times, speed })
}

fn problem(result: Result<CompiledAction, RegistryError>) -> Problem {
    match result {
        Err(RegistryError::Refused(Findings(mut findings))) => findings.remove(0).problem,
        other => panic!("{other:?}"),
    }
}

#[test]
fn steps_and_their_sources_in_order() {
    let nod = ActionDraft::new("nod", vec![ActionStep::moving(up(), 200), ActionStep::pause(100)]);
    let ending = ActionStep::Move {
        pose: Pose::MIDDLE,
        duration_ms: 50,
        ending_bumpers: BumperMask::FEET,
        times: 2,
    };
    let hello = ActionDraft::new("hello", vec![ending, ActionStep::play("nod", 2)]);
    let result = compiled(&hello, std::slice::from_ref(&nod), 2, 1.0).unwrap();

    let mut middle = Step::new(Pose::MIDDLE, 50);
    middle.ending_bumpers = BumperMask::FEET;
    let (raise, wait) = (Step::new(up(), 200), Step::new(Pose::EMPTY, 100));
    let once = [middle, middle, raise, wait, raise, wait];
    assert_eq!(result.steps, [once, once].concat());
    assert_eq!(result.duration_ms, 2 * (2 * 50 + 2 * 300));
    let sources: Vec<(&str, usize, usize, u16)> = result
        .sources
        .iter()
        .map(|source| (&*source.action, source.step, source.outer_step, source.round))
        .collect();
    let once = |round| {
        [
            ("hello", 1, 1, round),
            ("hello", 1, 1, round),
            ("nod", 1, 2, round),
            ("nod", 2, 2, round),
            ("nod", 1, 2, round),
            ("nod", 2, 2, round),
        ]
    };
    assert_eq!(sources, [once(1), once(2)].concat());
}

#[test]
fn speed_divides_and_rounds_to_at_least_a_millisecond() {
    for (ms, speed, expected) in
        [(3, 2.0, 2), (5, 2.0, 3), (4, 3.0, 1), (1, 10.0, 1), (1000, 0.5, 2000), (7, 1.0, 7)]
    {
        let draft = ActionDraft::new("a", vec![ActionStep::pause(ms)]);
        let result = compiled(&draft, &[], 1, speed).unwrap();
        assert_eq!(result.steps, [Step::new(Pose::EMPTY, expected)], "{ms} ms at {speed}");
        assert_eq!(result.duration_ms, u64::from(expected));
    }
}

#[test]
fn a_slow_long_step_waits_in_further_steps() {
    let draft = ActionDraft::new("a", vec![ActionStep::moving(up(), 65535)]);
    let result = compiled(&draft, &[], 1, 0.4).unwrap();
    // 65535 / 0.4 = 163837.5, rounded away from zero.
    let expected =
        [Step::new(up(), 65535), Step::new(Pose::EMPTY, 65535), Step::new(Pose::EMPTY, 32_768)];
    assert_eq!(result.steps, expected);
    assert_eq!(result.duration_ms, 163_838);
}

#[test]
fn options_out_of_range() {
    let draft = ActionDraft::new("a", vec![ActionStep::pause(1)]);
    for speed in [0.0, 0.099, 10.1, -1.0, f64::NAN, f64::INFINITY] {
        let result = compiled(&draft, &[], 1, speed);
        assert!(matches!(result, Err(RegistryError::BadSpeed { .. })), "{speed}");
    }
    for times in [0, 1001] {
        let result = compiled(&draft, &[], times, 1.0);
        assert!(matches!(result, Err(RegistryError::BadTimes { .. })), "{times}");
    }
    assert_eq!(compiled(&draft, &[], 1000, 10.0).unwrap().steps.len(), 1000);
}

#[test]
fn bounds_hold_before_anything_is_expanded() {
    let repeated = |name: &str, step: ActionStep, times: u16| match step {
        ActionStep::Play { action, .. } => {
            ActionDraft::new(name, vec![ActionStep::Play { action, times }])
        }
        ActionStep::Move { pose, duration_ms, ending_bumpers, .. } => {
            let step = ActionStep::Move { pose, duration_ms, ending_bumpers, times };
            ActionDraft::new(name, vec![step])
        }
    };
    // 1000 to the 30th steps: would never end if it were expanded.
    let mut played = vec![repeated("n1", ActionStep::pause(1), 1000)];
    for depth in 2..=30 {
        let below = ActionStep::play(format!("n{}", depth - 1), 1);
        played.push(repeated(&format!("n{depth}"), below, 1000));
    }
    let draft = repeated("top", ActionStep::play("n30", 1), 1);
    assert_eq!(
        problem(compiled(&draft, &played, 1, 1.0)),
        Problem::TooManyCompiledSteps { count: 1_000_000 }
    );

    let hundred = repeated("top", ActionStep::play("n1", 1), 100);
    assert_eq!(compiled(&hundred, &played[..1], 1, 1.0).unwrap().steps.len(), 100_000);
    assert_eq!(
        problem(compiled(&hundred, &played[..1], 2, 1.0)),
        Problem::TooManyCompiledSteps { count: 200_000 }
    );
    let minute = repeated("minute", ActionStep::pause(60_000), 1000);
    assert_eq!(
        problem(compiled(&minute, &[], 2, 1.0)),
        Problem::TooLong { duration_ms: 120_000_000 }
    );
}

#[test]
fn what_is_played_has_to_be_given() {
    let draft = ActionDraft::new("a", vec![ActionStep::pause(1), ActionStep::play("b", 1)]);
    let error = compiled(&draft, &[], 1, 1.0).unwrap_err();
    assert_eq!(error.to_string(), "action \"a\": step 2: plays \"b\", which is no action");
    let circle = ActionDraft::new("b", vec![ActionStep::play("a", 1)]);
    assert_eq!(
        problem(compiled(&draft, &[circle], 1, 1.0)),
        Problem::Cycle { path: ["a", "b", "a"].map(Into::into).into() }
    );
}
