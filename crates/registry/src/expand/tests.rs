use super::*;
use crate::check::{Rule, check_text};
use crate::compiled::Reaction;
use proptest::prelude::*;
use rsapien_protocol::{BumperMask, Step};

/// The last action of a text, compiled.
#[track_caller]
fn compiled(text: &str) -> CompiledAction {
    let checked = check_text(text, &NoActions);
    // Here joints need not arrive.
    let errors = checked.findings.errors().filter(|finding| finding.rule != Rule::TooShort).count();
    assert_eq!(errors, 0, "{}", checked.findings);
    checked.actions.into_iter().last().unwrap().compiled.unwrap()
}

/// Steps as they are written in short: `tilt-left:500 pause:20`.
fn short(steps: &[Step]) -> String {
    let text = |step: &Step| {
        let names: Vec<String> = step.pose.primitives().map(|it| it.to_string()).collect();
        let names = if names.is_empty() { "pause".to_owned() } else { names.join("+") };
        format!("{names}:{}", step.duration_ms)
    };
    steps.iter().map(text).collect::<Vec<_>>().join(" ")
}

#[test]
fn what_each_statement_becomes() {
    for (body, steps) in [
        ("do tilt-left + 1 for 650ms", "right-arm-up+tilt-left:650"),
        ("do right-hand-in", "right-hand-in:475"),
        ("do right-hand-in + left-arm-up", "left-arm-up+right-hand-in:1150"),
        ("wait 1.5s", "pause:1500"),
        ("repeat 2 { wait 1ms wait 2ms }", "pause:1 pause:2 pause:1 pause:2"),
        ("mirror { do tilt-left + left-leg-back for 9ms }", "tilt-right+right-leg-back:9"),
        ("mirror { mirror { do tilt-left for 9ms } }", "tilt-left:9"),
        ("speed 0.5 { wait 100ms speed 4 { wait 100ms } }", "pause:200 pause:50"),
        ("speed 0.5 { wait 65535ms }", "pause:65535 pause:65535"),
        ("speed 10 { wait 1ms }", "pause:1"),
        (
            "together { track { do tilt-left for 300ms do tilt-mid for 100ms } \
             track { wait 100ms do left-arm-up for 500ms } }",
            "tilt-left:100 left-arm-up:200 tilt-mid:100 pause:200",
        ),
        (
            "together { track { do 13 for 5ms } track { do 1 for 5ms } track { do 4 for 7ms } }",
            "right-arm-up+left-arm-up+tilt-left:5 pause:2",
        ),
    ] {
        let action = compiled(&format!("action a {{ {body} }}"));
        let written = short(&action.steps);
        // The order of primitives is the joints'.
        let normal = |text: &str| {
            let steps = text.split(' ').map(|step| {
                let (names, ms) = step.rsplit_once(':').unwrap();
                let mut names: Vec<&str> = names.split('+').collect();
                names.sort_unstable();
                format!("{}:{ms}", names.join("+"))
            });
            steps.collect::<Vec<_>>()
        };
        assert_eq!(normal(&written), normal(steps), "{body}");
        let sum: u64 = action.steps.iter().map(|step| u64::from(step.duration_ms)).sum();
        assert_eq!(action.duration_ms, sum, "{body}");
        assert_eq!(action.sources.len(), action.steps.len());
        assert_eq!(action.reactions.len(), action.steps.len());
    }
}

#[test]
fn an_action_that_is_played_takes_arguments_side_speed_and_repeats() {
    let text =
        "action nod(rounds = 1, to-side = 300ms) { repeat rounds { do tilt-left for to-side } }
                action a(n = 2) {
                    wait 1ms
                    play nod(rounds = n, to-side = 0.1s) mirrored at 2 times 2
                    play nod
                }";
    let action = compiled(text);
    let mirrored = ["tilt-right:50"; 4].join(" ");
    assert_eq!(short(&action.steps), format!("pause:1 {mirrored} tilt-left:300"));
    let source = &action.sources[2];
    assert_eq!((&*source.action, source.step, source.outer_step), ("nod", 1, 2));
    assert_eq!(action.sources[5].outer_step, 3);
}

