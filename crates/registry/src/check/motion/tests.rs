use crate::check::{Finding, Rule, check_text};
use crate::expand::NoActions;

fn findings(body: &str) -> Vec<Finding> {
    let text = format!("action a {{ {body} }}");
    check_text(&text, &NoActions).findings.list
}

fn rules(body: &str) -> Vec<Rule> {
    findings(body).into_iter().map(|finding| finding.rule).collect()
}

#[test]
fn a_joint_needs_its_worst_time_until_it_is_known_where_it_is() {
    // From anywhere to the left up to 500 ms, and then 500 ms to the right.
    assert_eq!(rules("do tilt-left for 499ms do tilt-right"), [Rule::TooShort]);
    assert_eq!(rules("do tilt-left for 500ms do tilt-right"), []);
    // From the left to the middle 250 ms.
    assert_eq!(rules("do tilt-left do tilt-mid for 249ms do tilt-left"), [Rule::TooShort]);
    assert_eq!(rules("do tilt-left do tilt-mid for 250ms do tilt-left"), []);
    // It goes on while others move, and while nothing is sent.
    assert_eq!(rules("do tilt-left for 200ms do 1 for 200ms wait 100ms do tilt-right"), []);
    assert_eq!(rules("do tilt-left for 1ms wait for any at most 1s do tilt-right"), []);
    // Sent to the same place again it just goes on; nothing relies on the last step.
    assert_eq!(rules("do tilt-left for 1ms do tilt-left for 1ms"), []);
    let found = &findings("repeat 9 { do tilt-left for 100ms do tilt-right for 600ms }");
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].label.contains("500 ms") && found[0].label.contains("100 ms"), "{found:?}");
}

#[test]
fn walking_pushes_with_both_legs_alike() {
    let stride = |left: &str| {
        format!(
            "repeat 3 {{
                do tilt-right do right-leg-back + left-leg-front
                do tilt-left do right-leg-front + {left}
            }}"
        )
    };
    assert_eq!(rules(&stride("left-leg-back")), []);
    assert!(rules(&stride("left-leg-mid")).contains(&Rule::LegsNotSymmetrical));
    // Standing up, bowing, and a leg that swings freely are no walking.
    assert_eq!(rules("do tilt-mid + left-leg-mid + right-leg-mid for 1150ms"), []);
    assert_eq!(rules("do tilt-mid + left-leg-back + right-leg-back"), []);
    assert_eq!(rules("do tilt-left do right-leg-front do tilt-right do tilt-mid"), []);
}

#[test]
fn weight_on_a_moving_leg_is_told() {
    assert_eq!(rules("do tilt-left + left-leg-front"), [Rule::TrunkAgainstLegs]);
    assert_eq!(rules("do tilt-left for 50ms do left-leg-front"), [Rule::TrunkAgainstLegs]);
    assert_eq!(rules("do tilt-left + right-leg-front"), []);
    assert_eq!(rules("do tilt-left for 250ms do left-leg-front"), []);
    let scissors = "do tilt-left do tilt-mid + left-leg-front + right-leg-back";
    assert_eq!(rules(scissors), [Rule::TrunkAgainstLegs]);
}

#[test]
fn a_closed_hand_at_the_leaning_side_is_told_and_silenced() {
    let body = "do right-arm-down + right-hand-in do tilt-right";
    assert_eq!(rules(body), [Rule::ArmsMeetTrunk]);
    assert_eq!(
        rules("mirror { do right-arm-down + right-hand-in do tilt-right }"),
        [Rule::ArmsMeetTrunk]
    );
    assert_eq!(rules("do right-arm-down + right-hand-in do tilt-left"), []);
    assert_eq!(rules("do right-arm-front + right-hand-in do tilt-right"), []);
    assert_eq!(rules(&format!("allow arms-meet-trunk \"soft things\" {body}")), []);
    assert_eq!(rules(&format!("allow arms-meet-trunk \" \" {body}")), [Rule::Misplaced]);
    assert_eq!(
        rules(&format!("allow arms-meet-trunks \"x\" {body}")),
        [Rule::UnknownName, Rule::ArmsMeetTrunk]
    );
    assert_eq!(rules("allow circle \"x\" wait 1s"), [Rule::Misplaced]);
    assert_eq!(rules("allow too-short \"x\" wait 1s"), [Rule::NeedlessAllow]);
}

#[test]
fn long_and_hard_work_is_told() {
    assert_eq!(rules("wait 10s"), []);
    assert_eq!(rules("wait 9s wait for any at most 1001ms"), [Rule::NeedsThePc]);
    let hammering = "allow too-short \"a test\" do right-arm-up
        repeat 50 { do right-arm-down for 1ms do right-arm-up for 150ms }";
    assert_eq!(rules(hammering), [Rule::AgainstEndStop]);
    let all_day = "allow needs-the-pc \"a test\" repeat 1000 { do 1 + 4 do 3 + 6 }";
    assert_eq!(rules(all_day), [Rule::DrainsBatteries]);
}

#[test]
fn what_is_played_is_told_where_it_is_played() {
    let text = "action inner { do tilt-left for 9ms do tilt-right }
                action outer { wait 1s play inner play inner }";
    let checked = check_text(text, &NoActions);
    let outer: Vec<&Finding> =
        checked.findings.list.iter().filter(|it| it.action.as_deref() == Some("outer")).collect();
    assert_eq!(outer.len(), 2, "{:?}", checked.findings);
    let place = &text[outer[0].span.start..outer[0].span.end];
    assert_eq!(place, "play inner");
    assert!(outer[0].label.contains("`inner`"), "{}", outer[0].label);
}

#[test]
fn what_an_action_silences_is_silent_where_it_is_played() {
    let text =
        "action inner { allow too-short \"it shakes\" do tilt-left for 9ms do tilt-right for 9ms }
                action outer { wait 1s play inner play inner }";
    assert_eq!(check_text(text, &NoActions).findings.list, []);
}
