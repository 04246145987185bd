//! How long a registry of 10,000 actions takes to open and list, an action to compile and save, and a search among
//! 100,000 actions, beside the same search without an index.

use criterion::{Criterion, criterion_group, criterion_main};
use rsapien_protocol::Joint;
use rsapien_registry::{
    ActionDraft, CompileOptions, ImportPolicy, Query, Registry, Statement, Trials,
};

/// Words that descriptions are made of.
const WORDS: [&str; 12] = [
    "walks", "sways", "greets", "turns", "points", "grips", "slowly", "quickly", "twice", "left",
    "right", "forward",
];

/// Steps and one action that is played, as users' actions have them.
fn many(count: usize) -> String {
    let one = |index: usize| {
        let played = if index.is_multiple_of(10) {
            "stand".to_owned()
        } else {
            format!("action-{}", index - 1)
        };
        let word = |step: usize| WORDS[index / step % WORDS.len()];
        format!(
            "action action-{index} {{\n    description \"It {} {} {}: number {index}.\"\n    tags many, group-{}\n    \
             do tilt-left + right-arm-up for 600ms\n    do right-leg-front + left-leg-back for 700ms\n    wait \
             {}ms\n    do tilt-mid + right-leg-mid + left-leg-mid for 500ms\n    play {played}\n}}\n",
            word(1),
            word(7),
            word(31),
            index % 100,
            1 + index % 5000
        )
    };
    (0..count).map(one).collect::<Vec<_>>().join("\n")
}

fn ten_thousand(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("registry.sqlite");
    let mut registry = Registry::open(&path).expect("a registry");
    registry.import_text(&many(10_000), ImportPolicy::Refuse, &Trials::new()).expect("actions");
    criterion.bench_function("open and list 10,000 actions", |bencher| {
        bencher.iter(|| Registry::open(&path).and_then(|registry| registry.list()));
    });
    criterion.bench_function("compile walk-forward out of 10,000 actions", |bencher| {
        bencher.iter(|| registry.compile("walk-forward", &CompileOptions::default()));
    });
    criterion.bench_function("compile an action 10 deep out of 10,000", |bencher| {
        bencher.iter(|| registry.compile("action-9999", &CompileOptions::default()));
    });
    let mut number = 0;
    criterion.bench_function("save one of 10,000 actions", |bencher| {
        bencher.iter(|| {
            number += 1;
            let mut draft = ActionDraft::new("saved", vec![Statement::play("wave", 1)]);
            draft.description = format!("version {number}");
            registry.save(&draft)
        });
    });
}

fn hundred_thousand(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("registry.sqlite");
    let mut registry = Registry::open(&path).expect("a registry");
    registry.import_text(&many(100_000), ImportPolicy::Refuse, &Trials::new()).expect("actions");
    let text = |text: &str| Query { text: text.to_owned(), ..Query::default() };
    let tag = Query { tags: vec!["group-7".into()], ..Query::default() };
    let joint = Query { joints: vec![Joint::LeftHand], ..Query::default() };
    let length =
        Query { duration_ms_min: Some(5000), duration_ms_max: Some(5010), ..Query::default() };
    let all = Query { tags: tag.tags.clone(), text: "sways slow".into(), ..length.clone() };
    let mut group = criterion.benchmark_group("100,000 actions");
    group.sample_size(20);
    for (name, query) in [
        ("search by a rare word", text("99999")),
        ("search by a word of every twelfth", text("greets")),
        ("search by three words", text("walks left number")),
        ("search by tag", tag),
        ("search by joint", joint),
        ("search by length", length),
        ("search by all of them", all),
    ] {
        group.bench_function(name, |bencher| bencher.iter(|| registry.search(&query)));
    }
    let peer = rusqlite::Connection::open(&path).expect("the same file");
    group.bench_function("peer: a rare word by LIKE", |bencher| {
        bencher.iter(|| {
            let mut statement = peer
                .prepare_cached(
                    "SELECT a.name FROM action AS a JOIN action_version AS v
                     ON v.action_id = a.id AND v.version = a.latest_version
                     WHERE v.source LIKE '%99999%' LIMIT 50",
                )
                .expect("a query");
            let names = statement.query_map([], |row| row.get::<_, String>(0)).expect("rows");
            names.count()
        });
    });
    let mut number = 0;
    group.bench_function("save one", |bencher| {
        bencher.iter(|| {
            number += 1;
            let mut draft = ActionDraft::new("saved", vec![Statement::play("wave", 1)]);
            draft.description = format!("version {number}");
            registry.save(&draft)
        });
    });
}

criterion_group!(benches, ten_thousand, hundred_thousand);
criterion_main!(benches);