#[test]
fn reactions_hold_to_the_end_of_their_block_and_in_what_is_played() {
    let text = "action back { do right-leg-back }
                action inner { wait 1ms on left-hand go-on wait 2ms }
                action a {
                    wait 3ms
                    on hands end
                    repeat 1 { on left-foot-front play back mirrored wait 4ms }
                    play inner
                    mirror { on left-hand go-on wait 5ms }
                }";
    let action = compiled(text);
    let ending: Vec<u8> = action.steps.iter().map(|step| step.ending_bumpers.bits()).collect();
    assert_eq!(ending, [0, 0x31, 0x30, 0x20, 0x10]);
    let front = BumperMask::from_low_bits(1);
    assert_eq!(action.reactions[1].to(front), Reaction::Play(0));
    assert_eq!(action.reactions[1].to(BumperMask::from_low_bits(0x30)), Reaction::End);
    assert_eq!(action.reactions[3].to(BumperMask::from_low_bits(0x10)), Reaction::GoOn);
    assert_eq!(short(&action.handlers[0].steps), "left-leg-back:700");
}

#[test]
fn waits_and_labels_stand_before_the_step_that_follows() {
    let text = "action a {
                    label begin
                    speed 0.5 { wait 40s }
                    label middle
                    mirror { wait for left-hand at most 2s else end }
                    wait 1ms
                    wait for any at most 1min
                    label finish
                }";
    let action = compiled(text);
    assert_eq!(short(&action.steps), "pause:65535 pause:14465 pause:1");
    let labels: Vec<(&str, usize)> =
        action.labels.iter().map(|label| (&*label.name, label.step)).collect();
    assert_eq!(labels, [("begin", 0), ("middle", 2), ("finish", 3)]);
    let waits: Vec<_> =
        action.waits.iter().map(|it| (it.before_step, it.bumpers.bits(), it.limit_ms)).collect();
    assert_eq!(waits, [(2, 0x20, 2000), (3, 0x3F, 60_000)]);
    assert_eq!(action.waits[0].otherwise, Reaction::End);
}

#[test]
fn options_choose_sides_speed_repeats_and_arguments() {
    let checked = check_text("action a(t = 10ms) { do tilt-left for t }", &NoActions);
    let draft = &checked.actions[0].parsed.draft;
    let arguments = vec![("t".to_owned(), Value::DurationMs(100))];
    let options = CompileOptions { times: 2, speed: 0.5, mirrored: true, arguments };
    let action = compile(draft, &NoActions, &options).unwrap();
    assert_eq!(short(&action.steps), "tilt-right:200 tilt-right:200");
    assert_eq!(action.sources[1].round, 2);
    let refused = |options| compile(draft, &NoActions, &options).unwrap_err().rule;
    let with = |name: &str, value| CompileOptions {
        arguments: vec![(name.to_owned(), value)],
        ..CompileOptions::default()
    };
    assert_eq!(refused(with("u", Value::count(1))), Rule::UnknownName);
    assert_eq!(refused(with("t", Value::count(1))), Rule::WrongKind);
    assert_eq!(refused(with("t", Value::DurationMs(0))), Rule::OutOfRange);
    assert_eq!(refused(CompileOptions { times: 0, ..CompileOptions::default() }), Rule::OutOfRange);
    for speed in [f64::NAN, 0.0, 0.09, 10.1] {
        assert_eq!(
            refused(CompileOptions { speed, ..CompileOptions::default() }),
            Rule::OutOfRange
        );
    }
}

