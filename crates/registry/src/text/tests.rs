use rsapien_protocol::{BumperMask, Joint, Pose, Position};

use super::*;

fn findings(text: &str) -> Vec<String> {
    read_toml(text).unwrap_err().0.iter().map(ToString::to_string).collect()
}

/// The findings of an action of one step, in line 3.
fn step_findings(step: &str) -> Vec<String> {
    findings(&format!("[[action]]\nname = \"a\"\nsteps = [{step}]\n"))
}

#[test]
fn every_key_has_its_meaning() {
    let text = r#"
# A comment.
[[action]]
name = "wave"
description = "Waves."
tags = ["greeting"]
steps = [
  { do = "right-arm-up", ms = 900 },
  { do = ["tilt-left", 5], ms = 500, until = ["left-hand", "feet"], times = 2 },
  { do = "right_arm_up + 21", ms = 1 },
  { play = "nod", times = 2 },
  { pause = 300 },
]

[[action]]
name = "nod"
steps = [{ pause = 65535, until = "right-hand" }]
"#;
    let pose = |pairs: &[(Joint, Position)]| {
        pairs.iter().fold(Pose::EMPTY, |pose, (joint, position)| pose.with(*joint, Some(*position)))
    };
    let up = (Joint::RightArm, Position::First);
    let wave = ActionDraft {
        name: "wave".into(),
        description: "Waves.".into(),
        tags: vec!["greeting".into()],
        steps: vec![
            ActionStep::moving(pose(&[up]), 900),
            ActionStep::Move {
                pose: pose(&[(Joint::Tilt, Position::First), (Joint::LeftArm, Position::Middle)]),
                duration_ms: 500,
                ending_bumpers: BumperMask::from_low_bits(0b01_1111),
                times: 2,
            },
            ActionStep::moving(pose(&[up, (Joint::LeftLeg, Position::Last)]), 1),
            ActionStep::play("nod", 2),
            ActionStep::pause(300),
        ],
    };
    let nod = ActionDraft::new(
        "nod",
        vec![ActionStep::Move {
            pose: Pose::EMPTY,
            duration_ms: 65535,
            ending_bumpers: BumperMask::from_low_bits(0b10_0000),
            times: 1,
        }],
    );
    assert_eq!(read_toml(text).unwrap(), [wave, nod]);
}

#[test]
fn what_is_written_is_pleasant_to_read() {
    let text = r#"[[action]]
name = "wave"
description = 'Says "hi".'
tags = ["greeting", "arms"]
steps = [
  { do = ["left-arm-front", "tilt-left"], ms = 500, until = "feet", times = 2 },
  { play = "nod" },
  { pause = 300 },
]

[[action]]
name = "nod"
steps = [
  { do = "tilt-left", ms = 300, until = ["left-hand", "right-hand"] },
]
"#;
    let drafts = read_toml(text).unwrap();
    assert_eq!(write_toml(&drafts), text);
}

#[test]
fn every_mistake_in_a_step_is_told() {
    let place = "line 3: action \"a\": step 1: ";
    for (step, message) in [
        (
            "{ do = \"tilt-lefd\", ms = 5 }",
            "\"tilt-lefd\" is no motion primitive; did you mean \"tilt-left\"?",
        ),
        (
            "{ do = 22, ms = 5 }",
            "\"22\" is no motion primitive: write a joint and a position, such as right-arm-up, or a \
             number from 1 to 21; an action is put in with play",
        ),
        (
            "{ do = [], ms = 5 }",
            "a step has exactly one of do, pause and play, this one has an empty do",
        ),
        (
            "{ do = [\"tilt-left\", \"tilt-right\"], ms = 5 }",
            "tilt-left and tilt-right cannot run together: they move the same joint",
        ),
        ("{ do = [\"tilt-left\", 13], ms = 5 }", "tilt-left is given twice in one step"),
        ("{ do = \"tilt-left\", ms = 0 }", "a duration of 0 ms: a step lasts 1 to 65535 ms"),
        (
            "{ do = \"tilt-left\", ms = 65536 }",
            "a duration of 65536 ms: a step lasts 1 to 65535 ms",
        ),
        ("{ pause = -1 }", "a duration of -1 ms: a step lasts 1 to 65535 ms"),
        ("{ do = \"tilt-left\" }", "do needs ms, the duration of the step in milliseconds"),
        ("{ play = \"b\", times = 0 }", "0 times: a step is repeated 1 to 1000 times"),
        ("{ play = \"b\", times = 1001 }", "1001 times: a step is repeated 1 to 1000 times"),
        ("{ play = \"b\", ms = 5 }", "ms does not go with play"),
        ("{ play = \"b\", until = \"feet\" }", "until does not go with play"),
        ("{ pause = 5, ms = 5 }", "ms does not go with pause"),
        ("{ }", "a step has exactly one of do, pause and play, this one has none"),
        (
            "{ do = 1, play = \"b\", ms = 5 }",
            "a step has exactly one of do, pause and play, this one has do and play",
        ),
    ] {
        assert_eq!(step_findings(step), [format!("{place}{message}")], "{step}");
    }
    let bumper = step_findings("{ pause = 5, until = \"hand\" }");
    assert!(
        bumper[0].starts_with(&format!("{place}\"hand\" is no bumper: the bumpers are left-f"))
    );
}

#[test]
fn texts_of_another_form_are_told_with_their_line() {
    for (text, line, words) in [
        ("[[action]]\nname = \"a\n", 2, "string"),
        ("[[action]]\nname = \"a\"\nstep = []\n", 3, "unknown field `step`"),
        ("[[actions]]\nname = \"a\"\n", 1, "unknown field `actions`"),
        ("[[action]]\nname = \"a\"\n", 1, "missing field `steps`"),
        (
            "[[action]]\nname = \"a\"\nsteps = [\n  { pause = 5, speed = 2 },\n]\n",
            4,
            "unknown field `speed`",
        ),
        ("[[action]]\nname = \"a\"\nsteps = [{ pause = 1.5 }]\n", 3, "floating point"),
        (
            "[[action]]\nname = \"a\"\nsteps = [{ do = true, ms = 5 }]\n",
            3,
            "a name or a list of names",
        ),
        ("[[action]]\nname = \"a\"\nname = \"b\"\nsteps = []\n", 3, "duplicate"),
    ] {
        let found = findings(text);
        assert_eq!(found.len(), 1, "{text}");
        assert!(found[0].starts_with(&format!("line {line}: ")), "{text}: {found:?}");
        assert!(found[0].contains(words), "{text}: {found:?}");
    }
}

#[test]
fn all_mistakes_are_told_at_once() {
    let text = "[[action]]\nname = \"Wave\"\nsteps = [\n  { pause = 5 },\n  { pause = 0 },\n]\n\
                [[action]]\nname = \"a\"\nsteps = []\n\
                [[action]]\nname = \"a\"\nsteps = [{ pause = 5 }]\n";
    let places: Vec<(Option<usize>, Option<usize>)> =
        read_toml(text).unwrap_err().0.iter().map(|it| (it.line, it.step)).collect();
    assert_eq!(places, [(Some(2), None), (Some(5), Some(2)), (Some(8), None), (Some(11), None)]);
    assert_eq!(findings(text)[3], "line 11: action \"a\": \"a\" is defined twice, first in line 8");
}

#[test]
fn an_empty_text_has_no_actions() {
    assert_eq!(read_toml("# nothing\n").unwrap(), []);
    assert_eq!(write_toml(&[]), "");
}
