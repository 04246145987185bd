//! What a registry keeps, refuses and says.

use rsapien_protocol::{Joint, Pose, Position, Primitive};
use rsapien_registry::{
    ActionDraft, CompileOptions, ImportPolicy, Query, Registry, RegistryError, Rule, Statement,
    Trials,
};

fn registry() -> Registry {
    Registry::open_in_memory().unwrap()
}

fn import(registry: &mut Registry, text: &str) -> Result<Vec<String>, RegistryError> {
    let report = registry.import_text(text, ImportPolicy::Replace, &Trials::new())?;
    Ok([report.added, report.replaced].concat())
}

#[track_caller]
fn rules(result: Result<Vec<String>, RegistryError>) -> Vec<Rule> {
    match result {
        Err(RegistryError::Refused(findings)) => findings.errors().map(|it| it.rule).collect(),
        other => panic!("not refused: {other:?}"),
    }
}

#[test]
fn a_registry_can_be_sent_to_another_thread() {
    let registry = registry();
    let count = std::thread::spawn(move || registry.list().unwrap().len()).join().unwrap();
    assert!(count >= 25);
}

#[test]
fn the_primitives_are_those_of_the_link() {
    let registry = registry();
    assert!(registry.primitives().unwrap().into_iter().eq(Primitive::all()));
}

#[test]
fn the_seed_library_is_there_and_its_summaries_are_those_of_the_compiled() {
    let registry = registry();
    let list = registry.list().unwrap();
    assert!(list.is_sorted_by(|left, right| left.name < right.name));
    for summary in &list {
        let compiled = registry.compile(&summary.name, &CompileOptions::default()).unwrap();
        assert_eq!(compiled.duration_ms, summary.duration_ms, "{}", summary.name);
        assert_eq!(compiled.steps.len(), summary.step_count as usize, "{}", summary.name);
        let bits = |name: &str| Joint::ALL.iter().position(|joint| joint.name() == name).unwrap();
        let joints = summary.joints.iter().fold(0_u8, |mask, name| mask | (1 << bits(name)));
        assert_eq!(compiled.joints(), joints, "{}", summary.name);
        assert!(!summary.description.is_empty() && !summary.tags.is_empty(), "{}", summary.name);
        assert_eq!(summary.content_hash.len(), 64);
        let action = registry.get(&summary.name).unwrap();
        assert_eq!(action.warnings, [""; 0], "{}", summary.name);
    }
}

