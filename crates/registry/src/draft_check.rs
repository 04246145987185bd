//! What can be checked of an action by itself: its name, its words, its steps.

use std::collections::BTreeSet;

use rsapien_protocol::Primitive;

use crate::action::{
    ActionDraft, ActionStep, DESCRIPTION_LENGTH_MAX, NAME_LENGTH_MAX, STEPS_MAX, TAGS_MAX,
    TIMES_MAX,
};
use crate::problem::{Finding, Problem};

/// The word of the short form that no action may bear as its name.
pub(crate) const RESERVED_NAME: &str = "pause";

/// Everything wrong with an action that can be seen without knowing the others.
///
/// Unknown primitives and opposite positions of one joint cannot reach a draft: they are refused
/// where its steps are made ([`ActionStep::together`], [`ActionStep::parse_short`], TOML).
pub fn check_draft(draft: &ActionDraft) -> Vec<Finding> {
    let mut problems: Vec<(Option<usize>, Problem)> = Vec::new();
    problems.extend(name_problem(&draft.name).map(|problem| (None, problem)));
    let length = draft.description.chars().count();
    if length > DESCRIPTION_LENGTH_MAX {
        problems.push((None, Problem::LongDescription { length }));
    }
    if draft.tags.len() > TAGS_MAX {
        problems.push((None, Problem::TooManyTags { count: draft.tags.len() }));
    }
    let mut seen = BTreeSet::new();
    for tag in &draft.tags {
        if !is_word(tag) {
            problems.push((None, Problem::BadTag { tag: tag.clone() }));
        } else if !seen.insert(tag) {
            problems.push((None, Problem::TagTwice { tag: tag.clone() }));
        }
    }
    if draft.steps.is_empty() || draft.steps.len() > STEPS_MAX {
        problems.push((None, Problem::StepCount { count: draft.steps.len() }));
    }
    for (number, step) in (1..).zip(&draft.steps) {
        let (ActionStep::Move { times, .. } | ActionStep::Play { times, .. }) = step;
        if !(1..=TIMES_MAX).contains(times) {
            problems.push((Some(number), Problem::BadTimes { times: i64::from(*times) }));
        }
        if let ActionStep::Move { duration_ms: 0, .. } = step {
            problems.push((Some(number), Problem::BadDuration { ms: 0 }));
        }
    }
    let located = |(step, problem)| Finding::of(&draft.name, step, problem);
    problems.into_iter().map(located).collect()
}

/// What is wrong with a name for an action, if anything.
pub(crate) fn name_problem(name: &str) -> Option<Problem> {
    let name_owned = || name.to_owned();
    if name == RESERVED_NAME {
        Some(Problem::ReservedName { name: name_owned() })
    } else if Primitive::parse(name).is_ok_and(|primitive| primitive.to_string() == name) {
        Some(Problem::NameOfPrimitive { name: name_owned() })
    } else if !is_word(name) || !name.starts_with(|first: char| first.is_ascii_lowercase()) {
        Some(Problem::BadName { name: name_owned() })
    } else {
        None
    }
}

/// Lower-case letters, digits and hyphens, 1 to 64, with no hyphen at either end.
fn is_word(text: &str) -> bool {
    (1..=NAME_LENGTH_MAX).contains(&text.len())
        && text.bytes().all(|byte| matches!(byte, b'a'..=b'z' | b'0'..=b'9' | b'-'))
        && !text.starts_with('-')
        && !text.ends_with('-')
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problems(draft: &ActionDraft) -> Vec<Problem> {
        check_draft(draft).into_iter().map(|finding| finding.problem).collect()
    }

    #[test]
    fn names() {
        let longest = "a".repeat(64);
        for name in ["a", "walk-forward", "step2", longest.as_str()] {
            assert_eq!(name_problem(name), None, "{name}");
        }
        let too_long = "a".repeat(65);
        for name in
            ["", "-", "-a", "a-", "2step", "7", "Wave", "wave_2", "a b", "é", "a\n", &too_long]
        {
            assert_eq!(name_problem(name), Some(Problem::BadName { name: name.into() }));
        }
        for primitive in Primitive::all() {
            let name = primitive.to_string();
            assert_eq!(name_problem(&name), Some(Problem::NameOfPrimitive { name }));
        }
        assert!(matches!(name_problem("pause"), Some(Problem::ReservedName { .. })));
    }

    #[test]
    fn every_finding_is_told_with_its_step() {
        let mut draft = ActionDraft::new(
            "Nod",
            vec![ActionStep::pause(0), ActionStep::pause(1), ActionStep::play("wave", 0)],
        );
        draft.tags = vec!["good".into(), "Bad".into(), "good".into()];
        draft.description = "é".repeat(2001);
        let places: Vec<Option<usize>> = check_draft(&draft).iter().map(|it| it.step).collect();
        assert_eq!(places, [None, None, None, None, Some(1), Some(3)]);
        assert_eq!(
            problems(&draft),
            [
                Problem::BadName { name: "Nod".into() },
                Problem::LongDescription { length: 2001 },
                Problem::BadTag { tag: "Bad".into() },
                Problem::TagTwice { tag: "good".into() },
                Problem::BadDuration { ms: 0 },
                Problem::BadTimes { times: 0 },
            ]
        );
    }

    #[test]
    fn bounds_are_the_last_values_allowed() {
        let step = ActionStep::Move {
            pose: rsapien_protocol::Pose::MIDDLE,
            duration_ms: u16::MAX,
            ending_bumpers: rsapien_protocol::BumperMask::ALL,
            times: 1000,
        };
        let mut draft = ActionDraft::new("long", vec![step; 1000]);
        draft.description = "é".repeat(2000);
        draft.tags = (0..32).map(|number| format!("tag-{number}")).collect();
        assert_eq!(problems(&draft), []);
        draft.steps.push(ActionStep::play("other", 1001));
        draft.tags.push("one-more".into());
        assert_eq!(
            problems(&draft),
            [
                Problem::TooManyTags { count: 33 },
                Problem::StepCount { count: 1001 },
                Problem::BadTimes { times: 1001 },
            ]
        );
        draft.steps.clear();
        draft.tags.clear();
        assert_eq!(problems(&draft), [Problem::StepCount { count: 0 }]);
    }
}
