//! One to one matching with as many pairs as possible (H. W. Kuhn, "The Hungarian method for the assignment problem",
//! 1955, for pairs without weights).

/// A true ellipse and how much a found one overlaps it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pair {
    pub(super) truth: usize,
    pub(super) overlap: f64,
}

/// The pairs of a maximum matching among those that overlap by at least `overlap_min`, as (found, pair) in the order of
/// the truths. `overlaps` holds for each found ellipse those it overlaps, most first. The found ellipses are tried in
/// the order of their best overlap; among matchings of the same size that order decides.
pub(super) fn maximum_matching(
    overlaps: &[Vec<Pair>],
    truths: usize,
    overlap_min: f64,
) -> Vec<(usize, Pair)> {
    let reaching: Vec<&[Pair]> = overlaps
        .iter()
        .map(|pairs| &pairs[..pairs.partition_point(|pair| pair.overlap >= overlap_min)])
        .collect();
    let best = |found: usize| overlaps[found].first().map_or(0.0, |pair| pair.overlap);
    let mut order: Vec<usize> = (0..overlaps.len()).collect();
    order.sort_by(|&a, &b| best(b).total_cmp(&best(a)));
    let mut owners = vec![None; truths];
    for found in order {
        augment(found, &reaching, &mut owners);
    }
    owners.into_iter().flatten().collect()
}

/// Looks, depth first, for a chain from `found` to a true ellipse without owner along which every owner moves on to
/// another one. On a stack of its own, so that the longest chain overflows none.
fn augment(found: usize, reaching: &[&[Pair]], owners: &mut [Option<(usize, Pair)>]) {
    let mut seen = vec![false; owners.len()];
    // The found ellipses of the chain, each with the position among its pairs after the one it tries.
    let mut chain = vec![(found, 0)];
    while let Some((last, next)) = chain.last_mut() {
        let pairs = reaching[*last];
        let Some(offset) = pairs[*next..].iter().position(|pair| !seen[pair.truth]) else {
            chain.pop();
            continue;
        };
        *next += offset + 1;
        let truth = pairs[*next - 1].truth;
        seen[truth] = true;
        if let Some((owner, _)) = owners[truth] {
            chain.push((owner, 0));
        } else {
            for &(found, next) in &chain {
                let pair = reaching[found][next - 1];
                owners[pair.truth] = Some((found, pair));
            }
            return;
        }
    }
}
