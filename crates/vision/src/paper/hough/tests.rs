use super::*;
use crate::paper::options::Options;
use crate::test_pictures::noise;

fn scattered(count: usize, seed: u64) -> Vec<EdgePoint> {
    noise(2 * count, seed)
        .chunks_exact(2)
        .map(|b| EdgePoint { x: b[0].into(), y: b[1].into() })
        .collect()
}

fn on_threads(threads: usize, points: &[EdgePoint], seed: u64) -> Search {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
    pool.install(|| search(points, &Options::paper().hough, 0, seed))
}

#[test]
fn one_two_and_eight_threads_find_the_same() {
    let points = scattered(700, 3);
    let one = on_threads(1, &points, 11);
    assert!(one.candidates.len() > 1000);
    assert_eq!(one, on_threads(2, &points, 11));
    assert_eq!(one, on_threads(8, &points, 11));
    assert_ne!(one.candidates, on_threads(1, &points, 12).candidates);
}

#[test]
fn pairs_are_counted_in_the_search_domain_only() {
    let points = scattered(300, 5);
    let options = Options::paper().hough;
    let found = search(&points, &options, 0, 1);
    assert_eq!((found.pairs, found.pairs_wanted), (600, 600));
    assert!(found.draws > found.pairs && !found.truncated());
    for candidate in &found.candidates {
        let a = candidate.ellipse.semi_major_px;
        assert!((29.999..=90.001).contains(&a), "{a}");
    }
}

#[test]
fn a_search_without_any_pair_in_the_domain_ends() {
    let points: Vec<_> = (0..20).map(|x| EdgePoint { x, y: 7 }).collect();
    let found = search(&points, &Options::paper().hough, 0, 1);
    assert_eq!((found.pairs, found.candidates.len()), (0, 0));
    assert_eq!(found.draws, 40 * DRAWS_PER_PAIR_MAX);
    assert!(found.truncated());
    assert_eq!(search(&points[..1], &Options::paper().hough, 0, 1).draws, 0);
}

#[test]
fn draws_are_spread_over_all_points() {
    let points: Vec<_> = (0..10).map(|x| EdgePoint { x, y: 0 }).collect();
    let mut random = batch_generator(1, 0);
    let mut counts = [0_u32; 10];
    for _ in 0..10_000 {
        counts[usize::from(draw(&points, &mut random).x)] += 1;
    }
    // Five standard deviations of a binomial with mean 1000 are 150.
    assert!(counts.iter().all(|count| (850..=1150).contains(count)), "{counts:?}");
}
