//! Whatever can be written comes back the same from text and from the database.

use proptest::prelude::*;
use rsapien_protocol::{BumperMask, Pose};
use rsapien_registry::language::{
    Parameter, Play, Quantity, Response, Span, StatementKind, Track, Value, Word,
};
use rsapien_registry::{
    ActionDraft, ImportPolicy, Registry, RegistryError, Statement, Trials, parse_text,
    print_action, print_actions,
};

fn duration() -> impl Strategy<Value = Quantity> {
    prop_oneof![
        3 => (1..=u32::from(u16::MAX)).prop_map(Quantity::duration_ms),
        1 => Just(Quantity::Parameter(Word::new("some-time"))),
    ]
}

fn count() -> impl Strategy<Value = Quantity> {
    prop_oneof![
        3 => (1..=2_u32).prop_map(Quantity::count),
        1 => Just(Quantity::Parameter(Word::new("some-count"))),
    ]
}

fn speed() -> impl Strategy<Value = Quantity> {
    (100..=10_000_u32).prop_map(Quantity::thousandths)
}

/// How one of the actions `n0`, `n1` and so on is played, as many as there are before.
fn play(before: usize) -> impl Strategy<Value = Play> {
    let arguments = prop::option::of((1..=3_u32).prop_map(Quantity::count));
    (0..before, arguments, any::<bool>(), prop::option::of(speed()), prop::option::of(count()))
        .prop_map(|(n, argument, mirrored, speed, times)| Play {
            action: Word::new(format!("n{n}")),
            arguments: argument.map(|value| (Word::new("some-count"), value)).into_iter().collect(),
            mirrored,
            speed,
            times,
        })
}

fn response(before: usize) -> BoxedStrategy<Response> {
    let plain = prop_oneof![Just(Response::GoOn), Just(Response::End)];
    if before == 0 {
        return plain.boxed();
    }
    prop_oneof![2 => plain, 1 => play(before).prop_map(Response::Play)].boxed()
}

fn bumpers() -> impl Strategy<Value = BumperMask> {
    (1..64_u8).prop_map(BumperMask::from_low_bits)
}

fn statements(before: usize) -> impl Strategy<Value = Vec<Statement>> {
    let moving = (1..0x4000_u16, prop::option::of(duration())).prop_map(|(word, duration)| {
        // Not every word has a joint that is sent somewhere.
        let pose = Pose::from_word(word | 1).unwrap();
        let primitives = pose.primitives().map(|it| (it, Span::default())).collect();
        StatementKind::Do { primitives, duration }
    });
    let waiting = duration().prop_map(|duration| StatementKind::Wait { duration });
    let playing = if before == 0 {
        waiting.boxed()
    } else {
        prop_oneof![waiting, play(before).prop_map(StatementKind::Play)].boxed()
    };
    let watching = (bumpers(), 1..=3_600_000_u32, response(before)).prop_map(
        |(bumpers, limit_ms, otherwise)| StatementKind::WaitFor {
            bumpers,
            limit: Quantity::duration_ms(limit_ms),
            otherwise,
        },
    );
    let reacting = (bumpers(), response(before))
        .prop_map(|(bumpers, response)| StatementKind::On { bumpers, response });
    let leaf = prop_oneof![4 => moving, 2 => playing, 1 => watching, 1 => reacting];
    let leaf = leaf.prop_map(Statement::from).boxed();
    let statement = leaf.prop_recursive(3, 12, 3, |inner| {
        let block = || prop::collection::vec(inner.clone(), 1..3).prop_map(with_a_step);
        prop_oneof![
            (count(), block())
                .prop_map(|(count, body)| StatementKind::Repeat { count: Some(count), body }),
            block().prop_map(|body| StatementKind::Mirror { body }),
            (speed(), block()).prop_map(|(factor, body)| StatementKind::Speed { factor, body }),
            duration().prop_map(|duration| StatementKind::Together {
                tracks: vec![Track {
                    body: vec![StatementKind::Wait { duration }.into()],
                    span: Span::default()
                }]
            }),
        ]
        .prop_map(Statement::from)
    });
    prop::collection::vec(statement, 1..4).prop_map(with_a_step)
}

