use super::*;
use crate::language::{
    Quantity, Response, Statement, StatementKind, Value, print_action, print_actions,
};
use proptest::prelude::*;

const WHOLE: &str = r#"# Two lines
# above.
action greet(rounds = 2, up-for = 1150ms, tempo = 0.8) {
    description "Waves \"hello\"."
    tags greeting, arms
    allow arms-meet-trunk "tried on the robot"
    on feet end
    on left-hand, right-foot-back play step-back mirrored
    label up
    do right-arm-up + right-hand-open for up-for
    repeat rounds { do 2 for 650ms  do right-arm-up }
    together {
        track { do tilt-left for 575ms }
        track { do left-arm-up for 1.5s }
    }
    mirror { play nod }  # here, too
    speed tempo { play wave(rounds = 3, tempo = tempo) mirrored at 0.8 times rounds }
    wait 300ms
    wait for right-hand at most 10s else end
    wait for any at most 2min
}
action nod { do tilt-left }
"#;

#[test]
fn every_statement_is_read_and_printed_the_same() {
    let parsed = parse_text(WHOLE);
    assert_eq!(parsed.findings, []);
    let [greet, nod] = parsed.actions.as_slice() else { panic!("{parsed:?}") };
    assert!(WHOLE[greet.span.start..greet.span.end].starts_with("# Two lines"));
    assert_eq!(&WHOLE[nod.span.start..nod.span.end], "action nod { do tilt-left }");
    assert_eq!(greet.draft.body.len(), 11);
    assert_eq!(greet.draft.parameters[2].default, Value::Thousandths(800));
    let StatementKind::WaitFor { limit, otherwise, .. } = &greet.draft.body[9].kind else {
        panic!("{:?}", greet.draft.body[9])
    };
    assert_eq!((limit, otherwise), (&Quantity::duration_ms(10_000), &Response::End));
    let printed = print_actions(parsed.actions.iter().map(|action| &action.draft));
    let again = parse_text(&printed);
    assert_eq!(again.findings, [], "{printed}");
    for (first, second) in parsed.actions.iter().zip(&again.actions) {
        assert_eq!(first.draft, second.draft);
        assert_eq!(print_action(&first.draft), print_action(&second.draft));
    }
}

#[track_caller]
fn first_finding(text: &str) -> (Rule, String, String) {
    let parsed = parse_text(text);
    let finding = parsed.findings.first().unwrap_or_else(|| panic!("nothing found in {text}"));
    let place = text[finding.span.start..finding.span.end].to_owned();
    (finding.rule, place, finding.help.clone().unwrap_or_default().into())
}

#[test]
fn mistakes_are_told_with_their_place_and_a_way_out() {
    for (text, rule, place, help) in [
        ("do tilt-left", Rule::Syntax, "do", "action NAME"),
        ("action { }", Rule::Syntax, "{", "action wave"),
        ("action a { tilt-left }", Rule::Syntax, "tilt-left", "do tilt-left"),
        ("action a { wiat 3s }", Rule::Syntax, "wiat", "`wait`"),
        ("action a { pause 3s }", Rule::Syntax, "pause", "wait 300ms"),
        ("action a { do tilt-lefd }", Rule::UnknownName, "tilt-lefd", "`tilt-left`"),
        ("action a { do wave }", Rule::UnknownName, "wave", "play"),
        ("action a { do 22 }", Rule::UnknownName, "22", "1 to 21"),
        ("action a { on foot end }", Rule::UnknownName, "foot", "feet"),
        ("action a { on feet stop }", Rule::Syntax, "stop", "on feet end"),
        ("action a { wait 3 }", Rule::Syntax, "", ""),
        ("action a { wait 3h }", Rule::Syntax, "3h", "1.5s"),
        ("action a { wait 0.5ms }", Rule::OutOfRange, "0.5ms", "650ms"),
        ("action a { wait for feet }", Rule::Syntax, "}", "at most"),
        ("action a { play b(c) }", Rule::Syntax, ")", "rounds = 3"),
        ("action a { play b times 2 times 3 }", Rule::Syntax, "times", "once"),
        ("action a { repeat 2 do tilt-left }", Rule::Syntax, "do", "`{`"),
        ("action a { do tilt-left", Rule::Syntax, "a", "`}`"),
        ("action a { repeat 2 { do tilt-left", Rule::Syntax, "{", "`}`"),
        ("action a { description \"open\n }", Rule::Syntax, "\"open", "Waves"),
        ("action a { mirror { tags x } }", Rule::Misplaced, "tags", "before"),
        ("action a { together { do tilt-left } }", Rule::Syntax, "do", "track"),
        ("action a { do tilt-left; }", Rule::Syntax, ";", "begins with"),
    ] {
        // A number without a unit is read; the checker tells that it is no time.
        if place.is_empty() {
            assert_eq!(parse_text(text).findings, []);
            continue;
        }
        let (found_rule, found_place, found_help) = first_finding(text);
        assert_eq!((found_rule, found_place.as_str()), (rule, place), "{text}: {found_help}");
        assert!(found_help.contains(help), "{text}: {found_help}");
    }
}

