//! What a registry keeps, refuses and says.

use rsapien_protocol::{BumperMask, Joint, Pose, Position, Primitive};
use rsapien_registry::{
    ActionDraft, ActionStep, CompileOptions, Findings, ImportPolicy, Problem, Registry,
    RegistryError,
};

/// The actions that a new registry has to know.
const EXPECTED: [&str; 14] = [
    "stand",
    "walk-forward",
    "walk-backward",
    "turn-left",
    "turn-right",
    "wave",
    "bow",
    "grip-right",
    "release-right",
    "grip-left",
    "release-left",
    "pick-up",
    "throw",
    "dance",
];

fn registry() -> Registry {
    Registry::open_in_memory().unwrap()
}

fn problems(error: RegistryError) -> Vec<Problem> {
    match error {
        RegistryError::Refused(Findings(findings)) => {
            findings.into_iter().map(|finding| finding.problem).collect()
        }
        other => panic!("not refused: {other}"),
    }
}

#[test]
fn a_registry_can_be_sent_to_another_thread() {
    let registry = registry();
    let count = std::thread::spawn(move || registry.list().unwrap().len()).join().unwrap();
    assert!(count >= EXPECTED.len());
}

#[test]
fn the_primitives_are_those_of_the_link() {
    let registry = registry();
    assert!(registry.primitives().unwrap().into_iter().eq(Primitive::all()));
}

#[test]
fn the_seed_library_is_there_and_compiles() {
    let registry = registry();
    let names: Vec<String> = registry.list().unwrap().into_iter().map(|it| it.name).collect();
    assert!(names.is_sorted());
    for name in EXPECTED {
        assert!(names.iter().any(|known| known == name), "{name}");
    }
    for summary in registry.list().unwrap() {
        let compiled = registry.compile(&summary.name, CompileOptions::default()).unwrap();
        assert_eq!(compiled.duration_ms, summary.duration_ms, "{}", summary.name);
        assert!(!summary.description.is_empty() && !summary.tags.is_empty(), "{}", summary.name);
    }
}

/// Follows every seeded action from the pose that INIT leaves, with travel a little quicker than
/// seeded durations have it, and looks where joints are at each step's end.
#[test]
fn seeded_joints_arrive_before_their_next_order() {
    const TRAVEL_MS: [u32; Joint::COUNT] = [1000, 1000, 400, 400, 500, 600, 600];
    let registry = registry();
    for summary in registry.list().unwrap() {
        let compiled = registry.compile(&summary.name, CompileOptions::default()).unwrap();
        // Where a joint is: 0 at its first position, 2 full travels of half each to its last.
        let mut at = [1_u32; Joint::COUNT];
        let mut left_ms = [0_u32; Joint::COUNT];
        for (step, source) in compiled.steps.iter().zip(&compiled.sources) {
            for joint in Joint::ALL {
                let index = usize::from(joint.index());
                if let Some(position) = step.pose.get(joint) {
                    assert_eq!(left_ms[index], 0, "{source:?}: {joint} is still travelling");
                    let target = u32::from(position.number()) - 1;
                    left_ms[index] = at[index].abs_diff(target) * TRAVEL_MS[index] / 2;
                    at[index] = target;
                }
                left_ms[index] = left_ms[index].saturating_sub(u32::from(step.duration_ms));
            }
        }
        assert_eq!(left_ms, [0; Joint::COUNT], "{}: joints still travel at its end", summary.name);
    }
}

/// Dynamic walking: with the trunk tilted to a side the leg of that side carries the weight, and
/// going from front to back it drives the robot forward.
#[test]
fn walking_drives_both_legs_alike_and_turning_one() {
    let drives = |name: &str| {
        let compiled = registry().compile(name, CompileOptions::default()).unwrap();
        let mut pose = Pose::MIDDLE;
        let mut driven = [0_i32; 2];
        for step in compiled.steps {
            let tilt = step.pose.get(Joint::Tilt).or(pose.get(Joint::Tilt));
            for (slot, leg) in [(0, Joint::LeftLeg), (1, Joint::RightLeg)] {
                let carries = match tilt {
                    Some(Position::First) => leg == Joint::LeftLeg,
                    Some(Position::Last) => leg == Joint::RightLeg,
                    _ => true,
                };
                if let (Some(from), Some(to)) = (pose.get(leg), step.pose.get(leg))
                    && carries
                {
                    driven[slot] += i32::from(to.number()) - i32::from(from.number());
                }
            }
            for primitive in step.pose.primitives() {
                pose = pose.with(primitive.joint(), Some(primitive.position()));
            }
        }
        let ends_standing = [Joint::Tilt, Joint::LeftLeg, Joint::RightLeg]
            .into_iter()
            .all(|joint| pose.get(joint) == Some(Position::Middle));
        assert!(ends_standing, "{name}");
        (driven[0], driven[1])
    };
    assert_eq!(drives("walk-forward"), (4, 4));
    assert_eq!(drives("walk-backward"), (-4, -4));
    assert_eq!(drives("turn-left"), (0, 4));
    assert_eq!(drives("turn-right"), (4, 0));
}

