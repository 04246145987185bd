//! The name that was probably meant.

/// The candidate nearest to `text` by edit distance (insertions, deletions, substitutions), if at
/// most a third of its characters differ; the first of several equally near.
pub(crate) fn closest<'a>(text: &str, candidates: impl Iterator<Item = &'a str>) -> Option<String> {
    // Longer texts are nobody's slip of the pen, and the distance takes quadratic time.
    let text: Vec<char> = text.to_lowercase().chars().take(100).collect();
    candidates
        .map(|candidate| (edit_distance(&text, candidate), candidate))
        .filter(|(distance, candidate)| *distance <= candidate.len().div_ceil(3))
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate.to_owned())
}

fn edit_distance(left: &[char], right: &str) -> usize {
    // row[i] is the distance between the first i characters of `left` and what was read of `right`.
    let mut row: Vec<usize> = (0..=left.len()).collect();
    for (index, right) in right.chars().enumerate() {
        let mut diagonal = index;
        let mut last = index + 1;
        for (slot, left) in row.iter_mut().skip(1).zip(left) {
            let above = *slot;
            last = (diagonal + usize::from(*left != right)).min(above + 1).min(last + 1);
            diagonal = above;
            *slot = last;
        }
        if let Some(first) = row.first_mut() {
            *first = index + 1;
        }
    }
    row.last().copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_of_known_pairs() {
        let distance = |left: &str, right| edit_distance(&left.chars().collect::<Vec<_>>(), right);
        assert_eq!(distance("kitten", "sitting"), 3);
        assert_eq!(distance("", "abc"), 3);
        assert_eq!(distance("abc", ""), 3);
        assert_eq!(distance("wave", "wave"), 0);
    }

    #[test]
    fn near_names_are_suggested_and_far_ones_not() {
        let names = ["walk-forward", "walk-backward", "wave"];
        assert_eq!(closest("walk-foward", names.into_iter()).as_deref(), Some("walk-forward"));
        assert_eq!(closest("Wave", names.into_iter()).as_deref(), Some("wave"));
        assert_eq!(closest("somersault", names.into_iter()), None);
    }
}