#[test]
fn a_mistake_does_not_hide_the_next_nor_what_is_right() {
    let text = "action a { do tilt-lefd for 3s  play 5  repeat 2 { wiat 1s  do tilt-mid }  wait 1s }\n\
                nonsense { action } \naction b { do tilt-mid }";
    let parsed = parse_text(text);
    assert_eq!(parsed.findings.len(), 4, "{:?}", parsed.findings);
    assert_eq!(parsed.actions.len(), 2);
    assert_eq!(parsed.actions[0].draft.body.len(), 3);
    assert_eq!(parsed.actions[1].draft.name.text, "b");
}

#[test]
fn blocks_without_end_do_not_exhaust_the_stack() {
    let text = format!("action a {{ {}", "mirror { ".repeat(100_000));
    assert!(parse_text(&text).findings.iter().any(|finding| finding.rule == Rule::OutOfRange));
}

proptest! {
    #[test]
    fn no_text_makes_the_parser_fail_and_places_are_within(text in "\\PC{0,200}") {
        check_places(&text);
    }

    #[test]
    fn no_row_of_words_makes_the_parser_fail(words in proptest::collection::vec(word(), 0..60)) {
        let text = format!("action a {{ {} }}", words.join(" "));
        check_places(&text);
        let parsed = parse_text(&text);
        for action in parsed.actions.iter().filter(|_| parsed.findings.is_empty()) {
            let printed = print_action(&action.draft);
            let again = parse_text(&printed);
            prop_assert_eq!(again.findings, vec![], "{}", printed);
            prop_assert_eq!(&again.actions[0].draft, &action.draft, "{}", printed);
        }
    }
}

fn check_places(text: &str) {
    let parsed = parse_text(text);
    for finding in &parsed.findings {
        assert!(text.get(finding.span.start..finding.span.end).is_some(), "{finding:?}");
    }
    for action in &parsed.actions {
        assert!(text.get(action.span.start..action.span.end).is_some());
        action.draft.visit(&mut |statement: &Statement| {
            assert!(text.get(statement.span.start..statement.span.end).is_some());
        });
    }
}

fn word() -> impl Strategy<Value = &'static str> {
    proptest::sample::select(vec![
        "do",
        "wait",
        "for",
        "at",
        "most",
        "else",
        "end",
        "go-on",
        "play",
        "wave",
        "mirrored",
        "times",
        "repeat",
        "mirror",
        "speed",
        "together",
        "track",
        "on",
        "feet",
        "left-hand",
        "label",
        "description",
        "tags",
        "allow",
        "too-short",
        "\"a \\\"b\"",
        "tilt-left",
        "right-arm-up",
        "13",
        "2",
        "0.8",
        "650ms",
        "1.5s",
        "{",
        "}",
        "(",
        ")",
        "=",
        ",",
        "+",
        "#",
        "rounds",
        "\n",
    ])
}