#[test]
fn saving_keeps_every_version() {
    let mut registry = registry();
    let mut draft = ActionDraft::new("nod", vec![ActionStep::pause(100)]);
    assert_eq!(registry.save(&draft).unwrap(), 1);
    draft.description = "nods".into();
    draft.tags = vec!["head".into(), "yes".into()];
    draft.steps = vec![
        ActionStep::Move {
            pose: Pose::MIDDLE,
            duration_ms: 65535,
            ending_bumpers: BumperMask::ALL,
            times: 1000,
        },
        ActionStep::play("wave", 3),
    ];
    assert_eq!(registry.save(&draft).unwrap(), 2);
    let action = registry.get("nod").unwrap();
    assert_eq!((&action.draft, action.version), (&draft, 2));
    assert!(action.created_ms > 1_700_000_000_000 && action.changed_ms >= action.created_ms);
    assert_eq!(registry.get_version("nod", 1).unwrap().draft.steps, [ActionStep::pause(100)]);
    let error = registry.get_version("nod", 3).unwrap_err();
    assert!(matches!(error, RegistryError::UnknownVersion { version: 3, latest: 2, .. }));

    registry.remove("nod").unwrap();
    assert!(matches!(registry.get("nod"), Err(RegistryError::UnknownAction { .. })));
    assert!(matches!(registry.remove("nod"), Err(RegistryError::UnknownAction { .. })));
    assert!(registry.list().unwrap().iter().all(|summary| summary.name != "nod"));
    assert_eq!(registry.history("nod").unwrap().len(), 2);
    assert_eq!(registry.get_version("nod", 2).unwrap().draft, draft);
    assert_eq!(registry.save(&draft).unwrap(), 3);
    assert_eq!(registry.get("nod").unwrap().created_ms, action.created_ms);
}

#[test]
fn an_action_in_use_is_not_removed() {
    let mut registry = registry();
    let user = ActionDraft::new("hello", vec![ActionStep::play("wave", 1)]);
    registry.save(&user).unwrap();
    match registry.remove("wave").unwrap_err() {
        RegistryError::InUse { name, users } => {
            assert_eq!((name.as_str(), users), ("wave", vec!["dance".into(), "hello".into()]));
        }
        other => panic!("{other}"),
    }
    registry.remove("hello").unwrap();
    registry.remove("dance").unwrap();
    // Only older versions and removed actions play it now.
    registry.remove("wave").unwrap();
}

#[test]
fn unknown_names_are_met_with_the_nearest() {
    let registry = registry();
    let error = registry.compile("walk-foward", CompileOptions::default()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "there is no action \"walk-foward\"; did you mean \"walk-forward\"?"
    );
    assert!(matches!(registry.get("tilt-left"), Err(RegistryError::IsPrimitive { .. })));
    let error = registry.get("somersault").unwrap_err();
    assert_eq!(error.to_string(), "there is no action \"somersault\"");
}

#[test]
fn circles_are_refused_with_their_path() {
    let mut registry = registry();
    let plays = |name: &str, other: &str| ActionDraft::new(name, vec![ActionStep::play(other, 1)]);
    registry.save(&ActionDraft::new("c", vec![ActionStep::pause(1)])).unwrap();
    registry.save(&plays("b", "c")).unwrap();
    registry.save(&plays("a", "b")).unwrap();
    let circle = |path: &[&str]| {
        vec![Problem::Cycle { path: path.iter().map(|name| (*name).to_owned()).collect() }]
    };
    let error = registry.save(&plays("c", "a")).unwrap_err();
    assert_eq!(
        error.to_string(),
        "action \"c\": step 1: actions play each other in a circle: c -> a -> b -> c"
    );
    assert_eq!(problems(error), circle(&["c", "a", "b", "c"]));
    let error = registry.save(&plays("c", "c")).unwrap_err();
    assert_eq!(problems(error), circle(&["c", "c"]));
    assert_eq!(registry.history("c").unwrap().len(), 1);
}

