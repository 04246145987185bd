//! How long a registry of 10,000 actions takes to open and list, and an action to compile.

use criterion::{Criterion, criterion_group, criterion_main};
use rsapien_registry::{
    ActionDraft, ActionStep, CompileOptions, ImportPolicy, Registry, compile, read_toml, write_toml,
};

/// Four moving steps and one that plays another, as users' actions have them.
fn many(count: usize) -> String {
    let step = |text| ActionStep::parse_short(text).expect("a step");
    let drafts: Vec<ActionDraft> = (0..count)
        .map(|index| ActionDraft {
            name: format!("action-{index}"),
            description: format!("The action number {index} of a large registry."),
            tags: vec!["many".into(), format!("group-{}", index % 100)],
            steps: vec![
                step("tilt-left+right-arm-up:500"),
                step("right-leg-front+left-leg-back:650"),
                step("pause:100"),
                step("tilt-mid+right-leg-mid+left-leg-mid:500"),
                if index % 10 == 0 {
                    step("stand")
                } else {
                    ActionStep::play(format!("action-{}", index - 1), 1)
                },
            ],
        })
        .collect();
    write_toml(&drafts)
}

fn benchmark(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("registry.sqlite");
    let mut registry = Registry::open(&path).expect("a registry");
    let text = many(10_000);
    registry.import_toml(&text, ImportPolicy::Refuse).expect("actions");

    criterion.bench_function("open and list 10,000 actions", |bencher| {
        bencher.iter(|| Registry::open(&path).and_then(|registry| registry.list()));
    });
    criterion.bench_function("compile walk-forward out of 10,000 actions", |bencher| {
        bencher.iter(|| registry.compile("walk-forward", CompileOptions::default()));
    });
    criterion.bench_function("compile an action 10 deep out of 10,000", |bencher| {
        bencher.iter(|| registry.compile("action-9999", CompileOptions::default()));
    });
    let drafts = read_toml(&registry.export_toml(&["walk-forward"], true).expect("text"));
    let drafts = drafts.expect("actions");
    criterion.bench_function("compile walk-forward from memory", |bencher| {
        bencher.iter(|| compile(&drafts[0], &drafts[1..], CompileOptions::default()));
    });
    criterion.bench_function("save one of 10,000 actions", |bencher| {
        let draft = ActionDraft::new("saved", vec![ActionStep::play("wave", 1)]);
        bencher.iter(|| registry.save(&draft));
    });
    let mut group = criterion.benchmark_group("slow");
    group.sample_size(10);
    group.bench_function("check a text of 10,000 actions", |bencher| {
        bencher.iter(|| registry.check_toml(&text));
    });
}

criterion_group!(benches, benchmark);
criterion_main!(benches);
