use super::*;
use crate::check::check_text;
use crate::expand::NoActions;
use proptest::prelude::*;

fn compiled(body: &str) -> CompiledAction {
    let text = format!("action a {{ allow too-short \"a test\" {body} }}");
    let checked = check_text(&text, &NoActions);
    checked.actions[0].compiled.clone().expect(&text)
}

#[test]
fn a_wave_in_a_terminal() {
    let wave = compiled(
        "do right-arm-up + right-hand-open for 1150ms label waving on left-hand end
         repeat 2 { do right-arm-front for 650ms do right-arm-up for 700ms }
         wait for right-hand at most 3s do right-arm-down + right-hand-mid for 1150ms",
    );
    let text = Timeline::of(&wave).to_text(60, false);
    let beginning = "           |0 s     |1 s      |2 s      |3 s      |4 s
                      ┌waving
right-arm  △△△△△△△up··▼▼▼▼▼▼▲▲▲▲▲▲▲▼▼▼▼▼▼▲▲▲▲▲▲▲┆▼▼▼▼▼▼▼▼▼▼▼
left-arm   ·····································┆···········
right-hand ▷▷▷open······························┆◀◀mid······
";
    assert!(text.starts_with(beginning), "{text}");
    assert!(text.contains("waits for right-hand, at most 3 s"), "{text}");
    assert!(text.contains("━ here left-hand end it"), "{text}");
    assert!(Timeline::of(&wave).to_text(60, true).contains("\x1b[34m△"));
}

#[test]
fn a_picture_is_xml_and_says_what_is_in_it() {
    let action = compiled(
        "do tilt-left label \u{61}-flag wait for any at most 2min on feet end do tilt-right",
    );
    let options = SvgOptions {
        title: "A <title> & more".into(),
        description: "\"quoted\" \u{1} \u{ffff}".into(),
        ..SvgOptions::default()
    };
    let svg = Timeline::of(&action).to_svg(&options);
    assert!(svg.contains("A &lt;title&gt; &amp; more") && !svg.contains('\u{1}'), "{svg}");
    assert!(svg.contains("tilt to left, 0 ms to 250 ms") && svg.contains("a-flag"), "{svg}");
    assert!(svg.contains("at most 2 min"), "{svg}");
    assert_eq!(svg, Timeline::of(&action).to_svg(&options));
    balanced(&svg);
}

/// Every element is closed.
#[track_caller]
fn balanced(svg: &str) {
    let mut open: Vec<&str> = Vec::new();
    for part in svg.split('<').skip(1) {
        let (tag, _) = part.split_once('>').expect(part);
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name), "{tag}");
        } else if !tag.ends_with('/') {
            open.push(tag.split_whitespace().next().unwrap_or(tag));
        }
    }
    assert!(open.is_empty(), "{open:?}");
}

#[test]
fn differences_are_told_by_joint_and_time() {
    let first = compiled("do tilt-left for 500ms do 1 + 4 for 1s wait 100ms do tilt-mid for 300ms");
    let second = compiled(
        "do tilt-left for 500ms do left-leg-front for 700ms do 1 + 5 for 1s wait 200ms do tilt-mid for 300ms",
    );
    let told = Difference::between(&first, &second).to_string();
    assert!(told.contains("-> back") || told.contains("left-arm"), "{told}");
    assert!(told.contains("4 steps, 1.900 s") && told.contains("5 steps, 2.700 s"), "{told}");
    assert!(Difference::between(&first, &first).is_empty());
    assert_eq!(Difference::between(&first, &first).to_string(), "a and a do the same");
    let inserted = compiled(
        "do tilt-left for 500ms wait 9ms do 1 + 4 for 1s wait 100ms do tilt-mid for 300ms",
    );
    let told = Difference::between(&first, &inserted);
    assert_eq!(told.changes.len(), 1, "{told}");
    assert!(told.to_string().ends_with("+ 0.500 s  wait for 9 ms"), "{told}");
    let other =
        compiled("do tilt-right for 500ms do 1 + 4 for 1s wait 100ms do tilt-mid for 250ms");
    let told = Difference::between(&first, &other).to_string();
    assert!(told.contains("~ 0.000 s  tilt: left -> right"), "{told}");
    assert!(told.contains("~ 1.600 s  lasts 300 ms -> 250 ms"), "{told}");
}