#[test]
fn an_action_that_would_grow_beyond_bounds_by_another_is_protected() {
    let mut registry = registry();
    let small = ActionDraft::new("small", vec![ActionStep::pause(1)]);
    registry.save(&small).unwrap();
    registry.save(&ActionDraft::new("large", vec![ActionStep::play("small", 1000)])).unwrap();
    let grown = ActionDraft::new("small", vec![ActionStep::pause(1); 101]);
    let error = registry.save(&grown).unwrap_err();
    assert_eq!(
        error.to_string(),
        "action \"large\": it makes 101000 steps when compiled: at most 100000 are allowed"
    );
    assert_eq!(registry.get("small").unwrap().draft, small);
}

#[test]
fn actions_nest_32_deep() {
    let mut registry = registry();
    registry.save(&ActionDraft::new("n1", vec![ActionStep::pause(1)])).unwrap();
    for depth in 2..=32 {
        let below = ActionStep::play(format!("n{}", depth - 1), 1);
        registry.save(&ActionDraft::new(format!("n{depth}"), vec![below])).unwrap();
    }
    let compiled = registry.compile("n32", CompileOptions::default()).unwrap();
    assert_eq!(compiled.steps.len(), 1);
    assert_eq!(&*compiled.sources[0].action, "n1");
    let deeper = ActionDraft::new("n33", vec![ActionStep::play("n32", 1)]);
    assert_eq!(problems(registry.save(&deeper).unwrap_err()), [Problem::TooDeep { depth: 33 }]);
}

#[test]
fn import_is_all_or_nothing() {
    let mut registry = registry();
    let text = r#"
[[action]]
name = "hello"
steps = [{ play = "nod", times = 2 }, { play = "wave" }]

[[action]]
name = "nod"
steps = [{ do = "tilt-left", ms = 300 }, { do = "tilt-mid", ms = 300 }]
"#;
    let report = registry.import_toml(text, ImportPolicy::Refuse).unwrap();
    assert_eq!(report.added, ["hello", "nod"]);
    let report = registry.import_toml(text, ImportPolicy::Refuse).unwrap();
    assert_eq!(report.unchanged, ["hello", "nod"]);
    assert_eq!(registry.get("nod").unwrap().version, 1);

    let changed =
        text.replace("times = 2", "times = 3").replace("name = \"nod\"", "name = \"nod2\"");
    match registry.import_toml(&changed, ImportPolicy::Refuse).unwrap_err() {
        RegistryError::AlreadyExist { names } => assert_eq!(names, ["hello"]),
        other => panic!("{other}"),
    }
    assert!(registry.get("nod2").is_err());
    let report = registry.import_toml(&changed, ImportPolicy::Replace).unwrap();
    assert_eq!((report.added, report.replaced), (vec!["nod2".into()], vec!["hello".into()]));
    assert_eq!(registry.get("hello").unwrap().version, 2);

    let broken = text.replace("play = \"wave\"", "play = \"wafe\"").replace("300", "301");
    let before = registry.export_all_toml().unwrap();
    let expected = "line 4: action \"hello\": step 2: plays \"wafe\", which is no action; \
                    did you mean \"wave\"?";
    let error = registry.import_toml(&broken, ImportPolicy::Replace).unwrap_err();
    assert_eq!(error.to_string(), expected);
    let findings = registry.check_toml(&broken).unwrap();
    assert_eq!(findings.iter().map(ToString::to_string).collect::<Vec<_>>(), [expected]);
    assert!(registry.check_toml(&changed.replace("301", "9")).unwrap().is_empty());
    assert_eq!(registry.export_all_toml().unwrap(), before);
}

#[test]
fn an_export_makes_the_same_registry_elsewhere() {
    let mut here = registry();
    here.save(&ActionDraft::new("hello", vec![ActionStep::play("dance", 2)])).unwrap();
    let text = here.export_toml(&["hello"], true).unwrap();
    let names: Vec<String> =
        rsapien_registry::read_toml(&text).unwrap().into_iter().map(|it| it.name).collect();
    assert_eq!(names, ["hello", "dance", "stand", "wave"]);
    assert_eq!(
        rsapien_registry::read_toml(&here.export_toml(&["hello"], false).unwrap()).unwrap().len(),
        1
    );

    let mut there = registry();
    let report = there.import_toml(&here.export_all_toml().unwrap(), ImportPolicy::Refuse).unwrap();
    assert_eq!(report.added, ["hello"]);
    assert_eq!(there.export_all_toml().unwrap(), here.export_all_toml().unwrap());
}