/// Follows every seeded action from the pose that INIT leaves, with travel a little quicker than
/// seeded durations have it, and looks where joints are at each step's end.
#[test]
fn seeded_joints_arrive_before_their_next_order() {
    let registry = registry();
    for summary in registry.list().unwrap() {
        let compiled = registry.compile(&summary.name, &CompileOptions::default()).unwrap();
        // Where a joint is: 0 at its first position, 2 full travels of half each to its last.
        let mut at = [1_u32; Joint::COUNT];
        let mut left_ms = [0_u32; Joint::COUNT];
        for (step, source) in compiled.steps.iter().zip(&compiled.sources) {
            for joint in Joint::ALL {
                let index = usize::from(joint.index());
                if let Some(position) = step.pose.get(joint) {
                    assert_eq!(left_ms[index], 0, "{source:?}: {joint} is still travelling");
                    let target = u32::from(position.number()) - 1;
                    left_ms[index] =
                        at[index].abs_diff(target) * u32::from(joint.full_travel_ms()) / 2;
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
        let compiled = registry().compile(name, &CompileOptions::default()).unwrap();
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
fn every_version_is_kept_word_for_word_and_can_be_restored() {
    let mut registry = registry();
    let first = "# First.\naction nod { wait 100ms  # slowly\n}";
    let second =
        "action nod(n = 2) { description \"nods\" tags head, yes\n repeat n { wait 5ms } }";
    assert_eq!(import(&mut registry, first).unwrap(), ["nod"]);
    let trials = Trials::from([("nod".to_owned(), "{\"outcome\":\"done\"}".to_owned())]);
    registry.import_text(second, ImportPolicy::Replace, &trials).unwrap();
    let action = registry.get("nod").unwrap();
    assert_eq!((action.text.as_str(), action.version), (second, 2));
    assert_eq!((action.description.as_str(), action.tags.len()), ("nods", 2));
    assert_eq!(action.trial.as_deref(), Some("{\"outcome\":\"done\"}"));
    assert!(action.created_ms > 1_700_000_000_000 && action.changed_ms >= action.created_ms);
    assert_eq!(registry.get_version("nod", 1).unwrap().text, first);
    let error = registry.get_version("nod", 3).unwrap_err();
    assert!(matches!(error, RegistryError::UnknownVersion { version: 3, latest: 2, .. }));

    registry.remove("nod").unwrap();
    assert!(matches!(registry.get("nod"), Err(RegistryError::UnknownAction { .. })));
    assert!(matches!(registry.remove("nod"), Err(RegistryError::UnknownAction { .. })));
    assert!(registry.list().unwrap().iter().all(|summary| summary.name != "nod"));
    assert_eq!(registry.history("nod").unwrap().len(), 2);
    assert_eq!(registry.restore("nod", 1).unwrap(), 3);
    let restored = registry.get("nod").unwrap();
    assert_eq!((restored.text.as_str(), restored.created_ms), (first, action.created_ms));
}

#[test]
fn an_action_in_use_is_not_removed() {
    let mut registry = registry();
    registry.save(&ActionDraft::new("hello", vec![Statement::play("shrug", 1)])).unwrap();
    import(&mut registry, "action reacts { on feet play shrug wait 1s }").unwrap();
    match registry.remove("shrug").unwrap_err() {
        RegistryError::InUse { name, users } => {
            assert_eq!((name.as_str(), users), ("shrug", vec!["hello".into(), "reacts".into()]));
        }
        other => panic!("{other}"),
    }
    registry.remove("hello").unwrap();
    registry.remove("reacts").unwrap();
    // Only older versions and removed actions play it now.
    registry.remove("shrug").unwrap();
}

#[test]
fn unknown_names_are_met_with_the_nearest() {
    let registry = registry();
    let error = registry.compile("walk-foward", &CompileOptions::default()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "there is no action \"walk-foward\"; did you mean \"walk-forward\"?"
    );
    assert!(matches!(registry.get("tilt-left"), Err(RegistryError::IsPrimitive { .. })));
    let error = registry.get("somersault").unwrap_err();
    assert_eq!(error.to_string(), "there is no action \"somersault\"");
}

#[test]
fn what_would_spoil_another_action_is_refused_and_nothing_is_stored() {
    let mut registry = registry();
    import(&mut registry, "action c { wait 1ms }").unwrap();
    import(&mut registry, "action b(n = 2) { play c times n }").unwrap();
    import(&mut registry, "action a { play b(n = 3) }").unwrap();
    assert_eq!(rules(import(&mut registry, "action c { play a }")), [Rule::Circle]);
    // The parameter that `a` gives a value is gone, or of another kind.
    for text in ["action b { play c }", "action b(n = 2ms) { wait n }"] {
        let result = import(&mut registry, text);
        let Err(RegistryError::Refused(findings)) = &result else { panic!("{result:?}") };
        assert!(findings.to_string().contains("`a`, which plays it"), "{findings}");
    }
    import(&mut registry, "action long { play c times 1000 }").unwrap();
    let long = "action c { repeat 101 { wait 1ms } }";
    assert_eq!(rules(import(&mut registry, long)), [Rule::OutOfRange]);
    assert_eq!(registry.history("c").unwrap().len(), 1);
    assert_eq!(registry.history("b").unwrap().len(), 1);
}

#[test]
fn lengths_and_hashes_of_users_follow_what_they_play() {
    let mut registry = registry();
    import(&mut registry, "action a { play b times 2 } action b { wait 100ms }").unwrap();
    let summary = |registry: &Registry, name: &str| {
        registry.list().unwrap().into_iter().find(|it| it.name == name).unwrap()
    };
    let before = summary(&registry, "a");
    assert_eq!(before.duration_ms, 200);
    import(&mut registry, "action b { description \"said otherwise\" wait 0.1s }").unwrap();
    assert_eq!(summary(&registry, "a").content_hash, before.content_hash);
    import(&mut registry, "action b { wait 300ms }").unwrap();
    let after = summary(&registry, "a");
    assert_eq!(after.duration_ms, 600);
    assert_ne!(after.content_hash, before.content_hash);
}

#[test]
fn the_same_action_has_the_same_name_everywhere() {
    let (mut here, mut there) = (registry(), registry());
    import(&mut here, "action a { play b times 2 } action b { do tilt-left for 1.5s }").unwrap();
    import(
        &mut there,
        "action z { do 13 for 1500ms } # mine\naction y { tags own play z times 2 }",
    )
    .unwrap();
    let hash = here.search(&Query { text: "a".into(), ..Query::default() }).unwrap();
    let hash = &hash.iter().find(|it| it.name == "a").unwrap().content_hash;
    let name = format!("#{}", &hash[..12]);
    assert_eq!(here.get(&name).unwrap().name, "a");
    assert_eq!(there.get(&name).unwrap().name, "y");
    assert_eq!(there.compile(&name, &CompileOptions::default()).unwrap().duration_ms, 3000);
    for name in ["#12", "#xyzxyz", "#000000000000"] {
        assert!(matches!(here.get(name), Err(RegistryError::UnknownAction { .. })), "{name}");
    }
}

#[test]
fn search_by_words_tags_joints_and_length() {
    let mut registry = registry();
    import(
        &mut registry,
        "action zebra { description \"Écrit une lettre\" tags odd # with patience\n label top repeat 2 { wait 45s } }",
    )
    .unwrap();
    let found = |query: Query| -> Vec<String> {
        registry.search(&query).unwrap().into_iter().map(|it| it.name).collect()
    };
    let text = |text: &str| Query { text: text.into(), ..Query::default() };
    for words in ["zebra", "ecrit", "LETTRE une", "pat", "top", "odd"] {
        assert_eq!(found(text(words)), ["zebra"], "{words}");
    }
    assert_eq!(found(text("wave left"))[0], "wave-left");
    assert_eq!(found(text("unheard-of")), [""; 0]);
    let tagged = |tags: &[&str]| Query {
        tags: tags.iter().map(|it| (*it).to_owned()).collect(),
        ..Query::default()
    };
    assert_eq!(found(tagged(&["walking", "safety"])), ["back-off", "explore"]);
    let legs = Query { joints: vec![Joint::LeftLeg, Joint::RightHand], ..Query::default() };
    assert!(found(legs.clone()).contains(&"stand".to_owned()));
    assert!(!found(legs).contains(&"wave".to_owned()));
    let long = Query { duration_ms_min: Some(60_000), ..Query::default() };
    assert_eq!(found(long), ["zebra"]);
    let short = Query { duration_ms_max: Some(475), ..tagged(&["hands"]) };
    assert_eq!(found(short), ["grip-left", "grip-right", "release-left", "release-right"]);
    let page = |offset| found(Query { limit: 10, offset, ..Query::default() });
    assert!(page(0).len() == 10 && page(0).iter().all(|name| !page(10).contains(name)));
    registry.remove("zebra").unwrap();
    assert!(registry.search(&text("zebra")).unwrap().is_empty());
}

#[test]
fn import_is_all_or_nothing() {
    let mut registry = registry();
    let text =
        "action hello { play nod times 2 play wave }\naction nod { do tilt-left for 300ms }\n";
    let refuse = |registry: &mut Registry, text: &str| {
        registry.import_text(text, ImportPolicy::Refuse, &Trials::new())
    };
    assert_eq!(refuse(&mut registry, text).unwrap().added, ["hello", "nod"]);
    assert_eq!(refuse(&mut registry, text).unwrap().unchanged, ["hello", "nod"]);
    assert_eq!(registry.get("nod").unwrap().version, 1);

    let changed = text.replace("times 2", "times 3").replace("action nod", "action nod2");
    match refuse(&mut registry, &changed).unwrap_err() {
        RegistryError::AlreadyExist { names } => assert_eq!(names, ["hello"]),
        other => panic!("{other}"),
    }
    assert!(registry.get("nod2").is_err());
    assert_eq!(import(&mut registry, &changed).unwrap(), ["nod2", "hello"]);
    assert_eq!(registry.get("hello").unwrap().version, 2);

    let broken = text.replace("play wave", "play wafe").replace("300", "301");
    let before = registry.export_all_text().unwrap();
    let error = import(&mut registry, &broken).unwrap_err();
    assert_eq!(
        error.to_string(),
        "error[unknown-name] in line 1: there is no action `wafe`; did you mean `wave`?"
    );
    let checked = registry.check_text(&broken).unwrap();
    assert_eq!(checked.findings.to_string(), error.to_string());
    assert!(!registry.check_text(&changed).unwrap().findings.has_errors());
    assert_eq!(registry.export_all_text().unwrap(), before);
}

#[test]
fn an_export_makes_the_same_registry_elsewhere() {
    let mut here = registry();
    here.save(&ActionDraft::new("hello", vec![Statement::play("explore", 2)])).unwrap();
    let names = |text: &str| -> Vec<String> {
        let actions = rsapien_registry::parse_text(text).actions;
        actions.into_iter().map(|it| it.draft.name.text).collect()
    };
    let with_played = names(&here.export_text(&["hello"], true).unwrap());
    let expected = [
        "hello",
        "back-off",
        "explore",
        "stride-backward",
        "stride-forward",
        "walk-backward",
        "walk-forward",
    ];
    assert_eq!(with_played, expected);
    assert_eq!(names(&here.export_text(&["hello"], false).unwrap()), ["hello"]);
    let mut there = registry();
    assert_eq!(import(&mut there, &here.export_all_text().unwrap()).unwrap(), ["hello"]);
    assert_eq!(there.export_all_text().unwrap(), here.export_all_text().unwrap());
}

#[test]
fn a_backup_is_a_registry_and_a_restore_keeps_what_was_there() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let mut registry = Registry::open(path("registry.sqlite")).unwrap();
    import(&mut registry, "action mine { wait 1s }").unwrap();
    let mut told = 0;
    registry.backup(&path("backup.sqlite"), |_, _| told += 1).unwrap();
    let again = registry.backup(&path("backup.sqlite"), |_, _| {});
    assert!(matches!(again, Err(RegistryError::FileExists { .. })));
    registry.remove("mine").unwrap();
    let kept = registry.restore_from(&path("backup.sqlite")).unwrap();
    assert_eq!(registry.get("mine").unwrap().version, 1);
    assert!(Registry::open(kept).unwrap().get("mine").is_err());
    assert_eq!(registry.integrity().unwrap().problems, []);
    std::fs::write(path("nonsense"), "no database".repeat(1000)).unwrap();
    assert!(registry.restore_from(&path("nonsense")).is_err());
    assert_eq!(registry.get("mine").unwrap().version, 1);
}

#[test]
fn what_is_derived_can_be_made_anew() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("registry.sqlite");
    let mut registry = Registry::open(&path).unwrap();
    let connection = rusqlite::Connection::open(&path).unwrap();
    connection
        .execute_batch(
            "UPDATE action SET duration_ms = 5 WHERE name = 'wave';
             UPDATE action SET content_hash = 'x' WHERE name = 'bow';
             DELETE FROM action_words WHERE rowid = (SELECT id FROM action WHERE name = 'hug');",
        )
        .unwrap();
    let integrity = registry.integrity().unwrap();
    let named: Vec<&str> = integrity.problems.iter().map(|it| it.what.as_str()).collect();
    assert_eq!(named.len(), 3, "{named:?}");
    assert!(integrity.problems.iter().all(|it| it.is_repairable && !it.advice.is_empty()));
    assert_eq!(registry.repair().unwrap().problems, []);
    assert_eq!(
        registry.search(&Query { text: "hug".into(), ..Query::default() }).unwrap().len(),
        1
    );
}

#[test]
fn actions_nest_32_deep() {
    let mut registry = registry();
    import(&mut registry, "action n1 { wait 1ms }").unwrap();
    for depth in 2..=32 {
        import(&mut registry, &format!("action n{depth} {{ play n{} }}", depth - 1)).unwrap();
    }
    let compiled = registry.compile("n32", &CompileOptions::default()).unwrap();
    assert_eq!(compiled.steps.len(), 1);
    assert_eq!(&*compiled.sources[0].action, "n1");
    assert_eq!(rules(import(&mut registry, "action n33 { play n32 }")), [Rule::OutOfRange]);
}