#[test]
fn the_bumpers_that_only_one_of_two_actions_ends_at_are_named() {
    let step = |bits| {
        let mut action = compiled("do right-arm-up for 500ms");
        action.steps[0].ending_bumpers = BumperMask::from_bits(bits).unwrap();
        action
    };
    let difference = Difference::between(&step(0b01_0001), &step(0b11_0010));
    assert_eq!(
        difference.changes[0].to_string(),
        "~ 0.000 s  bumpers that end it: +left-foot-back +right-hand -left-foot-front"
    );
    assert_eq!(difference.changes.len(), 1);
    assert!(Difference::between(&step(0b01_0001), &step(0b01_0001)).is_empty());
}

proptest! {
    #[test]
    fn rows_have_the_width_asked_for_and_pictures_are_whole(
        steps in proptest::collection::vec((1_u8..=21, 1_u16..3000), 1..40),
        width in 0_usize..220,
    ) {
        let body: Vec<String> =
            steps.iter().map(|(number, ms)| format!("do {number} for {ms}ms")).collect();
        let timeline = Timeline::of(&compiled(&body.join(" ")));
        let text = timeline.to_text(width, false);
        let rows: Vec<&str> = text
            .lines()
            .filter(|line| Joint::ALL.iter().any(|joint| line.starts_with(joint.name())))
            .collect();
        prop_assert_eq!(rows.len(), 7);
        for row in rows {
            prop_assert_eq!(row.chars().count(), width.max(40), "{}", text);
        }
        balanced(&timeline.to_svg(&SvgOptions::default()));
    }

    /// Backwards, what was added is removed, and the other way round.
    #[test]
    fn differences_are_the_same_from_both_sides(
        first in proptest::collection::vec((1_u8..=21, 1_u16..3), 0..12),
        second in proptest::collection::vec((1_u8..=21, 1_u16..3), 0..12),
    ) {
        let action = |steps: &[(u8, u16)]| {
            let steps = steps.iter().map(|(number, ms)| format!("do {number} for {ms}ms"));
            compiled(&format!("wait 1ms {}", steps.collect::<Vec<_>>().join(" ")))
        };
        let (first, second) = (action(&first), action(&second));
        let forth = Difference::between(&first, &second);
        let back = Difference::between(&second, &first);
        prop_assert_eq!(forth.is_empty(), first.steps == second.steps);
        let count = |changes: &[Change], wanted: fn(&Change) -> bool| {
            changes.iter().filter(|change| wanted(change)).count()
        };
        let added = |it: &Difference| count(&it.changes, |it| matches!(it, Change::Added { .. }));
        let removed = |it: &Difference| count(&it.changes, |it| matches!(it, Change::Removed { .. }));
        prop_assert_eq!(first.steps.len() + added(&forth), second.steps.len() + removed(&forth));
        prop_assert_eq!(second.steps.len() + added(&back), first.steps.len() + removed(&back));
    }
}

#[test]
fn a_bar_shows_in_every_row_where_the_action_is() {
    let checked = crate::check::check_text(
        "action a { do right-arm-up for 1s do right-arm-down for 1s }",
        &crate::NoActions,
    );
    let timeline = Timeline::of(checked.actions[0].compiled.as_ref().unwrap());
    let bars = |now_ms| -> Vec<usize> {
        let text = timeline.to_text_at(60, false, now_ms);
        text.lines().filter_map(|line| line.chars().position(|letter| letter == '┃')).collect()
    };
    assert!(bars(None).is_empty());
    let (early, late) = (bars(Some(0)), bars(Some(1_000_000)));
    assert_eq!((early, late), (vec![11; 7], vec![59; 7]));
}