/// A block that has a step in any case.
fn with_a_step(mut body: Vec<Statement>) -> Vec<Statement> {
    body.push(Statement::wait(5));
    body
}

fn drafts() -> impl Strategy<Value = Vec<ActionDraft>> {
    let texts =
        || (any::<String>(), prop::collection::btree_set("[a-z0-9]([a-z0-9-]?[a-z0-9])?", 0..4));
    (1..5_usize)
        .prop_flat_map(move |count| {
            (0..count).map(|index| (texts(), statements(index))).collect::<Vec<_>>()
        })
        .prop_map(|parts| {
            let parameter = |name: &str, default| Parameter {
                name: Word::new(name),
                default,
                span: Span::default(),
            };
            let draft = |(index, ((description, tags), body)): (usize, Part)| ActionDraft {
                name: Word::new(format!("n{index}")),
                parameters: vec![
                    parameter("some-time", Value::DurationMs(300)),
                    parameter("some-count", Value::count(2)),
                ],
                description,
                tags: tags.into_iter().map(Word::new).collect(),
                allowances: Vec::new(),
                body,
            };
            (0_usize..).zip(parts).map(draft).collect()
        })
}

/// Description and tags, and the statements.
type Part = ((String, std::collections::BTreeSet<String>), Vec<Statement>);

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn through_text(drafts in drafts()) {
        let text = print_actions(&drafts);
        let parsed = parse_text(&text).into_actions(&text).map_err(|it| TestCaseError::fail(it.to_string()))?;
        let again: Vec<ActionDraft> = parsed.into_iter().map(|action| action.draft).collect();
        prop_assert_eq!(again, drafts, "{}", text);
    }

    #[test]
    fn through_the_database(drafts in drafts()) {
        // In reverse, so that every action plays only those that stand behind it, with a comment each.
        let comment = |draft: &ActionDraft| format!("# why {}\n{}", draft.name.text, print_action(draft));
        let text = drafts.iter().rev().map(comment).collect::<Vec<_>>().join("\n\n");
        let mut registry = Registry::open_in_memory().unwrap();
        match registry.import_text(&text, ImportPolicy::Refuse, &Trials::new()) {
            Ok(_) => {
                for draft in &drafts {
                    let action = registry.get(&draft.name.text).unwrap();
                    let stored = action.draft();
                    prop_assert_eq!(stored.as_ref(), Some(draft));
                    prop_assert_eq!(action.text + "\n", comment(draft));
                }
                let exported = registry.export_all_text().unwrap();
                let again = registry.import_text(&exported, ImportPolicy::Refuse, &Trials::new());
                let report = again.unwrap();
                prop_assert!(report.added.is_empty() && report.replaced.is_empty());
                prop_assert_eq!(registry.integrity().unwrap().problems, vec![]);
            }
            // Durations may sum up to more than a day, and joints may be sent on too soon.
            Err(RegistryError::Refused(findings)) => {
                for finding in findings.errors() {
                    let rule = finding.rule.name();
                    prop_assert!(["out-of-range", "too-short"].contains(&rule), "{}\n{}", findings, text);
                }
            }
            Err(other) => return Err(TestCaseError::fail(other.to_string())),
        }
    }

    #[test]
    fn short_forms_never_panic(step in "[a-z0-9:*+ -]{0,20}|(tilt-left|21|pause)[:*+][0-9a-z:*+-]{0,8}") {
        if let Ok(step) = Statement::parse_short(&step) {
            let text = print_action(&ActionDraft::new("a", vec![step.clone()]));
            let parsed = parse_text(&text);
            prop_assert!(parsed.findings.is_empty(), "{}", text);
            prop_assert_eq!(&parsed.actions[0].draft.body[0], &step);
        }
    }
}
