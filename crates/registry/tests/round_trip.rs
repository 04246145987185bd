//! Whatever can be drafted comes back the same from text and from the database.

use proptest::prelude::*;
use rsapien_protocol::{BumperMask, Pose};
use rsapien_registry::{
    ActionDraft, ActionStep, ImportPolicy, Registry, RegistryError, read_toml, write_toml,
};

/// Steps that may play the actions `n0`, `n1` and so on, as many as there are before.
fn steps(before: usize) -> impl Strategy<Value = Vec<ActionStep>> {
    let moving = (0..0x4000_u16, 1..=u16::MAX, 0..64_u8, 1..=3_u16).prop_map(
        |(word, duration_ms, bumpers, times)| ActionStep::Move {
            pose: Pose::from_word(word).unwrap(),
            duration_ms,
            ending_bumpers: BumperMask::from_bits(bumpers).unwrap(),
            times,
        },
    );
    let step = if before == 0 {
        moving.boxed()
    } else {
        let playing =
            (0..before, 1..=2_u16).prop_map(|(n, times)| ActionStep::play(format!("n{n}"), times));
        prop_oneof![3 => moving, 1 => playing].boxed()
    };
    prop::collection::vec(step, 1..5)
}

fn drafts() -> impl Strategy<Value = Vec<ActionDraft>> {
    let texts =
        || (any::<String>(), prop::collection::btree_set("[a-z0-9]([a-z0-9-]?[a-z0-9])?", 0..4));
    let count = 1..6_usize;
    count
        .prop_flat_map(move |count| {
            (0..count).map(|index| (texts(), steps(index))).collect::<Vec<_>>()
        })
        .prop_map(|parts| {
            let draft = |(index, ((description, tags), steps))| ActionDraft {
                name: format!("n{index}"),
                description,
                tags: Vec::from_iter(tags),
                steps,
            };
            (0_usize..).zip(parts).map(draft).collect()
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn through_text(drafts in drafts()) {
        let text = write_toml(&drafts);
        prop_assert_eq!(read_toml(&text).expect(&text), drafts);
    }

    #[test]
    fn through_the_database(drafts in drafts()) {
        // In reverse, so that every action plays only those that stand behind it.
        let reversed: Vec<ActionDraft> = drafts.iter().rev().cloned().collect();
        let mut registry = Registry::open_in_memory().unwrap();
        match registry.import_toml(&write_toml(&reversed), ImportPolicy::Refuse) {
            Ok(_) => {
                for draft in &drafts {
                    prop_assert_eq!(&registry.get(&draft.name).unwrap().draft, draft);
                }
                let again = registry.import_toml(&write_toml(&drafts), ImportPolicy::Refuse);
                prop_assert_eq!(again.unwrap().unchanged.len(), drafts.len());
            }
            Err(RegistryError::Refused(findings)) => {
                prop_assert!(findings.to_string().contains("it lasts"), "{}", findings);
            }
            Err(other) => return Err(TestCaseError::fail(other.to_string())),
        }
    }

    #[test]
    fn no_text_panics(text in any::<String>(), step in any::<String>()) {
        let _ = read_toml(&text);
        let _ = read_toml(&format!("[[action]]\nname = \"a\"\nsteps = [{{ {step} }}]"));
        let _ = ActionStep::parse_short(&step);
    }

    #[test]
    fn short_forms_never_panic(step in "[a-z0-9:*+ -]{0,20}|(tilt-left|21|pause)[:*+][0-9a-z:*+-]{0,8}") {
        if let Ok(step) = ActionStep::parse_short(&step) {
            let draft = ActionDraft::new("a", vec![step]);
            prop_assert_eq!(rsapien_registry::check_draft(&draft), []);
        }
    }
}