#[test]
fn mistakes_are_told_with_their_rule_and_place() {
    for (text, rule, place) in [
        ("action a { do tilt-left + tilt-right }", Rule::JointTwoWays, "tilt-right"),
        ("action a { do 13 + tilt-left }", Rule::JointTwoWays, "tilt-left"),
        (
            "action a { together { track { do 13 } track { wait 1s  do 15 } } }",
            Rule::JointTwoWays,
            "do 15",
        ),
        ("action a { play b }", Rule::UnknownName, "b"),
        ("action a { play a }", Rule::Circle, "play a"),
        ("action b { play a } action a { on feet play b wait 1s }", Rule::Circle, "play a"),
        ("action a { repeat { do 1 } }", Rule::EndlessRepeat, "repeat"),
        ("action a { do 1 for 70s }", Rule::OutOfRange, "70s"),
        ("action a { do 1 for 3 }", Rule::WrongKind, "3"),
        ("action a(t = 3) { do 1 for t }", Rule::WrongKind, "t"),
        ("action a { do 1 for t }", Rule::UnknownName, "t"),
        ("action a { repeat 1.5 { do 1 } }", Rule::WrongKind, "1.5"),
        ("action a { repeat 0 { do 1 } }", Rule::OutOfRange, "0"),
        ("action a { speed 11 { do 1 } }", Rule::OutOfRange, "11"),
        (
            "action a { wait for any at most 2min wait for any at most 61min }",
            Rule::OutOfRange,
            "61min",
        ),
        ("action a { label x }", Rule::Empty, "a"),
        ("action a { wait 1s repeat 2 { label x } }", Rule::Empty, "repeat 2 { label x }"),
        ("action a { wait 1s together { } }", Rule::Empty, "together { }"),
        ("action a { together { track { on feet end do 1 } } }", Rule::Misplaced, "on feet end"),
        ("action a { wait 1s label x label x }", Rule::DefinedTwice, "x"),
        ("action a(n = 1, n = 2) { wait 1s }", Rule::DefinedTwice, "n"),
        ("action a { wait 1s } action a { wait 1s }", Rule::DefinedTwice, "a"),
        ("action a { tags x, x wait 1s }", Rule::DefinedTwice, "x"),
        ("action A { wait 1s }", Rule::BadName, "A"),
        ("action pause { wait 1s }", Rule::BadName, "pause"),
        ("action tilt-left { wait 1s }", Rule::BadName, "tilt-left"),
        ("action a { tags X wait 1s }", Rule::BadName, "X"),
        ("action b(n = 1) { wait 1s } action a { play b(m = 1) }", Rule::UnknownName, "m = 1"),
        ("action b(n = 1) { wait 1s } action a { play b(n = 1s) }", Rule::WrongKind, "n = 1s"),
        (
            "action b(n = 1) { repeat n { wait 1s } } action a { play b(n = 0) }",
            Rule::OutOfRange,
            "play b(n = 0)",
        ),
    ] {
        let checked = check_text(text, &NoActions);
        let finding = checked.findings.errors().next().unwrap_or_else(|| panic!("{text}"));
        let found = &text[finding.span.start..finding.span.end];
        assert_eq!((finding.rule, found), (rule, place), "{text}: {}", checked.findings);
        assert!(finding.help.is_some(), "{text}: {}", finding.message);
        assert!(finding.action.is_some(), "{text}");
    }
}

#[test]
fn what_would_take_too_long_is_refused_before_it_is_done() {
    let nested = |inner: &str, depth: usize| {
        let (open, close) = ("repeat 1000 { ".repeat(depth), "} ".repeat(depth));
        format!("action a {{ wait 1s {open}{inner} {close} }}")
    };
    // Every level plays the one below in two ways when a bumper is met.
    let mut ladder = vec!["action a0(n = 1) { wait 1s }".to_owned()];
    for level in 1..30 {
        let below = level - 1;
        ladder.push(format!(
            "action a{level}(n = 1) {{ on left-hand play a{below}(n = 2) on right-hand play a{below} wait 1s }}"
        ));
    }
    for text in
        [nested("wait 1ms", 3), nested("wait 65s", 2), nested("wait 1ms", 15), ladder.join("\n")]
    {
        let checked = check_text(&text, &NoActions);
        let rules: Vec<Rule> = checked.findings.errors().map(|finding| finding.rule).collect();
        assert!(rules.contains(&Rule::OutOfRange), "{rules:?}");
    }
}

proptest! {
    /// Side by side, each track does what it does alone, at the same times.
    #[test]
    fn tracks_do_not_change_each_other(
        left in proptest::collection::vec((0_u8..3, 1_u16..400), 1..6),
        right in proptest::collection::vec((0_u8..3, 1_u16..400), 1..6),
    ) {
        let body = |first: u8, steps: &[(u8, u16)]| -> String {
            let steps = steps.iter().map(|(at, ms)| format!("do {} for {ms}ms", first + at));
            steps.collect::<Vec<_>>().join(" ")
        };
        let (left, right) = (body(1, &left), body(13, &right));
        let both = compiled(&format!(
            "action a {{ together {{ track {{ {left} }} track {{ {right} }} }} }}"
        ));
        for text in [left, right] {
            let alone = compiled(&format!("action a {{ {text} }}"));
            let joints = alone.joints();
            let starts = |action: &CompiledAction| {
                let mut at_ms = 0_u64;
                let mut starts = Vec::new();
                for step in &action.steps {
                    for primitive in step.pose.primitives() {
                        if joints & (1 << primitive.joint().index()) != 0 {
                            starts.push((at_ms, primitive));
                        }
                    }
                    at_ms += u64::from(step.duration_ms);
                }
                starts
            };
            prop_assert_eq!(starts(&alone), starts(&both));
        }
    }
}
